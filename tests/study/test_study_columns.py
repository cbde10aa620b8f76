"""All columns of the runs of a study in its HDF5 file (&output hdf5_runs): each run has the bits, names, dimensions and units of the file
of a single run, up to the place where it failed; the same bits from threads, parts, merged files, processes, and after a kill; memory
does not grow with the number of runs.
"""
import os
import random
import resource
import signal
import subprocess
import time

import numpy as np
import pytest

from mech9_cases import PATIENCE, run
from mpi_processes import ENVIRONMENT, mpi_of
from study_cases import StudyCases

h5py = pytest.importorskip('h5py', reason='h5py is not installed (Debian: python3-h5py)')

DONE, DATA, FILE = 0, 3, 8
# some cranks are longer than their rods: these runs end at a dead point
SLIDER_CRANK = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1.1,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, zero=0,1,0, moving_point=0,0,0 /
&initial coordinate=4, position=1.2 /
&drive coordinate=1, kind='polynomial', coefficients=0.4, 10 /
&body link=4, mass=2 /
&point name='B', link=4 /
&point name='C', link=3, position=0.2,0.1,0 /
&time end=0.7, intervals=40 /
&quantity name='stroke', of='B.x', take='range' /
&parameter name='crank', sets='pair(2).point(1)', low=0.2, high=0.8 /
&parameter name='rod', sets='pair(3).point(1)', low=0.7, high=1.1 /
&output hdf5_runs=.true., reactions=.true., drive_forces=.true., poses=.true., conditioning=.true. /
&study kind='random', runs=60, seed=3 /
"""
# a free double pendulum, and a negative mass for some runs
PENDULUM = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0,-0.5,0, moving_point=0,0,0 /
&initial coordinate=1, position=0.4 /
&initial coordinate=2, position=0.3 /
&body link=2, mass=1, centre=0,-0.2,0 /
&body link=3, mass=1, centre=0,-0.5,0 /
&gravity acceleration=0,-9.81,0 /
&time end=1, intervals=20 /
&parameter name='mass', sets='body(2).mass', low=-0.2, high=2, value=1 /
&quantity name='swing', of='q2', take='range' /
&output hdf5_runs=.true., coordinates=2 /
&study kind='sobol', runs=32 /
"""
MECHANISMS = pytest.mark.parametrize('name, text, why', (('mech9k', SLIDER_CRANK, 'kinematics'), ('mech9d', PENDULUM, 'dynamics')),
                                     ids=('kinematics', 'dynamics'))


@pytest.fixture
def cases(checks, tmp_path):
    return StudyCases(checks, tmp_path, '--quiet')


def scales_of(item):
    return [[os.path.basename(scale.name) for scale in dim.values()] for dim in item.dims]


def contents_of(path):
    """All data sets of results: numbers, dimensions, description."""
    found = {}
    with h5py.File(path) as file:
        def take(name, item):
            if isinstance(item, h5py.Dataset) and not name.startswith('provenance/') and name != 'study/definition':
                found[name] = (item[()].tobytes() if item.dtype.kind in 'if' else repr(item[()].tolist() if item.shape else item[()]), item.shape, scales_of(item),
                               item.attrs.get('units'), item.attrs.get('long_name'))
        file.visititems(take)
    return found


def compare(cases, one, other, why):
    a, b = contents_of(one), contents_of(other)
    for name in ('study/part', 'study/parts'):
        a.pop(name), b.pop(name)
    # long names of provenance apart, the files are the same
    different = [name for name in sorted(a.keys() | b.keys()) if a.get(name) != b.get(name)]
    cases.checks.true(not different, f'{why}: the same data sets', different)


