"""Each kind of failure in numbers is raised in numerics, and has its sentence in src/wording.

Kinds are the constants of src/base/failure.f90; their numbers are 1, 2, ... without gaps.
"""
import os
import re

import pytest

from floors import WITHOUT_WORDS
from mech9_cases import TREE, text_of

KINDS = re.findall(r'^  integer, parameter :: (failure_\w+) = (\d+)', text_of(os.path.join(TREE, 'src', 'base', 'failure.f90')), re.M)


def code_of(sources, belongs):
    """The code of the floors that belong, without comments and `use` statements."""
    return ''.join(re.sub(r'^ *use .*?[^&]$', '', re.sub(r'!.*', '', text), flags=re.M | re.S) for floor, _, text in sources if belongs(floor))


@pytest.fixture(scope='module')
def numerics(sources):
    return code_of(sources, lambda floor: floor.startswith(WITHOUT_WORDS))


def test_kinds_are_numbered_without_gaps(checks):
    checks.true(len(KINDS) > 10, 'kinds were found')
    checks.equal([int(number) for _, number in KINDS], list(range(1, len(KINDS) + 1)), 'kinds are numbered without gaps')


def test_kinds_are_raised_in_numerics(checks, numerics):
    for kind, _ in KINDS:
        checks.true(re.search(rf'\b{kind}\b', numerics), f'{kind} is raised in numerics')


def test_kinds_have_sentences(checks, sources):
    wording = code_of(sources, lambda floor: floor == 'wording')
    for kind, _ in KINDS:
        checks.true(re.search(rf'\b{kind}\b', wording), f'{kind} has a sentence in src/wording')


def test_numerics_raise_no_messages(checks, numerics):
    checks.true(not re.search(r"call raise\(err, \w+, '", numerics), 'numerics raise no messages')
