"""The HDF5 file of a study: its data sets and dimensions; a study that is killed, interrupted or made in parts is continued with the
same bits, and joined to the whole study; files of other studies, and files that are no files of studies, are refused and stay as they are.
"""
import os
import random
import resource
import shutil
import signal
import subprocess
import time

import numpy as np
import pytest

from mech9_cases import PATIENCE, read_table, run, text_of
from study_cases import StudyCases

h5py = pytest.importorskip('h5py', reason='h5py is not installed (Debian: python3-h5py)')

DONE, USAGE, FILE, INTERRUPTED = 0, 2, 8, 130
RUNS = 400
# some cranks are longer than their rods: these runs fail
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
&quantity name='way', of='B.x', take='integral' /
&parameter name='crank', sets='pair(2).point(1)', low=0.2, high=0.8 /
&parameter name='rod', sets='pair(3).point(1)', low=0.7, high=1.1 /
"""
PENDULUM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0.4 /
&body link=2, mass=1, centre=0,-0.5,0, inertia=0,0,0.1,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&time end=1, intervals=20 /
&parameter name='mass', sets='body.mass' , spread=0.1 /
&quantity name='swing', of='q1', take='range' /
&study kind='sobol', runs=20 /
"""


@pytest.fixture
def cases(checks, tmp_path):
    return StudyCases(checks, tmp_path)


def random_study(runs=RUNS):
    return SLIDER_CRANK + f"&study kind='random', runs={runs}, seed=3 /\n"


def numbers_of(path):
    """All data sets over the runs, by name."""
    numbers = {}
    with h5py.File(path) as file:
        runs = len(file['run'])

        def take(name, item):
            if isinstance(item, h5py.Dataset) and item.shape[:1] == (runs,) and [dim.keys() for dim in item.dims][0] == ['run'] or name == 'run':
                numbers[name] = item[...]
        file.visititems(take)
    return numbers


def same_bits(a, b):
    return a.keys() == b.keys() and all(a[name].tobytes() == b[name].tobytes() for name in a)


@pytest.mark.parametrize('name, text, names', (
    ('mech9k', random_study(30), (('run', '', '1'), ('crank', 'parameters/', 'm'), ('rod', 'parameters/', 'm'), ('stroke', 'quantities/', 'm'),
                                  ('way', 'quantities/', 'm s'), ('exit_code', '', '1'))),
    ('mech9d', PENDULUM, (('run', '', '1'), ('mass', 'parameters/', 'kg'), ('swing', 'quantities/', 'rad'), ('exit_code', '', '1')))),
    ids=('mech9k', 'mech9d'))
def test_data_sets_are_the_columns_of_the_table(cases, build, name, text, names):
    """They have the run as their named dimension, and units."""
    check, program = cases.checks, build.program(name)
    cases.study(program, text, '--hdf5', cases.path('all.h5'), '--table', cases.path('all.dat'), why='file')
    rows = read_table(text_of(cases.path('all.dat')))
    with h5py.File(cases.path('all.h5')) as file:
        for name, group, unit in names:
            item = file[group + name]
            check.true(np.array_equal(item[...], rows[name], equal_nan=True), f'{name}: the column of the table')
            check.true([dim.keys() for dim in item.dims] == [['run']] if name != 'run' else item.attrs['CLASS'] == b'DIMENSION_SCALE', f'{name}: over the runs')
            check.true(item.attrs['units'] == unit and item.attrs['long_name'], f'{name}: its unit', item.attrs['units'])
        check.equal(file['provenance/data'].asstr()[()], text, 'the data file is kept')
        check.equal((file['study/runs'][()], file['study/part'][()], file['study/parts'][()]), (len(rows['run']), 1, 1), 'runs and parts')
    try:
        import xarray
        import h5netcdf  # noqa: F401
    except ImportError:
        check.left_out('xarray or h5netcdf is not installed: the file is not opened by it')
        return
    with xarray.open_dataset(cases.path('all.h5'), engine='h5netcdf', group='quantities') as opened:
        check.true(all(opened[name].dims == ('run',) for name, group, _ in names if group == 'quantities/'), 'xarray knows the dimension')


