"""Dead points, ranges, crossings of branches and conditioning through the whole program, by closed forms.

Compares the program with itself in part: positions with and without accelerations; all else is closed forms.
"""
import json
import math
import os
import re

import numpy as np
import pytest

from mech9_cases import read_table, run, text_of

# The promised accuracy of limits; the program does a thousand times better.
LIMIT = 1e-9
# Positions [rad], rates over the fastest one and accelerations over its square, within a crossing of branches: round-off over the
# least pivot at the positions of the polynomial, once more over the pivot in each derivative (tests/kinematics/followed_motions.f90).
PIVOT = 0.25 * 0.03
AT_CROSSING = [40 * 1e-15 / PIVOT ** k for k in (1, 2, 3)]
# Round-off of the entries of a loop's matrix, which are of order one, from angles of some radians; over a singular value it is
# the relative error of that value.
ENTRIES = 1e-14
# Ground, crank, coupler and rocker of the four-bar whose conditioning is looked at.
CONDITIONED = (0.4, 0.15, 0.35, 0.3)

FOUR_BAR = """
&mechanism title='four-bar', links=4, coordinates=4, angle_unit='deg' /
&structure cq={independent} /
&pair coordinate=1, links=1,2, kind='revolute', point=0,0,0, axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point={crank!r},0,0, moving_point=0,0,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point={coupler!r},0,0, moving_point={rocker!r},0,0, axis=0,0,1 /
&pair coordinate=4, links=1,4, kind='revolute', point={ground!r},0,0, moving_point=0,0,0, axis=0,0,1 /
{initial}
{drive}
&time start=0, end={end!r}, intervals={intervals} /
{more}
"""


def guesses_of(lengths, angle, branch=1):
    """The dependent coordinates of a four-bar (ground, crank, coupler, rocker) at a crank angle; in degrees, as it."""
    ground, crank, coupler, rocker = lengths
    angle = math.radians(angle)
    x, y = ground - crank * math.cos(angle), -crank * math.sin(angle)
    diagonal = math.hypot(x, y)
    along = (coupler ** 2 - rocker ** 2 + diagonal ** 2) / (2 * diagonal)
    across = branch * math.sqrt(coupler ** 2 - along ** 2)
    px = crank * math.cos(angle) + (along * x - across * y) / diagonal
    py = crank * math.sin(angle) + (along * y + across * x) / diagonal
    link_3, link_4 = math.atan2(py - crank * math.sin(angle), px - crank * math.cos(angle)), math.atan2(py, px - ground)
    return [math.degrees(guess) for guess in (link_3 - angle, link_4 - link_3, link_4)]


def four_bar(lengths, drive, end, intervals, branch=1, more=''):
    """A data file: ground, crank, coupler, rocker; the guesses are a closed position of the branch. Of a drive with one
    coefficient only the position counts, and the crank is free."""
    ground, crank, coupler, rocker = lengths
    driven = f"&drive coordinate=1, kind='polynomial', coefficients={', '.join(repr(c) for c in drive)} /"
    initial = '\n'.join(f'&initial coordinate={k}, position={guess!r} /'
                        for k, guess in zip((2, 3, 4), guesses_of(lengths, drive[0], branch)))
    return FOUR_BAR.format(ground=ground, crank=crank, coupler=coupler, rocker=rocker, initial=initial, independent=1,
                           drive=driven if len(drive) > 1 else '', end=end, intervals=intervals, more=more)


def limit(lengths, diagonal):
    """Crank angle in degrees where the diagonal between coupler and rocker has this length."""
    ground, crank = lengths[:2]
    return math.degrees(math.acos((ground ** 2 + crank ** 2 - diagonal ** 2) / (2 * ground * crank)))


class Cases:
    def __init__(self, program, folder, checks):
        self.program, self.folder, self.checks = program, folder, checks

    def run(self, text, *options):
        path = os.path.join(self.folder, 'case.nml')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return run(self.program, path, *options, folder=self.folder)


