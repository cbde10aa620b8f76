"""Searches by --optimize that are attacked: the same problem in other units of length; targets that cannot be reached; limits that no
design keeps; ranges beyond all reason; files that are none; full disks.
"""
import contextlib
import os
import resource


import pytest

from mech9_cases import run
from synthesis_cases import ASSEMBLY, DATA, DONE, FILE, FOUR_BAR, LENGTHS, Cases, targets, with_numbers

PATH = "&objective kind='path', point='P', file='targets.dat', timing='given' /\n"
FEW = '&optimum starts=3 /\n'
NAMES = ('crank', 'coupler', 'rocker')
FOUND = 'least value: '


def scaled(scale, crank, coupler, rocker):
    """The four-bar linkage and its parameters with all lengths times a factor."""
    text = with_numbers(FOUR_BAR, CRANK=crank*scale, COUPLER=coupler*scale, ROCKER=rocker*scale)
    text = text.replace('point=2,0.1,0', f'point={2*scale!r},{0.1*scale!r},0')
    text = text.replace('position=0.7,0.6,0', f'position={0.7*scale!r},{0.6*scale!r},0')
    lengths = LENGTHS
    for low, high in ((0.2, 0.8), (1, 3)):
        lengths = lengths.replace(f'low={low}, high={high}', f'low={low*scale!r}, high={high*scale!r}')
    return text + lengths


@pytest.fixture
def cases(checks, tmp_path, mech9k):
    return Cases(checks, tmp_path, mech9k)


@pytest.mark.parametrize('why, part, columns, more, tolerance', (
    ('given times', slice(None, None, 3), ('t', 'P.x', 'P.y'), '', 1e-8),
    ('free times', slice(4, 20, 3), ('P.x', 'P.y'), '', 1e-7),
    ('a transmission angle', slice(None, None, 3), ('t', 'P.x', 'P.y'), "&limit kind='transmission', coordinate=3, at_least=52 /\n", 1e-5),
    ('a crank', slice(None, None, 3), ('t', 'P.x', 'P.y'), "&limit kind='crank', coordinate=1 /\n", 1e-7)),
    ids=('given times', 'free times', 'transmission angle', 'crank'))
def test_the_same_design_in_other_units(cases, why, part, columns, more, tolerance):
    """A linkage of metres, millimetres and kilometres: the same design. Its targets are missed by some centimetres of a metre. Searches
    end where the value changes by 1e-14 of it, so that parameters have errors of its root, 1e-7; a limit lets them end earlier."""
    made = cases.motion(with_numbers(FOUR_BAR, CRANK=0.5, COUPLER=1.8, ROCKER=1.5))
    objective = PATH if 't' in columns else PATH.replace(", timing='given'", '')
    found = []
    for scale in (1.0, 1e-3, 1e3, 1e-9, 1e9):
        targets(cases, [made[name][part]*(scale if name != 't' else 1)*(1.03 if name == 'P.x' else 1) for name in columns])
        designs, _, _ = cases.search(scaled(scale, 0.4, 2.2, 1.9) + objective + more + FEW, f'{why}, {scale:g}')
        found.append([designs['value'][0]/scale**2] + [designs[name][0]/scale for name in NAMES])
    for design in found[1:]:
        cases.checks.near(design, found[0], tolerance, f'{why}: the same design in other units')
    cases.checks.true(found[0][0] > 1e-5, f'{why}: the targets are missed', str(found[0]))


def attacked(cases, text, file, why, code, words, *options):
    """A search ends with a code and some words, and never with a fault of the program."""
    path = os.path.join(cases.folder, 'targets.dat')
    with open(path, 'wb') as out:
        out.write(file if isinstance(file, bytes) else file.encode())
    done = run(cases.program, cases.write(text), '--optimize', *options)
    cases.checks.true(done.returncode == code and words in done.stderr, f'{why}: ends with {code}', f'{done.returncode}: {done.stderr}')
    cases.checks.true('acktrace' not in done.stderr and 'runtime error' not in done.stderr, f'{why}: no fault', done.stderr)


GOOD = with_numbers(FOUR_BAR, CRANK=0.5, COUPLER=1.8, ROCKER=1.5)
PLAIN = GOOD + LENGTHS + PATH + FEW
THREE = '0 1 1\n1 1 1.1\n2 1.2 1.3\n'


@pytest.mark.parametrize('why, file, code, words', (
    ('far away', '0 100 100\n1 -100 50\n2 1e3 1e5\n', DONE, FOUND),
    ('very far away', '0 1e59 1\n1 1 1\n', DONE, FOUND),
    ('beyond squares', '0 1e62 1\n1 1 1\n', DATA, 'the squares of such numbers cannot be added'),
    ('nearly nothing', '0 1e-300 1e-310\n1 1e-300 0\n', DONE, FOUND),
    ('two at one time', '1 1 1\n1 2 2\n', DONE, FOUND),
    ('not a number', '0 NaN 1\n1 1 1\n', DATA, "'NaN' is not a finite number"),
    ('one target', '0 1 1\n', DATA, 'at least two targets'),
    ('empty', '', DATA, 'the whole file is empty'),
    ('binary', bytes(range(256)), DATA, 'a binary file'),
    ('a line without end', '0 1 1\n' + '1 '*20000, DATA, 'this one has 20000 numbers')),
    ids=('far away', 'very far away', 'beyond squares', 'nearly nothing', 'two at one time', 'not a number', 'one target', 'empty', 'binary',
         'a line without end'))