@pytest.mark.without_sanitizers
def test_killed_studies_are_continued_with_the_same_bits(cases, mech9k):
    """Killed at random moments, several times one after the other, then continued: the bits of an undisturbed study. At each moment
    a run is whole in the file, or not made."""
    check = cases.checks
    intervals, length = 40, 0.0
    # readers see new runs after half a second: the study has to take longer
    while length < 2.0:
        intervals *= 2
        text = random_study().replace('intervals=40', f'intervals={intervals}')
        start = time.monotonic()
        cases.study(mech9k, text, '--hdf5', cases.path('whole.h5'), '--table', cases.path('whole.dat'), '--threads', '1', why='whole')
        length = time.monotonic() - start
    whole = numbers_of(cases.path('whole.h5'))
    random.seed(7)
    partly = 0
    for i in range(12):
        # how long a study takes depends on what else the machine does: go on until one was killed in the middle
        if i >= 4 and partly > 0:
            break
        path = cases.path(f'killed{i}.h5')
        words = [mech9k, cases.path('case.nml'), '--study', '--quiet', '--threads', str(1 + i % 2)]
        for target in (['--hdf5', path], ['--continue', path]):
            process = subprocess.Popen(words + target)
            time.sleep(random.uniform(0.1, 0.9) * length)
            process.send_signal(signal.SIGKILL)
            process.wait()
            if not os.path.exists(path):
                break
            left = numbers_of(path)
            made = left['exit_code'] >= 0
            partly += 0 < np.sum(made) < RUNS
            check.true(all(left[name][made].tobytes() == whole[name][made].tobytes() for name in whole), f'killed, {i}: runs are whole')
        else:
            printed = cases.study(mech9k, text, '--continue', path, '--table', cases.path('again.dat'), why=f'continued, {i}')
            check.true(f'{RUNS} runs: ' in printed, f'continued, {i}: all runs are told', printed)
            check.true(same_bits(numbers_of(path), whole), f'continued, {i}: the same bits')
            check.equal(text_of(cases.path('again.dat')), text_of(cases.path('whole.dat')), f'continued, {i}: the same table')
    check.true(partly > 0, 'studies were killed in the middle', partly)


def test_runs_that_the_file_has_are_not_made_again(cases, mech9k):
    """Numbers that were changed in the file stay as they are; failed runs count as made."""
    path = cases.path('gap.h5')
    text = random_study(30)
    cases.study(mech9k, text, '--hdf5', path, why='gap')
    whole = numbers_of(path)
    with h5py.File(path, 'r+') as file:
        file['quantities/stroke'][3] = 7.0
        for name in ('exit_code', 'quantities/stroke', 'quantities/way', 'parameters/crank', 'parameters/rod'):
            file[name][10:20] = -1
    cases.study(mech9k, text, '--continue', path, why='gap')
    again = numbers_of(path)
    cases.checks.true(again['quantities/stroke'][3] == 7.0, 'a run that was made is not made again')
    again['quantities/stroke'][3] = whole['quantities/stroke'][3]
    cases.checks.true(same_bits(again, whole), 'the others are')
    cases.checks.true(np.any(whole['exit_code'] != DONE), 'some of the runs fail')


