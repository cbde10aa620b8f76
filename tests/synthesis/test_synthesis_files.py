"""The HDF5 file of a search by --optimize: its data sets and dimensions; a search that is killed, interrupted or gets more starts is
continued with the same bits; files of other searches, and files that are no files of searches, are refused and stay as they are.
"""
import os
import random
import shutil
import signal
import subprocess
import time

import numpy as np
import pytest

from mech9_cases import PATIENCE, TREE, read_table, run, text_of
from synthesis_cases import contents_of

h5py = pytest.importorskip('h5py', reason='h5py is not installed (Debian: python3-h5py)')

DONE, USAGE, FILE, INTERRUPTED = 0, 2, 8, 130
FOLDER = os.path.join(TREE, 'examples', 'timed_path')
FEW = 8


class Cases:
    def __init__(self, checks, folder, program):
        self.checks, self.folder, self.program = checks, folder, program
        self.text = text_of(os.path.join(FOLDER, 'timed_path.nml'))
        shutil.copy(os.path.join(FOLDER, 'eighteen_points.dat'), folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, starts, text=None, name='case.nml'):
        with open(self.path(name), 'w', encoding='utf-8') as file:
            file.write((text or self.text).replace('starts=20', f'starts={starts}'))
        return self.path(name)

    def search(self, starts, *more, why, code=DONE, text=None):
        done = run(self.program, self.write(starts, text), '--optimize', *more, folder=self.folder)
        self.checks.true(done.returncode == code, f'{why}: ends with {code}', f'{done.returncode}: {done.stderr}')
        return done.stderr


@pytest.fixture
def cases(checks, tmp_path, mech9k):
    return Cases(checks, tmp_path, mech9k)


def test_data_sets_are_the_columns_of_the_table(cases):
    """The data sets are the columns of the table and the file of targets, with named dimensions."""
    check = cases.checks
    cases.search(FEW, '--hdf5', cases.path('all.h5'), '--table', cases.path('all.dat'), '--out', cases.path('best.nml'), why='file')
    rows = read_table(text_of(cases.path('all.dat')))
    names = [name for name in rows if name not in ('value', 'starts')]
    with h5py.File(cases.path('all.h5')) as file:
        optimum = file['optimum']
        for name in rows:
            item = optimum[name if name in ('value', 'starts') else 'parameters/' + name]
            check.true(np.array_equal(item[...], rows[name]), f'{name}: the column of the table')
            check.true([dim.keys() for dim in item.dims] == [['design']] and item.attrs['long_name'], f'{name}: over the designs')
        check.equal([name.decode() for name in file['parameter']], names, 'the parameters in their order')
        check.equal([int(optimum[name][()]) for name in ('made', 'wanted', 'seed')], [FEW, FEW, 1], 'starts and seed')
        check.equal([dim.keys() for dim in optimum['times'].dims], [['design'], ['target']], 'times over the targets')
        points = np.loadtxt(os.path.join(FOLDER, 'eighteen_points.dat'))
        check.true(np.array_equal(optimum['times'][0], points[:, 0]), 'the times are those of the file')
        check.true(np.array_equal(file['targets/place'][:, :2], points[:, 1:]), 'and the places')
        check.equal(list(file['targets/objective'][...]), [1]*18, 'of one objective')
        check.equal([dim.keys() for dim in optimum['coordinates'].dims], [['design'], ['coordinate']], 'coordinates by their numbers')
        # the best design's data file starts from these coordinates
        lines = [line for line in text_of(cases.path('best.nml')).splitlines() if line.startswith('&initial')]
        written = [float(line.split('position=')[1].split()[0].rstrip(',/')) for line in lines]
        check.near(optimum['coordinates'][0, 1:], written, 1e-14, 'the coordinates are those of the data file of the best design')
        check.near(optimum['coordinates'][0, 0] % 360, rows['angle'][0] % 360, 1e-12, 'and that of the crank follows from its drive')
        found = file['starts/found'][...]
        check.true(np.all(found >= 0) and int(optimum['reached'][()]) == np.sum(found > 0), 'starts that led to designs')
        values = file['starts/value'][...]
        check.true(np.array_equal(np.sum(np.isfinite(values), axis=1), found), 'each start has the designs to which it led')
        check.true(np.nanmin(values) == rows['value'][0], 'the best of them is the best design')
        check.equal(file['provenance/data'].asstr()[()], text_of(cases.path('case.nml')), 'the data file is kept')
    try:
        import xarray
        import h5netcdf  # noqa: F401
    except ImportError:
        check.left_out('xarray or h5netcdf is not installed: the file is not opened by it')
        return
    with xarray.open_dataset(cases.path('all.h5'), engine='h5netcdf', group='optimum') as opened:
        check.equal((opened['value'].dims, opened['times'].dims), (('design',), ('design', 'target')), 'xarray knows the dimensions')


