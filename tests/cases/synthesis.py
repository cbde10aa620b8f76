"""Synthesis by --optimize: dimensions that are recovered from the motion that they made, in the plane and in space, with given
and free times and as functions; the eighteen timed points of the literature, whose designs are recomputed by the closed form of a
four-bar linkage and must turn fully; the data file of the best design; the same bits again; mistakes.

usage: synthesis.py MECH9K
"""
import json
import os
import shutil
import sys
import tempfile

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from mech9_cases import TREE, Checks, read_table, run, text_of

DONE, USAGE, DATA, ASSEMBLY, FILE = 0, 2, 3, 5, 8
FOUR_BAR = """&mechanism angle_unit='deg' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0, moving_point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=CRANK,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=COUPLER,0,0, moving_point=ROCKER,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', axis=0,0,1, point=2,0.1,0, moving_point=0,0,0 /
&initial coordinate=2, position=50 /
&initial coordinate=3, position=60 /
&initial coordinate=4, position=100 /
&point name='P', link=3, position=0.7,0.6,0 /
&drive coordinate=1, kind='polynomial', coefficients=10, 30 /
&time end=12, intervals=24 /
"""
LENGTHS = """&parameter name='crank', sets='pair(2).point(1)', low=0.2, high=0.8 /
&parameter name='coupler', sets='pair(3).point(1)', low=1, high=3 /
&parameter name='rocker', sets='pair(3).moving_point(1)', low=1, high=3 /
"""
SPATIAL = """&parameter name='crank', sets='pair(2).point(1)','pair(3).point(1)','pair(4).point(1)', value=CRANK, low=0.1, high=0.3 /
&parameter name='tilt', sets='pair(7).axis(2)', value=TILT, low=-0.3, high=0.3 /
&parameter name='height', sets='pair(7).point(3)', value=HEIGHT, low=-0.3, high=0.1 /
"""


class Cases:
    def __init__(self, checks, folder, program):
        self.checks, self.folder, self.program = checks, folder, program

    def write(self, text, name='case.nml'):
        path = os.path.join(self.folder, name)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return path

    def motion(self, text, *options):
        """The table of a single run."""
        table = os.path.join(self.folder, 'motion.dat')
        done = run(self.program, self.write(text, 'motion.nml'), '--table', table, '--quiet', *options)
        self.checks.true(done.returncode == DONE, 'the motion runs', done.stderr)
        return read_table(text_of(table))

    def search(self, text, why, *options):
        """The designs that a search finds, its report, and what it prints."""
        table, report = (os.path.join(self.folder, name) for name in ('designs.dat', 'report.json'))
        done = run(self.program, self.write(text), '--optimize', '--table', table, '--report', report, *options)
        self.checks.true(done.returncode == DONE, f'{why}: goes through', done.stderr)
        with open(report, encoding='utf-8') as file:
            return read_table(text_of(table)), json.load(file), done.stderr

    def refused(self, text, words, code=DATA, *options):
        done = run(self.program, self.write(text), '--optimize', *options)
        self.checks.true(done.returncode == code and words in done.stderr, f'refused: {words}',
                         f'code {done.returncode}\n{done.stderr}')


def with_numbers(text, **numbers):
    for name, value in numbers.items():
        text = text.replace(name, f'{float(value)!r}')
    return text


def targets(cases, columns):
    cases.write('\n'.join(' '.join(f'{float(x)!r}' for x in row) for row in np.transpose(columns)) + '\n', 'targets.dat')


def is_recovered(cases, designs, expected, why, value=1e-24, tolerance=1e-9):
    """The best design is the one that made the targets. Steps end at round-off, which only exact derivatives bring about."""
    cases.checks.true(designs['value'][0] <= value, f'{why}: nothing is left of the differences', str(designs['value']))
    for name, number in expected.items():
        cases.checks.near(designs[name][0], number, tolerance, f'{why}: {name} is found again')


