"""A run that is asked to end (Ctrl-C, kill, the terminal closed) keeps what was computed and says so; an answer
just ends. Ctrl-\\ ends a run as it ends any program.

usage: interrupted_run.py MECH9K MECH9D
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
    patience = time.monotonic() + 30.0
    while not ready() and process.poll() is None and time.monotonic() < patience:
        time.sleep(0.02)
    time.sleep(seconds)
    process.send_signal(number)
    try:
        said, errors = process.communicate(timeout=30)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return None, '', ''
    return process.returncode, said, errors


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


def main():
    mech9k, mech9d = map(os.path.abspath, sys.argv[1:3])
    checks = Checks()
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
        # Ctrl-\\ is not taken
        code, _, errors = interrupted([mech9k, FIG1, '--no-write', '--set', 'time.intervals=' + MANY], folder, signal.SIGQUIT,
                                      lambda: True, 0.5)
        checks.true(code == -signal.SIGQUIT and 'acktrace' not in errors, 'SIGQUIT ends a run without a backtrace', (code, errors))
        # an answer has nothing to keep
        code, _, errors = interrupted([mech9k, PLATFORM, '--branches', '--starts', MANY], folder, signal.SIGINT,
                                      lambda: True, 0.5)
        checks.equal((code, errors), (-signal.SIGINT, ''), '--branches ends at once')
    checks.finish()


main()
