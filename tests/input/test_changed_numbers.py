"""Runs of a study one after the other, in which only the groups are read again whose numbers change, against each run alone, which reads
the whole data file: the same bits and the same codes, for the gallery with random parameters on pairs, points, bodies, loads, drives,
initial positions, couplings, gravity, times and tolerances; some values are refused.

Compares the program with itself: a run that follows others, and the same run alone.
"""
import functools
import os
import random
import re
import shutil

import pytest

from mech9_cases import TREE, run, text_of

RUNS = 5
# parts by which numbers change
SMALL, LARGE = 1e-3, 0.05
# folder, data file, program, and settings that make the runs short
MECHANISMS = (
    ('slider_crank', 'slider_crank.nml', 'k', ()), ('class_three_group', 'class_three_group.nml', 'k', ()),
    ('jansen_leg', 'jansen_leg.nml', 'k', ()), ('planetary_gear', 'planetary_gear.nml', 'k', ()),
    ('rsur', 'rsur.nml', 'k', ()), ('delta_robot', 'delta_robot.nml', 'k', ()), ('bennett', 'bennett.nml', 'k', ()),
    ('double_wishbone', 'double_wishbone.nml', 'k', ()), ('engine', 'engine.nml', 'k', ()), ('dwell_cam', 'dwell_cam.nml', 'k', ()),
    ('balanced_lamp', 'balanced_lamp.nml', 'd', ('time.end=0.1',)), ('rack_and_pinion', 'rack_and_pinion.nml', 'd', ('time.end=0.1',)),
    ('motor_crank', 'motor_crank.nml', 'd', ('time.end=0.02',)), ('crane', 'crane.nml', 'd', ('time.end=0.2',)),
    ('slider_crank_sundials', 'slider_crank.nml', 'd', ('time.end=0.2',)))
GROUP = re.compile(r'&(\w+)((?:[^/\'"]|\'[^\']*\'|"[^"]*")*)/')
ITEM = re.compile(r'(\w+)\s*=\s*((?:[-+.\d][-+.\deEdD]*\s*,?\s*)+)(?=\s*,?\s*\w+\s*=|\s*$)', re.S)
NUMBER = re.compile(r'[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?')
REAL = {'pair': ('point', 'moving_point', 'axis', 'moving_axis', 'pitch', 'dh'), 'point': ('position',), 'body': ('mass', 'centre'),
        'load': ('force', 'torque', 'stiffness', 'damping', 'free_length', 'rest', 'position'), 'gravity': ('acceleration',),
        'drive': ('coefficients', 'amplitude', 'mean', 'phase', 'angular_frequency', 'values'), 'initial': ('position', 'velocity'),
        'coupling': ('ratio', 'radius', 'radii', 'phase', 'constant'), 'time': ('end',), 'solver': ('relative_tolerance',),
        'motor': ('voltage', 'resistance', 'constant', 'proportional')}


def without_comments(text):
    return '\n'.join(re.sub(r'!(?=[^\'"]*(?:[\'"][^\'"]*[\'"][^\'"]*)*$).*', '', line) for line in text.splitlines())


def numbers_of(text):
    """Names of real numbers that the data file gives, and their values."""
    found, counts = [], {}
    groups = [(name.lower(), body) for name, body in GROUP.findall(text)]
    for name, _ in groups:
        counts[name] = counts.get(name, 0) + 1
    places = {}
    for name, body in groups:
        places[name] = places.get(name, 0) + 1
        for item, values in ITEM.findall(body):
            if item.lower() not in REAL.get(name, ()):
                continue
            values = [float(word.lower().replace('d', 'e')) for word in NUMBER.findall(values)]
            group = name if counts[name] == 1 else f'{name}({places[name]})'
            for i, value in enumerate(values):
                found.append((f'{group}.{item.lower()}' + (f'({i + 1})' if len(values) > 1 else ''), value))
    return found


