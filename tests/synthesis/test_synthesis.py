"""Synthesis by --optimize: dimensions that are recovered from the motion that they made, in the plane and in space, with given
and free times and as functions; the eighteen timed points of the literature, whose designs are recomputed by the closed form of a
four-bar linkage and must turn fully; the data file of the best design; the same bits again; mistakes.
"""
import os
import shutil

import numpy as np
import pytest

from mech9_cases import TREE, Checks, text_of
from synthesis_cases import ASSEMBLY, DATA, FILE, FOUR_BAR, LENGTHS, USAGE, Cases, is_recovered, targets, with_numbers

SPATIAL = """&parameter name='crank', sets='pair(2).point(1)','pair(3).point(1)','pair(4).point(1)', value=CRANK, low=0.1, high=0.3 /
&parameter name='tilt', sets='pair(7).axis(2)', value=TILT, low=-0.3, high=0.3 /
&parameter name='height', sets='pair(7).point(3)', value=HEIGHT, low=-0.3, high=0.1 /
"""


# Lengths of a four-bar linkage, which are found again from the path of its coupler point, and from the motion of its rocker.
MADE = dict(CRANK=0.5, COUPLER=1.8, ROCKER=1.5)
NAMES = dict(crank=0.5, coupler=1.8, rocker=1.5)
ROUGH = with_numbers(FOUR_BAR, CRANK=0.4, COUPLER=2.2, ROCKER=1.9)
PATH = "&objective kind='path', point='P', file='targets.dat', timing='given' /\n"
FOUR = '&optimum starts=4 /\n'


@pytest.fixture
def cases(checks, tmp_path, mech9k):
    return Cases(checks, tmp_path, mech9k)


@pytest.fixture
def made(cases):
    """The motion that the wanted lengths make."""
    return cases.motion(with_numbers(FOUR_BAR, **MADE))


def test_lengths_from_a_path_with_given_times(cases, made):
    targets(cases, [made['t'][::3], made['P.x'][::3], made['P.y'][::3]])
    designs, report, _ = cases.search(ROUGH + LENGTHS + FOUR + PATH, 'given times')
    is_recovered(cases, designs, NAMES, 'given times')
    cases.checks.equal(sorted(report['optimum']), ['parameters', 'reached', 'starts', 'value'], 'the report has the optimum')
    cases.checks.near([one['value'] for one in report['optimum']['parameters']], list(NAMES.values()), 1e-9, 'with its parameters')
    cases.checks.equal((report['optimum']['starts'], report['optimum']['reached']), (4, int(designs['starts'][0])), 'and its starts')


def test_lengths_and_the_start_of_the_crank(cases, made):
    targets(cases, [made['t'][::3], made['P.x'][::3], made['P.y'][::3]])
    angle = ROUGH.replace('coefficients=10', 'coefficients=40')
    angle += LENGTHS + PATH + FOUR + "&parameter name='angle', sets='drive.coefficients(1)', low=-30, high=60 /\n"
    designs, _, _ = cases.search(angle, 'start of the crank')
    is_recovered(cases, designs, dict(NAMES, angle=10), 'start of the crank')


def test_lengths_from_a_path_with_free_times(cases, made):
    """The path alone, in the middle part of the turn: the times are found with it."""
    part = slice(4, 20, 3)
    targets(cases, [made['P.x'][part], made['P.y'][part]])
    designs, _, _ = cases.search(ROUGH + LENGTHS + FOUR + PATH.replace(", timing='given'", ''), 'free times')
    is_recovered(cases, designs, NAMES, 'free times', tolerance=1e-7)


@pytest.mark.parametrize('over', ('q1', 't'))
def test_lengths_from_a_function(cases, made, over):
    """The rocker over the crank, and over time."""
    targets(cases, [made[over][1:20:2], made['q4'][1:20:2]])
    function = "&objective kind='function', of='q4', file='targets.dat'" + (f", over='{over}'" if over != 't' else '') + ' /\n'
    designs, _, _ = cases.search(ROUGH + LENGTHS + FOUR + function, f'function of {over}')
    is_recovered(cases, designs, NAMES, f'function of {over}')


