"""The benchmarks, in their quick form: they run, and their figures are there and can be true. Times are not judged."""
import math
import os
import re
import subprocess
import xml.etree.ElementTree as xml

import pytest

from mech9_cases import PATIENCE, TREE, text_of

OTHER_TABLES = ['Time per position', 'Studies, searches, sensitivities', 'Values of an objective', 'Growth', 'Mixed structures', 'Memory of mixed structures', 'Other programs']
PEERS = ('Exudyn', 'MuJoCo', 'Drake', 'Pinocchio', 'Simbody')
METHODS = ['auto', 'prince-dormand', 'dormand-prince', 'verner', 'fehlberg', 'merson', 'adams', 'bdf']


def tables_of(text):
    """{heading: rows of cells} of a page in Markdown; a heading with two tables holds both."""
    found, heading = {}, ''
    for line in text.splitlines():
        if line.startswith('#'):
            heading = line.lstrip('# ')
        elif line.startswith('|') and not line.startswith('| ---'):
            found.setdefault(heading, []).append([cell.strip() for cell in line.strip('|').split('|')])
    return found


@pytest.fixture(scope='module')
def folder(build, tmp_path_factory):
    """The folder that a quick run fills."""
    folder, programs = tmp_path_factory.mktemp('bench'), os.path.join(build.folder, 'bench')
    done = subprocess.run([os.path.join(TREE, 'bench', 'run'), '--quick', '--programs', programs, '--output', folder],
                          capture_output=True, text=True, timeout=250 * PATIENCE)
    assert done.returncode == 0, f'bench/run --quick ended with {done.returncode}:\n{done.stdout}\n{done.stderr}'
    return folder


@pytest.fixture(scope='module')
def page(folder):
    return text_of(folder / 'benchmarks.md')


@pytest.fixture(scope='module')
def tables(page):
    return tables_of(page)


def problems_of(tables):
    """The headings of the problems that are solved with growing precision."""
    return [heading for heading in tables if heading not in OTHER_TABLES]


def test_page(checks, page):
    checks.true('quick run' in page, 'the page says that it was a quick run')


def test_positions(checks, tables):
    rows = tables['Time per position']
    rows = [row for row in rows if 'pylinkage' not in row[0]]
    names = [row[0] for row in rows[1:]]
    checks.equal(names, ['four-bar, closed form', 'four-bar', 'six-bar', 'Fig. 1', 'spatial R-S-U-R',
                         'Stewart-Gough platform', 'pair of legs'], 'the mechanisms')
    for row in rows[1:]:
        times = float(row[2]), float(row[4])
        checks.true(0.001 < times[0] < 1e5 and 0.001 < times[1] < 1e5, f'{row[0]}: times above zero', row)
    closed = [float(cell) for cell in rows[1][2:]]
    for row in rows[2:]:
        for k in (0, 2):
            # times stand there with three decimals
            ratio = float(row[2 + k]) / closed[k]
            checks.near(float(row[3 + k]) / ratio, 1.0, 0.05 + 0.0006 / closed[k], f'{row[0]}: the ratio is that of the times')


def test_values(checks, tables):
    rows = tables['Values of an objective']
    checks.equal(len(rows), 5, 'a position, a value, a gradient, and a value that is followed')
    position = float(rows[1][1])
    checks.true(position > 0, 'a position takes time', rows)
    for row in rows[2:]:
        # times stand there with two decimals; a gradient is a difference of times, which may be anything on a busy machine
        checks.near(float(row[2]), float(row[1]) / position, 0.05 + 0.01 / position + 0.01 * abs(float(row[2])), f'{row[0]}: the ratio')
    checks.true(0 < float(rows[2][1]) < float(rows[4][1]), 'a value beside a known run costs less than one that is followed', rows)


def test_accelerations_of_the_closed_form(checks, page):
    error = float(re.search(r'largest acceleration:\n(\S+)\.\n', page).group(1))
    # round-off times the conditioning of a chain
    checks.true(error < 1e-10, 'the accelerations of the four-bar are those of the closed form', error)


def test_precision(checks, tables):
    problems = problems_of(tables)
    checks.equal(len(problems), 7, 'seven problems')
    for heading in problems:
        check_precision(checks, heading, tables[heading])


def check_precision(checks, heading, rows):
    methods = METHODS + (['by hand'] if heading.startswith('Andrews') else [])
    rows = [row for row in rows[1:] if row[0] not in PEERS]
    checks.equal([row[0] for row in rows], methods, f'{heading}: all methods')
    for row in rows:
        least = float(row[-1])
        # the loosest bound, over a twentieth of the motion
        checks.true(0 <= least < 1e-4, f'{heading}, {row[0]}: errors below 1e-4', row)
        cells = [cell for cell in row[1:-1] if cell != '-']
        checks.true(cells and all(re.fullmatch(r'[\d.e+-]+ ms, \d+', cell) for cell in cells),
                    f'{heading}, {row[0]}: times and evaluations', row)


