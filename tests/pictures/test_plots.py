"""Plots by --plot: what stands in the scripts is what the table holds, gnuplot accepts them, hostile names and
titles do no harm, and where gnuplot is missing or fails the program says so.
"""
import fcntl
import os
import pty
import re
import shutil
import stat
import struct
import subprocess
import termios
import xml.etree.ElementTree as xml

import numpy as np
import pytest

from mech9_cases import PATIENCE, TREE, read_table, run, text_of

FIG1 = os.path.join(TREE, 'examples', 'fig1', 'fig1.nml')
PENDULUM = os.path.join(TREE, 'examples', 'pendulum', 'pendulum.nml')
HOSTILE = '''it's "x" `touch harm` $(touch harm); @a {b}_c^d \\n \\ %s & <i> é'''


@pytest.fixture
def gnuplot(checks):
    """Tests that take it are left out where gnuplot is not installed."""
    if not checks.has('gnuplot', 'gnuplot-nox'):
        pytest.skip(checks.missing[-1])


def texts_of(picture):
    """All that is written in an SVG picture; fails where it is not well-formed."""
    found = []
    for element in xml.parse(picture).getroot().iter():
        if element.tag.endswith('}text'):
            found.append(' '.join(''.join(element.itertext()).split()))
    return found


def curves_of(checks, script, folder):
    """The curves that gnuplot would draw, as it writes them with `set table`: an array of x and y for each."""
    lines = [line for line in text_of(os.path.join(folder, script)).splitlines()
             if not re.match('(un)?set (terminal|output|multiplot|format)', line)]
    done = subprocess.run(['gnuplot', '-d'], input="set table 'curves.txt'\n" + '\n'.join(lines) + '\n', cwd=folder,
                          text=True, capture_output=True, timeout=60 * PATIENCE)
    checks.true(done.returncode == 0, f'{script}: gnuplot reads the script', done.stderr)
    curves = []
    for part in re.split(r'^# Curve \d.*$', text_of(os.path.join(folder, 'curves.txt')), flags=re.M)[1:]:
        rows = [line.split() for line in part.splitlines() if line.strip() and not line.startswith('#')]
        checks.equal({row[2] for row in rows}, {'i'}, f'{script}: all points are inside the axes')
        curves.append(np.array([row[:2] for row in rows], float))
    return curves


def check_picture(checks, folder, name, expected, words, why):
    """The picture is there, its words are those, its curves are `expected`: pairs of columns."""
    if not checks.true(os.path.exists(os.path.join(folder, name + '.svg')), f'{why}: the picture is there'):
        return
    found = texts_of(os.path.join(folder, name + '.svg'))
    for word in words:
        checks.true(word in found, f'{why}: the picture says {word!r}', found)
    curves = curves_of(checks, name + '.gp', folder)
    checks.equal(len(curves), len(expected), f'{why}: so many curves')
    for number, (curve, (x, y)) in enumerate(zip(curves, expected), 1):
        if checks.equal(len(curve), len(x), f'{why}: curve {number} has a point for each row'):
            # gnuplot writes six significant digits
            checks.near(curve, np.column_stack([x, y]), 1e-5, f'{why}: curve {number} is that of the table')


def test_beside_a_table(checks, gnuplot, mech9k, tmp_path):
    folder = tmp_path
    (folder / 'out').mkdir()
    done = run(mech9k, FIG1, '--table', 'out/motion.dat', '--plot', 'q3,P.x,q4,P.ax', '--plot', 'P.x:P.y',
               '--plot', 'elsewhere.svg:dq5', folder=folder)
    checks.equal(done.returncode, 0, 'plots beside the table')
    checks.true('out/motion.svg' in done.stderr and 'out/motion.gp' in done.stderr, 'the files are told', done.stderr)
    table = read_table(text_of(os.path.join(folder, 'out', 'motion.dat')))
    t, out = table['t'], os.path.join(folder, 'out')
    check_picture(checks, out, 'motion', [(t, table['q3']), (t, table['q4']), (t, table['P.x']), (t, table['P.ax'])],
                  ['Fig. 1: two closed chains, one degree of freedom', 't [s]', 'angle [rad]', 'q3', 'q4', 'P.x [m]',
                   'P.ax [m/s²]'], 'over time')
    check_picture(checks, out, 'motion-2', [(table['P.x'], table['P.y'])], ['P.x [m]', 'P.y [m]'], 'one against another')
    checks.true('motion.dat' in text_of(os.path.join(out, 'motion.gp')), 'the script reads the table beside it')
    check_picture(checks, folder, 'elsewhere', [(t, table['dq5'])], ['dq5 [rad/s]', 't [s]'], 'in another folder')
    # the script alone draws the same picture again
    first = text_of(os.path.join(out, 'motion.svg'))
    os.remove(os.path.join(out, 'motion.svg'))
    subprocess.run(['gnuplot', 'motion.gp'], cwd=out, check=True, timeout=60 * PATIENCE)
    checks.equal(text_of(os.path.join(out, 'motion.svg')), first, 'the script draws the picture again')


