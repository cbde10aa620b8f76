"""Each floor uses only the floors below it: reads the `use` statements of src, folder by folder.

A module of the project is known by its file's `module` statement; that of each must begin with mech9_,
stand in one place only, and be used with `only` (the hooks alone hand on all of mech9_taylor).
"""
import os
import re
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from mech9_cases import TREE, Checks, text_of

FLOORS = ['base', 'system', 'numerics', 'numerics/minima', 'spatial', 'structure', 'model/couplings', 'model/laws', 'model/request', 'model',
          'sampling', 'user', 'kinematics/plan', 'kinematics/motion', 'kinematics/assembly', 'kinematics/planning', 'kinematics/tracking',
          'ode', 'dynamics', 'dynamics/planning', 'dynamics/variations', 'analyses/sensitivity', 'dynamics/sensitivity', 'simulation',
          'analyses/reactions', 'analyses/equilibrium', 'analyses/planar_runs', 'analyses/synthesis', 'analyses', 'wording', 'input/document', 'input', 'output',
          'pictures/plots', 'pictures/scene',
          'pictures/films', 'terminal', 'session/command', 'session/words', 'facade', 'session/results', 'session/study', 'session/synthesis', 'session',
          'dialogue/drafts',
          'interchange/xml', 'interchange', 'dialogue',
          'programs/mpi', 'programs']
MOST_FILES = 25            # in one folder: more are hard to find one's way in
MOST_KINEMATICS = 14       # files of the kinematics that Lagrange's equations depend on, directly and through others
WITHOUT_WORDS = ('numerics', 'spatial', 'kinematics/', 'ode', 'dynamics', 'simulation', 'analyses/')   # they fail with numbers, see src/wording
MODULE = re.compile(r'^\s*module\s+(?!procedure\b|subroutine\b|function\b)(\w+)\s*$', re.I | re.M)
USE = re.compile(r'^\s*use\b\s*(?:,\s*(?:non_)?intrinsic\s*)?(?:::)?\s*([\w@]+)\s*(,\s*only\s*:)?', re.I | re.M)
PARENT = re.compile(r'^\s*submodule\s*\(\s*(\w+)', re.I | re.M)
FACADE = ('facade', 'mech9')      # the one module that other programs use
WITHOUT_ONLY = {('user', 'mech9_taylor')}


def sources(source_folder):
    """(floor, path, text) of every Fortran file under src; its floor is its folder."""
    for where, folders, names in os.walk(source_folder):
        folders.sort()
        for name in sorted(names):
            if name.endswith(('.f90', '.f90.in')):
                path = os.path.join(where, name)
                with open(path, encoding='utf-8') as file:
                    yield os.path.relpath(where, source_folder).replace(os.sep, '/'), path, file.read()


def used_modules(text):
    """(module, its only list or '') of every `use` statement, the parent of a submodule among them."""
    return [(module.lower(), only) for module, only in USE.findall(text)] + [(name.lower(), 'only') for name in PARENT.findall(text)]


def used_floors(found):
    """The other floors that each floor uses: sets by floor."""
    home = {module.lower(): floor for floor, _, text in found for module in MODULE.findall(text)}
    uses = {}
    for floor, _, text in found:
        below = {home[module] for module, _ in used_modules(text) if module in home} - {floor}
        uses.setdefault(floor, set()).update(below)
    return uses


def reached_files(found, start):
    """The files of src that those of a floor depend on, directly and through others."""
    home = {module.lower(): path for _, path, text in found for module in MODULE.findall(text)}
    uses = {path: {home[module] for module, _ in used_modules(text) if module in home} for _, path, text in found}
    reached = {path for floor, path, _ in found if floor == start}
    ahead = set(reached)
    while ahead:
        ahead = {used for path in ahead for used in uses[path]} - reached
        reached |= ahead
    return reached


def check(checks, found):
    home = {}
    for floor, path, text in found:
        checks.true(floor in FLOORS, f'{path}: {floor} is one of the floors')
        for module in MODULE.findall(text):
            checks.true(module.lower() not in home, f'{path}: module {module} stands in one place only')
            checks.true(module.startswith('mech9_') or (floor, module) == FACADE,
                        f'{path}: module {module} begins with mech9_')
            home[module.lower()] = floor
    for floor, path, text in found:
        for module, only in used_modules(text):
            if module in home:
                checks.true(FLOORS.index(home[module]) <= FLOORS.index(floor),
                            f'{path}: {floor} may not use {module}, which is of {home[module]}, a floor above')
            checks.true(module != 'mech9_text' or not floor.startswith(WITHOUT_WORDS), f'{path}: {floor} forms no texts')
            checks.true(bool(only) or (floor, module) in WITHOUT_ONLY, f'{path}: use {module} has an only list')


def main():
    checks = Checks()
    found = list(sources(os.path.join(TREE, 'src')))
    check(checks, found)
    checks.true(len(found) > 10, 'the sources were found')
    told = re.findall(r'^   ([\w/]+) {2,}\w', text_of(os.path.join(TREE, 'docs', 'architecture.md')), re.M)
    checks.equal(told[::-1], FLOORS, 'the architecture tells the same floors')
    for floor in FLOORS:
        files = [path for where, path, _ in found if where == floor]
        checks.true(0 < len(files) <= MOST_FILES, f'{floor}: at most {MOST_FILES} files', f'it has {len(files)}')
    kinematics = os.path.join(TREE, 'src', 'kinematics') + os.sep
    below = sorted(path[len(kinematics):] for path in reached_files(found, 'dynamics') if path.startswith(kinematics))
    checks.true(0 < len(below) <= MOST_KINEMATICS, f"Lagrange's equations depend on at most {MOST_KINEMATICS} files of the kinematics",
                f'they depend on {len(below)}: {" ".join(below)}')
    checks.finish()


if __name__ == '__main__':
    main()