def test_value_of_objectives_with_weights_is_the_weighted_sum(cases, made):
    targets(cases, [made['t'][::3], made['P.x'][::3] + 0.1, made['P.y'][::3]])
    rough = ROUGH + LENGTHS + FOUR
    one, _, _ = cases.search(rough + PATH, 'one objective')
    two, _, _ = cases.search(rough + PATH.replace(' /', ', weight=2 /') + PATH.replace(' /', ', weight=3 /'), 'two objectives')
    cases.checks.near(two['value'][0], 5*one['value'][0], 1e-9, 'weights are factors of the sums of squares')


# A harmonic drive stands before one whose coefficients are set for each design.
TWO_DRIVES = FOUR_BAR.replace('cq=1', 'cq=1,5') \
    .replace("kind='polynomial', coefficients=10, 30", "kind='harmonic', mean=60, amplitude=50, angular_frequency=30") \
    .replace('link=3, position=0.7,0.6,0', 'link=5, position=0.3,0,0') + """\
&pair coordinate=5, links=3,5, kind='revolute', axis=0,0,1, point=0.7,0.6,0, moving_point=0,0,0 /
&drive coordinate=5, kind='polynomial', coefficients=20, 15 /
"""


@pytest.mark.parametrize('with_angle', (False, True), ids=('without a parameter', 'one with a parameter'))
def test_two_drives(cases, with_angle):
    made = cases.motion(with_numbers(TWO_DRIVES, **MADE))
    targets(cases, [made['t'][::3], made['P.x'][::3], made['P.y'][::3]])
    text = with_numbers(TWO_DRIVES, CRANK=0.4, COUPLER=2.2, ROCKER=1.9) + LENGTHS + PATH + FOUR
    if with_angle:
        text = text.replace('coefficients=20, 15', 'coefficients=50, 15') + "&parameter name='angle', sets='drive(2).coefficients(1)', low=-30, high=60 /\n"
    designs, _, _ = cases.search(text, 'two drives')
    is_recovered(cases, designs, dict(NAMES, angle=20) if with_angle else NAMES, 'two drives')


def test_a_spatial_crank_and_rocker(cases):
    """A length, a place and the direction of an axis: the numbers are not affine in the parameters."""
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


class Found:
    """The search for eighteen timed points."""

    def __init__(self, folder, mech9k):
        self.folder = folder
        source = os.path.join(TREE, 'examples', 'timed_path')
        for name in ('timed_path.nml', 'eighteen_points.dat'):
            shutil.copy(os.path.join(source, name), folder)
        self.text = text_of(os.path.join(source, 'timed_path.nml'))
        self.points = np.loadtxt(os.path.join(source, 'eighteen_points.dat'))[:, 1:]
        self.best = os.path.join(folder, 'best.nml')
        checks = Checks()
        self.designs, self.report, self.printed = Cases(checks, folder, mech9k).search(self.text, 'eighteen points', '--out', self.best)
        checks.verdict()


@pytest.fixture(scope='module')
def eighteen(tmp_path_factory, mech9k):
    return Found(tmp_path_factory.mktemp('eighteen'), mech9k)


@pytest.fixture
def again(checks, eighteen, mech9k):
    """Further searches and runs in the folder of that search."""
    return Cases(checks, eighteen.folder, mech9k)


def test_eighteen_points_have_the_value_of_their_closed_form(checks, eighteen):
    """The designs of the classic problem. A crank turns fully where it and the longest bar are no longer than the others together,
    and it or the frame is the shortest (Grashof); then no design changes its branch."""
    designs = eighteen.designs
    # the least value that was found from thousands of starts
    checks.near(designs['value'][0]/0.00902888, 1, 1e-6, 'eighteen points: the best value')
    checks.true(np.all(np.diff(designs['value']) >= 0), 'the best design stands first')
    for i in range(len(designs['value'])):
        row = {name: float(designs[name][i]) for name in designs}
        checks.near(value_by_closed_form(row, eighteen.points)/row['value'], 1, 1e-7, 'the closed form has the same value')
        bars = [row['crank'], row['coupler'], row['rocker'], np.hypot(row['bx'] - row['ax'], row['by'] - row['ay'])]
        checks.true(2*(min(bars) + max(bars)) <= sum(bars)*(1 + 1e-9) and min(bars) in (bars[0], bars[3]), 'the crank turns fully',
                    str(bars))
        checks.true(all(-50 <= row[name] <= 50 for name in ('ax', 'ay', 'bx', 'by', 'px', 'py')), 'the bounds hold')
    printed = eighteen.printed
    checks.true('least value: 0.00902888' in printed and 'best design: ' in printed, 'both are told', printed)