def test_targets_beyond_reason(cases, why, file, code, words):
    attacked(cases, PLAIN, file, why, code, words)


@pytest.mark.parametrize('why, text, code, words', (
    ('a folder', PLAIN.replace('targets.dat', '.'), FILE, 'Is a directory'),
    ('no end', PLAIN.replace('targets.dat', '/dev/zero'), DATA, 'a binary file'),
    # starts lie far from all designs that close; the first one is that of the data file
    ('a wide range', GOOD + LENGTHS.replace('low=0.2, high=0.8', 'low=-1e61, high=1e61') + PATH + FEW, DONE, FOUND),
    ('a wider range', PLAIN.replace('high=0.8', 'high=1e200'), DATA, 'too large or too small'),
    ('no range', PLAIN.replace('low=0.2, high=0.8', 'low=0.5, high=0.5'), DATA, "'high' must be greater than 'low'"),
    ('starts without end', PLAIN.replace('starts=3', 'starts=2000000000'), DATA, 'at most 10000000 starts')),
    ids=('a folder', 'no end', 'a wide range', 'a wider range', 'no range', 'starts without end'))
def test_ranges_and_files_beyond_reason(cases, why, text, code, words):
    attacked(cases, text, THREE, why, code, words)


@pytest.mark.parametrize('why, limits', (('a stroke', "&limit kind='quantity', of='stroke', low=200 /\n"),
                                         ('a right angle', "&limit kind='transmission', coordinate=3, at_least=90 /\n")), ids=('a stroke', 'a right angle'))
def test_limits_that_no_design_keeps(cases, why, limits):
    stroke = "&quantity name='stroke', of='q4', take='range' /\n"
    attacked(cases, GOOD + LENGTHS + stroke + PATH + limits + '&optimum starts=1 /\n', THREE, f'{why} that no design has', ASSEMBLY,
             'within all limits; give more starts in &optimum, or other ranges of the parameters and limits')


def test_a_crank_that_never_turns(cases):
    long_crank = LENGTHS.replace('low=0.2, high=0.8', 'low=3, high=3.4').replace('low=1, high=3', 'low=1, high=1.2')
    attacked(cases, GOOD + long_crank + PATH + "&limit kind='crank', coordinate=1 /\n" + FEW, THREE, 'a crank that never turns', ASSEMBLY,
             'within all limits')


@pytest.mark.parametrize('option', ('--table', '--hdf5', '--out', '--report'))
def test_a_full_disk(cases, option):
    attacked(cases, PLAIN, THREE, f'{option} on a full disk', FILE, 'No space left on device', option, '/dev/full')


@contextlib.contextmanager
def largest_file(size):
    """Within it, no file may become larger."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.fixture
def results(cases):
    """The options of a search with files of results, and these files."""
    targets(cases, [[0, 1, 2], [1, 1, 1.2], [1, 1.1, 1.3]])
    names = [os.path.join(cases.folder, name) for name in ('x.h5', 'x.dat', 'x.nml')]
    return (cases.write(PLAIN), '--optimize', '--hdf5', names[0], '--table', names[1], '--out', names[2]), names


def test_a_disk_with_room(cases, results):
    """The file has places for all starts from the beginning, so that a search that has begun does not end for want of room."""
    options, names = results
    done = run(cases.program, *options)
    size = os.path.getsize(names[0])
    cases.checks.true(done.returncode == DONE and size > 100000, 'a disk with room', f'{done.returncode} {size}')


@pytest.mark.parametrize('limit', (1000, 20000, 100000))
def test_a_disk_without_room(cases, results, limit):
    """Results that cannot be written end with a message, and nothing is begun."""
    options, names = results
    with largest_file(limit):
        done = run(cases.program, *options)
    cases.checks.true(done.returncode == FILE and 'File too large' in done.stderr, f'{limit} bytes: a message', done.stderr)
    cases.checks.equal([os.path.exists(name) for name in names], [False]*3, f'{limit} bytes: nothing is begun')


def test_an_older_file_stays_as_it_is(cases, results):
    path, kept = results[0][0], os.path.join(cases.folder, 'kept.h5')
    run(cases.program, path, '--optimize', '--hdf5', kept)
    with open(kept, 'rb') as file:
        content = file.read()
    with largest_file(20000):
        done = run(cases.program, path, '--optimize', '--continue', kept, '--set', 'optimum.starts=5')
    with open(kept, 'rb') as file:
        cases.checks.true(done.returncode == FILE and file.read() == content, 'a file that cannot be continued stays', done.stderr)