def test_ctrl_c_ends_a_study(cases, mech9k):
    text = random_study(1000000)
    path, table = cases.path('interrupted.h5'), cases.path('interrupted.dat')
    process = subprocess.Popen([mech9k, cases.write(text, 'long.nml'), '--study', '--hdf5', path, '--table', table],
                               stderr=subprocess.PIPE, text=True)
    patience = time.monotonic() + 30.0 * PATIENCE
    while not os.path.exists(path) and time.monotonic() < patience:
        time.sleep(0.05)
    time.sleep(0.7)
    process.send_signal(signal.SIGINT)
    _, printed = process.communicate(timeout=60 * PATIENCE)
    cases.checks.true(process.returncode == INTERRUPTED and 'of 1000000 runs are finished' in printed, 'Ctrl-C ends a study', printed)
    numbers = numbers_of(path)
    rows = read_table(text_of(table))
    n = len(rows['run'])
    cases.checks.true(0 < n <= np.sum(numbers['exit_code'] >= 0) and np.array_equal(rows['run'], np.arange(1, n + 1)),
                      'Ctrl-C: finished runs are in both files', n)
    cases.checks.true(all(np.all(np.isnan(numbers[name][numbers['exit_code'] < 0])) for name in numbers if '/' in name),
                      'Ctrl-C: runs that are not made are NaN')
    cases.checks.true(np.array_equal(numbers['quantities/way'][:n], rows['way'], equal_nan=True), 'Ctrl-C: the same runs')


def test_a_part_is_continued_as_that_part(cases, mech9k):
    """A part has its own runs, and is continued as that part, which the file knows."""
    text = random_study(30)
    path = cases.path('part.h5')
    cases.study(mech9k, text, '--hdf5', cases.path('whole.h5'), why='whole')
    whole = numbers_of(cases.path('whole.h5'))
    cases.study(mech9k, text, '--part', '2/4', '--hdf5', path, why='part')
    part = numbers_of(path)
    cases.checks.true(list(part['run']) == list(range(2, 31, 4)), 'part: its runs', part['run'])
    cases.checks.true(all(part[name].tobytes() == whole[name][1::4].tobytes() for name in whole), 'part: the bits of the whole study')
    for more in ((), ('--part', '2/4')):
        cases.study(mech9k, text, '--continue', path, *more, why='part continued')
    printed = cases.study(mech9k, text, '--continue', path, '--part', '1/4', why='another part', code=FILE)
    cases.checks.true("part.h5' is of part 2/4, and --part 1/4 is another one; leave out --part" in printed, 'another part is refused', printed)
    cases.study(mech9k, text, '--part', '31/40', '--hdf5', path, why='no runs')
    cases.checks.true(all(len(values) == 0 for values in numbers_of(path).values()), 'a part without runs')
    cases.study(mech9k, text, '--continue', path, why='no runs')


class Parts:
    """The three parts of a study, the whole study, and merges of them, in the folder of a test."""

    def __init__(self, cases, mech9k, made):
        self.cases, self.mech9k, self.text = cases, mech9k, random_study(3000)
        shutil.copytree(made, cases.folder, dirs_exist_ok=True)
        self.whole = numbers_of(cases.path('whole.h5'))
        self.files = [cases.path(f'part{k}.h5') for k in (1, 2, 3)]
        self.joined = cases.path('joined.h5')

    def merge(self, paths, *more, code=DONE, why):
        done = run(self.mech9k, '--merge', *paths, '--hdf5', self.joined, *more)
        self.cases.checks.true(done.returncode == code, f'{why}: ends with {code}', f'{done.returncode}: {done.stderr}')
        return done.stderr


@pytest.fixture(scope='module')
def made(mech9k, tmp_path_factory):
    """A folder with the three parts of a study, the whole study and another one, which no test changes."""
    folder = tmp_path_factory.mktemp('made')

    def study(text, *words):
        (folder / 'case.nml').write_text(text, encoding='utf-8')
        done = run(mech9k, 'case.nml', '--study', *words, folder=folder)
        assert done.returncode == DONE, done.stderr
    study(random_study(2999), '--hdf5', 'other.h5')
    study(random_study(3000), '--hdf5', 'whole.h5', '--table', 'whole.dat')
    for k in (1, 2, 3):
        study(random_study(3000), '--part', f'{k}/3', '--hdf5', f'part{k}.h5')
    return folder


@pytest.fixture
def parts(cases, mech9k, made):
    return Parts(cases, mech9k, made)


