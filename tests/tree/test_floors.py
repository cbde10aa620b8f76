"""Each floor uses only the floors below it: reads the `use` statements of src, folder by folder."""
import os
import re

import pytest

from floors import FLOORS, MODULE, WITHOUT_WORDS, reached_files, used_floors, used_modules
from mech9_cases import TREE, text_of

MOST_FILES = 25            # in one folder: more are hard to find one's way in
MOST_KINEMATICS = 13       # files of the kinematics, without those of tolerances, that Lagrange's equations depend on, directly and through others
MOST_OF_SESSION = 10       # floors that the session uses, with its sub-floors: the number only goes down
FACADE = ('facade', 'mech9')      # the one module that other programs use
# Floors of the programs, and those between them and the facade that are about data files, results, pictures and words. All other floors
# below the facade are the engine, which the programs reach through the facade.
PROGRAMS = ('session', 'dialogue', 'programs')
OPEN = {'base', 'system', 'input/document', 'drafts', 'output', 'interchange', 'interchange/xml', 'pictures/plots', 'pictures/scene', 'pictures/arrows',
        'pictures/films', 'terminal', 'session/command', 'descriptions', 'descriptions/motions'}
# Floors of the engine that programs use all the same: the lists only become shorter. A conversation knows links, pairs and units before
# there is a mechanism; processes of MPI take the places of submodules of studies and searches.
ENGINE_OF = {'dialogue': {'structure', 'model'}, 'dialogue/questions': {'structure', 'model', 'input'},
             'programs/mpi': {'sampling', 'wording', 'studies', 'synthesis', 'searches'}}
WITHOUT_ONLY = {('user', 'mech9_taylor')}


@pytest.fixture(scope='module')
def homes(sources):
    """The floor of each module, by its name."""
    return {module.lower(): floor for floor, _, text in sources for module in MODULE.findall(text)}


def test_every_folder_is_a_floor(checks, sources):
    for floor, path, _ in sources:
        checks.true(floor in FLOORS, f'{path}: {floor} is one of the floors')


def test_modules_stand_in_one_place(checks, sources):
    seen = set()
    for _, path, text in sources:
        for module in MODULE.findall(text):
            checks.true(module.lower() not in seen, f'{path}: module {module} stands in one place only')
            seen.add(module.lower())


def test_modules_begin_with_mech9(checks, sources):
    for floor, path, text in sources:
        for module in MODULE.findall(text):
            checks.true(module.startswith('mech9_') or (floor, module) == FACADE, f'{path}: module {module} begins with mech9_')


def test_floors_use_only_those_below(checks, sources, homes):
    for floor, path, text in sources:
        for module, _ in used_modules(text):
            if module in homes:
                checks.true(FLOORS.index(homes[module]) <= FLOORS.index(floor),
                            f'{path}: {floor} may not use {module}, which is of {homes[module]}, a floor above')


def test_numerics_form_no_texts(checks, sources):
    for floor, path, text in sources:
        if floor.startswith(WITHOUT_WORDS):
            checks.true('mech9_text' not in [module for module, _ in used_modules(text)], f'{path}: {floor} forms no texts')


def test_use_statements_have_an_only_list(checks, sources):
    """The hooks alone hand on all of mech9_taylor."""
    for floor, path, text in sources:
        for module, only in used_modules(text):
            checks.true(bool(only) or (floor, module) in WITHOUT_ONLY, f'{path}: use {module} has an only list')


def test_architecture_tells_the_same_floors(checks):
    told = re.findall(r'^   ([\w/]+) {2,}\w', text_of(os.path.join(TREE, 'docs', 'explanation', 'architecture.md')), re.M)
    checks.equal(told[::-1], FLOORS, 'the architecture tells the same floors')


def test_folders_hold_few_files(checks, sources):
    for floor in FLOORS:
        files = [path for where, path, _ in sources if where == floor]
        checks.true(0 < len(files) <= MOST_FILES, f'{floor}: at most {MOST_FILES} files', f'it has {len(files)}')


def test_motions_begin_on_one_floor(checks, sources):
    """Whoever runs a model has its motion from the floor of runs (mech9_model_motion)."""
    for floor, path, text in sources:
        starts = re.findall(r'^\s*call (new_(?:driven|free)_simulation)', text, re.M)
        checks.true(not starts or floor == 'runs', f'{path}: simulations are made on the floor of runs', starts)


def test_session_uses_few_floors(checks, sources):
    """The session keeps options and files; what it asks of the engine stands on floors that C and Python use, too."""
    uses = used_floors(sources)
    own = {floor for floor in uses if floor == 'session' or floor.startswith('session/')}
    below = set().union(*(uses[floor] for floor in own)) - own
    checks.equal(len(below), MOST_OF_SESSION, 'the session and its sub-floors use as many floors as are counted here: after one less, '
                 f'lower MOST_OF_SESSION ({" ".join(sorted(below))})')


def test_programs_reach_the_engine_through_the_facade(checks, sources):
    uses = used_floors(sources)
    engine = set(FLOORS[:FLOORS.index('facade')]) - OPEN
    own = {floor for floor in uses if floor.split('/')[0] in PROGRAMS}
    checks.true({'session', 'dialogue', 'programs'} <= own and 'simulation' in engine, 'floors of programs and of the engine are told apart')
    for floor in sorted(own):
        checks.equal(uses[floor] & engine, ENGINE_OF.get(floor, set()), f'{floor} uses the engine through the facade, but for floors that '
                     'are listed here: after one less, shorten ENGINE_OF')


def test_dynamics_depends_on_little_of_kinematics(checks, sources):
    kinematics = os.path.join(TREE, 'src', 'kinematics') + os.sep
    below = sorted(path[len(kinematics):] for path in reached_files(sources, 'dynamics') if path.startswith(kinematics)
                   and not path.endswith('tolerances.f90'))
    checks.true(0 < len(below) <= MOST_KINEMATICS, f"Lagrange's equations depend on at most {MOST_KINEMATICS} files of the kinematics",
                f'they depend on {len(below)}: {" ".join(below)}')