@MECHANISMS
def test_every_run_has_the_columns_of_a_single_run(cases, build, name, text, why):
    """The columns are those of a single run with its values, NaN where that ends."""
    check, program = cases.checks, build.program(name)
    cases.study(program, text, '--hdf5', 'all.h5', why=why)
    alone = cases.path('alone.h5')
    kept = failed = 0
    with h5py.File(cases.path('all.h5')) as file:
        names = [name.decode() if isinstance(name, bytes) else name for name in file['study/parameters'][()]]
        columns = [name.decode() if isinstance(name, bytes) else name for name in file['study/columns'][()]]
        check.true(len(columns) >= 5, f'{why}: columns', columns)
        for i in range(len(file['run'])):
            code = file['exit_code'][i]
            if code == DONE and kept >= 3 or code != DONE and failed >= 3:
                continue
            kept, failed = kept + (code == DONE), failed + (code != DONE)
            settings = [word for k, name in enumerate(names) for word in ('--set', f'parameter({k + 1}).value={float(file["parameters/" + name][i])!r}')]
            done = run(program, cases.path('case.nml'), '--quiet', '--hdf5', alone, *settings)
            check.equal(done.returncode, code, f'{why}: run {i + 1} ends as alone')
            if not os.path.exists(alone):
                check.true(all(np.isnan(file[name][i]).all() for name in columns), f'{why}: run {i + 1} has no columns')
                continue
            with h5py.File(alone) as single:
                rows = len(single['time'])
                check.true(np.array_equal(single['time'], file['time'][:rows]), f'{why}: times of run {i + 1}')
                expected = {name for name, item in single.items() if isinstance(item, h5py.Dataset) and scales_of(item)[:1] == [['time']]}
                check.equal(set(columns), expected, f'{why}: the data sets of a single run')
                for name in columns:
                    values, other = file[name][i], single[name][()]
                    check.true(values[:rows].tobytes() == other.tobytes() and np.isnan(values[rows:]).all(), f'{why}: {name} of run {i + 1}')
                    check.equal(scales_of(file[name]), [['run']] + scales_of(single[name]), f'{why}: dimensions of {name}')
                    check.equal(dict(file[name].attrs)['units'], single[name].attrs['units'], f'{why}: units of {name}')
                for name, item in single.items():
                    if isinstance(item, h5py.Dataset) and name in file and name != 'time' and name not in columns:
                        check.true(np.array_equal(item[()], file[name][()]), f'{why}: scale {name}')
            os.remove(alone)
    check.true(kept > 0 and failed > 0, f'{why}: some runs fail', (kept, failed))


def test_xarray_opens_the_file(cases, mech9k):
    try:
        import xarray
        import h5netcdf  # noqa: F401
    except ImportError:
        cases.checks.left_out('xarray or h5netcdf is not installed: the file is not opened by it')
        return
    cases.study(mech9k, SLIDER_CRANK, '--hdf5', 'all.h5', why='xarray')
    with xarray.open_dataset(cases.path('all.h5'), engine='h5netcdf') as runs:
        check = cases.checks
        check.equal(runs['q'].dims, ('run', 'time', 'coordinate'), 'xarray: dimensions of q')
        check.equal(runs['position'].dims, ('run', 'time', 'point', 'axis'), 'xarray: dimensions of positions')
        check.equal(runs['reaction_force'].dims, ('run', 'time', 'pair', 'axis'), 'xarray: dimensions of reactions')
        run_17 = runs['position'].sel(run=17, point='B', axis='x')
        check.true(run_17.dims == ('time',) and run_17.sel(time=0.7).size == 1, 'xarray: a run by its number, a time by its value')
        with h5py.File(cases.path('all.h5')) as file:
            check.true(np.array_equal(run_17.values, file['position'][16, :, 0, 0], equal_nan=True), 'xarray: its numbers')