@pytest.mark.parametrize('order', ((0, 1, 2), (2, 1, 0), (1, 0, 2, 1)), ids=('in order', 'backwards', 'one twice'))
def test_parts_joined_in_any_order_are_the_whole_study(cases, parts, order):
    """They are the whole study in every bit."""
    check, whole, joined, table = cases.checks, parts.whole, parts.joined, cases.path('joined.dat')
    printed = parts.merge([parts.files[k] for k in order], '--table', table, why='merge')
    check.true(same_bits(numbers_of(joined), whole), 'merged: the bits of the whole study')
    check.equal(text_of(table), text_of(cases.path('whole.dat')), 'merged: the same table')
    check.true(f'3000 runs of 3000 from {len(order)} files' in printed and 'not made yet' not in printed, 'merged: told', printed)
    failed = np.sum(whole['exit_code'] == 6)
    check.true(f'{failed} runs failed with exit code 6' in printed, 'merged: failed runs', printed)
    check.true(('note: 1000 runs stood in more than one file, with the same numbers; first of them run 2 in' in printed) == (len(order) == 4),
               'merged: overlapping parts are told', printed)
    with h5py.File(joined) as file, h5py.File(parts.files[0]) as part:
        check.equal([file[name][()] for name in ('study/part', 'study/parts', 'study/runs')], [1, 1, 3000], 'merged: the whole study')
        check.true(file['provenance/data'][()] == part['provenance/data'][()] and file['quantities/way'].attrs['units'] == 'm s', 'merged: origin, units')


def test_what_a_merge_lacks_is_told_and_can_be_made(cases, mech9k, parts):
    check, whole, joined = cases.checks, parts.whole, parts.joined
    printed = parts.merge([parts.files[0], parts.files[2]], why='merge two of three')
    check.true('note: 1000 runs of the study are not made yet; --study --continue makes them' in printed, 'merged: missing runs are told', printed)
    left = numbers_of(joined)
    check.true(np.all(left['exit_code'][1::3] == -1) and np.all(np.isnan(left['quantities/way'][1::3])), 'merged: missing runs')
    # an incomplete merge is a part of a merge, and can be continued
    other = cases.path('other.h5')
    done = run(mech9k, '--merge', parts.files[1], joined, '--hdf5', other, '--quiet')
    check.true(done.returncode == DONE and done.stderr == '' and same_bits(numbers_of(other), whole), 'merged twice', done.stderr)
    cases.study(mech9k, parts.text, '--continue', joined, why='continue a merge')
    check.true(same_bits(numbers_of(joined), whole), 'a continued merge has the same bits')


@pytest.fixture
def merged(parts):
    """The parts, with a whole merge and files beside it that do not go together with them."""
    cases, files = parts.cases, parts.files
    parts.merge(files, why='merge')
    shutil.copy(files[1], cases.path('changed.h5'))
    with h5py.File(cases.path('changed.h5'), 'r+') as file:
        file['quantities/way'][7] += 1e-9
    with open(cases.path('short.h5'), 'wb') as file:
        file.write(open(files[0], 'rb').read()[:2500])
    return parts


def test_files_that_do_not_go_together_are_refused(cases, merged):
    """Nothing is written."""
    before = open(merged.joined, 'rb').read()
    for names, message in ((('part1.h5', 'other.h5'), "other.h5' are of different studies: in the first one '&study kind='random', runs=3000"),
                           (('part1.h5', 'other.h5'), '; merge files that one data file made with the same changes by --set'),
                           (('part1.h5', 'changed.h5', 'part2.h5'), "part2.h5' have different numbers for run 23; make it anew"),
                           (('part1.h5', 'short.h5'), 'truncated file'),
                           (('part1.h5', 'none.h5'), 'there is no such file'),
                           (('case.nml', 'part1.h5'), 'file signature not found')):
        printed = merged.merge([cases.path(name) for name in names], why=names, code=FILE)
        cases.checks.true(message in printed, f'{names}: {message}', printed)
    cases.checks.true(before == open(merged.joined, 'rb').read(), 'refused: nothing is written over')


