"""Studies in several processes: the same bits as in one, whatever their number; parts in HDF5 files, and the continuation
of a study one of whose processes was killed; failed runs, mistakes and interruptions as in one.
"""
import json
import os
import re
import signal
import subprocess
import time

import pytest

from mech9_cases import PATIENCE, run, text_of
from mpi_processes import ENVIRONMENT, mpi_of

DONE, USAGE, DATA, FILE = 0, 2, 3, 8
SLIDER_CRANK = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1.1,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, zero=0,1,0, moving_point=0,0,0 /
&initial coordinate=4, position=1.2 /
&drive coordinate=1, kind='polynomial', coefficients=0.4, 10 /
&point name='B', link=4 /
&time end=0.7, intervals=40 /
&quantity name='stroke', of='B.x', take='range' /
&quantity name='late', of='B.x', take='end' /
&parameter name='crank', sets='pair(2).point(1)', low=0.2, high=0.8, count=9 /
&parameter name='rod', sets='pair(3).point(1)', low=0.5, high=1.1, count=11 /
"""
PENDULUM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0.4 /
&body link=2, mass=1, centre=0,-0.5,0, inertia=0,0,0.1,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&time end=1, intervals=20 /
&parameter name='mass', sets='body.mass' , spread=0.1 /
&quantity name='swing', of='q1', take='range' /
"""

class Cases:
    def __init__(self, checks, folder, mpirun):
        self.checks, self.folder, self.mpirun = checks, folder, mpirun

    def write(self, text, name='case.nml'):
        path = os.path.join(self.folder, name)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return path

    def command(self, processes, program, *words):
        return [self.mpirun, '-n', str(processes), '--oversubscribe', program, *words]

    def processes(self, processes, program, *words):
        return subprocess.run(self.command(processes, program, *words), cwd=self.folder, env=ENVIRONMENT, text=True, capture_output=True, timeout=110 * PATIENCE)

    def file(self, name):
        return text_of(os.path.join(self.folder, name))


@pytest.fixture
def cases(checks, tmp_path, build):
    return Cases(checks, tmp_path, mpi_of(build))


@pytest.fixture
def mech9k_mpi(build, cases):
    return build.program('mech9k-mpi')


GRID = SLIDER_CRANK + "&study kind='grid' /\n"


@pytest.mark.parametrize('name, text, why', (
    ('mech9k', GRID, 'grid'), ('mech9d', PENDULUM + "&study kind='sobol', runs=150, seed=4 /\n", 'dynamics')), ids=('grid', 'dynamics'))
def test_several_processes_write_the_bits_of_one(cases, build, name, text, why):
    """Table and report of one process and of several; times and names of tables apart, they are the same."""
    check, program, program_mpi = cases.checks, build.program(name), build.program(f'{name}-mpi')
    path = cases.write(text)
    alone = run(program, path, '--study', '--table', 'alone.dat', '--report', 'alone.json', folder=cases.folder)
    check.true(alone.returncode == DONE, f'{why}: one process', alone.stderr)
    for n in (1, 2, 4):
        done = cases.processes(n, program_mpi, path, '--study', '--table', 'team.dat', '--report', 'team.json')
        check.true(done.returncode == DONE, f'{why}: {n} processes go through', f'{done.returncode}: {done.stderr}')
        check.equal(cases.file('team.dat'), cases.file('alone.dat'), f'{why}: {n} processes write the same table')
        check.equal(json.loads(cases.file('team.json').replace('team.dat', 'alone.dat')), json.loads(cases.file('alone.json')),
                    f'{why}: {n} processes write the same report')
        messages = [re.sub(r'\S+ m?s$', '', line) for line in alone.stderr.splitlines() if not line.startswith('table')]
        lines = [re.sub(r'\S+ m?s$', '', line) for line in done.stderr.splitlines()]
        check.true(all(lines.count(line) == 1 for line in messages), f'{why}: {n} processes say the same, and once', (messages, lines))
    done = cases.processes(2, program_mpi, path, '--study', '--part', '2/3', '--table', 'team.dat')
    run(program, path, '--study', '--part', '2/3', '--table', 'alone.dat', folder=cases.folder)
    check.equal(cases.file('team.dat'), cases.file('alone.dat'), f'{why}: a part of it')


