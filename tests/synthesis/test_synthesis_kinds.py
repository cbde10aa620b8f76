"""Synthesis by --optimize beyond paths and functions: poses, quantities and limits. Designs are recovered from poses and quantities that
they made; results within limits satisfy the conditions of Karush, Kuhn and Tucker, with closed forms of a four-bar linkage and with
differences of runs; free times that meet are minima in their order; one result from any number of threads; mistakes.
"""
import os

import numpy as np
import pytest

from mech9_cases import run, text_of
from synthesis_cases import DONE, FOUR_BAR, LENGTHS, Cases, gradient, is_optimal, is_recovered, targets, with_numbers

MADE = dict(CRANK=0.5, COUPLER=1.8, ROCKER=1.5)
NAMES = dict(crank=0.5, coupler=1.8, rocker=1.5)
ROUGH = with_numbers(FOUR_BAR, CRANK=0.4, COUPLER=2.2, ROCKER=1.9) + LENGTHS + '&optimum starts=6 /\n'
QUANTITIES = """&quantity name='stroke', of='q4', take='range' /
&quantity name='mean', of='P.x', take='mean' /
&quantity name='height', of='P.y', take='max' /
"""
STROKE = "&objective kind='quantity', of='stroke', make='largest' /\n"


PATH = "&objective kind='path', point='P', file='targets.dat', timing='given' /\n"
POSE = "&objective kind='pose', link=3, file='targets.dat', timing='given' /\n"
TRANSMISSION = "&limit kind='transmission', coordinate=3, at_least=40 /\n"


@pytest.fixture
def cases(checks, tmp_path, mech9k):
    return Cases(checks, tmp_path, mech9k)


@pytest.fixture
def made(cases):
    """The motion that the wanted lengths make."""
    return cases.motion(with_numbers(FOUR_BAR, **MADE))


@pytest.fixture
def posed(cases):
    """Times, places and angles of the coupler."""
    axes = "&point name='O', link=3, position=0,0,0 /\n&point name='X', link=3, position=1,0,0 /\n"
    made = cases.motion(with_numbers(FOUR_BAR, **MADE) + axes)
    angle = np.degrees(np.unwrap(np.arctan2(made['X.y'] - made['O.y'], made['X.x'] - made['O.x'])))
    part = slice(1, 20, 3)
    return made['t'][part], made['O.x'][part], made['O.y'][part], angle[part]


@pytest.mark.parametrize('why', ('given times', 'free times', 'rotation vectors'))
def test_a_design_is_recovered_from_poses_of_its_coupler(cases, posed, why):
    """In the plane with given and with free times, and in space."""
    t, x, y, angle = posed
    columns, objective = {
        'given times': ([t, x, y, angle], POSE),
        'free times': ([x, y, angle], POSE.replace(", timing='given'", '')),
        'rotation vectors': ([t, x, y, 0*t, 0*t, 0*t, angle], POSE.replace('/', ', length=0.3 /'))}[why]
    targets(cases, columns)
    designs, _, _ = cases.search(ROUGH + objective, f'poses: {why}')
    is_recovered(cases, designs, NAMES, f'poses: {why}', tolerance=1e-7 if why == 'free times' else 1e-9)


@pytest.mark.parametrize('shift, turn', ((1e-3, 0.0), (0.0, 1.0), (0.0, 30.0)))
def test_value_of_poses(cases, posed, shift, turn):
    """One degree more, and one millimetre: the value is their squares, the angle times the length."""
    t, x, y, angle = posed
    held = with_numbers(FOUR_BAR, **MADE) + "&parameter name='crank', sets='pair(2).point(1)', low=0.5, high=0.5000000001 /\n"
    targets(cases, [t, x + shift, y, angle + turn])
    designs, _, _ = cases.search(held + POSE.replace('/', ', length=0.3, weight=2 /') + '&optimum starts=1 /\n', 'value of poses')
    cases.checks.near(designs['value'][0], 2*len(t)*(shift**2 + (0.3*np.radians(turn))**2), 1e-8, f'value of poses {shift} {turn}')


def test_goals_of_three_quantities(cases):
    """Three quantities of a design lead back to it, or to another design with the same quantities."""
    cases.motion(with_numbers(FOUR_BAR, **MADE) + QUANTITIES)
    numbers = quantities_of(cases, with_numbers(FOUR_BAR, **MADE) + QUANTITIES)
    wanted = ''.join(f"&objective kind='quantity', of='{name}', goal={number!r} /\n" for name, number in numbers.items())
    designs, _, _ = cases.search(ROUGH + QUANTITIES + wanted, 'goals', '--out', os.path.join(cases.folder, 'best.nml'))
    cases.checks.true(designs['value'][0] < 1e-18, 'goals: all are met', str(designs['value']))
    best = quantities_of(cases, text_of(os.path.join(cases.folder, 'best.nml')))
    for name, number in numbers.items():
        cases.checks.near(best[name], number, 1e-8, f'goals: {name} of the best design')


