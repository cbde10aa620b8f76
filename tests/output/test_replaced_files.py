"""Files that hold what nobody wants to lose, drafts and data files of a conversation and HDF5 files, are written beside
and then named: the file that was there stays as it was for whoever has it, until the new one is whole."""
import os
import shutil
import signal
import stat
import subprocess
import time

import pytest

from conversations import piped
from mech9_cases import PATIENCE, TREE, run, text_of

try:
    import h5py
except ImportError:
    h5py = None

FIG1 = os.path.join(TREE, 'examples', 'fig1', 'fig1.nml')
TABLE = "&drive coordinate=5, kind='table', file='motion.txt' /"


def rights(path):
    return stat.S_IMODE(os.stat(path).st_mode)


def no_part_is_left(folder):
    return not any(name.endswith('.part') for name in os.listdir(folder))


def test_draft_that_is_written_again(checks, mech9k, tmp_path):
    folder, there = tmp_path, lambda name: tmp_path / name
    shutil.copy(FIG1, there('fig1.nml'))
    piped(mech9k, '--edit', 'fig1.nml', folder=folder, answers='time end = 2\nquit\n')
    draft = text_of(there('fig1.draft.nml'))
    os.link(there('fig1.draft.nml'), there('before'))
    os.chmod(there('fig1.draft.nml'), 0o640)
    piped(mech9k, '--resume', 'fig1.draft.nml', folder=folder, answers='time end = 3\nquit\n')
    checks.equal(text_of(there('before')), draft, 'the draft of before was not touched')
    checks.true('end=3' in text_of(there('fig1.draft.nml')), 'the new one holds the new answer', text_of(there('fig1.draft.nml')))
    checks.equal(rights(there('fig1.draft.nml')), 0o640, 'it has the rights of the one before')
    # a link stays a link, and its file is replaced where it stands
    os.mkdir(there('drafts'))
    os.rename(there('fig1.draft.nml'), there('drafts/kept'))
    os.symlink('drafts/kept', there('fig1.draft.nml'))
    piped(mech9k, '--resume', 'fig1.draft.nml', folder=folder, answers='time end = 4\nquit\n')
    checks.true(os.path.islink(there('fig1.draft.nml')) and 'end=4' in text_of(there('drafts/kept')), 'through a link')
    checks.true(no_part_is_left(folder), 'no part is left')


def test_data_file_that_is_saved_over_itself(checks, mech9k, tmp_path):
    folder, there = tmp_path, lambda name: tmp_path / name
    shutil.copy(FIG1, there('fig1.nml'))
    os.link(there('fig1.nml'), there('data before'))
    data = text_of(there('fig1.nml'))
    done = piped(mech9k, '--edit', 'fig1.nml', folder=folder, answers='time end = 5\n\nsave\n\n')
    checks.equal(done.returncode, 0, f'saved over itself: {done.stderr}')
    checks.equal(text_of(there('data before')), data, 'the data file of before was not touched')
    checks.true('end=5' in text_of(there('fig1.nml')), 'the new one holds the new answer')
    checks.true(no_part_is_left(folder), 'no part is left')


def test_draft_and_data_file_of_one_name(checks, mech9k, tmp_path):
    folder, there = tmp_path, lambda name: tmp_path / name
    shutil.copy(FIG1, there('fig1.nml'))
    # a draft that is kept: the next one is fig1_2.draft.nml
    piped(mech9k, '--edit', 'fig1.nml', folder=folder, answers='time end = 2\nquit\n')
    # the draft and the data file are one file with two names: it is not removed as the draft
    done = piped(mech9k, '--edit', 'fig1.nml', folder=folder, answers='time end = 6\n\nsave\n./fig1_2.draft.nml\nyes\n')
    kept = [name for name in os.listdir(folder) if name.startswith('fig1_2')]
    checks.true(kept == [] or 'end=6' in text_of(there(kept[0])), 'saved under another name of the draft', (kept, done.stderr))
    checks.true('Saved in ./fig1_2.draft.nml' not in done.stderr or kept == ['fig1_2.draft.nml'], 'what was saved is there',
                (kept, done.stderr))
    checks.true(no_part_is_left(folder), 'no part is left')


def test_table_of_a_drive_is_not_saved_over(checks, mech9k, tmp_path):
    folder = tmp_path
    lines = [TABLE if line.startswith('&drive') else line for line in text_of(FIG1).splitlines()]
    (folder / 'driven.nml').write_text('\n'.join(lines) + '\n', encoding='utf-8')
    motion = ''.join(f'{i / 4} {0.5 + i}\n' for i in range(5))
    (folder / 'motion.txt').write_text(motion, encoding='utf-8')
    done = piped(mech9k, '--edit', 'driven.nml', folder=folder, answers='time end = 0.5\n\nsave\nmotion.txt\nyes\nnew.nml\n')
    checks.true('holds numbers that this data file reads' in done.stderr, 'over the table of a drive', done.stderr)
    checks.equal(text_of(folder / 'motion.txt'), motion, 'the table is as it was')


@pytest.fixture
def words(checks, mech9k, tmp_path):
    """A run that writes a.h5 into the folder of the test."""
    if not h5py:
        checks.left_out('h5py is not installed (Debian: python3-h5py): no HDF5 file is tested')
        pytest.skip(checks.missing[-1])
    return [mech9k, FIG1, '--hdf5', tmp_path / 'a.h5', '--quiet', '--set', "output.table=''"]


def test_results_replace_those_of_before(checks, words, tmp_path):
    folder, path, part = tmp_path, tmp_path / 'a.h5', tmp_path / '.a.h5.part'
    checks.equal(run(*words).returncode, 0, 'a run')
    os.link(path, folder / 'before.h5')
    checks.equal(run(*words, '--set', 'time.intervals=10').returncode, 0, 'another run')
    for name, rows in (('before.h5', 101), ('a.h5', 11)):
        with h5py.File(folder / name, 'r') as file:
            checks.equal(file['time'].shape[0], rows, f'{name} holds its own rows')
    checks.true(not os.path.exists(part), 'no part is left')


def test_results_stay_until_the_first_rows_of_the_next_run(checks, words, tmp_path):
    """At whatever moment that run is killed."""
    path, part = tmp_path / 'a.h5', tmp_path / '.a.h5.part'
    # how long a run takes here until its file has its name
    endless = words + ['--set', 'time.intervals=50000000']
    process, start = subprocess.Popen(endless), time.monotonic()
    while not os.path.exists(path) and time.monotonic() - start < 60.0 * PATIENCE:
        time.sleep(0.001)
    laid_out = time.monotonic() - start
    process.kill()
    process.wait()
    named = 0
    for i in range(30):
        if os.path.exists(path):
            os.remove(path)
        process = subprocess.Popen(endless)
        time.sleep(1.3 * laid_out * i / 30)
        while i == 29 and not os.path.exists(path) and time.monotonic() - start < 60.0 * PATIENCE:
            time.sleep(0.001)
        process.send_signal(signal.SIGKILL)
        process.wait()
        if not os.path.exists(path):
            continue
        named += 1
        try:
            with h5py.File(path, 'r') as file:
                checks.equal(file['time'][:1].tolist(), [0.0], f'killed in moment {i} of 30: the start is there')
        except (OSError, KeyError) as error:
            checks.true(False, f'killed in moment {i} of 30: the file opens', error)
    checks.true(named > 0, 'some of the 30 files had their name when the run was killed')
    checks.equal(run(*words).returncode, 0, 'a run after those that were killed')
    checks.true(not os.path.exists(part), 'it leaves nothing of theirs')
