"""Lines asked for at prompts, on a pseudo-terminal and in a pipe: editing, history, completion, ends and interrupts.

usage: line_input.py PROBE yes|no    (the program of prompt_probe.f90; whether it can edit lines)
"""
import os
import random
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from mech9_cases import Checks
from terminal import Terminal, available, random_keys

PROBE, EDITS = sys.argv[1], sys.argv[2] == 'yes'
checks = Checks()


def answers(output):
    """The lines that the probe got, as bytes, and how it ended."""
    words = output.decode().split('\n')[:-1]
    return [bytes.fromhex(word) for word in words[:-1]], words[-1]


def piped(data, why, expected, code=0):
    done = subprocess.run([PROBE], input=data, capture_output=True, timeout=60)
    checks.equal(done.returncode, code, f'{why}: exit code')
    got, end = answers(done.stdout)
    checks.true(got == expected, f'{why}: the lines are what was sent', [line[:60] for line in got])
    checks.equal(end, 'ended', f'{why}: ends where the pipe ends')
    prompts = ''.join(f'a word\n{i}> \n' for i in range(1, len(expected) + 2))
    checks.true(done.stderr.decode() == prompts, f'{why}: each prompt once on standard error, no answer echoed',
                done.stderr[:200])


def test_pipe():
    piped(b'one\ntwo\n', 'two lines', [b'one', b'two'])
    piped(b'', 'nothing', [])
    piped(b'one\r\n\r\n', 'lines of another system', [b'one', b''])
    piped(b'one\nlast', 'a last line without an end', [b'one', b'last'])
    piped(b'a\0b\n\xff\xfe\xc3(\n\x1b[A\t\x03\x04\n', 'bytes that are no text', [b'a\0b', b'\xff\xfe\xc3(', b'\x1b[A\t\x03\x04'])
    million = bytes(33 + i % 90 for i in range(1000000))
    piped(million + b'\nnext\n', 'a line of a million bytes', [million, b'next'])
    piped(b'\n' * 3000, 'three thousand empty lines', [b''] * 3000)