def quantities_of(cases, text, *options):
    """The quantities that a run prints."""
    done = run(cases.program, cases.write(text, 'quantities.nml'), '--no-write', *options)
    cases.checks.true(done.returncode == DONE, 'the run goes through', done.stderr)
    found = {}
    for line in done.stderr.splitlines():
        words = line.split()
        if len(words) >= 3 and words[1] == '=' and not words[0].startswith('d('):
            found[words[0]] = float(words[2])
    return found


def stroke_and_transmission(x):
    """Swing of the rocker [deg] and extreme cosines of the transmission angle of the four-bar linkage, for a crank that turns fully."""
    crank, coupler, rocker = x
    frame = np.hypot(2, 0.1)

    def at_rocker(reach):
        return np.degrees(np.arccos((frame**2 + rocker**2 - reach**2)/(2*frame*rocker)))

    def cosine(diagonal):
        return (coupler**2 + rocker**2 - diagonal**2)/(2*coupler*rocker)
    return (at_rocker(coupler + crank) - at_rocker(coupler - crank),
            np.array([cosine(frame - crank), cosine(frame + crank)]))


@pytest.mark.parametrize('method', ('auto', 'mma'))
def test_largest_swing_with_transmission_angles(cases, method):
    """The largest swing of a rocker with transmission angles of 40 degrees and more. Swing and angles have closed forms."""
    names = ('crank', 'coupler', 'rocker')
    # the method of moving asymptotes goes a long way for each start
    starts = 1 if method == 'mma' else 2
    text = (ROUGH + QUANTITIES + STROKE + TRANSMISSION).replace('starts=6', f"starts={starts}, method='{method}'")
    designs, _, _ = cases.search(text, f'transmission {method}')
    x = np.array([designs[name][0] for name in names])
    swing, cosines = stroke_and_transmission(x)
    # a quantity locates extremes between outputs, here every 15 degrees, by a polynomial of eleventh degree
    cases.checks.near(-designs['value'][0], swing, 1e-8, 'transmission: the closed form has the same swing')
    allowed = np.cos(np.radians(40))
    cases.checks.true(np.max(np.abs(cosines)) <= allowed, 'transmission: the limit is kept', str(cosines))
    cases.checks.near(np.max(np.abs(cosines)), allowed, 1e-8, 'transmission: the limit is reached')
    walls = [gradient(lambda z: -sign*stroke_and_transmission(z)[1][i], x) for i in (0, 1) for sign in (1, -1)
             if sign*cosines[i] > allowed - 1e-6]
    low, high = np.array([0.2, 1, 1]), np.array([0.8, 3, 3])
    for i in range(3):
        if x[i] <= low[i] + 1e-9:
            walls.append(np.eye(3)[i])
        if x[i] >= high[i] - 1e-9:
            walls.append(-np.eye(3)[i])
    # the multiplier of a design that is no optimum by 1e-5 would leave as much of the slope
    is_optimal(cases.checks, gradient(lambda z: -stroke_and_transmission(z)[0], x), walls, f'transmission {method}', 1e-5)


def least_transmission():
    """The least transmission angle [deg] of the design that makes the targets."""
    _, cosines = stroke_and_transmission([0.5, 1.8, 1.5])
    return np.degrees(np.arccos(np.max(np.abs(cosines))))


def test_a_weaker_limit_keeps_the_design(cases, made):
    targets(cases, [made['t'][::3], made['P.x'][::3], made['P.y'][::3]])
    designs, _, _ = cases.search(ROUGH + PATH + TRANSMISSION.replace('40', f'{least_transmission() - 1:.6f}'), 'a limit that is kept anyway')
    is_recovered(cases, designs, NAMES, 'a limit that is kept anyway')


def test_a_stronger_limit_is_reached(cases, made):
    targets(cases, [made['t'][::3], made['P.x'][::3], made['P.y'][::3]])
    least = least_transmission()
    designs, _, _ = cases.search(ROUGH + PATH + TRANSMISSION.replace('40', f'{least + 2:.6f}'), 'a limit that is not')
    cases.checks.true(designs['value'][0] > 1e-8, 'a limit that is not: the path is missed', str(designs['value']))
    _, cosines = stroke_and_transmission([designs[name][0] for name in ('crank', 'coupler', 'rocker')])
    cases.checks.near(np.max(np.abs(cosines)), np.cos(np.radians(least + 2)), 1e-8, 'a limit that is not: it is reached')


