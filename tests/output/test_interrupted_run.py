"""A run that is asked to end (Ctrl-C, kill, the terminal closed) keeps what was computed and says so; an answer
just ends. Ctrl-\\ ends a run as it ends any program. What takes no notice of the request, a step that does not end or a
pipe that nobody reads, is ended within a second."""
import json
import os
import resource
import signal
import subprocess
import time

import pytest

from mech9_cases import PATIENCE, TREE, read_table, text_of

try:
    import h5py
except ImportError:
    h5py = None

FIG1 = os.path.join(TREE, 'examples', 'fig1', 'fig1.nml')
PENDULUM = os.path.join(TREE, 'examples', 'double_pendulum', 'double_pendulum.nml')
PLATFORM = os.path.join(TREE, 'examples', 'stewart_gough', 'stewart_gough.nml')
# outputs and steps that nobody waits for
MANY = '50000000'
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
# steps of a pendulum that nobody waits for
FAR = ['--set', 'time.end=1e6', '--set', 'solver.maximum_steps=2000000000']
each_signal = pytest.mark.parametrize('number', SIGNALS, ids=lambda number: number.name)


def default_actions():
    """Signals as an interactive shell leaves them, whatever the tests were started by."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_DFL)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def interrupted(words, folder, number, ready, seconds=0.3):
    """Run, wait until `ready` and a little longer, send the signal; what the ended process said, and its code."""
    process = subprocess.Popen(words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               preexec_fn=default_actions)
    return ended(process, number, ready, seconds)[:3]


def ended(process, number, ready, seconds=0.3):
    """The code of a process that a signal is sent to, what it said, and how long it went on after the signal [s]."""
    patience = time.monotonic() + 30.0 * PATIENCE
    while not ready() and process.poll() is None and time.monotonic() < patience:
        time.sleep(0.02)
    time.sleep(seconds)
    process.send_signal(number)
    start = time.monotonic()
    try:
        said, errors = process.communicate(timeout=30 * PATIENCE)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return None, '', '', 30.0 * PATIENCE
    return process.returncode, said, errors, time.monotonic() - start


# A mass under the force of a user's procedure that does not come back after 0.5 s.
ENDLESS = """
&mechanism links=2, coordinates=1 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&initial coordinate=1, position=0.0, velocity=0.0 /
&body link=2, mass=1.0 /
&load kind='user' /
&user parameters = 2.0, 0.5 /
&time start=0.0, end=1.0, intervals=100 /
"""


def check_stuck(checks, words, folder, number, why):
    """A run that takes no notice ends by the signal itself. A second is allowed, and another one for a busy machine."""
    process = subprocess.Popen(words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               preexec_fn=default_actions)
    code, _, errors, seconds = ended(process, number, lambda: True, 0.5)
    checks.equal(code, -number, f'{why}, {signal.Signals(number).name}: ended by the signal')
    checks.true(seconds < 2.0, f'{why}, {signal.Signals(number).name}: within a second', seconds)
    checks.true('acktrace' not in errors, f'{why}: without a backtrace', errors)


@each_signal
def test_pipe_without_a_reader(checks, mech9k, tmp_path, number):
    """A named pipe is waited for until somebody reads, or the run is asked to end."""
    os.mkfifo(tmp_path / 'pipe')
    check_stuck(checks, [mech9k, FIG1, '--table', 'pipe'], tmp_path, number, 'a pipe without a reader')


@each_signal
def test_force_that_does_not_come_back(checks, build, tmp_path, number):
    """A step that does not end is ended. The program is mech9d with tests/user/user_forces/failing_force.f90."""
    (tmp_path / 'endless.nml').write_text(ENDLESS, encoding='utf-8')
    words = [build.program('failing_force_d'), 'endless.nml', '--table', 'stuck.dat']
    check_stuck(checks, words, tmp_path, number, 'a force that does not come back')


def test_pipe_without_a_writer(checks, mech9k, tmp_path):
    os.mkfifo(tmp_path / 'pipe')
    check_stuck(checks, [mech9k, 'pipe'], tmp_path, signal.SIGTERM, 'a pipe without a writer')


def test_reader_that_comes_later(checks, mech9k, tmp_path):
    pipe = tmp_path / 'pipe'
    os.mkfifo(pipe)
    process = subprocess.Popen([mech9k, FIG1, '--quiet', '--table', pipe], stderr=subprocess.PIPE, text=True)
    time.sleep(0.3)
    with open(pipe, encoding='utf-8') as file:
        through = file.read()
    checks.equal((process.wait(timeout=30 * PATIENCE), process.stderr.read()), (0, ''), 'a reader that comes later: done')
    process.stderr.close()
    checks.true(len(read_table(through)['t']) > 10, 'a reader that comes later gets the table')


def test_reader_that_does_not_read_on(checks, mech9k):
    """The run stops in the middle of its rows."""
    process = subprocess.Popen([mech9k, FIG1, '--set', 'time.intervals=' + MANY, '--table', '-'], stdout=subprocess.PIPE,
                               stderr=subprocess.DEVNULL, preexec_fn=default_actions)
    time.sleep(0.5)
    start = time.monotonic()
    process.send_signal(signal.SIGTERM)
    checks.equal(process.wait(timeout=30 * PATIENCE), -signal.SIGTERM, 'a reader that does not read on: ended by the signal')
    checks.true(time.monotonic() - start < 2.0, 'a reader that does not read on: within a second')
    process.stdout.close()


def check_rows(checks, program, data, settings, folder, number):
    path = folder / 'part.dat'
    words = [program, data, '--table', 'part.dat', '--hdf5', 'part.h5', '--report', 'part.json']
    code, said, errors = interrupted(words + settings, folder, number,
                                     lambda: os.path.exists(path) and os.path.getsize(path) > 100000)
    why = f'{os.path.basename(program)}, {signal.Signals(number).name}'
    checks.equal((code, said), (130, ''), f'{why}: exit code, nothing on standard output')
    checks.true('interrupted before t = ' in errors and 'Backtrace' not in errors, f'{why}: told', errors)
    text = text_of(path)
    checks.true(text.endswith('\n'), f'{why}: the last row is whole')
    times = read_table(text)['t']
    report = json.loads(text_of(folder / 'part.json'))
    checks.equal(report['exit_code'], 130, f'{why}: the report is written')
    checks.true(len(report['errors']) == 1 and report['errors'][0]['message'] in errors, f'{why}: it says what was said', report)
    checks.true(len(times) in report.values(), f'{why}: it counts the rows of the table', (len(times), report))
    if not h5py:
        checks.left_out('h5py is not installed (Debian: python3-h5py): no HDF5 file is read')
    else:
        with h5py.File(folder / 'part.h5', 'r') as file:
            checks.equal(file['time'][:].tolist(), times.tolist(), f'{why}: the HDF5 file holds the same times')


@each_signal
def test_rows_of_kinematics_are_kept(checks, mech9k, tmp_path, number):
    check_rows(checks, mech9k, FIG1, ['--set', 'time.intervals=' + MANY], tmp_path, number)


def test_rows_of_dynamics_are_kept(checks, mech9d, tmp_path):
    check_rows(checks, mech9d, PENDULUM, FAR + ['--set', 'time.intervals=' + MANY], tmp_path, signal.SIGINT)


def test_start_is_kept_on_the_way_to_a_single_output(checks, mech9d, tmp_path):
    path = tmp_path / 'one.dat'
    code, _, errors = interrupted([mech9d, PENDULUM, '--table', path, *FAR, '--set', 'time.intervals=1'], tmp_path, signal.SIGINT, path.exists)
    checks.true(code == 130 and 'interrupted' in errors, 'mech9d, between two outputs', (code, errors))
    checks.equal(read_table(text_of(path))['t'].tolist(), [0.0], 'mech9d, between two outputs: the start is kept')


def test_quit_is_not_taken(checks, mech9k, tmp_path):
    """Ctrl-\\ ends a run as it ends any program."""
    code, _, errors = interrupted([mech9k, FIG1, '--no-write', '--set', 'time.intervals=' + MANY], tmp_path, signal.SIGQUIT, lambda: True, 0.5)
    checks.true(code == -signal.SIGQUIT and 'acktrace' not in errors, 'SIGQUIT ends a run without a backtrace', (code, errors))


def test_answer_has_nothing_to_keep(checks, mech9k, tmp_path):
    code, _, errors = interrupted([mech9k, PLATFORM, '--branches', '--starts', MANY], tmp_path, signal.SIGINT, lambda: True, 0.5)
    checks.equal((code, errors), (-signal.SIGINT, ''), '--branches ends at once')


@each_signal
def test_starts_are_kept(checks, mech9d, tmp_path, number):
    """A search from many random positions keeps what it has found: here the lower and the upper position of a pendulum."""
    folder = tmp_path
    (folder / 'single.nml').write_text(
        "&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /\n&initial coordinate=1, position=1 /\n"
        '&body link=2, mass=1, centre=1,0,0 /\n&gravity acceleration=0,-9.81,0 /\n', encoding='utf-8')
    words = [mech9d, 'single.nml', '--equilibrium', '--starts', MANY, '--table', 'rest.dat', '--report', 'rest.json']
    code, _, errors = interrupted(words, folder, number, lambda: True, 0.5)
    why = f'--starts, {signal.Signals(number).name}'
    checks.equal(code, 130, f'{why}: exit code')
    checks.true(f' of {MANY} random starts' in errors and '2 positions of equilibrium found so far' in errors, f'{why}: told', errors)
    checks.equal(read_table(text_of(folder / 'rest.dat'))['stable'].tolist(), [1.0, 0.0], f'{why}: both positions are kept')
    checks.equal(json.loads(text_of(folder / 'rest.json'))['exit_code'], 130, f'{why}: the report is written')
