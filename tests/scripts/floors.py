"""The floors of src, and the `use` statements by which they use each other.

A module of the project is known by its file's `module` statement.
"""
import os
import re

from mech9_cases import TREE, text_of

FLOORS = ['base', 'system', 'numerics', 'numerics/taylor', 'numerics/minima', 'numerics/continuation', 'spatial', 'structure', 'model/couplings', 'model/laws', 'model/loads', 'model/request', 'model',
          'sampling', 'user', 'kinematics/plan', 'kinematics/motion', 'kinematics/assembly', 'kinematics/planning', 'kinematics/tracking', 'kinematics/lanes',
          'ode', 'dynamics', 'dynamics/planning', 'dynamics/variations', 'analyses/sensitivity', 'dynamics/sensitivity', 'reactions', 'simulation/integration',
          'simulation/events', 'simulation', 'simulation/driven',
          'analyses/equilibrium', 'analyses/continuation', 'analyses/planar_runs', 'analyses', 'wording', 'runs', 'runs/long_term', 'studies', 'synthesis', 'input/document', 'input', 'drafts', 'input/checks', 'searches', 'output/layout', 'output', 'interchange/xml', 'interchange', 'reports',
          'pictures/plots', 'pictures/scene', 'pictures/arrows',
          'pictures/films', 'terminal', 'session/command', 'descriptions', 'descriptions/motions', 'facade', 'facade/files', 'facade/made', 'api', 'session/results', 'session/study', 'session',
          'dialogue/questions',
          'dialogue',
          'programs/mpi', 'programs']
INCLUDED = re.compile(r"^ *include '([^']+)' *$", re.M)
WITHOUT_WORDS = ('numerics', 'spatial', 'kinematics/', 'ode', 'dynamics', 'reactions', 'simulation', 'analyses/', 'synthesis')   # they fail with numbers, see src/wording
MODULE = re.compile(r'^\s*module\s+(?!procedure\b|subroutine\b|function\b)(\w+)\s*$', re.I | re.M)
USE = re.compile(r'^\s*use\b\s*(?:,\s*(?:non_)?intrinsic\s*)?(?:::)?\s*([\w@]+)\s*(,\s*only\s*:)?', re.I | re.M)
PARENT = re.compile(r'^\s*submodule\s*\(\s*(\w+)', re.I | re.M)


def sources(folder='src'):
    """(floor, path, text) of every Fortran file under src; its floor is its folder."""
    source_folder = os.path.join(TREE, folder)
    for where, folders, names in os.walk(source_folder):
        folders.sort()
        for name in sorted(names):
            if name.endswith(('.f90', '.f90.in')):
                path = os.path.join(where, name)
                with open(path, encoding='utf-8') as file:
                    yield os.path.relpath(where, source_folder).replace(os.sep, '/'), path, file.read()


def with_included(path, text):
    """The text of a file with those that it includes in their places."""
    return INCLUDED.sub(lambda found: text_of(os.path.join(os.path.dirname(path), found.group(1))), text)


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
