"""Synthesis by --optimize beyond paths and functions: poses, quantities and limits. Designs are recovered from poses and quantities that
they made; results within limits satisfy the conditions of Karush, Kuhn and Tucker, with closed forms of a four-bar linkage and with
differences of runs; free times that meet are minima in their order; one result from any number of threads; mistakes.

usage: synthesis_kinds.py MECH9K
"""
import os
import sys
import tempfile

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from mech9_cases import Checks, read_table, run, text_of
from synthesis import DATA, DONE, FOUR_BAR, LENGTHS, Cases, is_recovered, targets, with_numbers

MADE = dict(CRANK=0.5, COUPLER=1.8, ROCKER=1.5)
NAMES = dict(crank=0.5, coupler=1.8, rocker=1.5)
ROUGH = with_numbers(FOUR_BAR, CRANK=0.4, COUPLER=2.2, ROCKER=1.9) + LENGTHS + '&optimum starts=6 /\n'
QUANTITIES = """&quantity name='stroke', of='q4', take='range' /
&quantity name='mean', of='P.x', take='mean' /
&quantity name='height', of='P.y', take='max' /
"""
STROKE = "&objective kind='quantity', of='stroke', make='largest' /\n"


def poses(cases):
    """A design is recovered from poses of its coupler: in the plane with given and with free times, and in space."""
    axes = "&point name='O', link=3, position=0,0,0 /\n&point name='X', link=3, position=1,0,0 /\n"
    made = cases.motion(with_numbers(FOUR_BAR, **MADE) + axes)
    angle = np.degrees(np.unwrap(np.arctan2(made['X.y'] - made['O.y'], made['X.x'] - made['O.x'])))
    part = slice(1, 20, 3)
    t, x, y, angle = made['t'][part], made['O.x'][part], made['O.y'][part], angle[part]
    pose = "&objective kind='pose', link=3, file='targets.dat', timing='given' /\n"
    for why, columns, objective in (
            ('given times', [t, x, y, angle], pose),
            ('free times', [x, y, angle], pose.replace(", timing='given'", '')),
            ('rotation vectors', [t, x, y, 0*t, 0*t, 0*t, angle], pose.replace('/', ', length=0.3 /'))):
        targets(cases, columns)
        designs, _, _ = cases.search(ROUGH + objective, f'poses: {why}')
        is_recovered(cases, designs, NAMES, f'poses: {why}', tolerance=1e-7 if why == 'free times' else 1e-9)
    # one degree more, and one millimetre: the value is their squares, the angle times the length
    targets(cases, [t, x, y, angle])
    held = with_numbers(FOUR_BAR, **MADE) + "&parameter name='crank', sets='pair(2).point(1)', low=0.5, high=0.5000000001 /\n"
    for shift, turn in ((1e-3, 0.0), (0.0, 1.0), (0.0, 30.0)):
        targets(cases, [t, x + shift, y, angle + turn])
        designs, _, _ = cases.search(held + pose.replace('/', ', length=0.3, weight=2 /') + '&optimum starts=1 /\n', 'value of poses')
        cases.checks.near(designs['value'][0], 2*len(t)*(shift**2 + (0.3*np.radians(turn))**2), 1e-8, f'value of poses {shift} {turn}')


def goals(cases):
    """Three quantities of a design lead back to it, or to another design with the same quantities."""
    report = cases.motion(with_numbers(FOUR_BAR, **MADE) + QUANTITIES)
    numbers = quantities_of(cases, with_numbers(FOUR_BAR, **MADE) + QUANTITIES)
    wanted = ''.join(f"&objective kind='quantity', of='{name}', goal={number!r} /\n" for name, number in numbers.items())
    designs, _, _ = cases.search(ROUGH + QUANTITIES + wanted, 'goals', '--out', os.path.join(cases.folder, 'best.nml'))
    cases.checks.true(designs['value'][0] < 1e-18, 'goals: all are met', str(designs['value']))
    best = quantities_of(cases, text_of(os.path.join(cases.folder, 'best.nml')))
    for name, number in numbers.items():
        cases.checks.near(best[name], number, 1e-8, f'goals: {name} of the best design')
    return report


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