def without_output(folder):
    """A data file of Fig. 1 that names no file of results."""
    data = folder / 'no table.nml'
    data.write_text(re.sub(r"^&output.*?/", '', text_of(FIG1), flags=re.M | re.S), encoding='utf-8')
    return data


def test_without_a_table(checks, gnuplot, mech9k, tmp_path):
    folder, data = tmp_path, without_output(tmp_path)
    done = run(mech9k, data, '--plot', 'q1', '--plot', 'small.png:q1', '--plot', 'page.pdf:q1:q2', folder=folder)
    checks.equal((done.returncode, done.stdout), (0, ''), 'a plot and no table')
    table = read_table(run(mech9k, data, folder=folder).stdout)
    check_picture(checks, folder, 'no table', [(table['t'], table['q1'])], ['q1 [rad]'], 'the data stand in the script')
    for name, beginning in (('small.png', b'\x89PNG'), ('page.pdf', b'%PDF')):
        with open(os.path.join(folder, name), 'rb') as file:
            checks.true(file.read(4) == beginning, f'{name} is of its kind')
    both = run(mech9k, data, '--plot', 'q1', '--table', '-', folder=folder)
    checks.equal(read_table(both.stdout).keys(), table.keys(), 'a table on standard output as well')
    run(mech9k, data, '--plot', 'q1', '--table', 'x.csv', folder=folder)
    check_picture(checks, folder, 'x', [(table['t'], table['q1'])], ['q1 [rad]'], 'beside CSV')