@pytest.fixture
def s(checks, mech9k, tmp_path):
    return Cases(mech9k, tmp_path, checks)


@pytest.fixture
def dynamic(checks, mech9d, tmp_path):
    return Cases(mech9d, tmp_path, checks)


@pytest.mark.parametrize('intervals', [3, 50, 4000])
def test_dead_point(s, intervals):
    """The run ends with code 6; the message names time, chain, coordinates and limit; the table is kept."""
    lengths = (1.2, 0.7, 0.9, 0.4)
    end = limit(lengths, lengths[2] + lengths[3])
    report = os.path.join(s.folder, 'report.json')
    done = s.run(four_bar(lengths, (40.0, 100.0), 3.0, intervals), '--table', '-', '--report', report)
    s.checks.equal(done.returncode, 6, 'a dead point: exit code 6')
    s.checks.equal(json.loads(text_of(report))['exit_code'], 6, 'which the report tells, too')
    found = re.search(r'cannot go on beyond t = (\S+) s: closed chain 1 \(coordinates 2, 3, 4\) '
                      r'reaches a dead point at q1 = (\S+) ', done.stderr)
    if s.checks.true(found, 'the message names time, chain, coordinates and driven coordinate', done.stderr):
        s.checks.near(float(found[2]), end, LIMIT, 'the limit by its closed form')
        s.checks.near(float(found[1]), (end - 40.0) / 100.0, LIMIT, 'the time by its closed form')
    table = read_table(done.stdout)
    expected = [3.0 * i / intervals for i in range(intervals + 1) if 40.0 + 300.0 * i / intervals < end]
    s.checks.near(table['t'], expected, 1e-15, 'all results before the dead point are kept, none beyond')
    s.checks.true(all(np.all(np.isfinite(column)) for column in table.values()), 'and all are regular')
    s.checks.true(np.all(table['closure'] < 1e-13 * lengths[0]), 'and closed')


# a block on a line across and in a slot of the crank, which guides it to r = 0.3/sin q1 from its pin
SLOT = """
&mechanism links=4, coordinates=4, angle_unit='deg' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=1,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1 /
&pair coordinate=4, links=1,4, kind='prismatic', point=0,0.3,0, moving_point=0,0,0, axis=1,0,0 /
&initial coordinate=2, position=0.35 /
&initial coordinate=3, position=-60 /
&initial coordinate=4, position=0.17 /
&drive coordinate=1, kind='polynomial', coefficients=60, 50 /
&time start=0, end=3, intervals={intervals} /
"""


@pytest.mark.parametrize('intervals', [3, 30, 3000])
def test_slide_without_bounds(s, intervals):
    """The block is nowhere when slot and line become parallel: it is followed far out, and then the end is told."""
    done = s.run(SLOT.format(intervals=intervals), '--table', '-')
    s.checks.equal(done.returncode, 6, 'a slide without bounds: exit code 6')
    found = re.search(r'cannot go on beyond t = (\S+) s: closed chain 1 \(coordinates 2, 3, 4\) cannot follow up to '
                      r'q1 = (\S+), where coordinate [24] grows beyond all bounds', done.stderr)
    if s.checks.true(found, 'the message names time, chain, driven coordinate and what grows', done.stderr):
        # seven digits are told
        s.checks.near([float(found[1]) / 2.4, float(found[2]) / 180.0], 1.0, 1e-6, 'the end is at half a turn')
    table = read_table(done.stdout)
    # a hundred sizes of the mechanism out, at 0.35 m each, it is still half a degree from there
    near = np.array([t for t in np.arange(intervals + 1) * 3.0 / intervals if 60.0 + 50.0 * t < 179.5])
    if s.checks.true(len(table['t']) >= len(near), 'all results before it are kept', table['t'][-1]):
        s.checks.near(table['t'][:len(near)], near, 1e-15, 'at their times')
    # round-off of an angle times r/0.3 < 115
    s.checks.near(table['q2'] * np.sin(np.radians(table['q1'])) / 0.3, 1.0, 1e-13, 'where slot and line cross')