def recovered_planar(cases):
    """Lengths of a four-bar linkage from the path of its coupler point, and from the motion of its rocker."""
    lengths = dict(CRANK=0.5, COUPLER=1.8, ROCKER=1.5)
    names = dict(crank=0.5, coupler=1.8, rocker=1.5)
    made = cases.motion(with_numbers(FOUR_BAR, **lengths))
    rough = with_numbers(FOUR_BAR, CRANK=0.4, COUPLER=2.2, ROCKER=1.9) + LENGTHS + '&optimum starts=4 /\n'
    targets(cases, [made['t'][::3], made['P.x'][::3], made['P.y'][::3]])
    path = "&objective kind='path', point='P', file='targets.dat', timing='given' /\n"
    designs, report, _ = cases.search(rough + path, 'given times')
    is_recovered(cases, designs, names, 'given times')
    cases.checks.equal(sorted(report['optimum']), ['parameters', 'reached', 'starts', 'value'], 'the report has the optimum')
    cases.checks.near([one['value'] for one in report['optimum']['parameters']], list(names.values()), 1e-9, 'with its parameters')
    cases.checks.equal((report['optimum']['starts'], report['optimum']['reached']), (4, int(designs['starts'][0])), 'and its starts')
    angle = with_numbers(FOUR_BAR, CRANK=0.4, COUPLER=2.2, ROCKER=1.9).replace('coefficients=10', 'coefficients=40')
    angle += LENGTHS + path + "&optimum starts=4 /\n&parameter name='angle', sets='drive.coefficients(1)', low=-30, high=60 /\n"
    designs, _, _ = cases.search(angle, 'start of the crank')
    is_recovered(cases, designs, dict(names, angle=10), 'start of the crank')
    # the path alone, in the middle part of the turn: the times are found with it
    part = slice(4, 20, 3)
    targets(cases, [made['P.x'][part], made['P.y'][part]])
    designs, _, _ = cases.search(rough + path.replace(", timing='given'", ''), 'free times')
    is_recovered(cases, designs, names, 'free times', tolerance=1e-7)
    # the rocker over the crank, and over time
    for over in ('q1', 't'):
        targets(cases, [made[over][1:20:2], made['q4'][1:20:2]])
        function = f"&objective kind='function', of='q4', file='targets.dat'" + (f", over='{over}'" if over != 't' else '') + ' /\n'
        designs, _, _ = cases.search(rough + function, f'function of {over}')
        is_recovered(cases, designs, names, f'function of {over}')
    # two objectives with weights: the value is the weighted sum
    targets(cases, [made['t'][::3], made['P.x'][::3] + 0.1, made['P.y'][::3]])
    one, _, _ = cases.search(rough + path, 'one objective')
    two, _, _ = cases.search(rough + path.replace(' /', ', weight=2 /') + path.replace(' /', ', weight=3 /'), 'two objectives')
    cases.checks.near(two['value'][0], 5*one['value'][0], 1e-9, 'weights are factors of the sums of squares')


def several_drives(cases):
    """A harmonic drive stands before one whose coefficients are set for each design."""
    text = FOUR_BAR.replace('cq=1', 'cq=1,5').replace("kind='polynomial', coefficients=10, 30", "kind='harmonic', mean=60, amplitude=50, angular_frequency=30")
    text = text.replace("link=3, position=0.7,0.6,0", 'link=5, position=0.3,0,0')
    text += """&pair coordinate=5, links=3,5, kind='revolute', axis=0,0,1, point=0.7,0.6,0, moving_point=0,0,0 /
&drive coordinate=5, kind='polynomial', coefficients=20, 15 /
"""
    made = cases.motion(with_numbers(text, CRANK=0.5, COUPLER=1.8, ROCKER=1.5))
    targets(cases, [made['t'][::3], made['P.x'][::3], made['P.y'][::3]])
    text = with_numbers(text, CRANK=0.4, COUPLER=2.2, ROCKER=1.9) + LENGTHS
    text += "&objective kind='path', point='P', file='targets.dat', timing='given' /\n&optimum starts=4 /\n"
    lengths = dict(crank=0.5, coupler=1.8, rocker=1.5)
    designs, _, _ = cases.search(text, 'two drives')
    is_recovered(cases, designs, lengths, 'two drives')
    text = text.replace('coefficients=20, 15', 'coefficients=50, 15') + "&parameter name='angle', sets='drive(2).coefficients(1)', low=-30, high=60 /\n"
    designs, _, _ = cases.search(text, 'two drives, one with a parameter')
    is_recovered(cases, designs, dict(lengths, angle=20), 'two drives, one with a parameter')