def test_many_rows(checks, gnuplot, mech9k, tmp_path):
    """The picture of a run of many rows shows some of them, the first among them."""
    data = without_output(tmp_path)
    table = read_table(run(mech9k, data).stdout)
    done = run(mech9k, data, '--set', 'time.intervals=30000', '--plot', 'many.svg:q1', folder=tmp_path)
    checks.equal(done.returncode, 0, 'a plot of many rows')
    curve = curves_of(checks, 'many.gp', tmp_path)[0]
    checks.true(5000 < len(curve) <= 10000, 'so many points as a picture can show', len(curve))
    checks.near(curve[0], [table['t'][0], table['q1'][0]], 1e-5, 'from the start')
    checks.near(curve[::30000 // 100 // 4, 0][:5] - curve[0, 0], np.arange(5) * (table['t'][-1] / 100), 1e-5,
                'every so-manieth')
    checks.near(curve[::75, 1], table['q1'], 1e-5, 'and those are the right ones')


def test_energies(checks, gnuplot, mech9d, tmp_path):
    folder = tmp_path
    done = run(mech9d, PENDULUM, '--plot', 'energy.svg:E.kinetic,E.total,q1', folder=folder)
    checks.equal(done.returncode, 0, 'a plot of mech9d')
    curves = curves_of(checks, 'energy.gp', folder)
    checks.equal(len(curves), 3, 'energies and an angle')
    checks.true('energy [J]' in texts_of(os.path.join(folder, 'energy.svg')), 'the energy axis')
    # a pendulum that starts at rest: the kinetic energy starts at zero
    checks.near(curves[0][0], [0, 0], 1e-12, 'its start')
    # the sum stays zero but for round-off: its marks, like -2.5e-13, push the label to the left
    run(mech9d, PENDULUM, '--plot', 'marks.svg:E.total,q1', folder=folder)
    turned = re.findall(r'translate\(([-\d.]+),[-\d.]+\) rotate\((?:-90|270)', text_of(os.path.join(folder, 'marks.svg')))
    checks.equal(len(turned), 2, 'a label at each upward axis')
    for place in turned:
        checks.true(float(place) > 15, 'an upward label is within the picture: its base is farther in than letters are high', place)


def test_no_place(checks, gnuplot, mech9k, tmp_path):
    """A picture that cannot be opened, and one on a full disk: gnuplot itself takes both for done."""
    folder = tmp_path
    (folder / 'folder.svg').mkdir()
    targets = {'folder.svg': 'Is a directory'}
    if checks.has_full_disk():
        for ending in ('svg', 'png', 'pdf'):
            os.symlink('/dev/full', os.path.join(folder, 'full.' + ending))
            targets['full.' + ending] = 'disk full'
        # here its script is
        os.symlink('/dev/full', os.path.join(folder, 'script.gp'))
        targets['script.svg'] = 'no whole script'
    for target, words in targets.items():
        done = run(mech9k, FIG1, '--quiet', '--table', 'kept.dat', '--plot', target + ':q1', folder=folder)
        checks.true(done.returncode == 8 and target in done.stderr and words in done.stderr, f'{target}: told', done.stderr)
        checks.equal(done.stdout, '', f'{target}: nothing on standard output')
        checks.equal(len(read_table(text_of(os.path.join(folder, 'kept.dat')))['t']), 101, f'{target}: the table is whole')


@pytest.mark.parametrize('path', ('{name}/{name}.dat', '<{name}.dat', '|{name}.dat', '-x.dat', '$data.dat', '+.dat'))
def test_hostile_names(checks, gnuplot, mech9k, tmp_path, path):
    # a line end cannot stand in a title, but in the name of a file
    name, folder = HOSTILE.replace('/', '') + '\n| x', os.fspath(tmp_path)
    path = path.format(name=name)
    os.mkdir(os.path.join(folder, name))
    title = "mechanism.title='" + HOSTILE.replace("'", "''") + "'"
    done = run(mech9k, FIG1, '--set', title, f'--table={path}', '--plot', 'q1', folder=folder)
    checks.equal(done.returncode, 0, f'table {path!r}: {done.stderr}')
    base = path[:-len('.dat')]
    table = read_table(text_of(os.path.join(folder, path)))
    words = ' '.join(HOSTILE.split())
    where = os.path.join(folder, os.path.dirname(path))
    check_picture(checks, where, os.path.basename(base), [(table['t'], table['q1'])], [words], f'table {path!r}')
    found = [file for _, _, files in os.walk(folder) for file in files]
    checks.true('harm' not in found, 'nothing was carried out', found)


def test_hostile_title_in_the_terminal(checks, gnuplot, mech9k, tmp_path):
    done = titled(mech9k, HOSTILE, tmp_path, '--plot', 'term:q1')
    checks.equal(done.returncode, 0, 'a hostile title in the terminal')
    checks.true('harm' not in os.listdir(tmp_path), 'nothing was carried out')


def titled(mech9k, title, folder, *options):
    setting = "mechanism.title='" + title.replace("'", "''") + "'"
    return run(mech9k, FIG1, '--quiet', '--set', 'time.intervals=3', '--set', setting, *options, folder=folder)


@pytest.mark.parametrize('title', (
    "'", "''", "'''", "it''s", "'quoted'", "'; system 'touch harm' #", '"\'"', '\\', "'\\", "'`touch harm`",
    "'$(touch harm)", "'\\n", ']]>', "a]]>b]]>]]>'", '<script>alert(1)</script>', '@x', "'@x", 'a_{b}^2 {', '}',
    '^', '_', '\U0001f642 é', '<![CDATA[', '-->', '&amp;', '%s', '#', "'#", '!touch harm'))
def test_titles(checks, gnuplot, mech9k, tmp_path, title):
    """Titles are drawn as they are, whatever they mean to gnuplot and to XML, in one panel and above several."""
    folder = tmp_path
    done = titled(mech9k, title, folder, '--plot', 'one.svg:q1', '--plot', 'two.svg:q1,P.x', '--plot', 'three.png:q1')
    checks.equal(done.returncode, 0, f'the title {title!r}: {done.stderr}')
    for name in ('one', 'two'):
        # a space without width keeps `]]>` apart
        found = [words.replace('\u200b', '') for words in texts_of(os.path.join(folder, name + '.svg'))]
        checks.true(title in found, f'the picture says {title!r}', found)
    checks.true('harm' not in os.listdir(folder), 'nothing was carried out')


# titles with the mean width of their letters in DejaVu Sans, as a part of their size, and whether there is room for all of it
LONG_TITLES = {'words': ('a crank drives two rockers by one coupler, ' * 4, 0.505, True), 'one word': ('x' * 2000, 0.592, False)}


@pytest.mark.parametrize('kind', LONG_TITLES)
def test_long_title(checks, gnuplot, mech9k, tmp_path, kind):
    """A title with no room in one line is drawn in three at most, each within the picture."""
    (title, letter, whole), folder = LONG_TITLES[kind], tmp_path
    titled(mech9k, title, folder, '--plot', 'one.svg:q1', '--plot', 'two.svg:q1,P.x', '--plot', 'shape.svg:P.x:P.y')
    for name in ('one', 'two', 'shape'):
        found = [words for words in texts_of(os.path.join(folder, name + '.svg')) if words and words in title.strip()
                 or words.endswith('…')]
        found = [words for words in found if len(words) > 12]
        checks.true(2 <= len(found) <= 3, f'{name}: a long title in lines', found)
        width = float(xml.parse(os.path.join(folder, name + '.svg')).getroot().get('viewBox').split()[2])
        checks.true(15 * letter * max(map(len, found)) < width, f'{name}: none is longer than the picture', found)
        if whole and name != 'shape':
            checks.equal(' '.join(found), title.strip(), f'{name}: all of it')
        if not whole:
            checks.true(found[-1].endswith('…'), f'{name}: it is seen that there is more', found[-1])


def test_in_a_pipe(checks, gnuplot, mech9k, tmp_path):
    folder = tmp_path
    done = run(mech9k, FIG1, '--quiet', '--plot', 'term:q3,P.x', folder=folder)
    lines = done.stdout.splitlines()
    checks.equal(done.returncode, 0, 'a plot for the terminal')
    checks.true(lines and max(map(len, lines)) <= 79, 'at most 79 columns in a pipe')
    checks.true(len(lines) <= 2 * 24, 'two panels of 23 rows', len(lines))
    checks.true(done.stdout.count('*') > 60 and 'q3 [rad]' in done.stdout and 'P.x [m]' in done.stdout, 'curves and labels')
    checks.equal([name for name in os.listdir(folder) if not name.endswith('.dat')], [], 'no other file is left')
    done = run(mech9k, FIG1, '--quiet', '--plot', 'term', folder=folder)
    checks.true(all(f'q{i}' in done.stdout for i in range(1, 8)), 'all coordinates, where none is named')


def test_in_a_terminal(checks, gnuplot, mech9k, tmp_path):
    """A plot has the size of its terminal."""
    try:
        master, slave = pty.openpty()
    except OSError:
        checks.left_out('there are no pseudo-terminals here: the size of a terminal is not checked')
        return
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack('HHHH', 31, 101, 0, 0))
    with subprocess.Popen([mech9k, FIG1, '--quiet', '--plot', 'term:q3'], cwd=tmp_path, stdin=slave, stdout=slave,
                          stderr=slave) as process:
        os.close(slave)
        got = b''
        while True:
            try:
                piece = os.read(master, 65536)
            except OSError:
                break
            if not piece:
                break
            got += piece
        checks.equal(process.wait(60 * PATIENCE), 0, 'a plot in a pseudo-terminal')
    os.close(master)
    lines = got.decode().splitlines()
    checks.true(90 < max(map(len, lines)) <= 100 and 28 <= len(lines) <= 31, 'of its size less one',
                (max(map(len, lines)), len(lines)))


