"""A run that is asked to end (Ctrl-C, kill, the terminal closed) keeps what was computed and says so; an answer
just ends. Ctrl-\\ ends a run as it ends any program. What takes no notice of the request, a step that does not end or a
pipe that nobody reads, is ended within a second.

usage: interrupted_run.py MECH9K MECH9D FAILING_FORCE_D     the last: mech9d with user_forces/failing_force.f90
"""
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from mech9_cases import TREE, Checks, read_table

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
    patience = time.monotonic() + 30.0
    while not ready() and process.poll() is None and time.monotonic() < patience:
        time.sleep(0.02)
    time.sleep(seconds)
    process.send_signal(number)
    start = time.monotonic()
    try:
        said, errors = process.communicate(timeout=30)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return None, '', '', 30.0
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


def check_pipes(checks, program, endless, folder):
    """A named pipe is waited for until somebody reads, or the run is asked to end; a step that does not end is ended."""
    pipe, data = os.path.join(folder, 'pipe'), os.path.join(folder, 'endless.nml')
    os.mkfifo(pipe)
    with open(data, 'w', encoding='utf-8') as file:
        file.write(ENDLESS)
    for number in SIGNALS:
        check_stuck(checks, [program, FIG1, '--table', pipe], folder, number, 'a pipe without a reader')
        check_stuck(checks, [endless, data, '--table', 'stuck.dat'], folder, number, 'a force that does not come back')
    check_stuck(checks, [program, pipe], folder, signal.SIGTERM, 'a pipe without a writer')
    process = subprocess.Popen([program, FIG1, '--quiet', '--table', pipe], stderr=subprocess.PIPE, text=True)
    time.sleep(0.3)
    with open(pipe, encoding='utf-8') as file:
        through = file.read()
    checks.equal((process.wait(timeout=30), process.stderr.read()), (0, ''), 'a reader that comes later: done')
    process.stderr.close()
    checks.true(len(read_table(through)['t']) > 10, 'a reader that comes later gets the table')
    # one that does not go on reading: the run stops in the middle of its rows
    process = subprocess.Popen([program, FIG1, '--set', 'time.intervals=' + MANY, '--table', '-'], stdout=subprocess.PIPE,
                               stderr=subprocess.DEVNULL, preexec_fn=default_actions)
    time.sleep(0.5)
    start = time.monotonic()
    process.send_signal(signal.SIGTERM)
    checks.equal(process.wait(timeout=30), -signal.SIGTERM, 'a reader that does not read on: ended by the signal')
    checks.true(time.monotonic() - start < 2.0, 'a reader that does not read on: within a second')
    process.stdout.close()


def check_rows(checks, program, data, settings, folder, number):
    path = os.path.join(folder, 'part.dat')
    for name in os.listdir(folder):
        os.remove(os.path.join(folder, name))
    words = [program, data, '--table', 'part.dat', '--hdf5', 'part.h5', '--report', 'part.json']
    code, said, errors = interrupted(words + settings, folder, number,
                                     lambda: os.path.exists(path) and os.path.getsize(path) > 100000)
    why = f'{os.path.basename(program)}, {signal.Signals(number).name}'
    checks.equal((code, said), (130, ''), f'{why}: exit code, nothing on standard output')
    checks.true('interrupted before t = ' in errors and 'Backtrace' not in errors, f'{why}: told', errors)
    with open(path, encoding='utf-8') as file:
        text = file.read()
    checks.true(text.endswith('\n'), f'{why}: the last row is whole')
    times = read_table(text)['t']
    with open(os.path.join(folder, 'part.json'), encoding='utf-8') as file:
        report = json.load(file)
    checks.equal(report['exit_code'], 130, f'{why}: the report is written')
    checks.true(len(report['errors']) == 1 and report['errors'][0]['message'] in errors, f'{why}: it says what was said', report)
    checks.true(len(times) in report.values(), f'{why}: it counts the rows of the table', (len(times), report))
    if h5py:
        with h5py.File(os.path.join(folder, 'part.h5'), 'r') as file:
            checks.equal(file['time'][:].tolist(), times.tolist(), f'{why}: the HDF5 file holds the same times')


def check_starts(checks, mech9d, folder, number):
    """A search from many random positions keeps what it has found: here the lower and the upper position of a pendulum."""
    with open(os.path.join(folder, 'single.nml'), 'w', encoding='utf-8') as file:
        file.write("&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /\n&initial coordinate=1, position=1 /\n"
                   '&body link=2, mass=1, centre=1,0,0 /\n&gravity acceleration=0,-9.81,0 /\n')
    words = [mech9d, 'single.nml', '--equilibrium', '--starts', MANY, '--table', 'rest.dat', '--report', 'rest.json']
    code, _, errors = interrupted(words, folder, number, lambda: True, 0.5)
    why = f'--starts, {signal.Signals(number).name}'
    checks.equal(code, 130, f'{why}: exit code')
    checks.true(f' of {MANY} random starts' in errors and '2 positions of equilibrium found so far' in errors, f'{why}: told', errors)
    with open(os.path.join(folder, 'rest.dat'), encoding='utf-8') as file:
        checks.equal(read_table(file.read())['stable'].tolist(), [1.0, 0.0], f'{why}: both positions are kept')
    with open(os.path.join(folder, 'rest.json'), encoding='utf-8') as file:
        checks.equal(json.load(file)['exit_code'], 130, f'{why}: the report is written')


def main():
    mech9k, mech9d, endless = map(os.path.abspath, sys.argv[1:4])
    checks = Checks()
    if not h5py:
        checks.left_out('h5py is not installed (Debian: python3-h5py): no HDF5 file is read')
    with tempfile.TemporaryDirectory() as folder:
        for number in SIGNALS:
            check_rows(checks, mech9k, FIG1, ['--set', 'time.intervals=' + MANY], folder, number)
        far = ['--set', 'time.end=1e6', '--set', 'solver.maximum_steps=2000000000']
        check_rows(checks, mech9d, PENDULUM, far + ['--set', 'time.intervals=' + MANY], folder, signal.SIGINT)
        # on the way to a single output
        path = os.path.join(folder, 'one.dat')
        code, _, errors = interrupted([mech9d, PENDULUM, '--table', path, *far, '--set', 'time.intervals=1'], folder,
                                      signal.SIGINT, lambda: os.path.exists(path))
        checks.true(code == 130 and 'interrupted' in errors, 'mech9d, between two outputs', (code, errors))
        with open(path, encoding='utf-8') as file:
            checks.equal(read_table(file.read())['t'].tolist(), [0.0], 'mech9d, between two outputs: the start is kept')
        for number in SIGNALS:
            check_starts(checks, mech9d, folder, number)
        # Ctrl-\\ is not taken
        code, _, errors = interrupted([mech9k, FIG1, '--no-write', '--set', 'time.intervals=' + MANY], folder, signal.SIGQUIT,
                                      lambda: True, 0.5)
        checks.true(code == -signal.SIGQUIT and 'acktrace' not in errors, 'SIGQUIT ends a run without a backtrace', (code, errors))
        # an answer has nothing to keep
        code, _, errors = interrupted([mech9k, PLATFORM, '--branches', '--starts', MANY], folder, signal.SIGINT,
                                      lambda: True, 0.5)
        checks.equal((code, errors), (-signal.SIGINT, ''), '--branches ends at once')
    with tempfile.TemporaryDirectory() as folder:
        check_pipes(checks, mech9k, endless, folder)
    checks.finish()


main()