def recovered_spatial(cases):
    """A length, a place and the direction of an axis of a spatial crank and rocker: the numbers are not affine in the parameters."""
    rsur = text_of(os.path.join(TREE, 'examples', 'rsur', 'rsur.nml')) + SPATIAL
    rsur = rsur.replace('axis=1,0,0, point=0.3', 'axis=1,0,0.01, point=0.3')
    wanted = dict(crank=0.23, tilt=0.12, height=-0.03)
    made = cases.motion(with_numbers(rsur, **{name.upper(): number for name, number in wanted.items()}))
    targets(cases, [made['t'][::10], made['B.x'][::10], made['B.y'][::10], made['B.z'][::10]])
    rough = with_numbers(rsur, CRANK=0.2, TILT=0, HEIGHT=-0.1)
    rough += "&objective kind='path', point='B', file='targets.dat', timing='given' /\n&optimum starts=2 /\n"
    designs, _, _ = cases.search(rough, 'spatial')
    is_recovered(cases, designs, wanted, 'spatial')


def value_by_closed_form(row, points):
    """Least sum of squares over both assemblies of a four-bar linkage, by the triangle at the rocker."""
    theta = np.radians(row['angle'] + 20*np.arange(len(points)))
    ax, ay = row['ax'] + row['crank']*np.cos(theta), row['ay'] + row['crank']*np.sin(theta)
    dx, dy = row['bx'] - ax, row['by'] - ay
    d = np.hypot(dx, dy)
    c = (d**2 + row['coupler']**2 - row['rocker']**2)/(2*d*row['coupler'])
    if np.any(np.abs(c) > 1):
        return np.inf
    sums = []
    for sign in (1, -1):
        phi = np.arctan2(dy, dx) + sign*np.arccos(c)
        x = ax + row['px']*np.cos(phi) - row['py']*np.sin(phi)
        y = ay + row['px']*np.sin(phi) + row['py']*np.cos(phi)
        sums.append(np.sum((x - points[:, 0])**2 + (y - points[:, 1])**2))
    return min(sums)


def eighteen_points(cases):
    """The designs of the classic problem. A crank turns fully where it and the longest bar are no longer than the others together,
    and it or the frame is the shortest (Grashof); then no design changes its branch."""
    folder = os.path.join(TREE, 'examples', 'timed_path')
    for name in ('timed_path.nml', 'eighteen_points.dat'):
        shutil.copy(os.path.join(folder, name), cases.folder)
    text = text_of(os.path.join(folder, 'timed_path.nml'))
    best = os.path.join(cases.folder, 'best.nml')
    designs, report, printed = cases.search(text, 'eighteen points', '--out', best)
    check = cases.checks
    # the least value that was found from thousands of starts
    check.near(designs['value'][0]/0.00902888, 1, 1e-6, 'eighteen points: the best value')
    check.true(np.all(np.diff(designs['value']) >= 0), 'the best design stands first')
    points = np.loadtxt(os.path.join(folder, 'eighteen_points.dat'))[:, 1:]
    names = list(designs)
    for i in range(len(designs['value'])):
        row = {name: float(designs[name][i]) for name in names}
        check.near(value_by_closed_form(row, points)/row['value'], 1, 1e-7, 'the closed form has the same value')
        bars = [row['crank'], row['coupler'], row['rocker'], np.hypot(row['bx'] - row['ax'], row['by'] - row['ay'])]
        check.true(2*(min(bars) + max(bars)) <= sum(bars)*(1 + 1e-9) and min(bars) in (bars[0], bars[3]), 'the crank turns fully',
                   str(bars))
        check.true(all(-50 <= row[name] <= 50 for name in ('ax', 'ay', 'bx', 'by', 'px', 'py')), 'the bounds hold')
    again, _, _ = cases.search(text, 'again')
    check.true(all(np.array_equal(again[name], designs[name]) for name in names), 'another search has the same bits')
    more, _, _ = cases.search(text, 'more starts', '--set', 'optimum.starts=22')
    check.true(more['value'][0] <= designs['value'][0], 'more starts lose nothing')
    # the data file of the best design repeats it
    made = cases.motion(text_of(best), '--set', 'time.end=17', '--set', 'time.intervals=17')
    value = np.sum((made['P.x'] - points[:, 0])**2 + (made['P.y'] - points[:, 1])**2)
    check.near(value/designs['value'][0], 1, 1e-9, 'the best design repeats its value in a run')
    repeated, _, _ = cases.search(text_of(best), 'from the best design', '--set', 'optimum.starts=1')
    check.near(repeated['value'][0]/designs['value'][0], 1, 1e-9, 'it is a start from which nothing better is near')
    check.true('least value: 0.00902888' in printed and 'best design: ' in printed, 'both are told', printed)


