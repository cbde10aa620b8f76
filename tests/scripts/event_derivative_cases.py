"""Runs with derivatives through events, and derivatives against differences of runs."""
import json
import re

import numpy as np

from mech9_cases import read_table, run

BOUNCING = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /
&body link=2, mass=2 /
&gravity acceleration=0,0,-9.81 /
&stop coordinate=1, low=0, restitution=0.9 /
&initial coordinate=1, position=1 /
&parameter name='h', sets='initial(1).position' /
&parameter name='e', sets='stop(1).restitution' /
&parameter name='g', sets='gravity(1).acceleration(3)' /
&parameter name='low', sets='stop(1).low' /
&parameter name='m', sets='body(1).mass' /
"""
OSCILLATOR = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1 /
&load kind='coordinate', coordinate=1, stiffness=1, damping=0.2 /
&load kind='coordinate', coordinate=1, force=1, law='harmonic', amplitude=1, angular_frequency=2.5, phase=1.5707963267948966 /
&stop coordinate=1, low=0, restitution=0.8 /
&initial coordinate=1, position=0.5, velocity=0.1 /
"""
FOUR_BAR = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.2,0,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.7,0,0, axis=0,0,1, moving_point=1,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', point=0.6,0,0, axis=0,0,1 /
&initial coordinate=1, position=0.5, velocity=1 /
&initial coordinate=2, position=0.3 /
&initial coordinate=3, position=1 /
&initial coordinate=4, position=1.7 /
&body link=2, mass=0.2, centre=0.1,0,0, inertia=0,0,0.0006666666666666667,0,0,0 /
&body link=3, mass=0.5, centre=0.45,0,0, inertia=0,0,0.010416666666666667,0,0,0 /
&body link=4, mass=2, centre=0.8,0,0, inertia=0,0,0.026666666666666667,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&load kind='coordinate', coordinate=1, damping=0.05 /
&stop coordinate=4, high=2.3, restitution=0.7 /
&parameter name='v', sets='initial(1).velocity' /
&parameter name='m', sets='body(3).mass' /
&parameter name='l', sets='pair(3).point(1)' /
&parameter name='e', sets='stop(1).restitution' /
&parameter name='high', sets='stop(1).high' /
"""
COLUMNS = '&output sensitivities=.true. /\n'
TIGHT = '&solver relative_tolerance=1e-12, absolute_tolerance=1e-13 /\n'


def go(program, folder, text, *words, end=1.0, intervals=1, code=0):
    """Table, report and standard error of a run."""
    path, table, report = folder / 'event.nml', folder / 'event.dat', folder / 'event.json'
    path.write_text(f'{text}&time end={end!r}, intervals={intervals} /\n', encoding='utf-8')
    done = run(program, path, '--table', table, '--report', report, *words)
    assert done.returncode == code, done.stderr
    return read_table(table.read_text()) if code == 0 else None, json.loads(report.read_text()), done.stderr


def kinds(report):
    return [(event['kind'], event['number']) for event in report['events']]


def against_differences(checks, program, folder, text, columns, end, intervals, output=COLUMNS, step=1e-5, tol=2e-7):
    """Derivatives of all columns by all parameters against differences of fourth order of runs in which the same events happen."""
    table, report, _ = go(program, folder, text + output + TIGHT, end=end, intervals=intervals)
    plain = re.sub('&parameter.*\n', '', text) + output.replace('sensitivities=.true.', 'sensitivities=.false.')
    for name, target in re.findall(r"&parameter name='(\w+)', sets='([^']+)'", text):
        near = {}
        for i in (-2, -1, 1, 2):
            value = number_of(text, target) + i * step
            near[i], other, _ = go(program, folder, plain + TIGHT, '--set', f'{target}={value!r}', end=end, intervals=intervals)
            checks.true(kinds(other)[:6] == kinds(report)[:6], 'the same events happen', name)
        for column in columns:
            slope = (8 * (near[1][column] - near[-1][column]) - near[2][column] + near[-2][column]) / (12 * step)
            # tolerance: the error of motions, 1e-12 to 1e-11, over the step
            checks.near(table[f'd({column})/d({name})'], slope, tol, f'{column} by {name}', scale=max(1.0, float(np.abs(slope).max())))
    return report


def quantities_against_differences(checks, program, folder, text, takes, end, intervals, step=1e-5, tol=5e-6):
    """Derivatives of quantities, each a column and what is taken of it, against differences of fourth order, as above."""
    asked = ''.join(f"&quantity name='n{i}', of='{take.split()[0]}', take='{take.split()[1]}' /\n" for i, take in enumerate(takes))
    _, report, _ = go(program, folder, text + asked + '&output gradients=.true., energies=.true. /\n' + TIGHT, end=end, intervals=intervals)
    plain = re.sub('&parameter.*\n', '', text) + asked + '&output energies=.true. /\n' + TIGHT
    for name, target in re.findall(r"&parameter name='(\w+)', sets='([^']+)'", text):
        near = {}
        for i in (-2, -1, 1, 2):
            _, other, _ = go(program, folder, plain, '--set', f'{target}={number_of(text, target) + i * step!r}', end=end, intervals=intervals)
            checks.true(kinds(other)[:6] == kinds(report)[:6], 'the same events happen', name)
            near[i] = [one['value'] for one in other['quantities']]
        for i, take in enumerate(takes):
            slope = (8 * (near[1][i] - near[-1][i]) - near[2][i] + near[-2][i]) / (12 * step)
            found = {one['parameter']: one['value'] for one in report['quantities'][i]['gradient']}[name]
            checks.true(found is not None, f'{take} by {name}', 'is not known')
            # tolerance: as above
            if found is not None:
                checks.near(found, slope, tol, f'{take} by {name}', scale=max(1.0, abs(slope)))
    return report


def number_of(text, target):
    """A number of a data file by its name."""
    group, number, name, place = re.match(r'(\w+)\((\d+)\)\.(\w+)(?:\((\d+)\))?', target).groups()
    group = re.findall(rf'&{group}\s([^/]*)/', text)[int(number) - 1]
    return float(re.search(rf'\b{name}=([-\d.,e+]+)', group).group(1).strip(',').split(',')[int(place or 1) - 1])
