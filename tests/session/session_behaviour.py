"""Behaviour that can only be seen from outside a process: exit codes, signals, terminals, broken pipes.

usage: session_behaviour.py PROBE    (the program of session_probe.f90)
"""
import os
import pty
import signal
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from mech9_cases import Checks
from terminal import available

probe = sys.argv[1]
checks = Checks()


def check(condition, why, seen=""):
    checks.true(condition, why, seen)


def started(*words, **options):
    """A running probe, which is killed where it hangs, so that a failure is one and not a standstill."""
    process = subprocess.Popen([probe, *words], **options)
    timer = threading.Timer(60, process.kill)
    timer.daemon = True
    timer.start()
    return process


def run(*words, **options):
    return subprocess.run([probe, *words], capture_output=True, timeout=60, **options)


def rows_of(text):
    """Rows of a table as pandas and numpy read it: comments off, one line of names, numbers."""
    lines = [line for line in text.split("\n") if line and not line.startswith("#")]
    names = lines[0].split()
    rows = [[float(word) for word in line.split()] for line in lines[1:]]
    return names, rows


def test_exit():
    for code in (0, 3, 130):
        done = run("exit", str(code))
        check(done.returncode == code, f"exit code {code}", done.returncode)
        check(done.stdout == b"last words", "what was said last is not lost", done.stdout)
        check(done.stderr == b"", "an exit says nothing by itself", done.stderr)


def test_signals():
    for number in (signal.SIGINT, signal.SIGTERM):
        with started("wait", stdout=subprocess.PIPE) as process:
            check(process.stdout.readline() == b"ready\n", "the probe is ready")
            process.send_signal(number)
            check(process.stdout.readline() == b"noted\n", f"the first signal {number} is noted")
            check(process.wait() == 130, "the probe ends in order")
        with started("wait", "more", stdout=subprocess.PIPE) as process:
            process.stdout.readline()
            process.send_signal(number)
            process.stdout.readline()
            process.send_signal(number)
            check(process.wait() == -number, f"the second signal {number} ends the probe at once")
    # nohup and background jobs: who is told to ignore Ctrl-C goes on ignoring it
    ignore = lambda: signal.signal(signal.SIGINT, signal.SIG_IGN)
    with started("wait", stdout=subprocess.PIPE, preexec_fn=ignore) as process:
        process.stdout.readline()
        process.send_signal(signal.SIGINT)
        time.sleep(0.3)
        check(process.poll() is None, "an ignored signal stays ignored")
        process.send_signal(signal.SIGTERM)
        check(process.wait() == 130, "the other one ends it")


def on_terminal(*words):
    """Run with standard error on a terminal; all that the terminal got."""
    master, slave = pty.openpty()
    process = started(*words, stderr=slave, stdout=subprocess.DEVNULL)
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


def test_progress():
    check(run("progress", "2").stderr == b"", "nothing where standard error is no terminal")
    if not available():
        checks.left_out('there are no pseudo-terminals here')
        return
    got = on_terminal("progress", "3")
    lines = got.split("\r")
    shown = [line for line in lines if "left" in line]
    check(len(shown) >= 3, "a long run shows progress", got)
    check(all(len(line) <= 79 for line in lines), "within 80 columns")
    check(all(line.startswith("probe ") for line in shown), "with its label")
    # the echo of Ctrl-C then stands over the line, and goes with it
    check(all(after == "" for line, after in zip(lines, lines[1:]) if "left" in line), "the cursor waits at its beginning", got)
    # from the first line, after a second, the third of the work is done
    check(shown and 33 <= int(shown[0].split()[1]) < 80, "not before a second has passed", shown[:1])
    check(lines[-2].strip() == "" and len(lines[-2]) >= len(shown[-1].rstrip()) and lines[-1] == "",
          "erased in the end", lines[-2:])
    check("\n" not in got, "on one line")
    check(on_terminal("progress", "3", "quiet") == "", "nothing from a quiet run")
    check(on_terminal("progress", "0") == "", "nothing from a short run")


def test_table():
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "a b.dat")
        done = run("table", path, "20000")
        check(done.returncode == 0 and done.stdout == b"", "a table in a file")
        with open(path, encoding="utf-8") as file:
            in_file = file.read()
        names, rows = rows_of(in_file)
        check(names == [f"q{i}" for i in range(1, 21)], "names")
        check(rows == [[i] + [1 / i] * 19 for i in range(1, 20001)], "numbers, bit for bit")
        done = run("table", "-", "20000")
        check(done.stdout.decode() == in_file, "the same on standard output")
        test_killed(os.path.join(folder, "killed.dat"))
        test_named_pipe(os.path.join(folder, "pipe"))
    with open("/dev/full", "w") as full:
        done = subprocess.run([probe, "table", "-", "3"], stdout=full, stderr=subprocess.PIPE, timeout=60)
    check(done.returncode == 8 and b"standard output" in done.stderr, "standard output is full", done)
    # a reader that goes away
    with started("table", "-", "200000", stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdout.read(1000)
        process.stdout.close()
        said = process.stderr.read()
        check(process.wait() == 8, "a broken pipe is an error of writing", process.returncode)
        check(b"Backtrace" not in said and said.count(b"\n") == 1, "one line of message", said)


def test_killed(path):
    """A run that is killed leaves whole rows, and all but those of the last moment. The system may break
    off the very write that it was at, so that what follows the last line end does not count."""
    with started("table", path, "100000000") as process:
        while not os.path.exists(path) or os.path.getsize(path) < 5000000:
            time.sleep(0.01)
        process.kill()
    with open(path, encoding="utf-8") as file:
        text = file.read()
    check(len(text) >= 5000000, "what was there stays")
    text = text[:text.rindex("\n") + 1]
    _, rows = rows_of(text)
    check([row[0] for row in rows] == list(range(1, len(rows) + 1)), "no row is missing")
    check(all(len(row) == 20 for row in rows), "no row is torn")


def test_named_pipe(path):
    """As gnuplot reads one: opening waits for the reader."""
    os.mkfifo(path)
    with started("table", path, "1000") as process:
        with open(path, encoding="utf-8") as file:
            _, rows = rows_of(file.read())
        check(process.wait() == 0 and len(rows) == 1000, "a table through a named pipe")


test_exit()
test_signals()
test_progress()
test_table()
checks.finish()