def test_motion_that_ends_before_it_escapes(s):
    done = s.run(SLOT.format(intervals=30), '--table', '-', '--set', 'time.end=2.3')
    s.checks.equal(done.returncode, 0, 'a motion that ends before it is whole')


def test_range_between_limits(s):
    """--range: limits on both sides in the units of the file."""
    lengths = (1.0, 0.75, 1.0, 0.4)
    lower, upper = limit(lengths, 0.6), limit(lengths, 1.4)
    done = s.run(four_bar(lengths, (0.5 * (lower + upper), 1.0), 1.0, 1), '--range')
    s.checks.equal(done.returncode, 0, '--range is no failure')
    words = [line.split() for line in done.stdout.splitlines() if not line.startswith('#')]
    s.checks.equal(len(words), 1, 'one line for each independent coordinate')
    s.checks.equal(words[0][0], 'q1', 'its name')
    s.checks.near(float(words[0][2]), lower, LIMIT, 'the lower limit')
    s.checks.near(float(words[0][3]), upper, LIMIT, 'the upper limit')
    s.checks.true('deg   closed chain 1 (coordinates 2, 3, 4)' in done.stdout, 'unit and what limits it', done.stdout)


def test_range_of_a_full_turn(s):
    done = s.run(four_bar((0.4, 0.15, 0.35, 0.3), (10.0, 1.0), 1.0, 1), '--range')
    s.checks.true('full turn' in done.stdout, 'a crank that turns fully', done.stdout)


def test_range_without_limits(s):
    done = s.run("""
&mechanism links=3, coordinates=2 /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='helical', axis=1,0,0, pitch=0.1 /
&drive coordinate=1, kind='polynomial', coefficients=0.0 /
&drive coordinate=2, kind='polynomial', coefficients=0.0 /
""", '--range')
    s.checks.equal(len(re.findall('no limit up to', done.stdout)), 4, 'a slide and a screw without an end, both ways')


def test_range_takes_no_argument(s):
    s.checks.equal(s.run('', '--range', '--range=1').returncode, 2, '--range takes no argument')


def check_parallel(s, table, rate, closer=1):
    """The rocker of a parallelogram turns with its crank, whose rate is given in degrees per second. The last position before the
    crossing may stand closer to it, and its pivot be smaller, by a factor."""
    apart = np.radians((table['q4'] - table['q1'] + 180.0) % 360.0 - 180.0)
    s.checks.near(apart, 0.0, AT_CROSSING[0] * closer, 'the rocker turns with the crank')
    s.checks.near(table['dq4'] / rate, 1.0, AT_CROSSING[1] * closer ** 2, 'at the same rate')


def test_crossing_that_is_passed(s):
    """A parallelogram through its flat positions, of which outputs meet one exactly; the report tells of it."""
    text = four_bar((1.0, 0.4, 1.0, 0.4), (60.0, 240.0), 2.25, 54)
    report = os.path.join(s.folder, 'report.json')
    done = s.run(text, '--table', '-', '--report', report)
    s.checks.equal(done.returncode, 0, 'a parallelogram goes through its flat positions')
    table = read_table(done.stdout)
    check_parallel(s, table, 240.0)
    s.checks.near(np.radians(table['ddq4']) / np.radians(240.0) ** 2, 0.0, AT_CROSSING[2], 'evenly')
    s.checks.true('special positions passed: 3' in done.stderr, 'the report counts: 180, 360 and 540 degrees', done.stderr)
    with open(report, encoding='utf-8') as file:
        values = json.load(file)
    s.checks.equal(values['special_positions_passed'], 3, 'and so does its JSON')


