"""Behaviour that can only be seen from outside a process: exit codes, signals, terminals, broken pipes. The
program is that of session_probe.f90."""
import os
import pty
import signal
import subprocess
import threading
import time

import pytest

from mech9_cases import PATIENCE
from pseudo_terminal import available

# a damped pendulum under a torque with the period of 1 s
PENDULUM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&body link=2, mass=1, centre=0,-1,0 /
&gravity acceleration=0,-9.81,0 /
&load kind='coordinate', coordinate=1, damping=0.5 /
&load kind='coordinate', coordinate=1, force=2, law='harmonic', amplitude=1, angular_frequency=6.283185307179586 /
&initial coordinate=1, position=0.2 /
"""


@pytest.fixture
def probe(build):
    return build.program('session_probe')


def started(probe, *words, **options):
    """A running probe, which is killed where it hangs, so that a failure is one and not a standstill."""
    process = subprocess.Popen([probe, *words], **options)
    timer = threading.Timer(60 * PATIENCE, process.kill)
    timer.daemon = True
    timer.start()
    return process


def run(probe, *words, **options):
    return subprocess.run([probe, *words], capture_output=True, timeout=60 * PATIENCE, **options)


def rows_of(text):
    """Rows of a table as pandas and numpy read it: comments off, one line of names, numbers."""
    lines = [line for line in text.split("\n") if line and not line.startswith("#")]
    names = lines[0].split()
    rows = [[float(word) for word in line.split()] for line in lines[1:]]
    return names, rows


@pytest.mark.parametrize('code', (0, 3, 130))
def test_exit(checks, probe, code):
    done = run(probe, "exit", str(code))
    checks.true(done.returncode == code, f"exit code {code}", done.returncode)
    checks.true(done.stdout == b"last words", "what was said last is not lost", done.stdout)
    checks.true(done.stderr == b"", "an exit says nothing by itself", done.stderr)


@pytest.mark.parametrize('number', (signal.SIGINT, signal.SIGTERM), ids=lambda number: number.name)
def test_signals(checks, probe, number):
    with started(probe, "wait", stdout=subprocess.PIPE) as process:
        checks.true(process.stdout.readline() == b"ready\n", "the probe is ready")
        process.send_signal(number)
        checks.true(process.stdout.readline() == b"noted\n", f"the first signal {number} is noted")
        checks.true(process.wait() == 130, "the probe ends in order")
    with started(probe, "wait", "more", stdout=subprocess.PIPE) as process:
        process.stdout.readline()
        process.send_signal(number)
        process.stdout.readline()
        process.send_signal(number)
        checks.true(process.wait() == -number, f"the second signal {number} ends the probe at once")


def test_ignored_signal(checks, probe):
    """As by nohup and in background jobs: who is told to ignore Ctrl-C goes on ignoring it."""
    ignore = lambda: signal.signal(signal.SIGINT, signal.SIG_IGN)
    with started(probe, "wait", stdout=subprocess.PIPE, preexec_fn=ignore) as process:
        process.stdout.readline()
        process.send_signal(signal.SIGINT)
        time.sleep(0.3)
        checks.true(process.poll() is None, "an ignored signal stays ignored")
        process.send_signal(signal.SIGTERM)
        checks.true(process.wait() == 130, "the other one ends it")


def on_terminal(probe, *words):
    """Run with standard error on a terminal; all that the terminal got."""
    master, slave = pty.openpty()
    process = started(probe, *words, stderr=slave, stdout=subprocess.DEVNULL)
    os.close(slave)
    got = b""
    while True:
        try:
            piece = os.read(master, 4096)
        except OSError:
            break
        if not piece:
            break
        got += piece
    process.wait()
    os.close(master)
    return got.decode()


def test_no_progress_without_a_terminal(checks, probe):
    checks.true(run(probe, "progress", "2").stderr == b"", "nothing where standard error is no terminal")


def test_progress(checks, probe):
    if not available():
        checks.left_out('there are no pseudo-terminals here')
        return
    got = on_terminal(probe, "progress", "3")
    lines = got.split("\r")
    shown = [line for line in lines if "left" in line]
    checks.true(len(shown) >= 3, "a long run shows progress", got)
    checks.true(all(len(line) <= 79 for line in lines), "within 80 columns")
    checks.true(all(line.startswith("probe ") for line in shown), "with its label")
    # the echo of Ctrl-C then stands over the line, and goes with it
    checks.true(all(after == "" for line, after in zip(lines, lines[1:]) if "left" in line), "the cursor waits at its beginning", got)
    # from the first line, after a second, the third of the work is done
    checks.true(shown and 33 <= int(shown[0].split()[1]) < 80, "not before a second has passed", shown[:1])
    checks.true(lines[-2].strip() == "" and len(lines[-2]) >= len(shown[-1].rstrip()) and lines[-1] == "",
                "erased in the end", lines[-2:])
    checks.true("\n" not in got, "on one line")
    checks.true(on_terminal(probe, "progress", "3", "quiet") == "", "nothing from a quiet run")
    checks.true(on_terminal(probe, "progress", "0") == "", "nothing from a short run")


def test_progress_of_answers(checks, mech9d, tmp_path):
    """Exponents tell how far they are."""
    if not available():
        checks.left_out('there are no pseudo-terminals here')
        return
    path = tmp_path / 'pendulum.nml'
    for seconds in (500, 1500, 4500):
        path.write_text(f'{PENDULUM}&time end={seconds}, intervals=1 /\n', encoding='utf-8')
        lines = on_terminal(mech9d, path, '--exponents', '1', '--no-write').split('\r')
        shown = [line for line in lines if line.startswith('mech9d ') and 'left' in line]
        if shown:
            break
    checks.true(bool(shown) and all(len(line) <= 79 for line in shown), 'a line within 80 columns', lines[-3:])
    checks.true(bool(shown) and any(line == ' ' * 79 for line in lines[lines.index(shown[-1]):]), 'which is erased', lines[-3:])
    checks.true(on_terminal(mech9d, path, '--exponents', '1', '--no-write', '--quiet') == '', 'nothing with --quiet')


def test_table(checks, probe, tmp_path):
    path = tmp_path / "a b.dat"
    done = run(probe, "table", path, "20000")
    checks.true(done.returncode == 0 and done.stdout == b"", "a table in a file")
    with open(path, encoding="utf-8") as file:
        in_file = file.read()
    names, rows = rows_of(in_file)
    checks.true(names == [f"q{i}" for i in range(1, 21)], "names")
    checks.true(rows == [[i] + [1 / i] * 19 for i in range(1, 20001)], "numbers, bit for bit")
    done = run(probe, "table", "-", "20000")
    checks.true(done.stdout.decode() == in_file, "the same on standard output")


def test_full_standard_output(checks, probe):
    if not checks.has_full_disk():
        return
    with open("/dev/full", "w") as full:
        done = subprocess.run([probe, "table", "-", "3"], stdout=full, stderr=subprocess.PIPE, timeout=60 * PATIENCE)
    checks.true(done.returncode == 8 and b"standard output" in done.stderr, "standard output is full", done)


def test_reader_that_goes_away(checks, probe):
    with started(probe, "table", "-", "200000", stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdout.read(1000)
        process.stdout.close()
        said = process.stderr.read()
        checks.true(process.wait() == 8, "a broken pipe is an error of writing", process.returncode)
        checks.true(b"Backtrace" not in said and said.count(b"\n") == 1, "one line of message", said)


def test_killed(checks, probe, tmp_path):
    """A run that is killed leaves whole rows, and all but those of the last moment. The system may break
    off the very write that it was at, so that what follows the last line end does not count."""
    path = tmp_path / "killed.dat"
    with started(probe, "table", path, "100000000") as process:
        while not os.path.exists(path) or os.path.getsize(path) < 5000000:
            time.sleep(0.01)
        process.kill()
    with open(path, encoding="utf-8") as file:
        text = file.read()
    checks.true(len(text) >= 5000000, "what was there stays")
    text = text[:text.rindex("\n") + 1]
    _, rows = rows_of(text)
    checks.true([row[0] for row in rows] == list(range(1, len(rows) + 1)), "no row is missing")
    checks.true(all(len(row) == 20 for row in rows), "no row is torn")


def test_named_pipe(checks, probe, tmp_path):
    """As gnuplot reads one: opening waits for the reader."""
    path = tmp_path / "pipe"
    os.mkfifo(path)
    with started(probe, "table", path, "1000") as process:
        with open(path, encoding="utf-8") as file:
            _, rows = rows_of(file.read())
        checks.true(process.wait() == 0 and len(rows) == 1000, "a table through a named pipe")
