"""Dead points, ranges, crossings of branches and conditioning through the whole program, by closed forms.

usage: special_positions.py MECH9K MECH9D
"""
import json
import math
import os
import re
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
import numpy as np

from mech9_cases import Checks, read_table, run

# What is promised of limits; the program does a thousand times better.
LIMIT = 1e-9
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
&drive coordinate={independent}, kind='polynomial', coefficients={drive} /
&time start=0, end={end!r}, intervals={intervals} /
{more}
"""


def four_bar(lengths, drive, end, intervals, branch=1, more=''):
    """A data file: ground, crank, coupler, rocker; the guesses are a closed position of the branch."""
    ground, crank, coupler, rocker = lengths
    angle = math.radians(drive[0])
    x, y = ground - crank * math.cos(angle), -crank * math.sin(angle)
    diagonal = math.hypot(x, y)
    along = (coupler ** 2 - rocker ** 2 + diagonal ** 2) / (2 * diagonal)
    across = branch * math.sqrt(coupler ** 2 - along ** 2)
    px = crank * math.cos(angle) + (along * x - across * y) / diagonal
    py = crank * math.sin(angle) + (along * y + across * x) / diagonal
    link_3, link_4 = math.atan2(py - crank * math.sin(angle), px - crank * math.cos(angle)), math.atan2(py, px - ground)
    guesses = (link_3 - angle, link_4 - link_3, link_4)
    initial = '\n'.join(f'&initial coordinate={k}, position={math.degrees(guess)!r} /' for k, guess in zip((2, 3, 4), guesses))
    return FOUR_BAR.format(ground=ground, crank=crank, coupler=coupler, rocker=rocker, initial=initial, independent=1,
                           drive=', '.join(repr(c) for c in drive), end=end, intervals=intervals, more=more)


def limit(lengths, diagonal):
    """Crank angle in degrees where the diagonal between coupler and rocker has this length."""
    ground, crank = lengths[:2]
    return math.degrees(math.acos((ground ** 2 + crank ** 2 - diagonal ** 2) / (2 * ground * crank)))


class Cases:
    def __init__(self, program, folder):
        self.program, self.folder, self.checks = program, folder, Checks()

    def run(self, text, *options):
        path = os.path.join(self.folder, 'case.nml')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return run(self.program, path, *options, folder=self.folder)


def dead_point(s):
    """The run ends with code 6; the message names time, chain, coordinates and limit; the table is kept."""
    lengths = (1.2, 0.7, 0.9, 0.4)
    end = limit(lengths, lengths[2] + lengths[3])
    for intervals in (3, 50, 4000):
        done = s.run(four_bar(lengths, (40.0, 100.0), 3.0, intervals), '--table', '-')
        s.checks.equal(done.returncode, 6, 'a dead point: exit code 6')
        found = re.search(r'cannot go on beyond t = (\S+) s: closed chain 1 \(coordinates 2, 3, 4\) '
                          r'reaches a dead point at q1 = (\S+) ', done.stderr)
        if s.checks.true(found, 'the message names time, chain, coordinates and driven coordinate', done.stderr):
            s.checks.near(float(found[2]), end, LIMIT, 'the limit by its closed form')
            s.checks.near(float(found[1]), (end - 40.0) / 100.0, LIMIT, 'the time by its closed form')
        table = read_table(done.stdout)
        expected = [3.0 * i / intervals for i in range(intervals + 1) if 40.0 + 300.0 * i / intervals < end]
        s.checks.near(table['t'], expected, 1e-15, 'all results before the dead point are kept, none beyond')
        s.checks.true(all(np.all(np.isfinite(column)) for column in table.values()), 'and all are regular')
        s.checks.true(np.all(table['closure'] < 1e-13), 'and closed')


def ranges(s):
    """--range: limits on both sides in the units of the file, a full turn, none."""
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
    done = s.run(four_bar((0.4, 0.15, 0.35, 0.3), (10.0, 1.0), 1.0, 1), '--range')
    s.checks.true('full turn' in done.stdout, 'a crank that turns fully', done.stdout)
    done = s.run("""