def test_start_in_a_crossing_is_refused(s):
    """A start in a flat position is refused with the rates of both ways: a parallelogram's coupler keeps its direction."""
    done = s.run(four_bar((1.0, 0.4, 1.0, 0.4), (0.0, 240.0), 1.0, 10), '--table', '-')
    s.checks.equal(done.returncode, 6, 'a flat start is refused')
    rates = [{int(k): float(rate) for k, rate in re.findall(r'dq(\d) = ([-+.\deE]+)', way)}
             for way in re.search(r'two branches meet: (.*) \(deg/s, m/s\)', done.stderr).group(1).split(' or ')]
    expected = {2: -240.0, 3: 240.0, 4: 240.0}
    # six digits are told
    s.checks.true(any(all(abs(way[k] - rate) <= 5e-6 * 240.0 for k, rate in expected.items()) for way in rates),
                  'the way of the parallelogram, in the units of the file', done.stderr)


@pytest.fixture
def drive_table(s):
    """A table of a drive that ends just in the flat position of a parallelogram."""
    with open(os.path.join(s.folder, 'drive.txt'), 'w', encoding='utf-8') as file:
        file.writelines(f'{i / 10!r} {60.0 + 12.0 * i!r}\n' for i in range(11))


FLAT = (1.0, 0.4, 1.0, 0.4)
BY_TABLE = four_bar(FLAT, (60.0, 0.0), 1.0, 30).replace("kind='polynomial', coefficients=60.0, 0.0", "kind='table', file='drive.txt'")
MOTIONS = {f'a parallelogram, {n} intervals': four_bar(FLAT, (60.0, 240.0, 30.0), 2.25, n) for n in (3, 54, 777)}
MOTIONS.update({f'a dead point, {n} intervals': four_bar((1.2, 0.7, 0.9, 0.4), (40.0, 100.0), 3.0, n) for n in (3, 50, 4000)})
MOTIONS.update({f'an escape, {n} intervals': SLOT.format(intervals=n) for n in (3, 30, 3000)})
MOTIONS['the end of a table'] = BY_TABLE


@pytest.mark.usefixtures('drive_table')
@pytest.mark.parametrize('why', MOTIONS)
def test_positions_without_accelerations(s, why):
    """Without accelerations, or rates, the same positions and the same ends: what lies ahead is seen as well."""
    text, report = MOTIONS[why], os.path.join(s.folder, 'report.json')
    done = s.run(text, '--table', '-', '--report', report)
    whole, counts = read_table(done.stdout), json.loads(text_of(report))
    for derivatives in (0, 1):
        less = s.run(text, '--table', '-', '--report', report, '--set', f'output.derivatives={derivatives}')
        case = f'{why}, {derivatives} derivatives'
        s.checks.equal(less.returncode, done.returncode, f'{case}: the same exit code')
        s.checks.equal(re.findall(r'cannot go on.*', less.stderr), re.findall(r'cannot go on.*', done.stderr),
                       f'{case}: for the same reason at the same time')
        found = json.loads(text_of(report))
        s.checks.equal(found['special_positions_passed'], counts['special_positions_passed'],
                       f'{case}: passes as many special positions')
        if len(whole['t']) > 500:
            s.checks.true(found['acceleration_solutions'] < 0.5 * counts['acceleration_solutions'],
                          f'{case}: it goes on without accelerations beyond them', found['acceleration_solutions'])
        table = read_table(less.stdout)
        if not s.checks.equal(list(table['t']), list(whole['t']), f'{case}: the same times'):
            continue
        for name in table:
            if name[0] == 'q':
                # beside and in a special position they are those of a polynomial through positions near by
                s.checks.near(table[name], whole[name], LIMIT, f'{case}: {name}')


@pytest.mark.usefixtures('drive_table')
def test_table_that_ends_in_a_crossing(s):
    """Rates there are found by their limit."""
    done = s.run(BY_TABLE, '--table', '-')
    s.checks.equal(done.returncode, 0, 'a table that ends in a special position')
    if done.returncode == 0:
        table = read_table(done.stdout)
        s.checks.near(table['q1'][-1], 180.0, 1e-14, 'the last result lies there')
        # without positions beyond it, a third one is taken halfway between the second and the crossing
        check_parallel(s, table, 120.0, closer=2)
    else:
        s.checks.true(False, 'it ends well', done.stderr)


