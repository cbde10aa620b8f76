"""Lines asked for at prompts, on a pseudo-terminal and in a pipe: editing, history, completion, ends and interrupts.
The program is that of prompt_probe.f90."""
import random
import signal
import subprocess
import time

import pytest

from mech9_cases import PATIENCE
from pseudo_terminal import Terminal, needs_terminal, random_keys

LEFT, UP, DOWN, DELETE, HOME = '\x1b[D', '\x1b[A', '\x1b[B', '\x1b[3~', '\x01'


@pytest.fixture
def probe(build):
    return build.program('prompt_probe')


@pytest.fixture
def edits(build):
    """Tests that take it are left out where the programs are built without libedit."""
    settings = build.settings
    if settings.get('MECH9_LINE_EDITING') != 'ON' or settings.get('MECH9_LIBEDIT', 'NOTFOUND').endswith('NOTFOUND'):
        pytest.skip('the programs are built without libedit, so that lines cannot be edited')


def answers(output):
    """The lines that the probe got, as bytes, and how it ended."""
    words = output.decode().split('\n')[:-1]
    return [bytes.fromhex(word) for word in words[:-1]], words[-1]


MILLION = bytes(33 + i % 90 for i in range(1000000))
# bytes that are sent through a pipe, and the lines that the program gets
PIPED = {'two lines': (b'one\ntwo\n', [b'one', b'two']),
         'nothing': (b'', []),
         'lines of another system': (b'one\r\n\r\n', [b'one', b'']),
         'a last line without an end': (b'one\nlast', [b'one', b'last']),
         'bytes that are no text': (b'a\0b\n\xff\xfe\xc3(\n\x1b[A\t\x03\x04\n', [b'a\0b', b'\xff\xfe\xc3(', b'\x1b[A\t\x03\x04']),
         'a line of a million bytes': (MILLION + b'\nnext\n', [MILLION, b'next']),
         'three thousand empty lines': (b'\n' * 3000, [b''] * 3000)}


@pytest.mark.parametrize('why', PIPED)
def test_pipe(checks, probe, why):
    data, expected = PIPED[why]
    done = subprocess.run([probe], input=data, capture_output=True, timeout=60 * PATIENCE)
    checks.equal(done.returncode, 0, f'{why}: exit code')
    got, end = answers(done.stdout)
    checks.true(got == expected, f'{why}: the lines are what was sent', [line[:60] for line in got])
    checks.equal(end, 'ended', f'{why}: ends where the pipe ends')
    prompts = ''.join(f'a word\n{i}> \n' for i in range(1, len(expected) + 2))
    checks.true(done.stderr.decode() == prompts, f'{why}: each prompt once on standard error, no answer echoed',
                done.stderr[:200])