def test_another_search_has_the_same_bits(again, eighteen):
    designs, _, _ = again.search(eighteen.text, 'again')
    again.checks.true(all(np.array_equal(designs[name], eighteen.designs[name]) for name in eighteen.designs), 'another search has the same bits')


def test_more_starts_lose_nothing(again, eighteen):
    more, _, _ = again.search(eighteen.text, 'more starts', '--set', 'optimum.starts=22')
    again.checks.true(more['value'][0] <= eighteen.designs['value'][0], 'more starts lose nothing')


def test_data_file_of_the_best_design_repeats_it(again, eighteen):
    points, value = eighteen.points, eighteen.designs['value'][0]
    made = again.motion(text_of(eighteen.best), '--set', 'time.end=17', '--set', 'time.intervals=17')
    found = np.sum((made['P.x'] - points[:, 0])**2 + (made['P.y'] - points[:, 1])**2)
    again.checks.near(found/value, 1, 1e-9, 'the best design repeats its value in a run')
    repeated, _, _ = again.search(text_of(eighteen.best), 'from the best design', '--set', 'optimum.starts=1')
    again.checks.near(repeated['value'][0]/value, 1, 1e-9, 'it is a start from which nothing better is near')


GOOD = with_numbers(FOUR_BAR, **MADE)
TWO = '0 1 1\n1 1 1.1\n'
FUNCTION = "&objective kind='function', of='q4', over='q1', file='targets.dat' /\n"
ANGLES = '10 1\n20 2\n'


@pytest.mark.parametrize('file, text, words, code, options', (
    (TWO, GOOD + LENGTHS, 'this file has none', USAGE, ()),
    (TWO, GOOD + PATH, "give 'low' and 'high' in at least one &parameter", DATA, ()),
    (TWO, GOOD + LENGTHS.replace(', high=0.8', '') + PATH, "both 'low' and 'high'", DATA, ()),
    (TWO, GOOD + LENGTHS + PATH.replace("'P'", "'Q'"), "there is no &point 'Q'; the only one is P", DATA, ()),
    (TWO, GOOD + LENGTHS + PATH.replace('targets', 'missing'), 'the targets', FILE, ()),
    (TWO, GOOD + LENGTHS + PATH, '--study and --optimize are different tasks', USAGE, ('--study',)),
    (TWO, GOOD + LENGTHS + PATH, 'leave --verbose out', USAGE, ('--verbose',)),
    (TWO, GOOD + LENGTHS + PATH, 'would not have the changes by --set', USAGE, ('--out', 'x.nml', '--set', 'time.end=11')),
    (TWO, GOOD + LENGTHS + FUNCTION, 'each line holds the variable and the value of the function; this one has 3 numbers', DATA, ()),
    (ANGLES, GOOD + LENGTHS + FUNCTION.replace('q4', 'q5'), "there is no coordinate 'q5'; there are q1, q2, q3, q4", DATA, ()),
    (ANGLES, GOOD + LENGTHS + FUNCTION.replace("over='q1'", "over='q3'"), 't or a coordinate with a drive', DATA, ()),
    ('0 1 1\n', GOOD + LENGTHS + PATH, 'at least two targets, and the file has 1', DATA, ()),
    ('0 1 1\n1 1\n', GOOD + LENGTHS + PATH, 'this one has 2 numbers', DATA, ()),
    ('0 1 1\n1 1 x\n', GOOD + LENGTHS + PATH, "'x' ", DATA, ()),
    ('0 1 1\n13 1 1\n', GOOD + LENGTHS + PATH, 'target 2 is at t = 13 s, and the run goes from 0 to 12 s', DATA, ()),
    # a crank that is longer than all other bars together is never assembled
    (TWO, GOOD + LENGTHS.replace('low=0.2, high=0.8', 'low=0.4, high=0.6').replace('low=1, high=3', 'low=0.1, high=0.2') + PATH,
     'no start led to a design', ASSEMBLY, ())),
    ids=('no objective', 'no parameter', 'no range', 'unknown point', 'missing file', 'study', 'verbose', 'out and set', 'three numbers',
         'unknown coordinate', 'no drive', 'one target', 'two numbers', 'a word', 'a late target', 'never assembled'))
def test_refused(cases, file, text, words, code, options):
    cases.write(file, 'targets.dat')
    cases.refused(text, words, code, *options)