def test_added_starts_lead_to_the_bits_of_one_search(cases):
    """Starts that are added, in any number of threads, lead to the bits of one search; the data file need not be the same text."""
    check = cases.checks
    whole, path = cases.path('whole.h5'), cases.path('more.h5')
    cases.search(3*FEW, '--hdf5', whole, '--table', cases.path('whole.dat'), why='whole')
    cases.search(FEW, '--hdf5', path, '--threads', '1', why='few')
    few = contents_of(path)
    cases.search(2*FEW, '--continue', path, '--threads', '3', why='more')
    changed = cases.text.replace('! 20 degrees per second', '! slowly')
    printed = cases.search(3*FEW, '--continue', path, '--table', cases.path('more.dat'), why='still more', text=changed)
    check.true(contents_of(path) == contents_of(whole), 'more starts: the same bits')
    check.equal(text_of(cases.path('more.dat')), text_of(cases.path('whole.dat')), 'more starts: the same table')
    check.true(f'{3*FEW} starts: ' in printed and 'HDF5 file: ' in printed, 'more starts: all are told', printed)
    cases.search(FEW, '--hdf5', path, why='few again')
    check.true(contents_of(path) == few, 'again: the same bits')


def test_starts_that_the_file_has_are_not_made_again(cases):
    """A value that was changed in the file stays."""
    check, path = cases.checks, cases.path('more.h5')
    cases.search(FEW, '--hdf5', path, why='few')
    with h5py.File(path, 'r+') as file:
        row = int(np.argmax(file['starts/found'][...] > 0))
        file['starts/value'][row, 0] = 1e-6
    cases.search(2*FEW, '--continue', path, '--table', cases.path('changed.dat'), why='changed')
    with h5py.File(path) as file:
        check.true(file['starts/value'][row, 0] == 1e-6, 'a start that was made is not made again')
    check.true(1e-6 not in read_table(text_of(cases.path('changed.dat')))['value'], 'a design whose motion has another value is left out')


@pytest.mark.without_sanitizers
def test_killed_searches_are_continued_with_the_same_bits(cases):
    """Killed at random moments, several times one after the other, then continued: the bits of an undisturbed search. At each moment
    a start is whole in the file, or not made."""
    check = cases.checks
    starts, length = 2*FEW, 0.0
    while length < 1.0:
        starts *= 2
        begin = time.monotonic()
        cases.search(starts, '--hdf5', cases.path('whole.h5'), '--threads', '1', why='whole')
        length = time.monotonic() - begin
    whole = contents_of(cases.path('whole.h5'))
    with h5py.File(cases.path('whole.h5')) as file:
        values = file['starts/value'][...]
    random.seed(11)
    partly = 0
    for i in range(10):
        # how long a search takes depends on what else the machine does: go on until one was killed in the middle
        if i >= 3 and partly > 0:
            break
        path = cases.path(f'killed{i}.h5')
        words = [cases.program, cases.path('case.nml'), '--optimize', '--quiet', '--threads', str(1 + i % 2)]
        for target in (['--hdf5', path], ['--continue', path]):
            process = subprocess.Popen(words + target, cwd=cases.folder)
            time.sleep(random.uniform(0.1, 0.8)*length)
            process.send_signal(signal.SIGKILL)
            process.wait()
            if not os.path.exists(path):
                break
            with h5py.File(path) as file:
                made = file['starts/found'][...] >= 0
                check.true(file['starts/value'][...][made].tobytes() == values[made].tobytes(), f'killed, {i}: starts are whole')
            partly += 0 < np.sum(made) < starts
        else:
            cases.search(starts, '--continue', path, why=f'continued, {i}')
            check.true(contents_of(path) == whole, f'continued, {i}: the same bits')
    check.true(partly > 0, 'searches were killed in the middle', partly)


