"""Nothing that is read is written over, and no result by another, by whatever name: the run ends with code 2 before
a file is touched."""
import os
import subprocess
import tempfile

import pytest

from mech9_cases import PATIENCE, REFERENCE, text_of

FIG1 = text_of(os.path.join(REFERENCE, 'kinematics_fig1.nml')).replace("table='kinematics_fig1.dat'", '')
DRIVEN = FIG1.replace("kind='polynomial', coefficients=0.5, 6.0", "kind='table', file='motion.txt'")
MOTION = ''.join(f'{i / 4} {0.5 + i}\n' for i in range(5))
DONE, USAGE = 0, 2


class Folder:
    """A fresh folder with a data file, in which one command line is tried."""

    def __init__(self, checks, program, name='mine.nml', text=FIG1):
        self.checks, self.program, self.name = checks, program, name
        self.folder = tempfile.TemporaryDirectory()
        self.write(name, text)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, text):
        with open(self.path(name), 'w', encoding='utf-8') as file:
            file.write(text)

    def contents(self):
        """All files and links with what stands in them."""
        found = {}
        for name in sorted(os.listdir(self.folder.name)):
            path = self.path(name)
            if os.path.islink(path):
                found[name] = os.readlink(path)
                continue
            with open(path, 'rb') as file:
                found[name] = file.read()
        return found

    def run(self, *words, **how):
        how = {'stdout': subprocess.PIPE, **how}
        return subprocess.run([self.program, *words], cwd=self.folder.name, stderr=subprocess.PIPE, text=True, timeout=60 * PATIENCE, **how)

    def refuses(self, why, *words, names=(), **how):
        """The command line is refused, both names are told, and nothing has changed."""
        before = self.contents()
        done = self.run(*words, **how)
        self.checks.equal(done.returncode, USAGE, f'{why}: refused; {done.stderr}')
        for name in names:
            self.checks.true(f"'{name}'" in done.stderr, f'{why}: {name} is named', done.stderr)
        self.checks.true(self.contents() == before, f'{why}: nothing is touched', sorted(self.contents()))

    def does(self, why, *words, **how):
        done = self.run(*words, **how)
        self.checks.equal(done.returncode, DONE, f'{why}: done; {done.stderr}')


def test_data_file_is_not_written_over(checks, mech9k):
    """The data file, by its other names."""
    folder = Folder(checks, mech9k)
    os.link(folder.path('mine.nml'), folder.path('hard.dat'))
    os.symlink('mine.nml', folder.path('soft.dat'))
    for option in ('--table', '--hdf5', '--report'):
        for name in ('mine.nml', './mine.nml', 'hard.dat', 'soft.dat'):
            folder.refuses(f'{option} over the data file', 'mine.nml', option, name, names=('mine.nml', name))


def test_data_file_that_is_open(checks, mech9k):
    folder = Folder(checks, mech9k)
    with open(folder.path('mine.nml'), 'r+', encoding='utf-8') as file:
        name = f'/dev/fd/{file.fileno()}'
        folder.refuses('an open file', 'mine.nml', '--table', name, names=('mine.nml', name), pass_fds=(file.fileno(),))
        folder.refuses('standard input', 'mine.nml', '--table', '/dev/stdin', stdin=file)
        folder.refuses('data by standard input', '/dev/stdin', '--table', 'mine.nml', stdin=file)


def test_answers_behind_the_data(checks, mech9k):
    folder = Folder(checks, mech9k)
    with open(folder.path('mine.nml'), 'a', encoding='utf-8') as file:
        folder.refuses('a table behind the data', 'mine.nml', names=('mine.nml',), stdout=file)
        folder.refuses('an answer behind the data', 'mine.nml', '--check', names=('mine.nml',), stdout=file)
        folder.does('nothing on standard output', 'mine.nml', '--table', 'a.dat', stdout=file)


@pytest.mark.parametrize('name, words', (('a.gp', ('--plot', 'a.svg:q1')), ('a.dot', ('--graph', 'a.svg')),
                        ('a.xdmf', ('--hdf5', 'a.h5', '--set', 'output.poses=T')), ('a.svg', ('--plot', 'q1')),
                        ('a.svg', ('--sketch', 'a.svg', '--check')), ('a.html', ('--animate', 'a.html'))))
def test_files_beside_a_result(checks, mech9k, name, words):
    """A picture has its script beside it, an HDF5 file its XDMF file."""
    Folder(checks, mech9k, name).refuses(f'{words} over {name}', name, *words, names=(name,))