def mistakes(cases):
    path = "&objective kind='path', point='P', file='targets.dat', timing='given' /\n"
    good = with_numbers(FOUR_BAR, CRANK=0.5, COUPLER=1.8, ROCKER=1.5)
    cases.write('0 1 1\n1 1 1.1\n', 'targets.dat')
    cases.refused(good + LENGTHS, 'this file has none', USAGE)
    cases.refused(good + path, "give 'low' and 'high' in at least one &parameter")
    cases.refused(good + LENGTHS.replace(', high=0.8', '') + path, "both 'low' and 'high'")
    cases.refused(good + LENGTHS + path.replace("'P'", "'Q'"), "there is no &point 'Q'; the only one is P")
    cases.refused(good + LENGTHS + path.replace('targets', 'missing'), 'the targets', FILE)
    cases.refused(good + LENGTHS + path, '--study and --optimize are different tasks', USAGE, '--study')
    cases.refused(good + LENGTHS + path, 'leave --verbose out', USAGE, '--verbose')
    cases.refused(good + LENGTHS + path, 'would not have the changes by --set', USAGE, '--out', 'x.nml', '--set', 'time.end=11')
    function = "&objective kind='function', of='q4', over='q1', file='targets.dat' /\n"
    cases.refused(good + LENGTHS + function, 'each line holds the variable and the value of the function; this one has 3 numbers')
    cases.write('10 1\n20 2\n', 'targets.dat')
    cases.refused(good + LENGTHS + function.replace('q4', 'q5'), "there is no coordinate 'q5'; there are q1, q2, q3, q4")
    cases.refused(good + LENGTHS + function.replace("over='q1'", "over='q3'"), 't or a coordinate with a drive')
    for text, words in (('0 1 1\n', 'at least two targets, and the file has 1'), ('0 1 1\n1 1\n', 'this one has 2 numbers'),
                        ('0 1 1\n1 1 x\n', "'x' "), ('0 1 1\n13 1 1\n', 'target 2 is at t = 13 s, and the run goes from 0 to 12 s')):
        cases.write(text, 'targets.dat')
        cases.refused(good + LENGTHS + path, words)
    # a crank that is longer than all other bars together is never assembled
    cases.write('0 1 1\n1 1 1.1\n', 'targets.dat')
    locked = LENGTHS.replace('low=0.2, high=0.8', 'low=0.4, high=0.6').replace('low=1, high=3', 'low=0.1, high=0.2')
    cases.refused(good + locked + path, 'no start led to a design', ASSEMBLY)


def main():
    checks = Checks()
    with tempfile.TemporaryDirectory() as folder:
        cases = Cases(checks, folder, sys.argv[1])
        recovered_planar(cases)
        several_drives(cases)
        recovered_spatial(cases)
        eighteen_points(cases)
        mistakes(cases)
    checks.finish()


if __name__ == '__main__':
    main()