@MECHANISMS
def test_the_same_bits_from_threads_parts_and_merged_files(cases, build, name, text, why):
    program = build.program(name)
    cases.study(program, text, '--hdf5', 'whole.h5', '--threads', '1', why=why)
    whole = cases.path('whole.h5')
    for threads in ('2', '5'):
        cases.study(program, text, '--hdf5', 'threads.h5', '--threads', threads, why=f'{why}, {threads} threads')
        compare(cases, cases.path('threads.h5'), whole, f'{why}, {threads} threads')
    for k in (1, 2, 3):
        cases.study(program, text, '--part', f'{k}/3', '--hdf5', f'part{k}.h5', why=f'{why}, part {k}')
    for parts in (['part1.h5', 'part2.h5', 'part3.h5'], ['part3.h5', 'part1.h5', 'part3.h5', 'part2.h5']):
        done = run(program, '--merge', *parts, '--hdf5', 'joined.h5', '--quiet', folder=cases.folder)
        cases.checks.true(done.returncode == DONE, f'{why}: merged', done.stderr)
        compare(cases, cases.path('joined.h5'), whole, f'{why}: merged')
    run(program, '--merge', 'part1.h5', 'part3.h5', '--hdf5', 'joined.h5', '--quiet', folder=cases.folder)
    with h5py.File(cases.path('joined.h5')) as file:
        cases.checks.true(np.isnan(file['q'][1::3]).all(), f'{why}: runs that no part has are NaN')
    cases.study(program, text, '--continue', 'joined.h5', why=f'{why}: a merged file continued')
    compare(cases, cases.path('joined.h5'), whole, f'{why}: a merged file continued')
    with h5py.File(cases.path('part1.h5'), 'r+') as file:
        file['q'][3, 5, 0] += 1e-9
    done = run(program, '--merge', 'part1.h5', 'joined.h5', '--hdf5', 'other.h5', '--quiet', folder=cases.folder)
    cases.checks.true(done.returncode == FILE and 'have different numbers for run 10' in done.stderr and not os.path.exists(cases.path('other.h5')),
                      f'{why}: parts that differ in a column', done.stderr)


def killed(cases, command, whole, why, victim=None):
    """Killed in the middle and continued: the bits of an undisturbed study, whatever was finished at the kill."""
    check = cases.checks
    random.seed(5)
    partly, delay = 0, 0.6
    for i in range(20):
        if i >= 2 and partly > 0:
            break
        path = f'killed{i}.h5'
        if os.path.exists(cases.path(path)):     # of an earlier check, whose runs are others
            os.remove(cases.path(path))
        process = subprocess.Popen([*command, cases.path('case.nml'), '--study', '--quiet', '--hdf5', path], cwd=cases.folder, env=ENVIRONMENT,
                                   stderr=subprocess.DEVNULL, start_new_session=True)
        patience = time.monotonic() + 60 * PATIENCE
        while not os.path.exists(cases.path(path)) and process.poll() is None and time.monotonic() < patience:
            time.sleep(0.02)
        time.sleep(delay * random.uniform(0.7, 1.3))
        (victim or (lambda one: one.kill()))(process)
        process.wait(60 * PATIENCE)
        if not os.path.exists(cases.path(path)):
            continue
        with h5py.File(cases.path(path)) as file, h5py.File(whole) as good:
            codes = file['exit_code'][()]
            for k in np.flatnonzero(codes >= 0):
                check.true(file['q'][k].tobytes() == good['q'][k].tobytes() and file['closure'][k].tobytes() == good['closure'][k].tobytes(),
                           f'{why}: finished runs are whole at a kill')
            partly += 0 < np.sum(codes >= 0) < len(codes)
            # on a machine with other work a study may not have begun yet, or have ended
            delay *= 2 if np.all(codes < 0) else 0.5 if np.all(codes >= 0) else 1
        done = subprocess.run([*command, cases.path('case.nml'), '--study', '--quiet', '--continue', path], cwd=cases.folder, env=ENVIRONMENT,
                              capture_output=True, text=True, timeout=120 * PATIENCE)
        check.true(done.returncode == DONE, f'{why}: continued', done.stderr)
        compare(cases, cases.path(path), whole, f'{why}: continued')
    check.true(partly > 0, f'{why}: one was killed in the middle')


@pytest.mark.without_sanitizers
def test_killed_studies_are_continued_with_the_same_bits(cases, mech9k):
    long_study(cases, mech9k, SLIDER_CRANK, 'long')
    killed(cases, [mech9k], cases.path('whole_long.h5'), 'killed')


def long_study(cases, program, text, why):
    """A study that takes some seconds."""
    intervals, length = 40, 0.0
    while length < 2.0:
        intervals *= 2
        longer = text.replace('intervals=40', f'intervals={intervals}').replace('runs=60', 'runs=150').replace('poses=.true., ', '')
        start = time.monotonic()
        cases.study(program, longer, '--hdf5', 'whole_long.h5', '--threads', '2', why=why)
        length = time.monotonic() - start
    return longer


