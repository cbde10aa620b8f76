"""Searches in parts and in several processes: the bits of one search, whatever their number. Files of different searches, and files
with different designs for one start, are not joined.
Compares the program with itself: one search, its parts, and several processes.
"""
import os
import shutil
import signal
import subprocess
import time

import numpy as np
import pytest

from mech9_cases import PATIENCE, TREE, run, text_of
from mpi_processes import ENVIRONMENT, mpi_of
from synthesis_cases import contents_of

h5py = pytest.importorskip('h5py', reason='h5py is not installed (Debian: python3-h5py)')

DONE, USAGE, FILE = 0, 2, 8
FOLDER = os.path.join(TREE, 'examples', 'timed_path')
STARTS = 7
# A spring whose stiffness is found from the place at one time: mech9d makes its runs for quantities.
OSCILLATOR = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=2 /
&load kind='coordinate', coordinate=1, stiffness=30 /
&initial coordinate=1, position=0.1 /
&time end=1, intervals=4 /
&parameter name='k', sets='load(1).stiffness', low=20, high=300 /
&quantity name='x', of='q1', take='at', at=0.25 /
&objective kind='quantity', of='x', goal=0.01 /
&optimum starts=7 /
"""


class Cases:
    def __init__(self, checks, folder, program):
        self.checks, self.folder, self.program = checks, folder, program
        shutil.copy(os.path.join(FOLDER, 'eighteen_points.dat'), folder)
        self.data = self.write('case.nml', text_of(os.path.join(FOLDER, 'timed_path.nml')).replace('starts=20', f'starts={STARTS}'))

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), 'w', encoding='utf-8') as file:
            file.write(text)
        return self.path(name)

    def call(self, *words, code=DONE):
        done = run(self.program, *words, folder=self.folder)
        self.checks.true(done.returncode == code, f'{words}: ends with {code}', f'{done.returncode}: {done.stderr}')
        return done.stderr

    def search(self, *words, code=DONE):
        return self.call(self.data, '--optimize', *words, code=code)

    def processes(self, n, program, *words):
        return subprocess.run([shutil.which('mpiexec'), '-n', str(n), '--oversubscribe', program, *words], cwd=self.folder, env=ENVIRONMENT, text=True,
                              capture_output=True, timeout=110*PATIENCE)


@pytest.fixture
def cases(checks, tmp_path, mech9k):
    return Cases(checks, tmp_path, mech9k)


def test_joined_parts_have_the_bits_of_one_search(cases):
    check = cases.checks
    cases.search('--hdf5', 'whole.h5', '--table', 'whole.dat')
    for k in (1, 2, 3):
        told = cases.search('--part', f'{k}/3', '--hdf5', f'part{k}.h5', '--table', f'part{k}.dat')
        check.true(told.startswith(f'{(STARTS - k)//3 + 1} starts: '), 'a part makes its own starts', told)
        with h5py.File(cases.path(f'part{k}.h5')) as file:
            check.equal(list(np.flatnonzero(file['starts/found'][...] >= 0) + 1), list(range(k, STARTS + 1, 3)), 'these are K, K + N, K + 2N')
    told = cases.call('--merge', 'part3.h5', 'part1.h5', '--hdf5', 'some.h5')
    check.true('5 starts of 7 from 2 files' in told and '2 starts are not made yet' in told, 'starts that no file has are told', told)
    told = cases.call('--merge', 'part1.h5', 'some.h5', 'part2.h5', '--hdf5', 'joined.h5')
    check.true('7 starts of 7 from 3 files' in told and '3 starts stood in more than one file' in told, 'starts are joined once', told)
    cases.search('--continue', 'joined.h5', '--table', 'joined.dat')
    check.equal(text_of(cases.path('joined.dat')), text_of(cases.path('whole.dat')), 'the same table')
    check.true(contents_of(cases.path('joined.h5')) == contents_of(cases.path('whole.h5')), 'the same bits in the file')
    cases.search('--continue', 'some.h5', '--table', 'some.dat')
    check.equal(text_of(cases.path('some.dat')), text_of(cases.path('whole.dat')), 'missing starts are made: the same table')


def test_parts_that_do_not_fit_are_refused(cases):
    check = cases.checks
    cases.search('--part', '1/7', '--hdf5', 'part.h5')
    cases.search('--part', '1/7', '--hdf5', 'other.h5', '--set', 'optimum.seed=5')
    cases.search('--part', '8/9', '--hdf5', 'none.h5', code=USAGE)
    check.true(not os.path.exists(cases.path('none.h5')), 'a part without starts has no file')
    told = cases.call('--merge', 'part.h5', 'other.h5', '--hdf5', 'x.h5', code=FILE)
    check.true('are of different searches: ' in told and 'seed=5' in told, 'other searches are refused, and the difference is told', told)
    told = cases.call('--merge', 'part.h5', 'other.h5', '--hdf5', 'x.h5', '--table', 'x.dat', code=USAGE)
    check.true('leave --table out' in told, 'a merge of a search has no table', told)
    shutil.copy(cases.path('part.h5'), cases.path('changed.h5'))
    with h5py.File(cases.path('changed.h5'), 'r+') as file:
        file['starts/value'][0, 0] = 1e-6
    told = cases.call('--merge', 'part.h5', 'changed.h5', '--hdf5', 'x.h5', code=FILE)
    check.true('different designs for start 1' in told, 'different numbers for one start are refused', told)
    cases.call(cases.data, '--hdf5', 'run.h5')
    for first, second, words in (('part.h5', 'run.h5', 'it is not the file of a search by --optimize'),
                                 ('run.h5', 'part.h5', 'run.h5')):
        told = cases.call('--merge', first, second, '--hdf5', 'x.h5', code=FILE)
        check.true(words in told, 'other files are refused', told)
    check.true(not os.path.exists(cases.path('x.h5')), 'what is refused leaves no file')


def test_a_full_disk_ends_a_merge(cases):
    """A limit of the size of files takes the place of a full disk. Wherever it ends the writing, no file is left, and the parts stay."""
    check = cases.checks
    for k in (1, 2):
        cases.search('--part', f'{k}/2', '--hdf5', f'part{k}.h5')
    before = [contents_of(cases.path(f'part{k}.h5')) for k in (1, 2)]
    for kilobytes in (1, 8, 64, 140):
        done = run('sh', '-c', f'ulimit -f {2*kilobytes}; exec "$0" "$@"', cases.program, '--merge', 'part1.h5', 'part2.h5', '--hdf5', 'joined.h5',
                   folder=cases.folder)
        check.true(done.returncode == FILE and "cannot write to 'joined.h5'" in done.stderr, f'{kilobytes} kB: told', f'{done.returncode}: {done.stderr}')
        check.true(not os.path.exists(cases.path('joined.h5')), f'{kilobytes} kB: no file is left')
    check.true(before == [contents_of(cases.path(f'part{k}.h5')) for k in (1, 2)], 'the parts stay as they are')


@pytest.mark.parametrize('name', ('mech9k', 'mech9d'))
def test_several_processes_find_the_bits_of_one(cases, build, name):
    check = cases.checks
    mpi_of(build)
    cases.program = build.program(name)
    if name == 'mech9d':
        cases.data = cases.write('case.nml', OSCILLATOR)
    cases.search('--hdf5', 'whole.h5', '--table', 'whole.dat')
    for n in (1, 3):
        done = cases.processes(n, build.program(f'{name}-mpi'), cases.data, '--optimize', '--hdf5', 'team.h5', '--table', 'team.dat')
        check.true(done.returncode == DONE and done.stderr.count('7 starts: ') == 1, f'{n} processes go through, and say so once', done.stderr)
        check.equal(text_of(cases.path('team.dat')), text_of(cases.path('whole.dat')), f'{n} processes write the same table')
        check.true(contents_of(cases.path('team.h5')) == contents_of(cases.path('whole.h5')), f'{n} processes write the same bits')
    done = cases.processes(2, build.program(f'{name}-mpi'), cases.data, '--optimize', '--table', 'none/table.dat')
    check.true(done.returncode == FILE and done.stderr.count('none/table.dat') == 1, 'a mistake of the first one ends all, and is told once', done.stderr)


def test_a_killed_process_ends_all_and_loses_no_start(cases, build):
    check = cases.checks
    mpirun = mpi_of(build)
    cases.data = cases.write('case.nml', text_of(cases.data).replace(f'starts={STARTS}', 'starts=40'))
    words = [mpirun, '-n', '3', '--oversubscribe', build.program('mech9k-mpi'), cases.data, '--optimize', '--hdf5', 'cut.h5']
    with subprocess.Popen(words, cwd=cases.folder, env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                          start_new_session=True) as process:
        end = time.time() + 30*PATIENCE
        while time.time() < end and made_starts(cases.path('cut.h5')) == 0:
            time.sleep(0.02)
        children = run('ps', '-o', 'pid=', '--ppid', str(process.pid)).stdout.split()
        os.kill(int(children[-1]), signal.SIGKILL)
        check.true(process.wait(60*PATIENCE) != DONE, 'a process that is killed ends all')
    made = made_starts(cases.path('cut.h5'))
    check.true(0 < made < 40, 'the kill comes in the middle', made)
    cases.search('--continue', 'cut.h5', '--threads', '2')
    cases.search('--hdf5', 'whole.h5')
    check.true(contents_of(cases.path('cut.h5')) == contents_of(cases.path('whole.h5')), 'one process continues to the same bits')


def made_starts(path):
    """How many starts the file of a search has; 0 where it is about to be written."""
    try:
        with h5py.File(path, 'r', locking=False) as file:
            return int((file['starts/found'][()] >= 0).sum())
    except (OSError, KeyError):
        return 0