def gradient(function, x, step=1e-6):
    """Central differences."""
    columns = []
    for i in range(len(x)):
        move = np.zeros(len(x))
        move[i] = step
        columns.append((np.asarray(function(x + move)) - np.asarray(function(x - move)))/(2*step))
    return np.array(columns)


def is_optimal(checks, slope, walls, why, tolerance):
    """The slope of a function that is least is a sum of the slopes of active limits (not negative where they are kept) with
    multipliers that are not negative."""
    multipliers, _, _, _ = np.linalg.lstsq(np.transpose(walls), slope, rcond=None)
    rest = slope - np.transpose(walls) @ multipliers
    checks.true(np.linalg.norm(rest) <= tolerance*np.linalg.norm(slope), f'{why}: the slope is one of the limits', f'{rest} of {slope}')
    checks.true(np.all(multipliers > -tolerance*np.linalg.norm(slope)), f'{why}: the multipliers are not negative', str(multipliers))


def transmission(cases):
    """The largest swing of a rocker with transmission angles of 40 degrees and more. Swing and angles have closed forms."""
    limit = "&limit kind='transmission', coordinate=3, at_least=40 /\n"
    names = ('crank', 'coupler', 'rocker')
    for method in ('auto', 'mma'):
        text = (ROUGH + QUANTITIES + STROKE + limit).replace('starts=6', f"starts=2, method='{method}'")
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
    # a weaker limit keeps the design of a least sum of squares; a stronger one does not
    made = cases.motion(with_numbers(FOUR_BAR, **MADE))
    targets(cases, [made['t'][::3], made['P.x'][::3], made['P.y'][::3]])
    path = "&objective kind='path', point='P', file='targets.dat', timing='given' /\n"
    _, cosines = stroke_and_transmission([0.5, 1.8, 1.5])
    least = np.degrees(np.arccos(np.max(np.abs(cosines))))
    designs, _, _ = cases.search(ROUGH + path + limit.replace('40', f'{least - 1:.6f}'), 'a limit that is kept anyway')
    is_recovered(cases, designs, NAMES, 'a limit that is kept anyway')
    designs, _, _ = cases.search(ROUGH + path + limit.replace('40', f'{least + 2:.6f}'), 'a limit that is not')
    cases.checks.true(designs['value'][0] > 1e-8, 'a limit that is not: the path is missed', str(designs['value']))
    _, cosines = stroke_and_transmission([designs[name][0] for name in names])
    cases.checks.near(np.max(np.abs(cosines)), np.cos(np.radians(least + 2)), 1e-8, 'a limit that is not: it is reached')


def ranges(cases):
    """The path of a design with limits of two quantities: conditions of the optimum from differences of runs."""
    made = cases.motion(with_numbers(FOUR_BAR, **MADE))
    targets(cases, [made['t'][::3], made['P.x'][::3], made['P.y'][::3]])
    path = "&objective kind='path', point='P', file='targets.dat', timing='given' /\n"
    numbers = quantities_of(cases, with_numbers(FOUR_BAR, **MADE) + QUANTITIES)
    limits = f"&limit kind='quantity', of='stroke', high={numbers['stroke'] - 2!r} /\n"
    limits += f"&limit kind='quantity', of='height', low={numbers['height'] + 0.02!r}, high=10 /\n"
    designs, _, _ = cases.search(ROUGH + QUANTITIES + path + limits, 'ranges')
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


def cranks(cases):
    """A crank that need not turn fully in the run must be able to, by Grashof's condition."""
    made = cases.motion(with_numbers(FOUR_BAR, **MADE))
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


def times_that_meet(cases):
    """Targets in the wrong order are met at one time; the value is then least by parameters and times within the order."""
    made = cases.motion(with_numbers(FOUR_BAR, **MADE))
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


