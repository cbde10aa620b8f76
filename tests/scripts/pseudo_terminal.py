"""A program on a pseudo-terminal: what it shows, and what is typed.

Where the system has no pseudo-terminals, `available` is false, and tests that are marked by `needs_terminal` are skipped.
"""
import fcntl
import os
import pty
import re
import select
import struct
import subprocess
import termios
import time

import pytest

from mech9_cases import PATIENCE


def available():
    try:
        master, slave = pty.openpty()
    except OSError:
        return False
    os.close(master)
    os.close(slave)
    return True


needs_terminal = pytest.mark.skipif(not available(), reason='there are no pseudo-terminals here')


def random_keys(chance, count):
    """Keys, of which some are likely ones and the rest any byte, but for those that stop the terminal itself, and
    Ctrl-C and Ctrl-D, which end."""
    kept = [byte for byte in range(256) if byte not in b'\x03\x04\x11\x13\x1a\x1c']
    likely = [b'\x1b[A', b'\x1b[B', b'\x1b[D', b'\x1b[3~', b'\t', b'\r', b'\x12', b'\x16', b'\x1b', 'é中'.encode(), b'p', b'\x7f',
              b'\x19']
    return b''.join(chance.choice(likely) if chance.random() < 0.4 else bytes([chance.choice(kept)]) for _ in range(count))


class Terminal:
    """A program that has a terminal of 80 x 24 as its controlling one. `seen` is all that was shown."""

    def __init__(self, words, folder=None, term='xterm', patience=5 * PATIENCE, stdout=None, **environment):
        self.patience = patience
        self.seen = ''
        self.place = 0        # up to where `expect` has looked
        self.master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack('HHHH', 24, 80, 0, 0))
        variables = {**os.environ, 'TERM': term, 'LC_ALL': 'C.UTF-8', **environment}
        self.process = subprocess.Popen(
            [os.fspath(word) for word in words], cwd=folder, env=variables, stdin=slave, stderr=slave,
            stdout=slave if stdout is None else stdout, start_new_session=True,
            preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0))
        os.close(slave)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        self.hang_up()

    def hang_up(self):
        """Close the terminal, as a window that is closed."""
        if self.master >= 0:
            os.close(self.master)
        self.master = -1

    def read(self, seconds):
        """Take what is shown within a time; whether anything was."""
        if self.master < 0 or not select.select([self.master], [], [], seconds)[0]:
            return False
        try:
            piece = os.read(self.master, 65536)
        except OSError:           # Linux: the other side is closed
            return False
        self.seen += piece.decode('utf-8', 'replace')
        return bool(piece)

    def expect(self, text):
        """Wait until a text is shown behind what was expected before; whether it was in time."""
        end = time.monotonic() + self.patience
        while True:
            found = self.seen.find(text, self.place)
            if found >= 0:
                self.place = found + len(text)
                return True
            if time.monotonic() > end or (not self.read(0.1) and self.process.poll() is not None and not self.read(0.1)):
                return text in self.seen[self.place:]

    def type(self, text):
        """Type; while the program does not read, its output is taken, so that neither waits for the other."""
        data = text if isinstance(text, bytes) else text.encode()
        end = time.monotonic() + self.patience
        while data and time.monotonic() < end:
            readable, writable, _ = select.select([self.master], [self.master], [], 1.0)
            if readable:
                self.read(0)
            if writable:
                data = data[os.write(self.master, data[:256]):]

    def ends(self):
        """The exit code, negative for a signal; None where it does not end."""
        end = time.monotonic() + self.patience
        while self.process.poll() is None and time.monotonic() < end:
            self.read(0.05)
        while self.read(0.05):
            pass
        return self.process.poll()

    def signal(self, number):
        self.process.send_signal(number)

    def plain(self):
        """All that was shown, without the sequences that move the cursor or colour."""
        return re.sub(r'\x1b(\[[0-9;?]*[A-Za-z]|[()].|[=>])', '', self.seen).replace('\r', '')