def test_options_of_merges_that_are_refused(cases, mech9k, merged):
    check, joined = cases.checks, merged.joined
    before = open(joined, 'rb').read()
    for words, message in ((('--merge', 'part1.h5', '--hdf5', 'joined.h5'), 'give two of them or more'),
                           (('--merge', 'part1.h5', 'part2.h5'), '--merge needs the file that it makes'),
                           (('--merge', 'part1.h5', 'joined.h5', '--hdf5', 'joined.h5'), "would overwrite 'joined.h5', which is read"),
                           (('case.nml', '--merge', 'part1.h5', 'part2.h5', '--hdf5', 'joined.h5'), 'a data file is given beside --merge'),
                           (('--merge', 'part1.h5', 'part2.h5', '--hdf5', 'joined.h5', '--study'), 'leave --study out')):
        done = run(mech9k, *words, folder=cases.folder)
        check.true(done.returncode == USAGE and message in done.stderr, f'{words}: {message}', f'{done.returncode}: {done.stderr}')
    for target in ('--hdf5', '--table'):
        done = run(mech9k, '--merge', *merged.files, target, '/dev/full')
        check.true(done.returncode == FILE and 'No space left on device' in done.stderr, f'{target} /dev/full', done.stderr)
    check.true(before == open(joined, 'rb').read(), 'refused: nothing is written over')
    done = subprocess.run([mech9k, '--merge', *merged.files, '--hdf5', cases.path('large.h5')], capture_output=True, text=True,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000)))
    check.true(done.returncode == FILE and 'File too large' in done.stderr, 'a file that may not grow', f'{done.returncode}: {done.stderr}')


TEXT = random_study(30)
LISTED = SLIDER_CRANK + "&study kind='list', file='designs.dat' /\n"


@pytest.fixture
def files(cases, mech9k):
    """Files of studies, and files that are none."""
    cases.write('0.3 1\n0.2 1\n', 'designs.dat')
    cases.study(mech9k, TEXT, '--hdf5', cases.path('file.h5'), why='file')
    cases.study(mech9k, LISTED, '--hdf5', cases.path('list.h5'), why='file')
    cases.write('0.3 1\n0.2 1.01\n', 'designs.dat')
    whole = open(cases.path('file.h5'), 'rb').read()
    with open(cases.path('short.h5'), 'wb') as file:
        file.write(whole[:3000])
    run(mech9k, cases.write(TEXT), '--hdf5', cases.path('run.h5'))
    with h5py.File(cases.path('other.h5'), 'w') as file:
        file['x'] = [1, 2]
    with h5py.File(cases.path('shape.h5'), 'w') as file, h5py.File(cases.path('file.h5')) as good:
        for name in good:
            good.copy(name, file)
        del file['quantities/way']
        file['quantities/way'] = [1.0, 2.0]


@pytest.mark.parametrize('name, text, more, message', (
    ('file.h5', TEXT.replace('seed=3', 'seed=4'), (), "it is of another study: there '&study kind='random', runs=30, seed=3,', here '&study"),
    ('file.h5', TEXT.replace('runs=30', 'runs=31'), (), 'that made it, or make a new one by --hdf5'),
    ('file.h5', TEXT.replace('0.4, 10', '0.4, 10.5'), (), "here '&drive coordinate=1, kind='polynomial', coefficients=0.4,10.5,'"),
    ('file.h5', TEXT.replace('zero=0,1,0, moving_point=0,0,0', 'zero=0,1,0, moving_point=0,0,0.00012345678'), (),
     "moving_point=0,0,0.00012345678,'"),
    ('file.h5', TEXT, ('--set', 'parameter(1).low=0.21'), 'it is of another study'),
    ('file.h5', TEXT.replace("'way'", "'path'"), (), 'it is of another study'),
    ('list.h5', LISTED, (), "it is of another study: there 'file 1"),
    ('short.h5', TEXT, (), 'truncated file'),
    ('run.h5', TEXT, (), "it has no data set 'study/definition'"),
    ('other.h5', TEXT, (), "it has no data set 'study/definition'"),
    ('shape.h5', TEXT, (), "data set 'quantities/way' has other dimensions than this study gives it"),
    ('none.h5', TEXT, (), 'there is no such file'),
    ('designs.dat', TEXT, (), 'file signature not found')),
    ids=('another seed', 'more runs', 'a drive', 'a small length', 'a changed range', 'a name', 'another list', 'cut', 'a run', 'another file',
         'other dimensions', 'no file', 'a text'))
