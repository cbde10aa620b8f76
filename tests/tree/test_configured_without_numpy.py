"""Without Python, numpy and pytest a build is configured all the same: a warning tells that the tests in Python are left out."""
import json
import os
import re

from mech9_cases import TREE, run


def test_configured_without_numpy(checks, build, tmp_path):
    settings = build.settings
    done = run(settings['CMAKE_COMMAND'], '-S', TREE, '-B', tmp_path / 'build', '-G', 'Ninja', '-DMECH9_BUILD_TESTS=ON', '-DMECH9_TEST_PYTHON=false',
               '-DCMAKE_BUILD_TYPE=Debug',
               f"-DCMAKE_Fortran_COMPILER={settings['CMAKE_Fortran_COMPILER']}", timeout=600)
    said = re.sub(r'\s+', ' ', done.stdout + done.stderr)
    checks.equal(done.returncode, 0, f'cmake configures; {done.stdout}{done.stderr}')
    checks.true('Python 3 with numpy and pytest' in said, 'it is told that Python is not there', said)
    done = run(settings['CMAKE_CTEST_COMMAND'], '--test-dir', tmp_path / 'build', '--show-only=json-v1')
    # a program that is not built has no command yet
    commands = {test['name']: test.get('command', []) for test in json.loads(done.stdout)['tests']}
    checks.true('unit_structure.structure' in commands, 'a test in Fortran is there', sorted(commands))
    checks.true(len(commands) > 50, 'many are', len(commands))
    for name, words in commands.items():
        checks.true('/' not in name, f'{name} is no file of pytest')
        checks.true(not any(word.endswith('.py') or os.path.basename(word).startswith('python') for word in words), f'{name} needs no Python', words)