def test_file_of_a_drive(checks, mech9k):
    """The file of a drive, also where nothing else can be read or is run."""
    folder = Folder(checks, mech9k, text=DRIVEN)
    folder.write('motion.txt', MOTION)
    os.link(folder.path('motion.txt'), folder.path('hard.txt'))
    folder.does('a drive from a table', 'mine.nml', '--no-write')
    for words in (('--table', 'motion.txt'), ('--hdf5', 'hard.txt'), ('--report', 'hard.txt'),
                  ('--report', 'motion.txt', '--check'), ('--report', 'motion.txt', '--structure'),
                  ('--report', 'motion.txt', '--set', 'pair(1).kind=revolutte')):
        folder.refuses(f'{words} over a drive', 'mine.nml', *words, names=('motion.txt',))
    folder.does('a drive that is not read', 'mine.nml', '--set', 'drive.file=motion.txt', '--table', 'a.dat')


def test_file_of_a_curve(checks, mech9k):
    """The file of a curve."""
    folder = Folder(checks, mech9k, text="&pair coordinate=1, links=1,2, kind='path', file='curve.txt' /\n&structure cq=1 /\n"
                    "&drive coordinate=1, kind='polynomial', coefficients=0.5 /\n")
    folder.write('curve.txt', '0 0\n1 0\n2 0\n3 1\n')
    folder.does('a curve from a file', 'mine.nml', '--no-write')
    for words in (('--table', 'curve.txt'), ('--report', 'curve.txt', '--check')):
        folder.refuses(f'{words} over a curve', 'mine.nml', *words, names=('curve.txt',))


@pytest.mark.parametrize('words', (
    ('--table', 'a', '--hdf5', 'a'), ('--table', 'a', '--hdf5', './a'), ('--table', 'a', '--report', 'a'),
    ('--plot', 'a.svg:q1', '--plot', 'a.png:q1'), ('--plot', 'a.svg:q1', '--plot', 'a.svg:q2'),
    ('--plot', 'a.svg:q1', '--sketch', 'a.svg'), ('--sketch', 'a.svg', '--animate', 'a.svg'),
    ('--table', 'a.gp', '--plot', 'q1'), ('--table', 'a.svg', '--plot', 'a.svg:q1'), ('--report', 'a.gp', '--plot', 'a.svg:q1'),
    ('--hdf5', 'a.h5', '--report', 'a.xdmf', '--set', 'output.poses=T'), ('--graph', 'a.svg', '--report', 'a.dot'),
    ('--graph', 'a.svg', '--sketch', 'a.svg'), ('--table', 'new', '--report', 'dangling')), ids=' '.join)
def test_results_over_results(checks, mech9k, words):
    folder = Folder(checks, mech9k)
    os.symlink('new', folder.path('dangling'))
    folder.refuses(' '.join(words), 'mine.nml', *words)


def test_names_of_one_file(checks, mech9k):
    folder = Folder(checks, mech9k)
    folder.write('old', '')
    os.link(folder.path('old'), folder.path('hard'))
    os.symlink('.', folder.path('here'))
    folder.refuses('two names of one file', 'mine.nml', '--table', 'old', '--hdf5', 'hard', names=('old', 'hard'))
    folder.refuses('two ways to one folder', 'mine.nml', '--table', 'new', '--report', 'here/new', names=('new', 'here/new'))
    with open(folder.path('old'), 'w', encoding='utf-8') as file:
        folder.refuses('the table behind a report', 'mine.nml', '--table', '-', '--report', 'old', names=('old',), stdout=file)
        folder.refuses('a file that is open', 'mine.nml', '--table', '/dev/stdout', '--report', 'hard', stdout=file)
        folder.does('nothing on standard output', 'mine.nml', '--table', 'old', stdout=file)


def test_harmless(checks, mech9k):
    """Nothing is refused that loses nothing."""
    folder = Folder(checks, mech9k)
    folder.does('nowhere, twice', 'mine.nml', '--table', '/dev/null', '--report', '/dev/null')
    folder.does('one behind the other', 'mine.nml', '--table', '-', '--report', '-')
    folder.does('one behind the other in a pipe', 'mine.nml', '--table', '-', '--report', '/dev/stdout')
    folder.does('what is not written', 'mine.nml', '--check', '--table', 'mine.nml')
    folder.does('neighbours', 'mine.nml', '--table', 'a.dat', '--hdf5', 'a.h5', '--report', 'a.json', '--sketch', 'a.svg',
                '--animate', 'a.html')
    folder.does('the same once more', 'mine.nml', '--table', 'a.dat', '--hdf5', 'a.h5', '--report', 'a.json')