&mechanism links=3, coordinates=2 /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='helical', axis=1,0,0, pitch=0.1 /
&drive coordinate=1, kind='polynomial', coefficients=0.0 /
&drive coordinate=2, kind='polynomial', coefficients=0.0 /
""", '--range')
    s.checks.equal(len(re.findall('no limit up to', done.stdout)), 4, 'a slide and a screw without an end, both ways')
    s.checks.equal(s.run('', '--range', '--range=1').returncode, 2, '--range takes no argument')


def passed(s):
    """A parallelogram through its flat positions, of which outputs meet one exactly; the report tells of it."""
    text = four_bar((1.0, 0.4, 1.0, 0.4), (60.0, 240.0), 2.25, 54)
    report = os.path.join(s.folder, 'report.json')
    done = s.run(text, '--table', '-', '--report', report)
    s.checks.equal(done.returncode, 0, 'a parallelogram goes through its flat positions')
    table = read_table(done.stdout)
    s.checks.near(np.cos(np.radians(table['q4'] - table['q1'])), 1.0, 1e-13, 'the rocker turns with the crank')
    s.checks.near(table['dq4'], 240.0, 1e-8, 'at the same rate')
    s.checks.near(table['ddq4'], 0.0, 1e-4, 'evenly')
    s.checks.true('special positions passed: 3' in done.stderr, 'the report counts: 180, 360 and 540 degrees', done.stderr)
    with open(report, encoding='utf-8') as file:
        values = json.load(file)
    s.checks.equal(values['special_positions_passed'], 3, 'and so does its JSON')


def end_of_table(s):
    """A drive by a table that ends just in the flat position of a parallelogram: rates there by their limit."""
    with open(os.path.join(s.folder, 'drive.txt'), 'w', encoding='utf-8') as file:
        file.writelines(f'{i / 10!r} {60.0 + 12.0 * i!r}\n' for i in range(11))
    text = four_bar((1.0, 0.4, 1.0, 0.4), (60.0, 0.0), 1.0, 30).replace("kind='polynomial', coefficients=60.0, 0.0",
                                                                         "kind='table', file='drive.txt'")
    done = s.run(text, '--table', '-')
    s.checks.equal(done.returncode, 0, 'a table that ends in a special position')
    if done.returncode == 0:
        table = read_table(done.stdout)
        s.checks.near(table['q1'][-1], 180.0, 1e-14, 'the last result lies there')
        s.checks.near(np.cos(np.radians(table['q4'] - table['q1'])), 1.0, 1e-13, 'the rocker turned with the crank')
        s.checks.near(table['dq4'], 120.0, 1e-8, 'at the same rate')
    else:
        s.checks.true(False, 'it ends well', done.stderr)


def least_singular_values(lengths, table):
    """Of the loop's matrix at each row: turns about its pins as (rotation, velocity/size of the middle of the ground)."""
    ground, crank, coupler, _ = lengths
    size = max(lengths)
    values = []
    for q1, q2 in np.radians(np.stack([table['q1'], table['q2']], axis=1)):
        pins = [crank * np.array([math.cos(q1), math.sin(q1)])]
        pins.append(pins[0] + coupler * np.array([math.cos(q1 + q2), math.sin(q1 + q2)]))
        pins.append(np.array([ground, 0.0]))
        columns = [[1.0, pin[1] / size, -(pin[0] - 0.5 * ground) / size] for pin in pins]
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
    s.checks.near(table['conditioning'] / values, 1.0, 1e-11, f'{name}: the least singular value of the loop')
    with open(report, encoding='utf-8') as file:
        found = json.load(file)
    least = int(np.argmin(values))
    s.checks.near(found['least_conditioning'] / values[least], 1.0, 1e-11, f'{name}: its least value in the report')
    s.checks.near(found['least_conditioning_time'], table['t'][least], 1e-15, f'{name}: and when')
    s.checks.true('least conditioning' in done.stderr, f'{name}: also in words', done.stderr)


def conditioning(s):
    """The column is the least singular value of the loop's matrix; the report has its least value and when."""
    text = four_bar(CONDITIONED, (0.0, 360.0), 1.0, 90, more='&output conditioning=.true. /')
    compare_conditioning(s, text, 'mech9k')
    s.checks.true('conditioning' not in s.run(text, '--table', '-', '--set', 'output.conditioning=.false.').stdout,
                  'no column unless it is asked for')


def conditioning_of_motion(s):
    """The same of a four-bar whose crank is thrown."""
    compare_conditioning(s, four_bar(CONDITIONED, (0.0, 360.0), 1.0, 90, more="""&initial coordinate=1, position=0, velocity=300 /
&body link=2, mass=1, centre=0,0,0, inertia=0.1,0.1,0.1,0,0,0 /
&output conditioning=.true. /"""), 'mech9d')


def main():
    with tempfile.TemporaryDirectory() as folder:
        s = Cases(os.path.abspath(sys.argv[1]), folder)
        for case in (dead_point, ranges, passed, end_of_table, conditioning):
            case(s)
        s.program = os.path.abspath(sys.argv[2])
        conditioning_of_motion(s)
        s.checks.finish()


main()
