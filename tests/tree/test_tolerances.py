"""Each tolerance stands with its reason, is used, and stands in the file of a floor that uses it, or in the one that floors share."""
import os
import re

from floors import with_included
from mech9_cases import TREE

SHARED = os.path.join(TREE, 'src', 'kinematics', 'plan', 'tolerances.f90')
TOLERANCE = re.compile(r'^(.*)\n  real\(wp\), parameter :: (\w+)', re.M)


def is_home(path):
    return path == SHARED or path.endswith('_tolerances.f90')


def code_of(text):
    """The code of a file, without comments and `use` statements."""
    return re.sub(r'^ *use .*?[^&]$', '', re.sub(r'!.*', '', text), flags=re.M | re.S)


def test_tolerances_have_reasons_and_are_used(checks, sources):
    homes = [(floor, path, text) for floor, path, text in sources if is_home(path)]
    checks.true(len(homes) > 3, 'files of tolerances were found')
    code = {}
    for floor, path, text in sources:
        if not is_home(path):
            code[floor] = code.get(floor, '') + code_of(with_included(path, text))
    names = []
    for floor, path, text in homes:
        users = ''.join(code.values()) + code_of(text).split('\ncontains\n')[-1] if path == SHARED else code[floor]
        for before, name in TOLERANCE.findall(text):
            checks.true(before.startswith('  !> '), f'{path}: {name} has its reason')
            checks.true(re.search(rf'\b{name}\b', users), f'{path}: {name} is used' + (f' in src/{floor}' if path != SHARED else ''))
            names.append(name)
    checks.true(len(names) > 50, 'tolerances were found')
    checks.equal(len(set(names)), len(names), 'each name stands in one file')
