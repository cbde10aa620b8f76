"""Each kind of failure in numbers is raised in numerics, and has its sentence in src/wording.

Kinds are constants of the modules that the table in src/base/failure.f90 lists, one for each floor that raises kinds of its own.
Each module numbers its kinds from the beginning of its range, without gaps.
"""
import os
import re

import pytest

from failures import BASE, KIND, kinds, last_kinds, ranges
from floors import WITHOUT_WORDS
from mech9_cases import TREE, text_of

RANGES = ranges()
KINDS = kinds()
HOMES = {os.path.join(TREE, 'src', *path.split('/')) for path, _, _ in RANGES}


def code_of(sources, belongs):
    """The code of the floors that belong, without comments and `use` statements, and without the modules of kinds."""
    return ''.join(re.sub(r'^ *use .*?[^&]$', '', re.sub(r'!.*', '', text), flags=re.M | re.S)
                   for floor, path, text in sources if belongs(floor) and path not in HOMES)


@pytest.fixture(scope='module')
def numerics(sources):
    return code_of(sources, lambda floor: floor.startswith(WITHOUT_WORDS))


def test_ranges_do_not_overlap(checks):
    checks.true(len(RANGES) > 5, 'ranges were found')
    bounds = [bound for _, first, last in RANGES for bound in (first, last)]
    checks.true(bounds == sorted(set(bounds)), 'ranges ascend and do not overlap', str(bounds))
    checks.true(all(first % 100 == 1 for _, first, _ in RANGES), 'ranges begin behind a multiple of 100')


def test_kinds_stand_in_the_modules_of_the_table(checks, sources):
    for _, path, text in sources:
        if path not in HOMES:
            checks.true(not KIND.search(text), f'{path}: kinds stand in the modules that src/base/failure.f90 lists only')


def test_kinds_are_unique(checks):
    checks.true(len(KINDS) > 10, 'kinds were found')
    checks.equal(len({name for name, _, _ in KINDS}), len(KINDS), 'each name stands in one module')
    checks.equal(len({number for _, number, _ in KINDS}), len(KINDS), 'each number belongs to one kind')


def test_kinds_are_numbered_without_gaps(checks):
    for path, first, last in RANGES:
        numbers = [number for _, number, where in KINDS if where == path]
        checks.equal(numbers, list(range(first, first + len(numbers))), f'src/{path}: kinds are numbered from {first} without gaps')
        checks.true(0 < len(numbers) <= last - first + 1, f'src/{path}: the range holds its kinds')
        lasts = [kind for _, kind in last_kinds(path)]
        checks.equal(lasts, [name for name, _, where in KINDS if where == path][-1:], f'src/{path}: the last kind is called so')


def test_kinds_are_raised_in_numerics(checks, numerics):
    for kind, _, _ in KINDS:
        checks.true(re.search(rf'\b{kind}\b', numerics), f'{kind} is raised in numerics')


def test_kinds_stand_in_the_lowest_floor_that_raises_them(checks, sources):
    """A floor uses only those below it, so that the lowest floor which knows a kind is the one that holds it."""
    for path, _, _ in RANGES:
        if path != BASE:
            code = code_of(sources, lambda floor, home=os.path.dirname(path): floor == home)
            for kind in [name for name, _, where in KINDS if where == path]:
                checks.true(re.search(rf'\b{kind}\b', code), f'{kind} is raised in src/{os.path.dirname(path)}')


def test_kinds_have_sentences(checks, sources):
    wording = code_of(sources, lambda floor: floor == 'wording')
    for kind, _, _ in KINDS:
        checks.true(re.search(rf'\b{kind}\b', wording), f'{kind} has a sentence in src/wording')


def test_sentences_of_each_module_are_tested(checks):
    test = text_of(os.path.join(TREE, 'tests', 'wording', 'test_explanation.f90'))
    for path, _, _ in RANGES:
        for last, _ in last_kinds(path):
            checks.equal(len(re.findall(rf'\b{last}\b', test)), 2, f'tests/wording/test_explanation.f90 goes to {last}')


def test_numerics_raise_no_messages(checks, numerics):
    checks.true(not re.search(r"call raise\(err, \w+, '", numerics), 'numerics raise no messages')