def test_refusals(checks, mech9k, tmp_path):
    folder = tmp_path
    done = run(mech9k, FIG1, '--table', 'none.dat', '--plot', 'q1,q33', folder=folder)
    checks.true(done.returncode == 2 and "did you mean 'q3'?" in done.stderr, 'an unknown name', done.stderr)
    for setting, name in (('output.derivatives=0', 'dq3'), ('output.coordinates=5', 'q3')):
        left_out = run(mech9k, FIG1, '--table', 'none.dat', '--plot', name, '--set', setting, folder=folder)
        checks.true(left_out.returncode == 2 and 'leave some out' in left_out.stderr, f'{name} is left out by {setting}',
                    left_out.stderr)
    checks.true('leave some out' not in done.stderr, 'where nothing is left out it is not said', done.stderr)
    checks.equal(os.listdir(folder), [], 'nothing is written then')
    for table, plot in (('a.gp', 'q1'), ('a.svg', 'a.svg:q1'), ('b/a.gp', 'b/a.png:q1')):
        done = run(mech9k, FIG1, '--table', table, '--plot', plot, folder=folder)
        checks.true(done.returncode == 2 and 'cannot both be' in done.stderr, f'{plot} over {table}', done.stderr)
    checks.equal(os.listdir(folder), [], 'nor then')
    done = run(mech9k, FIG1, '--no-write', '--plot', 'q1', folder=folder)
    checks.equal(done.returncode, 2, 'a plot that is not to be written')
    done = run(mech9k, FIG1, '--plot', 'no/such/folder.svg:q1', folder=folder)
    checks.true(done.returncode == 8 and 'no/such/folder.gp' in done.stderr, 'a folder that is not there', done.stderr)


