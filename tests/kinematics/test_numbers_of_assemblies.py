"""Closed positions and positions of rest of random mechanisms do not depend on the numbers of links and coordinates, nor on the order
of groups.

Compares the program with itself: a fault that does not depend on numbers passes.
"""
import os
import re

import numpy as np
import pytest

import families
from data_file import write
from force_files import family_groups, with_coordinates, with_links
from mech9_cases import read_table, run

# Round-off over the conditioning of positions, which may be 1e-4 in random mechanisms; other assemblies differ by more than 1e-3.
SAME = 1e-7
TWO_LOOPS = families.two_spatial_loops(10)
FAMILIES = {'five-bars': families.five_bar((2, 4)), 'six-bars of Watt': families.six_bar(families.WATT, 6),
            'six-bars of Stephenson': families.six_bar(families.STEPHENSON, 5), 'rows of four-bars': families.row_of_four_bars(4, 13),
            '3-RRR platforms': families.platform, 'loops of R, P and H': families.seven('RHRPRHR'), 'two spatial loops': TWO_LOOPS}
MEMBERS = 10


def numbered_anew(rng, groups):
    """(the mechanism with links and coordinates permuted and its groups in another order, the new number of each coordinate)."""
    count = next(items['coordinates'][0] for group, items in groups if group == 'mechanism')
    links = next(items['links'][0] for group, items in groups if group == 'mechanism')
    new = [int(k) + 1 for k in rng.permutation(count)]
    groups = with_coordinates(with_links(groups, [1, *(int(k) + 2 for k in rng.permutation(links - 1))]), new)
    return [groups[i] for i in rng.permutation(len(groups))], new


def answer(program, folder, groups, option):
    """The words on standard output, or '' with exit code 5."""
    path = os.path.join(folder, 'case.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(write(groups))
    done = run(program, path, option, folder=folder)
    if done.returncode not in (0, 5):
        raise RuntimeError(f'{write(groups)}\nended with {done.returncode}:\n{done.stderr}')
    return done.stdout if done.returncode == 0 else ''


def assembled(mech9k, folder, groups):
    """The coordinates at the start; none where the chains do not close."""
    listed = answer(mech9k, folder, groups, '--check').partition('assembled at the start:')[2]
    return [float(value) for value in re.findall(r'^  q\d+ +(\S+)$', listed, re.M)]


def resting(mech9d, folder, groups):
    """The coordinates of the equilibrium; none where there is none."""
    text = answer(mech9d, folder, groups, '--equilibrium')
    if not text:
        return []
    table = read_table(text)
    return [table[f'q{k}'][0] for k in range(1, 1 + sum(re.fullmatch(r'q\d+', name) is not None for name in table))]


def same_place(found, expected, revolute):
    """Whether two positions are the same; whole turns do not count."""
    if len(found) != len(expected) or not found:
        return len(found) == len(expected)
    difference = np.array(found) - np.array(expected)
    turned = np.where(revolute, (difference + np.pi) % (2 * np.pi) - np.pi, difference)
    return float(np.max(np.abs(turned))) < SAME


def started(rng, groups, with_guesses):
    """The mechanism without its loads, at a random start within reach of some members, perhaps with rough guesses."""
    pairs = {items['coordinate'][0]: items['kind'][0] for group, items in groups if group == 'pair'}
    driven = next(items['cq'] for group, items in groups if group == 'structure')
    changed = [(group, items) for group, items in groups if group not in ('body', 'load', 'gravity', 'drive')]
    for k in driven:
        start = float(rng.uniform(-1, 1) * (0.8 * np.pi if pairs[k] == 'revolute' else 0.5))
        changed.append(('drive', {'coordinate': [k], 'kind': ['polynomial'], 'coefficients': [start, 0.5]}))
    for k in pairs:
        if with_guesses and k not in driven:
            changed.append(('initial', {'coordinate': [k], 'position': [float(rng.uniform(-0.8, 0.8))]}))
    return changed


@pytest.mark.parametrize('name', FAMILIES)
@pytest.mark.parametrize('with_guesses', [False, True], ids=['drawn', 'guessed'])
def test_assemblies_in_other_numbers(checks, mech9k, tmp_path, name, with_guesses):
    closed = 0
    for member in range(MEMBERS):
        rng = np.random.default_rng((29, list(FAMILIES).index(name), member, with_guesses))
        groups = started(rng, family_groups(FAMILIES[name], rng), with_guesses)
        revolute = [items['kind'][0] == 'revolute' for group, items in groups if group == 'pair']
        place = assembled(mech9k, tmp_path, groups)
        closed += bool(place)
        for _ in range(3):
            other, new = numbered_anew(rng, groups)
            found = assembled(mech9k, tmp_path, other)
            found = [found[new[k] - 1] for k in range(len(new))] if found else []
            checks.true(same_place(found, place, revolute), f'{name} {member}: the same position in other numbers', (found, place))
    checks.true(closed > 0, f'{name}: some chains close', closed)


@pytest.mark.parametrize('name', ['five-bars', '3-RRR platforms', 'two spatial loops'])
def test_rests_in_other_numbers(checks, mech9d, tmp_path, name):
    for member in range(MEMBERS):
        rng = np.random.default_rng((30, list(FAMILIES).index(name), member))
        groups = [(group, items) for group, items in family_groups(FAMILIES[name], rng) if group not in ('drive', 'time')]
        cq = next(items['cq'] for group, items in groups if group == 'structure')
        groups += [('initial', {'coordinate': [k], 'position': [float(rng.uniform(-1, 1))]}) for k in cq]
        revolute = [items['kind'][0] == 'revolute' for group, items in groups if group == 'pair']
        place = resting(mech9d, tmp_path, groups)
        for _ in range(3):
            other, new = numbered_anew(rng, groups)
            found = resting(mech9d, tmp_path, other)
            found = [found[new[k] - 1] for k in range(len(new))] if found else []
            checks.true(same_place(found, place, revolute), f'{name} {member}: the same rest in other numbers', (found, place))
