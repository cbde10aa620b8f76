"""A program to which the system gives no more memory says so in one line and ends with code 8, wherever that happens; a small
stack is enough for a large mechanism."""
import os
import resource
import subprocess

import pytest

from mech9_cases import PATIENCE, TREE
from n_four_bar import data_file

DONE, FILE = 0, 8
PENDULUM = os.path.join(TREE, 'examples', 'double_pendulum', 'double_pendulum.nml')
MEBIBYTE = 1 << 20
# windows of the ladder, and steps between the least memory and enough
WINDOWS, LIMITS = 400, 14


@pytest.fixture(autouse=True)
def memory_of_the_system(build):
    if build.kind in ('Sanitize', 'Threads'):
        pytest.skip('the sanitizers have a memory of their own')


def run(words, limit=None, stack=None):
    """A program under limits of its memory and its stack [bytes]."""
    def limits():
        if limit:
            resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
        if stack:
            resource.setrlimit(resource.RLIMIT_STACK, (stack, stack))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    return subprocess.run(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors='replace',
                          timeout=120 * PATIENCE, preexec_fn=limits)


def ladder(folder, program):
    """A row of four-bar linkages, driven for mech9k."""
    path = folder / (program + '.nml')
    text = data_file(WINDOWS, 0.1)
    if program == 'mech9k':
        text = text.replace('&initial coordinate=1, position=0, velocity=-1 /',
                            "&drive coordinate=1, kind='polynomial', coefficients=0, -1 /")
    path.write_text(text, encoding='utf-8')
    return path


def options(folder):
    return ['--quiet', '--table', folder / 't.dat', '--set', 'time.intervals=2']


def least_that_does(words):
    """The least limit, to a mebibyte, under which a command is done."""
    low, high = 0, 4096 * MEBIBYTE
    while high - low > MEBIBYTE:
        middle = (low + high) // 2
        if run(words, middle).returncode == DONE:
            high = middle
        else:
            low = middle
    return high


def check_between(checks, why, program, words):
    """Limits between what a program needs to tell its version and what a run needs: none ends it without a word."""
    least, enough = least_that_does([program, '--version']), least_that_does([program, *words])
    checks.true(enough > least + MEBIBYTE, f'{why}: the run needs memory', (least, enough))
    refused = 0
    for i in range(1, LIMITS):
        limit = least + (enough - least) * i // LIMITS
        done = run([program, *words], limit)
        if done.returncode == DONE:   # the memory that is enough depends on where the system puts it
            continue
        refused += 1
        checks.equal(done.returncode, FILE, f'{why}, {limit // 1024} KiB: exit code; {done.stderr[:400]}')
        checks.true(done.stderr.startswith('out of memory: ') and done.stderr.count('\n') == 1, f'{why}, {limit // 1024} KiB: one line',
                    done.stderr[:400])
    checks.true(refused > LIMITS // 2, f'{why}: most limits are too low', refused)


def test_run(checks, mech9k, tmp_path):
    check_between(checks, 'mech9k', mech9k, [ladder(tmp_path, 'mech9k'), *options(tmp_path)])


@pytest.mark.parametrize('name', ('mech9k', 'mech9d'))
def test_check(checks, build, tmp_path, name):
    check_between(checks, f'{name} --check', build.program(name), [ladder(tmp_path, name), '--check'])


def test_program_of_a_user(checks, build, tmp_path):
    """mech9d with a user's force."""
    check_between(checks, "a user's program", build.program('failing_force_d'), [ladder(tmp_path, 'mech9d'), '--structure'])


@pytest.mark.parametrize('name', ('mech9k', 'mech9d'))
def test_small_stack(checks, build, tmp_path, name):
    data = PENDULUM if name == 'mech9d' else ladder(tmp_path, name)
    done = run([build.program(name), data, *options(tmp_path)], stack=128 * 1024)
    checks.equal(done.returncode, DONE, f'{name} with a small stack; {done.stderr[:400]}')