def processes_of(session, program):
    """Processes of a session that run a program, the ranks of MPI in the order of their start."""
    found = []
    for entry in os.listdir('/proc'):
        if not entry.isdigit():
            continue
        try:
            with open(f'/proc/{entry}/stat', encoding='utf-8') as file:
                fields = file.read().rsplit(')', 1)[1].split()
            if int(fields[3]) == session and os.path.basename(os.readlink(f'/proc/{entry}/exe')) == os.path.basename(program):
                found.append(int(entry))
        except OSError:
            continue
    return sorted(found)


def wait_for(process):
    """Whether a process whose ranks have ended ends by itself."""
    try:
        process.wait(30 * PATIENCE)
    except subprocess.TimeoutExpired:
        return False
    return True


@MECHANISMS
def test_several_processes_write_the_bits_of_one(cases, build, name, text, why):
    mpirun, program = mpi_of(build), build.program(name)
    program_mpi = build.program(f'{name}-mpi')
    cases.study(program, text, '--hdf5', 'whole.h5', why='whole')
    for n in ('2', '4'):
        for part in ((), ('--part', '2/3')):
            done = subprocess.run([mpirun, '-n', n, '--oversubscribe', program_mpi, cases.path('case.nml'), '--study', '--quiet', '--hdf5', 'team.h5', *part],
                                  cwd=cases.folder, env=ENVIRONMENT, capture_output=True, text=True, timeout=120 * PATIENCE)
            cases.checks.true(done.returncode == DONE, f'{name}-mpi, {n} processes', done.stderr)
            if part:
                cases.study(program, text, '--hdf5', 'whole.h5', *part, why='part')
            compare(cases, cases.path('team.h5'), cases.path('whole.h5'), f'{name}-mpi, {n} processes {part}')
            if part:
                cases.study(program, text, '--hdf5', 'whole.h5', why='whole')


@pytest.mark.parametrize('rank', (0, 1))
def test_a_process_is_killed_and_the_study_continued(cases, build, mech9k, rank):
    mpirun = mpi_of(build)
    program_mpi = build.program('mech9k-mpi')
    long_study(cases, mech9k, SLIDER_CRANK, 'processes')

    def kill_rank(process):
        ranks = processes_of(process.pid, program_mpi)
        # none are left where the study has ended
        cases.checks.true(len(ranks) == 2 or process.poll() is not None or wait_for(process), 'two processes make the runs', ranks)
        if len(ranks) == 2:
            os.kill(ranks[rank], signal.SIGKILL)

    killed(cases, [mpirun, '-n', '2', '--oversubscribe', program_mpi], cases.path('whole_long.h5'), f'rank {rank} killed', kill_rank)


@pytest.mark.without_sanitizers
def test_memory_does_not_grow_with_the_number_of_runs(cases, mech9k):
    """The peak of memory of a study whose columns have a hundred times its size is that of a tenth of its runs."""
    peaks = []
    for runs in (10, 100):
        text = SLIDER_CRANK.replace('intervals=40', 'intervals=4000').replace('runs=60', f'runs={runs}').replace('high=0.8', 'high=0.5')
        text = text.replace('reactions=.true., drive_forces=.true., poses=.true., conditioning=.true.', 'derivatives=0')
        # the address sanitizer keeps up to 256 MB of freed memory back, unless it is told not to
        process = subprocess.Popen([mech9k, cases.write(text), '--study', '--quiet', '--hdf5', cases.path('large.h5'), '--threads', '2'],
                                   env={**os.environ, 'ASAN_OPTIONS': os.environ.get('ASAN_OPTIONS', '') + ':quarantine_size_mb=1:thread_local_quarantine_size_kb=64'})
        _, status, usage = os.wait4(process.pid, 0)
        cases.checks.equal(status, 0, f'{runs} runs')
        peaks.append(usage.ru_maxrss)
    # 100 runs have 35 MB of columns
    cases.checks.true(peaks[1] < peaks[0] + 15000, 'memory does not grow with the number of runs', peaks)
    os.remove(cases.path('large.h5'))


