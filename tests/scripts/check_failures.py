"""Each kind of failure in numbers is raised in numerics, and has its sentence in src/wording.

Kinds are the constants of src/base/failure.f90; their numbers are 1, 2, ... without gaps.
"""
import os
import re
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from check_floors import WITHOUT_WORDS, sources
from mech9_cases import TREE, Checks, text_of


def main():
    checks = Checks()
    kinds = re.findall(r'^  integer, parameter :: (failure_\w+) = (\d+)',
                       text_of(os.path.join(TREE, 'src', 'base', 'failure.f90')), re.M)
    checks.equal([int(number) for _, number in kinds], list(range(1, len(kinds) + 1)), 'kinds are numbered without gaps')
    numerics, wording = '', ''
    for floor, _, text in sources(os.path.join(TREE, 'src')):
        code = re.sub(r'^ *use .*?[^&]$', '', re.sub(r'!.*', '', text), flags=re.M | re.S)
        if floor.startswith(WITHOUT_WORDS):
            numerics += code
        if floor == 'wording':
            wording += code
    checks.true(len(kinds) > 10, 'kinds were found')
    for kind, _ in kinds:
        checks.true(re.search(rf'\b{kind}\b', numerics), f'{kind} is raised in numerics')
        checks.true(re.search(rf'\b{kind}\b', wording), f'{kind} has a sentence in src/wording')
    checks.true(not re.search(r"call raise\(err, \w+, '", numerics), 'numerics raise no messages')
    checks.finish()


if __name__ == '__main__':
    main()