def parameters(random, chosen, spread):
    """Groups &parameter for numbers, and values of a study: first those of the file, then changes of a few, the last of all."""
    groups = ''.join(f"&parameter name='p{i}', sets='{name}' /\n" for i, (name, _) in enumerate(chosen))
    rows = [[value for _, value in chosen]]
    for r in range(1, RUNS):
        share = 1.0 if r == RUNS - 1 else 0.3
        rows.append([value * (1 + spread * random.uniform(-1, 1)) if random.random() < share else value for _, value in chosen])
    return groups, rows


@functools.lru_cache()
def drawn():
    """For each mechanism and spread, in turn: the text of its data file, the numbers that are parameters, their groups and values."""
    source, found = random.Random(1718), {}
    for name, data, _, _ in MECHANISMS:
        text = without_comments(text_of(os.path.join(TREE, 'examples', name, data)))
        numbers = numbers_of(text)
        for spread in (SMALL, LARGE):
            chosen = source.sample(numbers, min(len(numbers), 8))
            found[name, spread] = text, chosen, *parameters(source, chosen, spread)
    return found


def study(program, folder, data, settings, *more):
    table = os.path.join(folder, 'study.dat')
    done = run(program, data, '--study', '--table', table, *(word for one in settings for word in ('--set', one)), *more)
    if not os.path.exists(table):
        return done, []
    lines = [line.split() for line in text_of(table).splitlines() if not line.startswith('#')]
    os.remove(table)
    return done, [line for line in lines if NUMBER.fullmatch(line[0])]


def follow(checks, folder, program, name, data, settings, spread, broken):
    """One mechanism with one choice of parameters."""
    source = os.path.join(TREE, 'examples', name)
    text, chosen, groups, rows = drawn()[name, spread]
    if broken:
        # a number that is refused, or an axis without a direction, in the middle: what follows it must be as if it had not been
        rows[RUNS // 2] = [0.0 if 'axis' in target or 'mass' in target else -abs(value) for target, value in chosen]
    for file in os.listdir(source):
        if file != data and os.path.isfile(os.path.join(source, file)):
            shutil.copy(os.path.join(source, file), folder)
    with open(os.path.join(folder, 'values.txt'), 'w', encoding='utf-8') as file:
        file.write('\n'.join(' '.join(f'{float(value)!r}' for value in row) for row in rows) + '\n')
    path = os.path.join(folder, 'case.nml')
    extra = "&quantity name='last', of='q1', take='end' /\n&quantity name='sum', of='dq2', take='rms' /\n"
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text + '\n' + groups + extra + "&study kind='list', file='values.txt' /\n")
    why = f'{name}, {[target for target, _ in chosen]}'
    done, together = study(program, folder, path, settings)
    if not checks.true(len(together) == RUNS, f'{why}: the study has its rows', done.stderr):
        return
    for i in range(RUNS):
        alone, row = study(program, folder, path, settings, '--part', f'{i + 1}/{RUNS}')
        checks.true(row == [together[i]], f'{why}: run {i + 1} is as alone', (row, together[i]))
        if float(together[i][-1]) == 0 or f'run {i + 1}: ' not in done.stderr:
            continue
        # the first run that failed is told with its message
        reason = [line for line in alone.stderr.splitlines() if f'run {i + 1}: ' in line]
        checks.true(reason != [] and reason[0] in done.stderr.splitlines(), f'{why}: run {i + 1} has its message', (alone.stderr, done.stderr))


@pytest.mark.parametrize('spread, broken', ((SMALL, False), (LARGE, True)), ids=('small changes', 'with values that are refused'))
@pytest.mark.parametrize('name, data, which, settings', MECHANISMS, ids=[mechanism[0] for mechanism in MECHANISMS])
def test_runs_of_a_study_are_as_alone(checks, tmp_path, build, name, data, which, settings, spread, broken):
    follow(checks, tmp_path, build.program(f'mech9{which}'), name, data, ('time.intervals=3',) + settings, spread, broken)