LATE = "&parameter name='late', sets='time.end', low=0.5, high=0.7 /\n"


@pytest.mark.parametrize('text, words, code, message', (
    (SLIDER_CRANK + LATE, ('--hdf5', 'no.h5'), DATA,
     "parameter 'late' sets time.end, and hdf5_runs=.true. in &output records all runs at the same times"),
    (SLIDER_CRANK, ('--hdf5', 'no.h5', '--set', 'output.hdf5_runs=1'), DATA, 'hdf5_runs'),
    (SLIDER_CRANK, ('--hdf5', '/dev/full'), FILE, 'No space left on device')), ids=('other times', 'a number', 'a full disk'))
def test_refused(cases, mech9k, text, words, code, message):
    printed = cases.study(mech9k, text, *words, why=message, code=code)
    cases.checks.true(message in printed and not os.path.exists(cases.path('no.h5')), message, printed)


def test_a_file_with_columns_is_not_continued_without(cases, mech9k):
    cases.study(mech9k, SLIDER_CRANK, '--hdf5', 'all.h5', why='with columns')
    printed = cases.study(mech9k, SLIDER_CRANK, '--set', 'output.hdf5_runs=.false.', '--continue', 'all.h5', why='without columns', code=FILE)
    cases.checks.true('it is of another study' in printed and 'hdf5_runs' in printed, 'a file with columns is not continued without', printed)


def test_a_file_that_lacks_columns(cases, mech9k):
    check = cases.checks
    cases.study(mech9k, SLIDER_CRANK, '--hdf5', 'all.h5', why='with columns')
    with h5py.File(cases.path('all.h5'), 'r+') as file:
        del file['q']
    before = open(cases.path('all.h5'), 'rb').read()
    for words, message in ((('case.nml', '--study', '--continue', 'all.h5'), "q'"), (('--merge', 'all.h5', 'all.h5', '--hdf5', 'no.h5'), "it has no data set 'q'")):
        done = run(mech9k, *words, '--quiet', folder=cases.folder)
        check.true(done.returncode == FILE and message in done.stderr, f'a file without its columns: {words}', done.stderr)
    check.true(before == open(cases.path('all.h5'), 'rb').read() and not os.path.exists(cases.path('no.h5')), 'nothing is written over')


def test_a_file_that_may_not_grow(cases, mech9k):
    done = subprocess.run([mech9k, cases.write(SLIDER_CRANK), '--study', '--quiet', '--hdf5', cases.path('large.h5')], capture_output=True, text=True,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (200000, 200000)))
    cases.checks.true(done.returncode == FILE and 'File too large' in done.stderr and not os.path.exists(cases.path('large.h5')), 'a file that may not grow', done.stderr)


def test_a_merged_file_that_may_not_grow(cases, mech9k):
    """Limits of the size of files take the place of a full disk, wherever it ends the writing."""
    check = cases.checks
    path = cases.write(SLIDER_CRANK)
    for k in (1, 2):
        run(mech9k, path, '--study', '--quiet', '--part', f'{k}/2', '--hdf5', f'grown{k}.h5', folder=cases.folder)
    size = sum(os.path.getsize(cases.path(f'grown{k}.h5')) for k in (1, 2))
    for limit in (1000, 100000, 140000, size // 3):
        done = run('sh', '-c', f'ulimit -f {max(1, limit // 512)}; exec "$0" "$@"', mech9k, '--merge', 'grown1.h5', 'grown2.h5', '--hdf5', 'merged.h5',
                   folder=cases.folder)
        check.true(done.returncode == FILE and 'File too large' in done.stderr and not os.path.exists(cases.path('merged.h5')), f'{limit} bytes',
                   f'{done.returncode}: {done.stderr}')


def test_a_table_alone_needs_no_columns(cases, mech9k):
    cases.checks.equal(cases.study(mech9k, SLIDER_CRANK + LATE, '--table', 'table.dat', why='a table'), '', 'nothing to be said')