def numbers_of(path):
    """All numbers of the runs in the HDF5 file of a study, as bytes."""
    h5py = pytest.importorskip('h5py', reason='h5py is not installed (Debian: python3-h5py)')
    with h5py.File(path, 'r') as file:
        names = ['run', 'exit_code'] + [f'{group}/{name}' for group in ('parameters', 'quantities') for name in file[group]]
        return {name: file[name][()].tobytes() for name in names}


@pytest.mark.parametrize('n', (2, 4))
def test_parts_in_files_and_their_continuation(cases, mech9k, mech9k_mpi, n):
    """Parts in HDF5 files have the bits of one process; what a killed process leaves is continued by others to the same bits."""
    check = cases.checks
    path = cases.write(SLIDER_CRANK.replace('count=9', 'count=300') + "&study kind='grid' /\n")
    whole, cut, part = (os.path.join(cases.folder, name) for name in ('whole.h5', 'cut.h5', 'part.h5'))
    done = run(mech9k, path, '--study', '--part', '1/2', '--hdf5', whole, folder=cases.folder)
    check.true(done.returncode == DONE, 'the part in one process', done.stderr)
    expected = numbers_of(whole)
    done = cases.processes(n, mech9k_mpi, path, '--study', '--part', '1/2', '--hdf5', part)
    check.true(done.returncode == DONE, f'the part in {n} processes', f'{done.returncode}: {done.stderr}')
    check.true(numbers_of(part) == expected, f'the part in {n} processes has the same bits')
    made = kill_one(cases, n, mech9k_mpi, path, cut)
    check.true(0 < made < 1650, f'{n} processes: the kill comes in the middle', made)
    done = cases.processes(n, mech9k_mpi, path, '--study', '--part', '1/2', '--continue', cut)
    check.true(done.returncode == DONE, f'{n} processes continue the study', f'{done.returncode}: {done.stderr}')
    check.true(numbers_of(cut) == expected, f'{n} processes continue to the same bits')


def kill_one(cases, processes, program, path, file):
    """Kill the last process of a study in the middle; returns how many runs are in the file."""
    with subprocess.Popen(cases.command(processes, program, path, '--study', '--part', '1/2', '--hdf5', file), cwd=cases.folder, env=ENVIRONMENT,
                          stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True) as process:
        end = time.time() + 30 * PATIENCE
        while time.time() < end and not (os.path.exists(file) and made_runs(file) > 0):
            time.sleep(0.02)
        children = run('ps', '-o', 'pid=', '--ppid', str(process.pid)).stdout.split()
        os.kill(int(children[-1]), signal.SIGKILL)
        cases.checks.true(process.wait(60 * PATIENCE) != DONE, f'{processes} processes: one that is killed ends all')
    return made_runs(file)


def made_runs(file):
    """How many runs the file of a study has; 0 where it is about to be written."""
    h5py = pytest.importorskip('h5py', reason='h5py is not installed (Debian: python3-h5py)')
    try:
        with h5py.File(file, 'r', locking=False) as study:
            return int((study['exit_code'][()] >= 0).sum())
    except OSError:
        return 0


@pytest.mark.parametrize('words, code, message', (
    (('--study', '--table', 'none/table.dat'), FILE, 'none/table.dat'),
    ((), USAGE, 'several processes make the runs of a study or the starts of a search; add --study or --optimize, or use mech9k'),
    (('--study', '--threads', '2'), USAGE, '--threads is for one process'),
    (('--study', '--part', '4/3'), USAGE, '--part needs the number K'),
    (('--study', '--plot', 'stroek'), USAGE, "did you mean 'stroke'?")), ids=('no folder', 'no study', 'threads', 'part', 'plot'))