def test_ctrl_c_ends_a_search(cases):
    """Ctrl-C ends a search; the file then has the starts and the designs so far, and is continued."""
    check = cases.checks
    path = cases.path('interrupted.h5')
    process = subprocess.Popen([cases.program, cases.write(100000), '--optimize', '--hdf5', path, '--table', cases.path('some.dat')],
                               stderr=subprocess.PIPE, text=True, cwd=cases.folder)
    patience = time.monotonic() + 30.0*PATIENCE
    while not os.path.exists(path) and time.monotonic() < patience:
        time.sleep(0.05)
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    _, printed = process.communicate(timeout=60*PATIENCE)
    check.true(process.returncode == INTERRUPTED and 'of 100000 starts are made' in printed, 'Ctrl-C ends a search', printed)
    with h5py.File(path) as file:
        made = int(np.sum(file['starts/found'][...] >= 0))
        check.true(0 < made < 100000 and file['optimum/made'][()] == made, 'Ctrl-C: the starts so far are in the file', made)
        check.true(np.array_equal(file['optimum/value'][...], read_table(text_of(cases.path('some.dat')))['value']),
                   'Ctrl-C: and their designs')


def test_refused_files_stay_as_they_are(cases):
    check = cases.checks
    path = cases.path('other.h5')
    cases.search(FEW, '--hdf5', path, why='other')
    before = open(path, 'rb').read()
    for text, starts, words in (
            (cases.text.replace("timing='given'", "timing='given', weight=2"), FEW,
             "it is of another search: there '&objective kind='path', point='P', file='eighteen_points.dat', timing='given',', here "
             "'&objective kind='path', point='P', file='eighteen_points.dat', timing='given', weight=2,'"),
            (None, FEW - 1, 'it has 8 starts, and the data file asks for 7; give at least as many by starts= in &optimum')):
        printed = cases.search(starts, '--continue', path, why='refused', code=FILE, text=text)
        check.true(words in printed, f'refused: {words}', printed)
    with open(cases.path('eighteen_points.dat'), 'a', encoding='utf-8') as file:
        file.write('17.5 0.55 1.05\n')
    printed = cases.search(FEW, '--continue', path, why='other targets', code=FILE)
    check.true("it is of another search: there 'file 1 " in printed, 'other targets are refused', printed)
    shutil.copy(os.path.join(FOLDER, 'eighteen_points.dat'), cases.folder)
    check.true(open(path, 'rb').read() == before, 'a refused file stays as it is')
    cases.search(FEW, '--continue', path, why='the same again')


def test_files_of_no_search_are_refused(cases):
    check, path = cases.checks, cases.path('other.h5')
    run(cases.program, cases.write(FEW), '--hdf5', cases.path('run.h5'), folder=cases.folder)
    printed = cases.search(FEW, '--continue', cases.path('run.h5'), why='a run', code=FILE)
    check.true("run.h5': it is not the file of a search by --optimize" in printed, 'the file of a run is refused', printed)
    printed = cases.search(FEW, '--continue', cases.path('nowhere.h5'), why='no file', code=FILE)
    check.true('there is no such file' in printed, 'a file that is not there', printed)
    for words, options in (('give one of them, too', ('--continue', path)),
                           ('leave --hdf5 and --no-write out', ('--optimize', '--continue', path, '--hdf5', 'x.h5'))):
        done = run(cases.program, cases.write(FEW), *options, folder=cases.folder)
        check.true(done.returncode == USAGE and words in done.stderr, f'options: {words}', done.stderr)