def least_singular_values(lengths, table, first=1, at=0.0, width=None):
    """Of the loop's matrix at each row: turns about its pins as (rotation, velocity/size of the middle of the frame, which
    reaches from 0 to `width`). Its coordinates are `first` and the next ones, its crank's pin stands at x = `at`."""
    ground, crank, coupler, _ = lengths
    width = ground if width is None else width
    size = max(*lengths, width)
    values = []
    for q1, q2 in np.radians(np.stack([table[f'q{first}'], table[f'q{first + 1}']], axis=1)):
        pins = [np.array([at, 0.0]) + crank * np.array([math.cos(q1), math.sin(q1)])]
        pins.append(pins[0] + coupler * np.array([math.cos(q1 + q2), math.sin(q1 + q2)]))
        pins.append(np.array([at + ground, 0.0]))
        columns = [[1.0, pin[1] / size, -(pin[0] - 0.5 * width) / size] for pin in pins]
        values.append(np.linalg.svd(np.array(columns).T, compute_uv=False)[-1])
    return np.array(values)


def compare_conditioning(s, text, name):
    """Column and report of a run of CONDITIONED against the least singular values of its loop."""
    report = os.path.join(s.folder, 'report.json')
    done = s.run(text, '--table', '-', '--report', report)
    if not s.checks.equal(done.returncode, 0, f'{name} runs') or not s.checks.true(done.stdout, f'{name}: a table', done.stderr):
        return
    table = read_table(done.stdout)
    values = least_singular_values(CONDITIONED, table)
    s.checks.near(table['conditioning'] / values, 1.0, ENTRIES / np.min(values), f'{name}: the least singular value of the loop')
    with open(report, encoding='utf-8') as file:
        found = json.load(file)
    least = int(np.argmin(values))
    s.checks.near(found['least_conditioning'] / values[least], 1.0, ENTRIES / np.min(values), f'{name}: its least value in the report')
    s.checks.near(found['least_conditioning_time'], table['t'][least], 1e-15, f'{name}: and when')
    s.checks.true('least conditioning' in done.stderr, f'{name}: also in words', done.stderr)


def test_conditioning(s):
    """The column is the least singular value of the loop's matrix; the report has its least value and when."""
    text = four_bar(CONDITIONED, (0.0, 360.0), 1.0, 90, more='&output conditioning=.true. /')
    compare_conditioning(s, text, 'mech9k')
    report = os.path.join(s.folder, 'report.json')
    table = read_table(s.run(text, '--table', '-').stdout)
    values = least_singular_values(CONDITIONED, table)
    done = s.run(text, '--table', '-', '--report', report, '--set', 'output.conditioning=.false.')
    s.checks.true('conditioning' not in done.stdout, 'no column unless it is asked for')
    with open(report, encoding='utf-8') as file:
        found = json.load(file)
    # not every position is looked at then, but those where the pivots of the matrix have fallen by a hundredth
    row = int(np.argmin(np.abs(table['t'] - found['least_conditioning_time'])))
    s.checks.near(found['least_conditioning_time'], table['t'][row], 1e-15, 'without the column: a time of an output')
    s.checks.near(found['least_conditioning'] / values[row], 1.0, ENTRIES / np.min(values), 'and the value there')
    s.checks.near(found['least_conditioning'] / np.min(values), 1.0, 0.05, 'about as small as it becomes')


