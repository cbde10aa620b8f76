"""The tests that changes can touch, as a regular expression of names for ctest; nothing where no test is touched.

usage: affected.py COMMIT      changes are those since this commit, with files that are not committed

A suite of unit tests is touched by the modules that it uses, directly or through others. The tests in Python run whole programs.
Those floors of src that a program needs for some requests only are listed below with the tests that make such requests; a change of
another floor can touch every test in Python.
"""
import os
import re
import subprocess
import sys

from floors import MODULE, sources, used_modules
from mech9_cases import TREE, text_of

ALL = ['.*']
# Floors that only some requests need, and the tests that make these. Documents and the conversation make nearly all requests.
MANY = ['documents/', 'dialogue/', 'gallery/', 'programs/', 'session/', 'output/']
REQUESTS = {
    'interchange': ['interchange/'], 'interchange/xml': ['interchange/'],
    'dialogue': [], 'dialogue/questions': [], 'drafts': ['interchange/', 'synthesis/'], 'terminal': ['terminal/'],
    'pictures/plots': ['pictures/', 'study/', 'synthesis/'], 'pictures/scene': ['pictures/', 'synthesis/'],
    'pictures/films': ['pictures/', 'synthesis/'], 'pictures/arrows': ['pictures/'],
    'synthesis': ['synthesis/', 'threads/'],
    'analyses/planar_runs': ['synthesis/', 'threads/'], 'session/study': ['study/', 'synthesis/', 'analyses/', 'input/', 'threads/'],
    'sampling': ['study/', 'synthesis/', 'threads/'], 'numerics/minima': ['synthesis/', 'threads/'],
    'analyses/equilibrium': ['analyses/', 'model/', 'simulation/'],
    'facade': ['facade/', 'user/', 'api/', 'python/'], 'api': ['api/', 'python/'],
    'searches': ['synthesis/', 'threads/', 'python/'],
}


def changed_files(commit):
    """Paths within the project."""
    def git(*words):
        return subprocess.run(['git', '-C', TREE, *words], check=True, capture_output=True, text=True).stdout.split('\0')
    return sorted(set(filter(None, git('diff', '--name-only', '-z', commit) + git('ls-files', '-o', '--exclude-standard', '-z'))))


def users_of(paths):
    """The files of src and of unit tests that depend on some files, directly or through others, and these themselves."""
    found = [(path, text) for folder in ('src', 'tests') for _, path, text in sources(folder)]
    home = {module.lower(): path for path, text in found for module in MODULE.findall(text)}
    users = {}
    for path, text in found:
        for module, _ in used_modules(text):
            if module in home:
                users.setdefault(home[module], set()).add(path)
    reached, ahead = set(), set(paths)
    while ahead:
        reached |= ahead
        ahead = set().union(*(users.get(path, set()) for path in ahead)) - reached
    return reached


def suites_in(paths):
    """Names for ctest of the suites of unit tests whose files are among some paths."""
    for path in paths:
        found = re.fullmatch(r'tests/.*/test_(\w+)\.f90', os.path.relpath(path, TREE))
        if found:
            yield rf'^unit_\w+\.{found.group(1)}$'


def tests_of(path):
    """Names of the tests in Python that a changed file can touch."""
    folder = os.path.dirname(path)
    if path.startswith('src/'):
        floor = folder[len('src/'):]
        return [f'^{name}' for name in REQUESTS[floor] + MANY] if floor in REQUESTS else ALL
    if re.match(r'tests/.*/test_\w+\.py$', path):
        return [f'^{path[len("tests/"):-len(".py")]}$']
    if re.match(r'tests/.*\.f90$', path):
        return []
    if path.endswith('.md') or path.startswith('docs/'):
        return ['^documents/', '^tree/', '^input/']
    if path.startswith('examples/'):
        return ['^gallery/', '^documents/', '^pictures/']
    if path.startswith('bench/'):
        return ['^documents/', '^tree/']
    return ALL


def main():
    changed = [path for path in changed_files(sys.argv[1])]
    if not changed:
        return
    names = {'^tree/'}
    for path in changed:
        names.update(tests_of(path))
    fortran = [os.path.join(TREE, path) for path in changed if path.endswith('.f90')]
    names.update(suites_in(users_of(fortran)))
    print('.*' if '.*' in names else '|'.join(sorted(names)))


if __name__ == '__main__':
    main()
