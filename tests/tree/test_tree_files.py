"""The tree as it is handed on: nothing at its root but what belongs there, no paths of somebody's machine, no file that holds more than one idea,
scripts that can be run, Fortran files with their head, pages where the files name them, and tests that say where they compare the program
with itself.
"""
import os
import re
import subprocess

import pytest

from mech9_cases import TREE, text_of

ROOT = set('.ci .gitignore CHANGELOG.md CITATION.cff CMakeLists.txt CMakePresets.json CONTRIBUTING.md LICENSE README.md bench cmake docs examples '
           'include packaging python src tests user_procs'.split())
LONGEST = 600
# homes and mounts that mean something on one machine only; the system's own places are fine
MACHINE_PATH = re.compile(r'(?<![\w.$}-])/(home|root|work|mnt|media|Users|opt/\w+)/[\w.]')
# a page that a comment, a message or a test names
PAGE = re.compile(r'(?<![\w./-])(?:bench|docs|examples|tests|user_procs)/(?:[\w-]+/)*[\w-]+\.md\b')
TEXT = ('.f90', '.f', '.py', '.sh', '.cmake', '.txt', '.md', '.nml', '.json', '.in', 'run')
SKIPPED = {'.git', 'build', '__pycache__'}


def files():
    """Every file of the project: those that git knows, or all where there is no git."""
    try:
        listed = subprocess.run(['git', '-c', 'safe.directory=*', '-C', TREE, 'ls-files', '-z'], check=True,
                                capture_output=True, text=True)
        names = [name for name in listed.stdout.split('\0') if name]
        if names:
            return [name for name in names if os.path.isfile(os.path.join(TREE, name))]
    except (OSError, subprocess.CalledProcessError):
        pass
    names = []
    for where, folders, found in os.walk(TREE):
        folders[:] = [folder for folder in folders if folder not in SKIPPED and not folder.startswith('build')]
        names += [os.path.relpath(os.path.join(where, name), TREE) for name in found]
    return names


@pytest.fixture(scope='module')
def names():
    """The names of all files of the project."""
    found = files()
    assert len(found) > 50, 'the files were found'
    return found


@pytest.fixture(scope='module')
def texts(names):
    """The texts of those files that hold one, by their names. Those of tests/input/malformed are wrong on purpose."""
    found = {}
    for name in names:
        if '/malformed/' not in name and name.endswith(TEXT):
            with open(os.path.join(TREE, name), encoding='utf-8', errors='replace') as file:
                found[name] = file.read()
    return found


def test_root(checks, names):
    """Documents and CMake files stand at the root of the project, and nothing else."""
    checks.equal({name.split('/')[0] for name in names} - ROOT, set(), 'nothing else stands at the root')


def test_modules_of_scripts(checks, names):
    """Python may take a folder of tests for a module of its name."""
    folders = {name.split('/')[1] for name in names if re.match(r'tests/\w+/', name)}
    modules = {os.path.basename(name)[:-3] for name in names if re.match(r'tests/scripts/\w+\.py$', name)}
    checks.true(len(folders) > 20 and len(modules) > 10, 'folders and modules were found')
    checks.equal(folders & modules, set(), 'no module has the name of a folder')


def test_no_paths_of_one_machine(checks, texts):
    for name, text in texts.items():
        found = [f'{number}: {line}' for number, line in enumerate(text.splitlines(), 1) if MACHINE_PATH.search(line)]
        checks.true(not found, f'{name}: no path of one machine', '\n'.join(found))


def test_files_are_short(checks, texts):
    for name, text in texts.items():
        if name.endswith(('.f90', '.f', '.py', '.cmake')):
            lines = len(text.splitlines())
            checks.true(lines <= LONGEST, f'{name}: at most {LONGEST} lines', f'it has {lines}')


def test_heads_of_fortran_files(checks, texts):
    for name, text in texts.items():
        if name.endswith('.f90'):
            checks.true(text.startswith('!>'), f'{name}: begins with a sentence on what it is')
            checks.true('implicit none' in text, f'{name}: implicit none')


def test_no_tabs_in_fortran_files(checks, texts):
    for name, text in texts.items():
        if name.endswith('.f90'):
            checks.true('\t' not in text, f'{name}: no tab characters')


def test_scripts_can_be_run(checks, texts):
    for name, text in texts.items():
        if text.startswith('#!') and not name.endswith('.in'):   # .in: made executable when configured
            checks.true(os.access(os.path.join(TREE, name), os.X_OK), f'{name}: can be run')


def test_pages_that_files_name(checks, names, texts):
    """Comments, messages and tests name pages that are there."""
    for name, text in texts.items():
        checks.equal(set(PAGE.findall(text)) - set(names), set(), f'{name}: the pages that it names are there')


def test_self_comparisons(checks, texts):
    """The tests that say in their heads that they compare the program with itself are those that tests/README.md lists."""
    said = {name for name, text in texts.items()
            if name.startswith('tests/') and name.endswith(('.f90', '.py')) and not name.startswith(('tests/scripts/', 'tests/tree/'))
            and 'Compares the program with itself' in text[:2000]}
    listed = set(re.findall(r'^\| `(tests/\S+)` \|', text_of(os.path.join(TREE, 'tests', 'README.md')), re.M))
    checks.equal(said, listed, 'tests/README.md lists the tests that compare the program with itself')