def test_without_gnuplot(checks, mech9k, tmp_path, monkeypatch):
    folder, path = tmp_path, os.environ['PATH']
    (folder / 'empty').mkdir()
    monkeypatch.setenv('PATH', os.fspath(folder / 'empty'))
    done = run(mech9k, FIG1, '--table', 'a.dat', '--plot', 'q1', folder=folder)
    checks.true(done.returncode == 0 and 'gnuplot a.gp' in done.stderr, 'no gnuplot: the script is kept', done.stderr)
    checks.true(not os.path.exists(os.path.join(folder, 'a.svg')), 'no picture then')
    done = run(mech9k, FIG1, '--table', 'a.dat', '--plot', 'q1', '--quiet', folder=folder)
    checks.true(done.stderr.startswith('plot: gnuplot is not here') and done.stderr.count('\n') == 1,
                'no gnuplot: told to who wants quiet, too', done.stderr)
    done = run(mech9k, FIG1, '--quiet', '--plot', 'term:q1', folder=folder)
    checks.true(done.returncode == 8 and 'gnuplot' in done.stderr, 'no gnuplot for the terminal', done.stderr)
    monkeypatch.setenv('PATH', path)
    if checks.has('gnuplot', 'gnuplot-nox'):
        subprocess.run(['gnuplot', 'a.gp'], cwd=folder, check=True, timeout=60 * PATIENCE)
        checks.true('q1 [rad]' in texts_of(os.path.join(folder, 'a.svg')), 'gnuplot draws it later')


SHELL = shutil.which('sh')
# one that fails, one that is ended, one that misses a library; one without an interpreter, and one that is no program: they are
# there, and why they do not start is told
FAILING = {'fails': ('echo cannot draw >&2; exit 3', SHELL, stat.S_IRWXU, 'cannot draw'),
           'ended': ('kill -9 $$', SHELL, stat.S_IRWXU, 'ended with 137'),
           'no library': ('echo no library libgd.so >&2; exit 127', SHELL, stat.S_IRWXU, 'ended with 127: no library libgd.so'),
           'no interpreter': ('', '/nowhere/none', stat.S_IRWXU, 'empty/gnuplot: No such file or directory; install'),
           'no program': ('', SHELL, stat.S_IRUSR, 'empty/gnuplot: Permission denied; install')}


@pytest.mark.parametrize('kind', FAILING)
def test_failing_gnuplot(checks, mech9k, tmp_path, monkeypatch, kind):
    script, interpreter, mode, words = FAILING[kind]
    fake = tmp_path / 'empty' / 'gnuplot'
    fake.parent.mkdir()
    fake.write_text(f'#!{interpreter}\n{script}\n', encoding='utf-8')
    fake.chmod(mode)
    monkeypatch.setenv('PATH', os.fspath(fake.parent))
    done = run(mech9k, FIG1, '--table', 'b.dat', '--plot', 'q1', folder=tmp_path)
    checks.true(done.returncode == 8 and words in done.stderr, f'gnuplot fails: {script}', done.stderr)
    checks.true('is not here' not in done.stderr, f'it is not said that gnuplot is not here: {words}', done.stderr)
    checks.equal(len(read_table(text_of(tmp_path / 'b.dat'))['t']), 101, 'the table is whole')