def test_answers(checks, tables):
    rows = tables['Studies, searches, sensitivities']
    checks.equal(len(rows), 6, 'a study, two runs with and without derivatives, two searches')
    for row in rows[1:]:
        checks.true(re.fullmatch(r'[\d.]+', row[1]) and re.match(r'[\d.]+ (µs a position|ms a start)', row[2]), f'{row[0]}: times', row)
    study = rows[1]
    runs = int(re.search(r'of (\d+) four-bars', study[0]).group(1))
    # processor time stands there with three decimals
    apart = abs(float(study[2].split()[0]) - 1e6 * float(study[1]) / runs / 361)
    checks.true(apart <= 1e6 * 0.0006 / runs / 361 + 0.001, 'the time of a position', study)


def test_by_hand(checks, page, tables):
    rows = next(tables[heading] for heading in problems_of(tables) if heading.startswith('Andrews'))
    by_hand = next(row for row in rows if row[0] == 'by hand')
    # round-off of a short motion, in angles of order one
    checks.true(float(by_hand[-1]) < 1e-13, 'the equation by hand has the motion of the reference', by_hand)
    times = {row[0]: float(row[3].split()[0]) for row in rows[1:] if row[0] in ('prince-dormand', 'by hand')}
    ratio = float(re.search(r'the program takes (\S+) times as long', page).group(1))
    # times stand there with three digits
    checks.near(ratio / (times['prince-dormand'] / times['by hand']), 1.0, 0.02, 'the ratio is that of the times to 1e-8')


def test_growth(checks, tables):
    rows = tables['Growth']
    titles = [i for i, row in enumerate(rows) if row[0] == 'N']
    checks.equal(len(titles), 2, 'ladders and chains')
    for first, last, links in ((titles[0] + 1, titles[1], lambda n: 2 * n + 2), (titles[1] + 1, len(rows), lambda n: n + 1)):
        checks.true(last - first >= 3, 'three sizes at least')
        for row in rows[first:last]:
            checks.equal(int(row[1]), links(int(row[0])), f'links of N = {row[0]}')
            checks.true(float(row[6]) > 0 and float(row[8]) >= 0, f'N = {row[0]}: an evaluation takes time', row)
        checks.true(float(rows[last - 1][6]) > float(rows[first][6]), 'more links take longer', rows[first:last])


def test_mixed_structures(checks, tables):
    rows = tables['Mixed structures']
    chains = {row[1]: row for row in rows[1:] if row[0] == 'open chain'}
    checks.equal(len({row[0] for row in rows[1:]}), 6, 'six structures')
    for row in rows[1:]:
        checks.true(int(row[2]) > int(row[1]), f'{row[0]}: links', row)
        for k in (4, 7):
            # times stand there with two decimals
            ratio = float(row[k]) / float(chains[row[1]][k])
            checks.near(float(row[k + 2]) / ratio, 1.0, 0.05, f'{row[0]}: the ratio is that of the times')


def test_memory(checks, build, tables):
    rows = tables['Memory of mixed structures']
    checks.equal(len(rows), 7, 'memory of six structures')
    for row in rows[1:]:
        # some 10 kB for a link; between mechanisms as small as those of a quick run, pages that the system gives at once
        # count more. The sanitizer of addresses keeps memory that was given back
        limit = math.inf if build.kind == 'Sanitize' else 200
        checks.true(all(abs(float(cell)) < limit for cell in row[2:]), f'{row[0]}: memory for a link', row)


def test_other_programs(checks, page, tables):
    rows = tables['Other programs']
    mechanisms = {}
    for row in rows[1:]:
        mechanisms.setdefault((row[0], row[1]), {})[row[2].split(',')[0]] = row
    checks.true(len(mechanisms) >= 8, 'eight mechanisms', list(mechanisms))
    checks.equal(sum('by hand' in found for found in mechanisms.values()), 3, 'three mechanisms by hand')
    for (name, _), found in mechanisms.items():
        own = found['MECH9']
        checks.true(float(own[3]) > 0, f'{name}: an evaluation takes time', own)
        for program, row in found.items():
            # times stand there with three decimals
            checks.near(float(row[5]) / (float(row[3]) / float(own[3])), 1.0, 0.05 + 0.0006 / float(row[3]), f'{name}: ratio')
            if program != 'MECH9':
                # soft constraints and single proximal steps leave more than round-off
                checks.true(float(row[6]) < (1e-13 if program == 'by hand' else 1e-2), f'{name}, {program}: accelerations', row)
    for program in ('MuJoCo', 'Pinocchio'):
        found = [program in row for row in mechanisms.values()]
        absent = re.search(rf'not measured: .*{program.lower()}', page.lower())
        checks.true(not any(found) if absent else all(found), f'{program} is measured, or said to be missing')


def test_pictures(checks, folder, page):
    pictures = re.findall(r'\((pictures/\S+\.svg)\)', page)
    for picture in pictures:
        xml.parse(folder / picture)
    if checks.has('gnuplot', 'gnuplot-nox'):
        checks.equal(len(pictures), 8, 'a picture for each problem and one of the growth')


def test_unknown_option(checks):
    done = subprocess.run([os.path.join(TREE, 'bench', 'run'), '--nonsense'], capture_output=True, text=True, timeout=60 * PATIENCE)
    checks.true(done.returncode == 2 and 'bench/run [--quick]' in done.stderr, 'an unknown option', done.stderr)