def test_limits_of_two_quantities(cases, made):
    """The path of a design with limits of two quantities: conditions of the optimum from differences of runs."""
    targets(cases, [made['t'][::3], made['P.x'][::3], made['P.y'][::3]])
    numbers = quantities_of(cases, with_numbers(FOUR_BAR, **MADE) + QUANTITIES)
    limits = f"&limit kind='quantity', of='stroke', high={numbers['stroke'] - 2!r} /\n"
    limits += f"&limit kind='quantity', of='height', low={numbers['height'] + 0.02!r}, high=10 /\n"
    designs, _, _ = cases.search(ROUGH + QUANTITIES + PATH + limits, 'ranges')
    names = ('crank', 'coupler', 'rocker')
    x = np.array([designs[name][0] for name in names])
    points = np.loadtxt(os.path.join(cases.folder, 'targets.dat'))

    def everything(x):
        text = with_numbers(FOUR_BAR, CRANK=x[0], COUPLER=x[1], ROCKER=x[2]) + QUANTITIES
        found = quantities_of(cases, text)
        path = cases.motion(text)
        at = slice(None, None, 3)
        value = np.sum((path['P.x'][at] - points[:, 1])**2 + (path['P.y'][at] - points[:, 2])**2)
        return np.array([value, numbers['stroke'] - 2 - found['stroke'], found['height'] - numbers['height'] - 0.02])
    here = everything(x)
    cases.checks.near(here[0], designs['value'][0], 1e-10, 'ranges: the value is that of a run')
    cases.checks.true(np.all(here[1:] >= -1e-12), 'ranges: the limits are kept', str(here))
    active = [i for i in (1, 2) if here[i] < 1e-5]
    cases.checks.true(active, 'ranges: a limit is reached', str(here))
    slopes = gradient(everything, x, 1e-5)
    # quantities are printed with twelve digits, so that differences have some seven
    is_optimal(cases.checks, slopes[:, 0], [slopes[:, i] for i in active], 'ranges', 1e-4)


def test_a_limit_of_the_crank(cases, made):
    """A crank that need not turn fully in the run must be able to, by Grashof's condition."""
    targets(cases, [made['q1'][1:8:2], 50 + 0.8*made['q1'][1:8:2]])
    text = ROUGH.replace('end=12, intervals=24', 'end=4, intervals=24')
    text += "&objective kind='function', of='q4', over='q1', file='targets.dat' /\n"
    free, _, _ = cases.search(text, 'without a crank')
    turning, _, _ = cases.search(text + "&limit kind='crank', coordinate=1 /\n", 'with a crank')
    frame = np.hypot(2, 0.1)

    def turns(designs):
        bars = [frame] + [designs[name][0] for name in ('crank', 'coupler', 'rocker')]
        return bars[1] + max(bars) <= sum(bars) - bars[1] - max(bars) and bars[1] == min(bars)
    cases.checks.true(not turns(free), 'the best design without the limit does not turn')
    cases.checks.true(turns(turning), 'with the limit it turns fully', str(turning))
    cases.checks.true(turning['value'][0] > free['value'][0], 'which costs something')


def test_times_that_meet(cases, made):
    """Targets in the wrong order are met at one time; the value is then least by parameters and times within the order."""
    order = [4, 7, 13, 10, 16, 19]
    points = np.transpose([made['P.x'][order], made['P.y'][order]])
    targets(cases, [points[:, 0], points[:, 1]])
    best = os.path.join(cases.folder, 'best.nml')
    path = "&objective kind='path', point='P', file='targets.dat' /\n"
    designs, _, printed = cases.search(ROUGH + path, 'times that meet', '--out', best)
    cases.checks.true('note' not in printed, 'there is nothing to warn of', printed)
    text = text_of(best).replace('intervals=24', 'intervals=4800')
    names = ('crank', 'coupler', 'rocker')

    def value(x):
        """Least sum of squared distances with times in their order, by dynamic programming and parabolas on a dense path."""
        for name, number in zip(names, x):
            line = next(line for line in text.splitlines() if f"name='{name}'" in line)
            start = line.index('value=') + 6
            changed.setdefault(name, (line, start))
        now = text
        for name, number in zip(names, x):
            line, start = changed[name]
            end = line.index(',', start)
            now = now.replace(line, line[:start] + repr(float(number)) + line[end:])
        motion = cases.motion(now)
        curve = np.transpose([motion['P.x'], motion['P.y']])
        squares = np.sum((curve[None, :, :] - points[:, None, :])**2, axis=2)
        best_so_far = squares[0]
        for row in squares[1:]:
            best_so_far = row + np.minimum.accumulate(best_so_far)
        return np.min(best_so_far)
    changed = {}
    x = np.array([designs[name][0] for name in names])
    here = value(x)
    # the dense path has an error of the second order in its step
    cases.checks.true(designs['value'][0] <= here*(1 + 1e-9) and here - designs['value'][0] < 1e-4*here, 'times that meet: the value',
                      f"{designs['value'][0]} {here}")
    for i in range(3):
        for step in (1e-3, -1e-3):
            moved = x.copy()
            moved[i] += step
            cases.checks.true(value(moved) > here - 1e-4*here*abs(step)/1e-3, f'times that meet: {names[i]} {step:+} is no better')