def test_a_wrong_option_is_told_once(cases, mech9k_mpi, words, code, message):
    """All processes end with the code of the mistake."""
    done = cases.processes(4, mech9k_mpi, cases.write(GRID), *words)
    cases.checks.true(done.returncode == code and done.stderr.count(message) == 1, f'{words}: {message}', f'{done.returncode}: {done.stderr}')


@pytest.mark.parametrize('text, message', (
    (GRID.replace("'crank'", "'rod'"), "a second &parameter for name 'rod'"),
    (SLIDER_CRANK, '--study carries out the study of a group &study')), ids=('two parameters of a name', 'no study'))
def test_a_mistake_in_the_data_file_is_told_once(cases, mech9k_mpi, text, message):
    done = cases.processes(2, mech9k_mpi, cases.write(text), '--study')
    cases.checks.true(done.returncode in (USAGE, DATA) and done.stderr.count(message) == 1, message, f'{done.returncode}: {done.stderr}')


def test_a_full_disk_ends_all_processes(cases, mech9k_mpi):
    if cases.checks.has_full_disk():
        done = cases.processes(2, mech9k_mpi, cases.write(GRID), '--study', '--table', '/dev/full')
        cases.checks.true(done.returncode == FILE, 'a full disk ends all', f'{done.returncode}: {done.stderr}')


def test_the_version_is_told_once(cases, mech9k_mpi):
    done = cases.processes(2, mech9k_mpi, '--version')
    cases.checks.true(done.returncode == DONE and len(done.stdout.splitlines()) == len(run(mech9k_mpi, '--version').stdout.splitlines()),
                      'the version, once', done.stdout)


def test_ctrl_c_ends_all_processes(cases, mech9k_mpi):
    """Ctrl-C ends all processes soon; the table has whole rows, those of the first runs."""
    check = cases.checks
    text = SLIDER_CRANK.replace('count=9', 'count=900').replace('count=11', 'count=1100') + "&study kind='grid' /\n"
    with subprocess.Popen(cases.command(2, mech9k_mpi, cases.write(text), '--study', '--table', 'cut.dat'), cwd=cases.folder, env=ENVIRONMENT,
                          text=True, stderr=subprocess.PIPE, start_new_session=True) as process:
        table = os.path.join(cases.folder, 'cut.dat')
        end = time.time() + 30 * PATIENCE
        while time.time() < end and not (os.path.exists(table) and os.path.getsize(table) > 20000):
            time.sleep(0.05)
        os.killpg(process.pid, signal.SIGINT)
        try:
            _, errors = process.communicate(timeout=30 * PATIENCE)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            check.true(False, 'Ctrl-C ends all processes')
            return
    check.true(process.returncode not in (DONE, FILE), 'an interrupted study tells so', f'{process.returncode}: {errors}')
    lines = [line for line in cases.file('cut.dat').splitlines() if not line.startswith('#')]
    rows = [line.split() for line in lines[1:] if line.strip()]
    numbers = [int(float(row[0])) for row in rows if row[0][0].isdigit()]
    check.true(len(numbers) > 10 and numbers == list(range(1, len(numbers) + 1)) and all(len(row) == 6 for row in rows), 'the first rows are whole',
               (numbers[:3], numbers[-3:], rows[-1:]))


def test_the_program_for_one_process_is_free_of_mpi(checks, build, mech9k):
    mpi_of(build)
    # SUNDIALS 7 of Debian needs MPI itself
    done = run(build.settings['CMAKE_READELF'], '--dynamic', mech9k)
    checks.equal(done.returncode, 0, f'the libraries of the program are listed; {done.stderr}')
    checks.true('libm.so' in done.stdout and 'libmpi' not in done.stdout, 'the program for one process is free of MPI', done.stdout)