def two_chains(first, second, at):
    """A data file: two four-bars on one frame, the crank of the second half a turn behind."""
    lines = ["&mechanism links=7, coordinates=8, angle_unit='deg' /", '&structure cq=1,5 /']
    for k, x, frame, lengths, angle in ((1, 0.0, (1, 2, 3, 4), first, 0.0), (5, at, (1, 5, 6, 7), second, 180.0)):
        ground, crank, coupler, rocker = lengths
        places = (f'{x!r},0,0, moving_point=0,0,0', f'{crank!r},0,0, moving_point=0,0,0',
                  f'{coupler!r},0,0, moving_point={rocker!r},0,0', f'{x + ground!r},0,0, moving_point=0,0,0')
        for i, (links, place) in enumerate(zip(((0, 1), (1, 2), (2, 3), (0, 3)), places)):
            lines.append(f"&pair coordinate={k + i}, links={frame[links[0]]},{frame[links[1]]}, kind='revolute', "
                         f'axis=0,0,1, point={place} /')
        lines += [f'&initial coordinate={k + i}, position={guess!r} /'
                  for i, guess in enumerate(guesses_of(lengths, angle), 1)]
        lines.append(f"&drive coordinate={k}, kind='polynomial', coefficients={angle!r}, 360.0 /")
    return '\n'.join(lines + ['&time start=0, end=1, intervals=90 /', '&output conditioning=.true. /']) + '\n'


def test_conditioning_of_two_chains(s):
    """Of two chains that are solved one after the other it is that of the worse one, now the first, now the second."""
    first, second, at = CONDITIONED, (0.4, 0.16, 0.35, 0.3), 0.5
    report = os.path.join(s.folder, 'report.json')
    done = s.run(two_chains(first, second, at), '--table', '-', '--report', report)
    if not s.checks.equal(done.returncode, 0, f'two four-bars run; stderr: {done.stderr}'):
        return
    table, width = read_table(done.stdout), at + second[0]
    values = [least_singular_values(first, table, 1, 0.0, width), least_singular_values(second, table, 5, at, width)]
    worse = np.argmin(values, axis=0)
    s.checks.equal(set(worse), {0, 1}, 'each chain is the worse one at times')
    s.checks.near(table['conditioning'] / np.min(values, axis=0), 1.0, ENTRIES / np.min(values), 'the least singular value of both loops')
    with open(report, encoding='utf-8') as file:
        found = json.load(file)
    # the last row is the first one again, a turn later: of equal ones the first counts
    least = np.min(values, axis=0)
    row = int(np.argmax(least <= np.min(least) * (1 + 1e-12)))
    s.checks.near(found['least_conditioning_time'], table['t'][row], 1e-15, 'when it is least of all')
    block = found['blocks'][found['least_conditioning_block'] - 1]
    s.checks.equal(sorted(block['unknowns']), [[2, 3, 4], [6, 7, 8]][worse[row]], 'and in which chain')


def test_conditioning_of_a_free_motion(dynamic):
    """The same of a four-bar whose crank is thrown."""
    compare_conditioning(dynamic, four_bar(CONDITIONED, (0.0,), 1.0, 90, more="""&initial coordinate=1, position=0, velocity=300 /
&body link=2, mass=1, centre=0,0,0, inertia=0.1,0.1,0.1,0,0,0 /
&output conditioning=.true. /"""), 'mech9d')


def test_crossings_of_a_free_motion(dynamic):
    """Dynamics of a parallelogram: no coordinate serves in its flat positions; the chain is named."""
    s = dynamic
    moving = '''&initial coordinate=1, position={start!r}, velocity=240.0 /
                &body link=2, mass=1.0, centre=0.2,0,0, inertia=0.01,0.01,0.02,0,0,0 /'''
    for start, words in ((0.0, ['start a little beside it']), (60.0, ['cannot go on from t = '])):
        # with mass on the crank alone and without loads it turns evenly: it is flat at 180 degrees, after 0.5 s
        done = s.run(four_bar((1.0, 0.4, 1.0, 0.4), (start,), 1.0, 10, more=moving.format(start=start)), '--table', '-')
        s.checks.equal(done.returncode, 6, f'dynamics of a parallelogram from {start} degrees: exit code')
        for word in ['closed chain 1 (coordinates 2, 3, 4) is in a singular position', *words]:
            s.checks.true(word in done.stderr, f'dynamics of a parallelogram from {start} degrees: says {word!r}', done.stderr)
    times = read_table(done.stdout)['t']
    s.checks.near(times, np.arange(5) / 10.0, 1e-15, 'the table holds what lies before the flat position')
