"""Each floor uses only the floors below it: reads the `use` statements of src, folder by folder.

A module of the project is known by its file's `module` statement; that of each must begin with mech9_,
stand in one place only, and be used with `only` (the hooks alone hand on all of mech9_taylor).
"""
import os
import re
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from mech9_cases import TREE, Checks

FLOORS = ['base', 'numerics', 'spatial', 'structure', 'model', 'user', 'kinematics', 'dynamics',
          'input', 'output', 'pictures', 'terminal', 'session', 'dialogue', 'programs']
MODULE = re.compile(r'^\s*module\s+(?!procedure\b|subroutine\b|function\b)(\w+)\s*$', re.I | re.M)
USE = re.compile(r'^\s*use\b\s*(?:,\s*(?:non_)?intrinsic\s*)?(?:::)?\s*([\w@]+)\s*(,\s*only\s*:)?', re.I | re.M)
PARENT = re.compile(r'^\s*submodule\s*\(\s*(\w+)', re.I | re.M)
WITHOUT_ONLY = {('user', 'mech9_taylor')}


def sources(source_folder):
    """(floor, path, text) of every Fortran file under src."""
    for floor in sorted(os.listdir(source_folder)):
        folder = os.path.join(source_folder, floor)
        for where, _, names in os.walk(folder):
            for name in sorted(names):
                if name.endswith(('.f90', '.f90.in')):
                    path = os.path.join(where, name)
                    with open(path, encoding='utf-8') as file:
                        yield floor, path, file.read()


def check(checks, source_folder):
    found = list(sources(source_folder))
    home = {}
    for floor, path, text in found:
        checks.true(floor in FLOORS, f'{path}: {floor} is one of the floors')
        for module in MODULE.findall(text):
            checks.true(module.lower() not in home, f'{path}: module {module} stands in one place only')
            checks.true(module.startswith('mech9_'), f'{path}: module {module} begins with mech9_')
            home[module.lower()] = floor
    for floor, path, text in found:
        uses = USE.findall(text) + [(parent, 'only') for parent in PARENT.findall(text)]
        for module, only in uses:
            module = module.lower()
            if module in home:
                checks.true(FLOORS.index(home[module]) <= FLOORS.index(floor),
                            f'{path}: {floor} may not use {module}, which is of {home[module]}, a floor above')
            checks.true(bool(only) or (floor, module) in WITHOUT_ONLY, f'{path}: use {module} has an only list')
    return found


def main():
    checks = Checks()
    found = check(checks, os.path.join(TREE, 'src'))
    checks.true(len(found) > 10, 'the sources were found')
    for path, pattern in (('src/CMakeLists.txt', r'^add_subdirectory\((\w+)\)'), ('docs/architecture.md', r'^   (\w+) {2,}\w')):
        with open(os.path.join(TREE, path), encoding='utf-8') as file:
            told = re.findall(pattern, file.read(), re.M)
        checks.equal(told if path.startswith('src') else told[::-1], FLOORS, f'{path} tells the same floors in this order')
    checks.finish()


if __name__ == '__main__':
    main()
