"""The commands that documents show, run as they stand; their links, and the places in the code that they name.

Blocks between ``` sh: commands that must succeed. Blocks between ``` console: commands after '$ ', each followed by what
it says; '...' stands for anything within a line, or for any lines where it stands alone. The commands run in a scratch copy of
the tree, one block after the other in the folder where the one before left off, with the programs on PATH and in
build/release/bin. Above a block may stand
    <!-- not run: why -->
"""
import os
import re
import shutil
import subprocess

from mech9_cases import PATIENCE, TREE, text_of

BLOCK = re.compile(r'^(?P<not_run><!-- not run: [^\n]* -->\n)?'
                   r'(?P<indent> *)```(?P<kind>\w*)\n(?P<text>.*?)^ *```$', re.M | re.S)
LINK = re.compile(r'\[[^\]]*\]\((?!https?:)([^)#\s]*)(#[^)\s]*)?\)')
PLACE = re.compile(r'`((?:src|tests|user_procs|cmake|examples|docs|bench)/[\w/.-]+)`(?:: ((?:`\w+`(?:, )?)+))?')
# no command needs the sources of programs and unit tests, most of the files
COPIED = ('cmake', 'docs', 'examples', 'user_procs', 'tests/scripts')


def blocks_of(text):
    """Kind and text of each block that is to be run."""
    for found in BLOCK.finditer(text):
        if found.group('kind') in ('sh', 'console') and not found.group('not_run'):
            indent = len(found.group('indent'))
            yield found.group('kind'), ''.join(line[indent:] for line in found.group('text').splitlines(True))


def scratch_copy(folder, binaries):
    """The tree in another folder, with the programs in its build folder."""
    for name in COPIED:
        shutil.copytree(os.path.join(TREE, name), os.path.join(folder, name),
                        ignore=shutil.ignore_patterns('__pycache__', 'malformed'))
    for name in os.listdir(TREE):
        if os.path.isfile(os.path.join(TREE, name)):
            shutil.copy2(os.path.join(TREE, name), folder)
    os.makedirs(os.path.join(folder, 'build', 'release'))
    os.symlink(binaries, os.path.join(folder, 'build', 'release', 'bin'))


class Shell:
    """Runs pieces of shell text, each in the folder where the one before left off, with its exit code in $?."""

    def __init__(self, folder, binaries):
        self.where, self.answer = folder, 0
        self.note = os.path.join(folder, 'build', 'where')
        self.environment = dict(os.environ, PATH=binaries + os.pathsep + os.environ['PATH'], MECH9_BIN=binaries, LC_ALL='C')

    def run(self, text, before=''):
        before = before or f'(exit {self.answer})'      # sets $?
        script = f'trap \'pwd >"{self.note}"\' EXIT\n{before}\n{text}'
        done = subprocess.run(['bash', '-c', script], cwd=self.where, env=self.environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors='replace', timeout=200 * PATIENCE)
        with open(self.note, encoding='utf-8') as file:
            self.where = file.read().rstrip('\n')
        self.answer = done.returncode
        return done


def pattern_of(line):
    """A line as shown: '...' for anything, and long numbers but for their last digits, in which builds may differ."""
    parts = re.split(r'(\.\.\.|\d+\.\d{9,})', line.rstrip())
    return ''.join('.*' if part == '...' else re.escape(part) if i % 2 == 0 else re.escape(part[:-4]) + r'\d*'
                   for i, part in enumerate(parts))


def matches(shown, said):
    """Whether what was said is what the document shows."""
    pattern = ''.join('(?:.*\n)*?' if line.strip() == '...' else pattern_of(line) + ' *\n' for line in shown.splitlines())
    return re.fullmatch(pattern, said if said.endswith('\n') or not said else said + '\n')


def run_blocks(checks, shell, text):
    """The commands of a text succeed, or say what it shows."""
    for kind, block in blocks_of(text):
        if kind == 'sh':
            done = shell.run(block, 'set -e -o pipefail')
            checks.equal(done.returncode, 0, f'these commands succeed:\n{block}\n{done.stdout[-2000:]}')
            continue
        for part in re.split(r'^\$ ', block, flags=re.M)[1:]:
            command, _, shown = part.partition('\n')
            done = shell.run(command)
            checks.true(matches(shown, done.stdout), f'as shown: {command}', f'shown:\n{shown}\nsaid:\n{done.stdout}')


def anchor(heading):
    """A heading as GitHub links to it."""
    return re.sub(r'[^\w\- ]', '', heading.strip().lower()).replace(' ', '-')


def check_document(checks, document):
    """The title of a document, its links, and the places in the code that it names."""
    path = os.path.join(TREE, document)
    text = text_of(path)
    checks.true(text.startswith('# '), f'{document} begins with its title')
    check_links(checks, path, text)
    check_places(checks, text)


def check_commands(checks, documents, folder, binaries):
    """The commands of some documents, one after the other in one copy of the tree."""
    scratch_copy(folder, binaries)
    for document in documents:
        run_blocks(checks, Shell(folder, binaries), text_of(os.path.join(TREE, document)))


def check_links(checks, path, text):
    """Links lead to files and headings that are there."""
    text = re.sub(r'```.*?```', '', text, flags=re.S)
    for target, part in LINK.findall(text) + [(source, '') for source in re.findall(r'<img src="([^"]+)"', text)]:
        there = os.path.normpath(os.path.join(os.path.dirname(path), target)) if target else path
        if checks.true(os.path.exists(there), f'the link {target} leads to something') and part and there.endswith('.md'):
            headings = [anchor(line.lstrip('#')) for line in text_of(there).splitlines() if line.startswith('#')]
            checks.true(part[1:] in headings, f'the link {target}{part} leads to a heading', headings)


def check_places(checks, text):
    """Files that the text names are there and hold the names that it gives them."""
    for place, names in PLACE.findall(text):
        path = os.path.join(TREE, place.rstrip('/'))
        if '*' in place or place == 'docs/build-api' or not checks.true(os.path.exists(path), f'{place} is there'):
            continue
        for name in re.findall(r'\w+', names):
            checks.true(re.search(rf'\b{name}\b', text_of(path)), f'{place} holds {name}')