@pytest.mark.parametrize('why, text', (
    ('a stroke', ROUGH + QUANTITIES + STROKE + TRANSMISSION),
    ('a path and a crank', ROUGH + PATH.replace(", timing='given'", '') + "&limit kind='crank', coordinate=1 /\n")),
    ids=('a stroke', 'a path and a crank'))
def test_the_same_bits_from_any_number_of_threads(cases, made, why, text):
    """The same bits from one, two and four threads."""
    targets(cases, [made['P.x'][4:20:3], 1.05*made['P.y'][4:20:3]])
    tables = []
    for count in (1, 2, 4):
        table = os.path.join(cases.folder, f'threads{count}.dat')
        done = run(cases.program, cases.write(text), '--optimize', '--table', table, '--threads', str(count))
        cases.checks.true(done.returncode == DONE, f'{why}: {count} threads', done.stderr)
        tables.append(text_of(table))
    cases.checks.true(tables[0] == tables[1] == tables[2], f'{why}: the same bits from any number of threads')


GOOD = ROUGH + QUANTITIES
RANGE = "&limit kind='quantity', of='stroke', low=30 /\n"


@pytest.mark.parametrize('text, words', (
    (GOOD + POSE.replace('link=3', 'link=5'), 'there is no link 5; the mechanism has 4 links'),
    (GOOD + POSE.replace('link=3', 'link=1'), 'link 1 is the frame, whose pose never changes'),
    (GOOD + POSE.replace("timing='given'", "timing='free'"), 'each line holds a pose: x, y and an angle'),
    (GOOD + STROKE.replace('stroke', 'strike'), "there is no &quantity 'strike'; there are stroke, mean, height"),
    (ROUGH + STROKE.replace('stroke', 'strike'), "there is no &quantity 'strike'"),
    (GOOD + STROKE.replace('make', 'goal=3, make'), "leave one of them out"),
    (GOOD + STROKE + RANGE + "&limit kind='quantity', of='stroke', high=20 /\n", 'exclude each other'),
    (GOOD + STROKE + RANGE.replace('low=30', 'low=30, high=20'), "no value is at least 30 and at most 20"),
    (GOOD + STROKE + RANGE.replace('low=30', 'low=30, high=30'), 'round-off would break a limit to one value'),
    (GOOD + STROKE + RANGE.replace(', low=30', ''), "needs 'low', 'high' or both"),
    (GOOD + STROKE + RANGE.replace('stroke', 'force'), "there is no &quantity 'force'"),
    (GOOD.replace("of='q4'", "of='F1'") + STROKE, "quantity 'stroke' is of column 'F1', which is not recorded"),
    (GOOD + STROKE + "&limit kind='crank', coordinate=3 /\n", 'must have a drive, and coordinate 3 has none'),
    (GOOD + STROKE + "&limit kind='crank', coordinate=9 /\n", 'there is no coordinate 9; there are q1 to q4'),
    (GOOD + STROKE + "&limit kind='transmission', coordinate=1, at_least=40 /\n", 'there is no transmission angle at q1'),
    (GOOD + STROKE + "&limit kind='transmission', coordinate=3, at_least=91 /\n", 'a transmission angle is at most a right angle'),
    (with_numbers(FOUR_BAR, **MADE) + LENGTHS + QUANTITIES + STROKE + "&optimum method='levenberg-marquardt' /\n",
     'levenberg-marquardt finds the least sum of squares only')),
    ids=('link 5', 'the frame', 'free times', 'unknown goal', 'no quantities', 'goal and least', 'two limits', 'empty range', 'one value', 'no range',
         'unknown quantity', 'no drive forces', 'crank without a drive', 'coordinate 9', 'no transmission angle', 'more than a right angle',
         'least squares'))
def test_refused(cases, made, text, words):
    targets(cases, [made['t'][:4], made['P.x'][:4], made['P.y'][:4], made['q1'][:4]])
    cases.refused(text, words)


@pytest.mark.parametrize('angle, words', ((400, 'the run never brings q1 to 400'), (1e80, 'the squares of such numbers cannot be added')))
def test_targets_of_a_function_beyond_reason(cases, angle, words):
    targets(cases, [[20, angle], [50, 60]])
    cases.refused(GOOD + "&objective kind='function', of='q4', over='q1', file='targets.dat' /\n", words)


def test_poses_in_one_place_need_a_length(cases, made):
    targets(cases, [0*made['t'][:4], 0*made['t'][:4], made['q1'][:4]])
    cases.refused(GOOD + POSE.replace(", timing='given'", ''), "give 'length'")
