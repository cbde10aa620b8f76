"""The tree as it is handed on: no paths of somebody's machine, no file that holds more than one idea,
scripts that can be run, Fortran files with their head, and tests that say where they compare the program with itself.
"""
import os
import re
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from mech9_cases import TREE, Checks

LONGEST = 600
# homes and mounts that mean something on one machine only; the system's own places are fine
MACHINE_PATH = re.compile(r'(?<![\w.$}-])/(home|root|work|mnt|media|Users|opt/\w+)/[\w.]')
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


def check_self_comparisons(checks, names):
    """The tests that say in their heads that they compare the program with itself are those that tests/README.md lists."""
    said = set()
    for name in names:
        if name.startswith('tests/') and name.endswith(('.f90', '.py')) and not name.startswith('tests/scripts/'):
            with open(os.path.join(TREE, name), encoding='utf-8') as file:
                if 'Compares the program with itself' in file.read(2000):
                    said.add(name)
    with open(os.path.join(TREE, 'tests', 'README.md'), encoding='utf-8') as file:
        listed = set(re.findall(r'^\| `(tests/\S+)` \|', file.read(), re.M))
    checks.equal(said, listed, 'tests/README.md lists the tests that compare the program with itself')


def main():
    checks = Checks()
    check_self_comparisons(checks, files())
    for name in files():
        path = os.path.join(TREE, name)
        if 'malformed' in name or not name.endswith(TEXT):
            continue
        with open(path, encoding='utf-8', errors='replace') as file:
            text = file.read()
        lines = text.splitlines()
        for number, line in enumerate(lines, 1):
            if MACHINE_PATH.search(line):
                checks.true(False, f'{name}:{number}: a path of one machine', line)
        if name.endswith(('.f90', '.f', '.py', '.cmake')):
            checks.true(len(lines) <= LONGEST, f'{name}: at most {LONGEST} lines', f'it has {len(lines)}')
        if name.endswith('.f90'):
            checks.true(text.startswith('!>'), f'{name}: begins with a sentence on what it is')
            checks.true('implicit none' in text, f'{name}: implicit none')
            checks.true('\t' not in text, f'{name}: no tab characters')
        if text.startswith('#!') and not name.endswith('.in'):   # .in: made executable when configured
            checks.true(os.access(path, os.X_OK), f'{name}: can be run')
    checks.true(checks.passed > 50, 'the files were found')
    checks.finish()


main()
