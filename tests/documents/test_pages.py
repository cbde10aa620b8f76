"""Manual pages and completions of bash say what the programs themselves say, and work."""
import os
import re
import subprocess

import pytest

from mech9_cases import PATIENCE, run
from pseudo_terminal import Terminal, needs_terminal

BOTH = pytest.mark.parametrize('name', ('mech9k', 'mech9d'))


@pytest.fixture
def pages(build):
    return os.path.join(build.folder, 'pages')


@pytest.fixture
def folder(tmp_path):
    """A folder with files whose names can be completed."""
    for file in ('mine.nml', 'a b.nml', 'old.dat'):
        (tmp_path / file).touch()
    (tmp_path / 'sub').mkdir()
    return tmp_path


def options_of(program):
    """The options in the help, each with what follows it."""
    return dict(re.findall(r'^  (--[a-z0-9-]+)(.*)$', run(program, '--help').stdout, re.M))


def data_names(program):
    """GROUP.NAME of the whole data file, as the help tells them."""
    groups = re.findall(r'^  &(\w+)', run(program, '--help-data').stdout, re.M)
    names = []
    for group in groups:
        text = run(program, '--help-data', group).stdout
        names += [f'{group}.{name}' for name in re.findall(r'^  (\w+) = ', text, re.M)]
    return groups, sorted(set(names))


@BOTH
def test_manual(checks, build, pages, name):
    page, program = os.path.join(pages, f'{name}.1'), build.program(name)
    if not checks.has('groff', 'groff-base'):
        return
    done = subprocess.run(['groff', '-man', '-Tutf8', '-ww', '-rLL=200n', '-P-c', page], capture_output=True,
                          timeout=60 * PATIENCE)
    text = re.sub('.\b', '', done.stdout.decode())
    checks.true(done.returncode == 0 and not done.stderr, f'{name}.1 is set without a warning', done.stderr.decode())
    for option, rest in options_of(program).items():
        words = re.sub(r'\s+', ' ', re.split(r'\s{2,}', rest.strip(), maxsplit=1)[-1])
        checks.true(option in text and words in re.sub(r'\s+', ' ', text), f'{name}.1 explains {option}', words)
    groups, names = data_names(program)
    checks.true(len(groups) > 10 and len(names) > 40, 'the groups and names were found')
    for group in groups:
        checks.true(f'&{group}' in text, f'{name}.1 has the group {group}')
    for item in names:
        checks.true(re.search(rf'^ +{item.split(".")[1]}\b.* = ', text, re.M), f'{name}.1 has the name {item}')
    for section in ('NAME', 'SYNOPSIS', 'DESCRIPTION', 'OPTIONS', 'CONVERSATION', 'DATA FILE', 'EXAMPLES', 'ENVIRONMENT', 'EXIT STATUS'):
        checks.true(re.search(rf'^{section}$', text, re.M), f'{name}.1 has the section {section}')
    for code in (0, 1, 2, 3, 4, 5, 6, 7, 8, 130):
        checks.true(re.search(rf'^ +{code}\b', text, re.M), f'{name}.1 explains the exit code {code}')


def completed(checks, pages, name, words, folder):
    """The completions offered to bash for the last of the words, which it cut at each `=`."""
    quoted = ' '.join("'" + word.replace("'", "'\\''") + "'" for word in [name, *words])
    script = (f'compopt() {{ :; }}\nsource "{pages}/{name}.bash"\nCOMP_WORDS=({quoted})\n'
              f'COMP_CWORD={len(words)}\n_{name}\nprintf "%s\\n" "${{COMPREPLY[@]}}"\n')
    done = subprocess.run(['bash', '--norc', '--noprofile', '-c', script], cwd=folder, capture_output=True, text=True,
                          timeout=60 * PATIENCE)
    checks.true(done.returncode == 0 and not done.stderr, f'{name} {words}: no error', done.stderr)
    return sorted(word for word in done.stdout.split('\n') if word)


@BOTH
def test_completion(checks, build, pages, folder, name):
    program = build.program(name)
    options = options_of(program)
    groups, names = data_names(program)
    offered = lambda *words: completed(checks, pages, name, words, folder)
    checks.equal(offered('--'), sorted(options), f'{name}: all options')
    checks.equal(offered('--ver'), ['--verbose', '--version'], f'{name}: options that begin so')
    checks.equal(offered('--help-data', ''), sorted(groups + names), f'{name}: groups and names after --help-data')
    checks.equal(offered('--help-data', 'grav'), ['gravity', 'gravity.acceleration'], f'{name}: those that begin so')
    checks.equal(offered('--help-data', '--che'), ['--check'], f'{name}: its argument may be left out')
    checks.equal(offered('--set', ''), [item + '=' for item in names], f'{name}: all names to be set')
    checks.equal(offered('--set', '=', 'time.e'), ['time.end='], f'{name}: also after an equals sign')
    checks.equal(offered('--set', 'load.frame', '='), ['fixed', 'link'], f'{name}: the words that a name takes')
    checks.equal(offered('--set', 'load.frame', '=', 'li'), ['link'], f'{name}: those that begin so')
    checks.equal(offered('--set', 'time.end', '=', ''), [], f'{name}: a number cannot be guessed')
    checks.equal(offered(''), ['a b.nml', 'mine.nml', 'sub'], f'{name}: data files and folders')
    checks.equal(offered('mine.nml', '--table', ''), ['a b.nml', 'mine.nml', 'old.dat', 'sub'], f'{name}: any file for the table')
    checks.equal(offered('mine.nml', '--table', '=', 'o'), ['old.dat'], f'{name}: also after an equals sign')


@needs_terminal
def test_in_bash(checks, pages, folder):
    """Tab, pressed in a shell."""
    with Terminal(['bash', '--norc', '--noprofile', '-i'], folder=folder, INPUTRC='/dev/null', PS1='ready> ') as shell:
        shell.expect('ready> ')
        shell.type(f'source "{pages}/mech9k.bash"; true\r')
        shell.expect('ready> ')
        shell.type('mech9k --verb\t')
        checks.true(shell.expect('--verbose '), 'an option is completed', shell.seen)
        shell.type('--set solver.me\t')
        checks.true(shell.expect('solver.method='), 'a name is completed', shell.seen)
        shell.type('ad\t')
        checks.true(shell.expect('adams '), 'its word, with no blank between', shell.seen)
        shell.type('a\t')
        checks.true(shell.expect('a\\ b.nml '), 'a file with a blank in its name', shell.seen)
        shell.type('\x15exit\r')
        shell.ends()