def test_other_studies_are_refused(cases, mech9k, files, name, text, more, message):
    """Other studies, and files that are no files of studies; nothing is changed in them."""
    check, path = cases.checks, cases.path(name)
    before = open(path, 'rb').read() if os.path.exists(path) else None
    cases.write('kept', 'kept.dat')
    done = run(mech9k, cases.write(text), '--study', '--continue', path, '--table', cases.path('kept.dat'), *more)
    check.true(done.returncode == FILE and message in done.stderr, f'{name}: {message}', f'{done.returncode}: {done.stderr}')
    check.true(before == (open(path, 'rb').read() if os.path.exists(path) else None), f'{name}: not changed')
    check.equal(text_of(cases.path('kept.dat')), 'kept', f'{name}: the table is not changed')


def test_blanks_comments_and_names_of_results_make_no_other_study(cases, mech9k, files):
    same = '! a comment\n' + TEXT.replace('runs=30', ' runs = 30') + "&output table='kept.dat', compression=3 /\n"
    cases.study(mech9k, same, '--continue', cases.path('file.h5'), '--table', cases.path('kept.dat'), why='the same study')


@pytest.mark.parametrize('words, code, message', (
    (('--continue', 'file.h5'), USAGE, 'or the starts of --optimize, that the file does not have yet; give one of them, too'),
    (('--study', '--continue', 'file.h5', '--hdf5', 'x.h5'), USAGE, 'leave --hdf5 and --no-write out'),
    (('--study', '--continue', 'file.h5', '--no-write'), USAGE, 'leave --hdf5 and --no-write out'),
    (('--study', '--hdf5', 'full.h5', '--table', 'full.h5'), USAGE, 'cannot both be'),
    (('--study', '--hdf5', '/dev/full'), FILE, 'No space left on device'),
    (('--study', '--hdf5', 'fine.h5', '--table', '/dev/full'), FILE, 'No space left on device'),
    (('--study', '--hdf5', 'none/fine.h5'), FILE, "cannot open 'none/fine.h5'"),
    (('--study', '--continue', '/dev/full'), FILE, 'is not a file of HDF5')),
    ids=('no study', 'hdf5', 'no-write', 'table over file', 'a full disk', 'a full disk for the table', 'no folder', 'continue a device'))
def test_options_that_are_refused(cases, mech9k, files, words, code, message):
    done = run(mech9k, cases.write(TEXT), *words, folder=cases.folder)
    cases.checks.true(done.returncode == code and message in done.stderr, f'{words}: {message}', f'{done.returncode}: {done.stderr}')
    cases.checks.true(not os.path.exists(cases.path('none')) and not os.path.exists(cases.path('.full.h5.part')), 'nothing is left behind')


@pytest.mark.skipif(os.geteuid() == 0, reason='root may write every file')
def test_a_file_that_may_not_be_written(cases, mech9k, files):
    shutil.copy(cases.path('file.h5'), cases.path('locked.h5'))
    os.chmod(cases.path('locked.h5'), 0o444)
    done = run(mech9k, cases.write(TEXT), '--study', '--continue', cases.path('locked.h5'))
    cases.checks.true(done.returncode == FILE and 'ermission denied' in done.stderr, 'a file that may not be written', done.stderr)