@pytest.mark.parametrize('number', (signal.SIGINT, signal.SIGTERM, signal.SIGHUP), ids=lambda number: number.name)
def test_signals_in_a_pipe(checks, probe, number):
    with subprocess.Popen([probe], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdin.write(b'one\n')
        process.stdin.flush()
        process.stdout.readline()
        process.send_signal(number)
        rest, _ = process.communicate(timeout=60 * PATIENCE)
        hung_up = number == signal.SIGHUP
        checks.equal(rest, b'ended\n' if hung_up else b'interrupted\n', f'signal {number} ends the waiting')
        checks.equal(process.returncode, 0 if hung_up else 130, f'signal {number}: in order')


def dialogue(checks, probe, why, typed, expected, end='ended', leave='\x04', shown=(), **options):
    """Type one line after the other, each when it is asked for."""
    with Terminal([probe], stdout=subprocess.PIPE, **options) as terminal:
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


# keys that are typed, and the lines that the program gets
EDITED = {
    'plain lines': (['abc\r', '\r', 'x\r'], ['abc', '', 'x']),
    'moving and erasing': (['abd' + LEFT + 'c\r', 'abx\x7fc\r', 'xab' + HOME + DELETE + '\r', 'one two\x17three\r'],
                           ['abcd', 'abc', 'ab', 'one three']),
    'killing and recalling a word': (['one two' + HOME + '\x0b\x19\x19\r'], ['one twoone two']),
    'history': (['first\r', 'second\r', UP + UP + '\r', UP + UP + DOWN + '\r', UP + '!\r'],
                ['first', 'second', 'first', 'first', 'first!']),
    'history searched backwards': (['gravity\r', 'other\r', ['\x12', ('gra', 'gravity'), '\r']], ['gravity', 'other', 'gravity']),
    'an unfinished line is not history': (['kept\r', 'lost\x15\r', UP + '\r'], ['kept', '', 'kept']),
    'letters of several bytes': (['Miądowicz é中' + LEFT + '\x7fü\r'], ['Miądowicz ü中']),
    'bytes that are no text': ([b'a\xffb\xc3(\r'], ['a\ufffdb\ufffd(']),
    'a line longer than the screen': (['x' * 3000 + '\r', UP + 'y\r'], ['x' * 3000, 'x' * 3000 + 'y']),
    'a line longer than a terminal takes': (['y' * 30000 + '\r', UP + '\r'], ['y' * 4095, 'y' * 4095]),
    'no command line of the editor': (['\x1bxedit off\r', 'ab' + LEFT + 'c\r'], ['edit off', 'acb'])}


@needs_terminal
@pytest.mark.parametrize('why', EDITED)
def test_editing(checks, probe, edits, why):
    dialogue(checks, probe, why, *EDITED[why])


@needs_terminal
@pytest.mark.parametrize('locale', ('C', 'POSIX', 'no_SUCH'))
def test_letters_of_several_bytes_in_any_locale(checks, probe, edits, locale):
    dialogue(checks, probe, f'LC_ALL={locale}', ['ąé中' + LEFT + '\x7fü\r'], ['ąü中'], LC_ALL=locale)


# keys that are typed, the lines that the program gets, and texts that are shown
COMPLETED = {
    'one word fits': (['rev\t\r', 'a,bac\tc\r'], ['revolute ', 'a,back c'], []),
    'two words fit': ([[('p\t', 'prism'), ('\t', 'prism'), 'atic\r']], ['prismatic'], ['prismatic  prism\n']),
    'all words fit an empty line': ([[('\t', 'back'), '\r']], [''], ['revolute   prismatic  prism      back\n']),
    'no word fits': (['xyz\t\r'], ['xyz'], [])}


@needs_terminal
@pytest.mark.parametrize('why', COMPLETED)
def test_completion(checks, probe, edits, why):
    typed, expected, shown = COMPLETED[why]
    dialogue(checks, probe, why, typed, expected, shown=shown)


@needs_terminal
def test_end_of_input(checks, probe):
    dialogue(checks, probe, 'Ctrl-D', ['abc\r'], ['abc'])


@needs_terminal
def test_interrupt(checks, probe):
    dialogue(checks, probe, 'Ctrl-C', ['abc\r'], ['abc'], end='interrupted', leave='half a line\x03')


@needs_terminal
@pytest.mark.parametrize('number, end, code', ((signal.SIGTERM, 'interrupted', 130), (signal.SIGHUP, 'ended', 0)))
def test_signals_at_a_prompt(checks, probe, number, end, code):
    with Terminal([probe], stdout=subprocess.PIPE) as terminal:
        terminal.expect('1> ')
        terminal.type('half a line')
        terminal.expect('half a line')
        terminal.signal(number)
        checks.equal(terminal.ends(), code, f'signal {number} at a prompt: exit code')
        checks.equal(terminal.process.stdout.read().decode(), end + '\n', f'signal {number} at a prompt')


@needs_terminal
def test_window_that_is_closed(checks, probe):
    with Terminal([probe], stdout=subprocess.PIPE) as terminal:
        terminal.expect('1> ')
        terminal.hang_up()
        checks.equal(terminal.process.stdout.read().decode(), 'ended\n', 'a window that is closed ends the input')
        checks.equal(terminal.ends(), 0, 'and the program in order')


@needs_terminal
@pytest.mark.parametrize('seed', (1995, 1996, 1997))
def test_hostile_keys(checks, probe, edits, seed):
    """Whatever is typed, Ctrl-C still ends it."""
    with Terminal([probe], stdout=subprocess.DEVNULL, patience=10 * PATIENCE) as terminal:
        terminal.expect('1> ')
        terminal.type(random_keys(random.Random(seed), 3000))
        terminal.type(b'\r\r\x03')
        # Ctrl-C that comes between two prompts is a signal, which ends the probe by itself
        end = terminal.ends()
        checks.true(end in (130, -signal.SIGINT), f'three thousand random keys of {seed}: Ctrl-C still ends it', end)
        checks.true('Backtrace' not in terminal.plain() and 'Sanitizer' not in terminal.plain(), 'no crash', terminal.plain()[-2000:])


@needs_terminal
def test_stopped(checks, probe, edits):
    """Stopped by Ctrl-Z and continued, the program shows the line again that was being edited."""
    with Terminal([probe], stdout=subprocess.PIPE) as terminal:
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


@needs_terminal
@pytest.mark.parametrize('term', ('dumb', ''), ids=('dumb', 'none'))
def test_simple_terminal(checks, probe, term):
    """A terminal that cannot move its cursor gets no sequences that would move it."""
    dialogue(checks, probe, f'TERM={term}', ['abc\r', '\r'], ['abc', ''], term=term)
    dialogue(checks, probe, f'TERM={term}: Ctrl-C', ['abc\r'], ['abc'], end='interrupted', leave='\x03', term=term)
    with Terminal([probe], stdout=subprocess.PIPE, term=term) as terminal:
        terminal.expect('1> ')
        terminal.type('abc\r')
        terminal.expect('2> ')
        terminal.type('\x04')
        terminal.ends()
        checks.true('\x1b' not in terminal.seen, f'TERM={term}: no sequences', terminal.seen)
        checks.true(terminal.seen.startswith('a word\r\n1> abc\r\na word\r\n2> '), f'TERM={term}: the answer once', terminal.seen)