def test_pipe_signals():
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        with subprocess.Popen([PROBE], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
            process.stdin.write(b'one\n')
            process.stdin.flush()
            process.stdout.readline()
            process.send_signal(number)
            rest, _ = process.communicate(timeout=60)
            hung_up = number == signal.SIGHUP
            checks.equal(rest, b'ended\n' if hung_up else b'interrupted\n', f'signal {number} ends the waiting')
            checks.equal(process.returncode, 0 if hung_up else 130, f'signal {number}: in order')


def dialogue(why, typed, expected, end='ended', leave='\x04', shown=(), **options):
    """Type one line after the other, each when it is asked for."""
    with Terminal([PROBE], stdout=subprocess.PIPE, **options) as terminal:
        for number, keys in enumerate(typed, 1):
            checks.true(terminal.expect(f'{number}> '), f'{why}: prompt {number} is shown', terminal.seen)
            for part in keys if isinstance(keys, list) else [keys]:
                terminal.type(part[0] if isinstance(part, tuple) else part)
                if isinstance(part, tuple):
                    checks.true(terminal.expect(part[1]), f'{why}: shows {part[1]!r}', terminal.seen)
        terminal.expect(f'{len(typed) + 1}> ')
        terminal.type(leave)
        code = terminal.ends()
        got, last = answers(terminal.process.stdout.read())
        checks.equal(code, 130 if end == 'interrupted' else 0, f'{why}: exit code')
        checks.equal(last, end, f'{why}: how it ends')
        checks.equal(got, [line.encode() if isinstance(line, str) else line for line in expected], f'{why}: the lines')
        for text in shown:
            checks.true(text in terminal.plain(), f'{why}: shows {text!r}', terminal.seen)


def test_editing():
    left, up, down, delete, home = '\x1b[D', '\x1b[A', '\x1b[B', '\x1b[3~', '\x01'
    dialogue('plain lines', ['abc\r', '\r', 'x\r'], ['abc', '', 'x'])
    dialogue('moving and erasing', ['abd' + left + 'c\r', 'abx\x7fc\r', 'xab' + home + delete + '\r', 'one two\x17three\r'],
             ['abcd', 'abc', 'ab', 'one three'])
    dialogue('killing and recalling a word', ['one two' + home + '\x0b\x19\x19\r'], ['one twoone two'])
    dialogue('history', ['first\r', 'second\r', up + up + '\r', up + up + down + '\r', up + '!\r'],
             ['first', 'second', 'first', 'first', 'first!'])
    dialogue('history searched backwards', ['gravity\r', 'other\r', ['\x12', ('gra', 'gravity'), '\r']],
             ['gravity', 'other', 'gravity'])
    dialogue('an unfinished line is not history', ['kept\r', 'lost\x15\r', up + '\r'], ['kept', '', 'kept'])
    dialogue('letters of several bytes', ['Miądowicz é中' + left + '\x7fü\r'], ['Miądowicz ü中'])
    dialogue('bytes that are no text', [b'a\xffb\xc3(\r'], ['a\ufffdb\ufffd('])
    dialogue('a line longer than the screen', ['x' * 3000 + '\r', up + 'y\r'], ['x' * 3000, 'x' * 3000 + 'y'])
    dialogue('a line longer than a terminal takes', ['y' * 30000 + '\r', up + '\r'], ['y' * 4095, 'y' * 4095])
    for locale in ('C', 'POSIX', 'no_SUCH'):
        dialogue(f'letters of several bytes, LC_ALL={locale}', ['ąé中' + left + '\x7fü\r'], ['ąü中'], LC_ALL=locale)
    dialogue('no command line of the editor', ['\x1bxedit off\r', 'ab' + left + 'c\r'], ['edit off', 'acb'])


def test_completion():
    dialogue('one word fits', ['rev\t\r', 'a,bac\tc\r'], ['revolute ', 'a,back c'])
    dialogue('two words fit', [[('p\t', 'prism'), ('\t', 'prism'), 'atic\r']], ['prismatic'], shown=['prismatic  prism\n'])
    dialogue('all words fit an empty line', [[('\t', 'back'), '\r']], [''], shown=['revolute   prismatic  prism      back\n'])
    dialogue('no word fits', ['xyz\t\r'], ['xyz'])


def test_ends():
    dialogue('Ctrl-D', ['abc\r'], ['abc'])
    dialogue('Ctrl-C', ['abc\r'], ['abc'], end='interrupted', leave='half a line\x03')
    for number, end, code in ((signal.SIGTERM, 'interrupted', 130), (signal.SIGHUP, 'ended', 0)):
        with Terminal([PROBE], stdout=subprocess.PIPE) as terminal:
            terminal.expect('1> ')
            terminal.type('half a line')
            terminal.expect('half a line')
            terminal.signal(number)
            checks.equal(terminal.ends(), code, f'signal {number} at a prompt: exit code')
            checks.equal(terminal.process.stdout.read().decode(), end + '\n', f'signal {number} at a prompt')
    with Terminal([PROBE], stdout=subprocess.PIPE) as terminal:
        terminal.expect('1> ')
        terminal.hang_up()
        checks.equal(terminal.process.stdout.read().decode(), 'ended\n', 'a window that is closed ends the input')
        checks.equal(terminal.ends(), 0, 'and the program in order')


def test_hostile_keys():
    """Whatever is typed, Ctrl-C still ends it."""
    chance = random.Random(1995)
    for session in range(3):
        with Terminal([PROBE], stdout=subprocess.DEVNULL, patience=60) as terminal:
            terminal.expect('1> ')
            terminal.type(random_keys(chance, 3000))
            terminal.type(b'\r\r\x03')
            # Ctrl-C that comes between two prompts is a signal, which ends the probe by itself
            end = terminal.ends()
            checks.true(end in (130, -signal.SIGINT), f'three thousand random keys, {session}: Ctrl-C still ends it', end)
            checks.true('Backtrace' not in terminal.plain() and 'Sanitizer' not in terminal.plain(), 'no crash', terminal.plain()[-2000:])


def test_stopped():
    """Stopped by Ctrl-Z and continued, the program shows the line again that was being edited."""
    with Terminal([PROBE], stdout=subprocess.PIPE) as terminal:
        terminal.expect('1> ')
        terminal.type('abd')
        terminal.expect('abd')
        time.sleep(0.5)          # until it waits for the next key, as it does when a person stops it
        terminal.signal(signal.SIGCONT)
        checks.true(terminal.expect('1> abd'), 'the prompt and the line are shown again', terminal.seen)
        terminal.type('\x7fc\r')
        terminal.expect('2> ')
        terminal.type('\x04')
        checks.equal(terminal.ends(), 0, 'and it goes on')
        checks.equal(answers(terminal.process.stdout.read()), ([b'abc'], 'ended'), 'with the line as it was')


def test_simple_terminal():
    """A terminal that cannot move its cursor gets no sequences that would move it."""
    for term in ('dumb', ''):
        dialogue(f'TERM={term}', ['abc\r', '\r'], ['abc', ''], term=term)
        dialogue(f'TERM={term}: Ctrl-C', ['abc\r'], ['abc'], end='interrupted', leave='\x03', term=term)
        with Terminal([PROBE], stdout=subprocess.PIPE, term=term) as terminal:
            terminal.expect('1> ')
            terminal.type('abc\r')
            terminal.expect('2> ')
            terminal.type('\x04')
            terminal.ends()
            checks.true('\x1b' not in terminal.seen, f'TERM={term}: no sequences', terminal.seen)
            checks.true(terminal.seen.startswith('a word\r\n1> abc\r\na word\r\n2> '), f'TERM={term}: the answer once', terminal.seen)


test_pipe()
test_pipe_signals()
if available():
    if EDITS:
        test_editing()
        test_completion()
        test_hostile_keys()
        test_stopped()
    else:
        checks.left_out('the programs are built without libedit, so that lines cannot be edited')
    test_ends()
    test_simple_terminal()
else:
    checks.left_out('there are no pseudo-terminals here')
checks.finish()
