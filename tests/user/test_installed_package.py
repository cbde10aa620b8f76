"""The programs of examples/library, as a project of its own that finds the installed package."""
import os

from mech9_cases import TREE, run


def test_examples_of_the_library(checks, installed, made_by_cmake):
    checks.true(os.access(installed / 'bin' / 'mech9k', os.X_OK), 'mech9k is installed')
    folder = os.path.join(TREE, 'examples', 'library')
    made = made_by_cmake(folder)
    for name, rows in (('from_file', 13), ('from_values', 11), ('other_cranks', 3)):
        done = run(made / name, folder=folder)
        checks.equal(done.returncode, 0, f'{name} runs; {done.stderr}')
        checks.equal(len(done.stdout.splitlines()), rows, f'{name}: its rows')
