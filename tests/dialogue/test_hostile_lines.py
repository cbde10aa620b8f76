"""Ten thousand random and hostile lines at the prompts of the conversation: no crash, no hang, a known exit code.

The lines come from a generator with a fixed seed: answers that could be right, answers that are nearly right,
and bytes that are no answers at all. Some sessions begin with nothing, so that they hang about the first
questions; some open an example and so reach the end of the conversation, runs, and what comes after them.
"""
import os
import random
import shutil
import subprocess
import tempfile

import pytest

from mech9_cases import PATIENCE, TREE
from pseudo_terminal import Terminal, needs_terminal, random_keys

LINES, PER_SESSION, MOST_SESSIONS = 10000, 500, 300
BLOCK = 4096     # bytes that the program may have taken from its input without having asked for them
ALLOWED = {0, 2, 3, 4, 5, 6, 7, 8, 130}
TROUBLE = ('Backtrace', 'backtrace', 'Fortran runtime error', 'SIGSEGV', 'Sanitizer', 'runtime error:', 'signal')
# no number is so large that a run with it would take long, or fill the disk
NUMBERS = ['0', '1', '2', '3', '5', '7', '12', '-1', '0.5', '2.0', '-0.25', '1e-3', '1d0', '.5', '30', '1e-300', '-0', '+2',
           '0x10', '1e', '1.2.3', '1,5', '1e999', '-1e999', 'nan', 'inf', '99999999999999999999', '1*2', '3*0', '١']
WORDS = ['', '', '', '', '?', 'back', 'list', 'help', 'default', 'yes', 'no', 'go', 'pairs', 'matrix', 'vectors', 'revolute',
         'prismatic', 'helical', 'user', 'polynomial', 'harmonic', 'table', 'force', 'spring', 'deg', 'rad', 'add', 'add pair',
         'add point', 'add load', 'remove', 'remove 3', 'remove pair 2', 'remove time', 'save', 'run', 'both', 'neither',
         'time end', 'pair 2 axis', 'point 1', 'show', 'show 3', 'plot', 'plot q1', 'compare', 'change 4', 'y', 'n', 'P', 'A']
HOSTILE = [b'\0', b'a\0b', b'\xff\xfe\xfd', b'\xc3(', b'\xed\xa0\x80', b'\x1b[2J\x1b]0;x\x07', b'\r\r\r', b'\t \t', b"'", b'"', b"''",
           b"'a", b'/', b'/ &pair', b"1 /\n&pair coordinate=9", b'&', b'!', b'! a comment', b'$(ls)', b'`ls`', b'%s%n%d', b';', b'|',
           b'\\', b'..', b'../x', b'/dev/full', b'/nowhere/file.nml', b'a/b/c', b'.', b'-', b'--help', b'a' * 300, b'1 ' * 3000,
           b'1,' * 5000, b'(' * 2000, b'9' * 400, b'x' * 100000, 'ąęłżź 機構 🦀'.encode(), '\u202e\u0000'.encode(), b'c(1,:)=0,5',
           b'pair(3).axis=1,0,0', b'time.end=', b'time end = 2', b'= 3', b'==', b'0 = 0']


def line_of(chance):
    """One line."""
    kind = chance.random()
    if kind < 0.35:
        return chance.choice(WORDS).encode()
    if kind < 0.65:
        return chance.choice((' ', ', ', ',')).join(chance.choice(NUMBERS) for _ in range(chance.choice((1, 1, 2, 3, 3, 6, 9)))).encode()
    if kind < 0.85:
        return chance.choice(HOSTILE)
    return bytes(chance.choice([byte for byte in range(256) if byte != 10]) for _ in range(chance.randrange(40)))


def session(checks, program, words, folder, lines):
    """One conversation. It may end before all lines are read; gives how many it certainly read."""
    data = b'\n'.join(lines) + b'\n'
    with tempfile.TemporaryFile() as answers:
        answers.write(data)
        answers.seek(0)
        try:
            done = subprocess.run([program, *words], stdin=answers, capture_output=True, cwd=folder, timeout=60 * PATIENCE)
        except subprocess.TimeoutExpired:
            checks.true(False, f'{words}: ends')
            return len(lines)
        at = os.lseek(answers.fileno(), 0, os.SEEK_CUR)
    said = (done.stdout + done.stderr).decode('utf-8', 'replace')
    checks.true(done.returncode in ALLOWED, f'{words}: a known exit code', f'it was {done.returncode}\n{said[-2000:]}')
    checks.true(not any(word in said for word in TROUBLE), f'{words}: no crash', said[-2000:])
    checks.true('\0' not in said and '\x1b' not in said, f'{words}: nothing is echoed that would rule a terminal',
                repr(said[-2000:]))
    return len(lines) if at >= len(data) else data[:max(at - BLOCK, 0)].count(b'\n')


def test_hostile_lines(checks, mech9k, mech9d, tmp_path):
    programs, chance = [mech9k, mech9d], random.Random(20240229)
    starts = [[], ['--edit', 'fig1.nml'], ['--dialogue'], ['--edit', 'pendulum.nml']]
    read = sessions = 0
    for name in ('fig1', 'pendulum'):
        shutil.copy(os.path.join(TREE, 'examples', name, f'{name}.nml'), tmp_path)
    while read < LINES and sessions < MOST_SESSIONS:
        work = tmp_path / str(sessions)
        work.mkdir()
        words = [os.path.join('..', word) if word.endswith('.nml') else word for word in starts[sessions % len(starts)]]
        read += session(checks, programs[sessions // 2 % 2], words, work, [line_of(chance) for _ in range(PER_SESSION)])
        sessions += 1
    checks.true(read >= LINES, f'{LINES} lines were read', f'{read} in {sessions} sessions')


@needs_terminal
@pytest.mark.parametrize('name', ('mech9k', 'mech9d'))
def test_hostile_keys(checks, build, tmp_path, name):
    """The same at a terminal, key by key; Ctrl-C ends it, or the conversation has come to an end by itself."""
    chance = random.Random(20240229)
    with Terminal([build.program(name)], folder=tmp_path, patience=10 * PATIENCE) as terminal:
        terminal.expect('title')
        terminal.type(random_keys(chance, 2000))
        terminal.type('\r\x03')
        checks.true(terminal.ends() in ALLOWED, 'random keys: a known exit code', f'{terminal.process.returncode}\n{terminal.seen[-2000:]}')
        checks.true(not any(word in terminal.seen for word in TROUBLE), 'random keys: no crash', terminal.seen[-2000:])