def threads(cases):
    """The same bits from one, two and four threads."""
    transmission_angle = "&limit kind='transmission', coordinate=3, at_least=40 /\n"
    made = cases.motion(with_numbers(FOUR_BAR, **MADE))
    targets(cases, [made['P.x'][4:20:3], 1.05*made['P.y'][4:20:3]])
    path = "&objective kind='path', point='P', file='targets.dat' /\n"
    for why, text in (('a stroke', ROUGH + QUANTITIES + STROKE + transmission_angle),
                      ('a path and a crank', ROUGH + path + "&limit kind='crank', coordinate=1 /\n")):
        tables = []
        for count in (1, 2, 4):
            table = os.path.join(cases.folder, f'threads{count}.dat')
            done = run(cases.program, cases.write(text), '--optimize', '--table', table, '--threads', str(count))
            cases.checks.true(done.returncode == DONE, f'{why}: {count} threads', done.stderr)
            tables.append(text_of(table))
        cases.checks.true(tables[0] == tables[1] == tables[2], f'{why}: the same bits from any number of threads')


def refusals(cases):
    made = cases.motion(with_numbers(FOUR_BAR, **MADE))
    targets(cases, [made['t'][:4], made['P.x'][:4], made['P.y'][:4], made['q1'][:4]])
    good = ROUGH + QUANTITIES
    pose = "&objective kind='pose', link=3, file='targets.dat', timing='given' /\n"
    stroke = "&limit kind='quantity', of='stroke', low=30 /\n"
    refuse = cases.refused
    refuse(good + pose.replace('link=3', 'link=5'), 'there is no link 5; the mechanism has 4 links')
    refuse(good + pose.replace('link=3', 'link=1'), 'link 1 is the frame, whose pose never changes')
    refuse(good + pose.replace("timing='given'", "timing='free'"), 'each line holds a pose: x, y and an angle')
    refuse(good + STROKE.replace('stroke', 'strike'), "there is no &quantity 'strike'; there are stroke, mean, height")
    refuse(ROUGH + STROKE.replace('stroke', 'strike'), "there is no &quantity 'strike'")
    refuse(good + STROKE.replace('make', 'goal=3, make'), "leave one of them out")
    refuse(good + STROKE + stroke + "&limit kind='quantity', of='stroke', high=20 /\n", 'exclude each other')
    refuse(good + STROKE + stroke.replace('low=30', 'low=30, high=20'), "no value is at least 30 and at most 20")
    refuse(good + STROKE + stroke.replace('low=30', 'low=30, high=30'), 'round-off would break a limit to one value')
    refuse(good + STROKE + stroke.replace(', low=30', ''), "needs 'low', 'high' or both")
    refuse(good + STROKE + stroke.replace('stroke', 'force'), "there is no &quantity 'force'")
    force = good.replace("of='q4'", "of='F1'")
    refuse(force + STROKE, "quantity 'stroke' is of column 'F1', which is not recorded")
    refuse(good + STROKE + "&limit kind='crank', coordinate=3 /\n", 'must have a drive, and q3 has none')
    refuse(good + STROKE + "&limit kind='crank', coordinate=9 /\n", 'there is no coordinate 9; there are q1 to q4')
    refuse(good + STROKE + "&limit kind='transmission', coordinate=1, at_least=40 /\n", 'there is no transmission angle at q1')
    refuse(good + STROKE + "&limit kind='transmission', coordinate=3, at_least=91 /\n", 'a transmission angle is at most a right angle')
    plain = with_numbers(FOUR_BAR, **MADE) + LENGTHS + QUANTITIES
    refuse(plain + STROKE + "&optimum method='levenberg-marquardt' /\n", 'levenberg-marquardt finds the least sum of squares only')
    function = "&objective kind='function', of='q4', over='q1', file='targets.dat' /\n"
    targets(cases, [[20, 400], [50, 60]])
    refuse(good + function, 'the run never brings q1 to 400')
    targets(cases, [[20, 1e80], [50, 60]])
    refuse(good + function, 'the squares of such numbers cannot be added')
    targets(cases, [0*made['t'][:4], 0*made['t'][:4], made['q1'][:4]])
    refuse(good + pose.replace(", timing='given'", ''), "give 'length'")


def main():
    checks = Checks()
    with tempfile.TemporaryDirectory() as folder:
        cases = Cases(checks, folder, sys.argv[1])
        for case in (poses, goals, transmission, ranges, cranks, times_that_meet, threads, refusals):
            case(cases)
    checks.finish()


if __name__ == '__main__':
    main()
