"""Quantities of motions whose laws jump, against closed forms.

A slide is driven by segments, so that its rate or acceleration jumps where segments join. All extremes, means and integrals are known.
In mech9d a second body slides freely on the first one: beside it nothing pulls, so that it goes on uniformly in space while
the rate of its slide jumps.
"""
import json
import math
import re

import numpy as np

from mech9_cases import run, table_of

MASS, DAMPING = 2.0, 3.0
# Segments of up to the fifth degree are followed by polynomials of that degree: round-off of sums over some hundred pieces.
EXACT = 1e-11
# Gradients come from differences of closed forms.
GRADIENT = 1e-8

SLIDE = """
&mechanism links=2, coordinates=1 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass={mass}, centre=0,0,0 /
&load kind='coordinate', coordinate=1, damping={damping} /
&point name='P', link=2 /
&drive coordinate=1, kind='segments', times={times}, values={values}, laws={laws} {more} /
&time start={start}, end={end}, intervals={intervals} /
"""
COLUMNS = {'q': 'q1', 'v': 'dq1', 'a': 'ddq1', 'x': 'P.x', 'vx': 'P.vx', 'ax': 'P.ax', 'force': 'F1'}
TAKES = ('min', 'max', 'peak', 'range', 'mean', 'rms', 'integral')
CURVES = {'constant-velocity': [0, 1], 'dwell': [0], 'polynomial345': [0, 0, 0, 10, -15, 6]}


def pieces_of(times, values, laws, start, end, period=False):
    """Polynomials of time from each joint on: (beginning, end, polynomial of t - beginning of the segment, that beginning)."""
    length = times[-1] - times[0]
    found = []
    for turn in range(math.ceil((end - times[0]) / length) if period else 1):
        for i, law in enumerate(laws):
            span, rise = times[i + 1] - times[i], values[i + 1] - values[i]
            curve = np.polynomial.Polynomial(CURVES[law])(np.polynomial.Polynomial([0, 1 / span]))
            polynomial = values[i] + turn * (values[-1] - values[0]) + rise * curve
            begin = times[i] + turn * length
            low, high = max(begin, start), min(begin + span, end)
            if high > low + 1e-9:
                found.append((low - begin, high - begin, polynomial))
    return found


def closed_form(pieces, column, mass=MASS, damping=DAMPING):
    """All numbers that a quantity may be, of one column."""
    lows, highs, integral, square, duration = [], [], 0.0, 0.0, 0.0
    for low, high, q in pieces:
        q = np.polynomial.Polynomial(np.atleast_1d(q.coef))
        f = {'q': q, 'v': q.deriv(), 'a': q.deriv(2), 'force': mass * q.deriv(2) + damping * q.deriv()}[column]
        places = [low, high] + [r.real for r in f.deriv().roots() if abs(r.imag) < 1e-9 and low < r.real < high]
        lows.append(min(f(x) for x in places))
        highs.append(max(f(x) for x in places))
        integral += f.integ()(high) - f.integ()(low)
        square += (f * f).integ()(high) - (f * f).integ()(low)
        duration += high - low
    low, high = min(lows), max(highs)
    return {'min': low, 'max': high, 'peak': max(abs(low), abs(high)), 'range': high - low, 'mean': integral / duration,
            'rms': math.sqrt(max(0.0, square) / duration), 'integral': integral}


def quantities_of(program, folder, text, columns):
    """The numbers of the quantities of a run, by column and kind, and their gradients."""
    for short, name in columns.items():
        text += ''.join(f"&quantity name='{short}_{take}', of='{name}', take='{take}' /\n" for take in TAKES)
    (folder / 'case.nml').write_text(text, encoding='utf-8')
    done = run(program, folder / 'case.nml', '--no-write', '--report', folder / 'report.json', folder=folder)
    if done.returncode:
        raise RuntimeError(done.stderr)
    with open(folder / 'report.json', encoding='utf-8') as file:
        return {q['name']: q for q in json.load(file)['quantities']}


def listed(numbers):
    return ', '.join(repr(x) for x in numbers)


def names(laws):
    return ', '.join(f"'{law}'" for law in laws)


def slide(times, values, laws, start, end, intervals, more=''):
    return SLIDE.format(mass=MASS, damping=DAMPING, times=listed(times), values=listed(values), laws=names(laws), more=more,
                        start=start, end=end, intervals=intervals)


TIMES, VALUES = [0, 0.3, 0.7, 1.0, 1.3], [0, 0.2, 0.55, 0.55, 0.1]
LAWS = ['constant-velocity', 'polynomial345', 'dwell', 'constant-velocity']
PERIODIC = [0, 0.35, 0.6, 0.7], [0, 0.2, -0.1, 0.05], ['constant-velocity', 'polynomial345', 'constant-velocity']


def tolerance_of(short, take, interval, exact=EXACT):
    """The square of a coordinate has the tenth degree, and sums over ten points are exact up to the ninth. Where a piece is as long as
    a segment, the part beyond is 1e-7 of the square; it shrinks with the tenth power of the length."""
    return max(1e-6 * min(1.0, (interval / 0.3)**10), exact) if take == 'rms' and short in ('q', 'x') else exact


def compare(checks, program, folder, motion, period, intervals, why):
    times, values, laws, start, end = motion
    more = f', period={times[-1] - times[0]!r}' if period else ''
    text = slide(times, values, laws, start, end, intervals, more) + '&output drive_forces=.true. /\n'
    found = quantities_of(program, folder, text, COLUMNS)
    pieces = pieces_of(times, values, laws, start, end, period)
    for short in COLUMNS:
        expected = closed_form(pieces, {'x': 'q', 'vx': 'v', 'ax': 'a'}.get(short, short))
        scale = max(1.0, expected['peak'])
        for take in TAKES:
            checks.near(found[f'{short}_{take}']['value'], expected[take], tolerance_of(short, take, (end - start) / intervals),
                        f'{why}: {take} of {COLUMNS[short]}', scale=scale)


def test_driven_slide(checks, mech9k, mech9d, tmp_path):
    for intervals in 1, 3, 4, 7, 10, 13, 26, 100, 130, 333:
        compare(checks, mech9k, tmp_path, (TIMES, VALUES, LAWS, 0, 1.3), False, intervals, f'mech9k, {intervals} intervals')
    for intervals in 1, 13, 50:
        compare(checks, mech9d, tmp_path, (TIMES, VALUES, LAWS, 0, 1.3), False, intervals, f'mech9d, {intervals} intervals')


def test_repeating_slide(checks, mech9k, tmp_path):
    # outputs on the joints, some of them one unit of round-off beside; the run begins and ends at joints, or between them
    for start, end in (0, 2.8), (0.35, 2.1), (0.1, 2.05):
        for intervals in 1, 5, 28, 56, 101:
            compare(checks, mech9k, tmp_path, (*PERIODIC, start, end), True, intervals, f'{start} to {end} s, {intervals} intervals')


def test_backwards(checks, mech9k, tmp_path):
    for intervals in 1, 13, 40:
        text = slide(TIMES, VALUES, LAWS, 1.3, 0, intervals) + '&output drive_forces=.true. /\n'
        found = quantities_of(mech9k, tmp_path, text, COLUMNS)
        for short in 'q', 'v', 'a', 'force':
            expected = closed_form(pieces_of(TIMES, VALUES, LAWS, 0, 1.3), short)
            for take in ('min', 'max', 'mean', 'rms'):
                checks.near(found[f'{short}_{take}']['value'], expected[take], tolerance_of(short, take, 1.3 / intervals),
                            f'backwards: {take} of {short}', scale=max(1.0, expected['peak']))


HARMONIC = [0, 0.4, 0.6, 1.0], [0, 0.3, 0.3, -0.1], ['harmonic', 'dwell', 'harmonic']


def test_harmonic_law(checks, mech9k, tmp_path):
    """Accelerations jump, and are no polynomials: the force has its values at ten points of each piece."""
    times, values, laws = HARMONIC
    rises = [(0.3, 0.4), (-0.4, 0.4)]
    peak = max(abs(h) * math.pi**2 / (2 * t**2) for h, t in rises)
    square = sum((h * math.pi**2 / (2 * t**2))**2 * t / 2 for h, t in rises)
    for intervals in 5, 10, 37, 200:
        text = slide(times, values, laws, 0, 1.0, intervals).replace(f'damping={DAMPING}', 'damping=0')
        found = quantities_of(mech9k, tmp_path, text + '&output drive_forces=.true. /\n', COLUMNS)
        # a half wave by ten points in five or more pieces: 1e-13; by two neighbouring outputs with two derivatives, 5e-5 of
        # the acceleration at 0.1 s and less with the fourth power of their distance
        for short, factor, tolerance in ('force', MASS, 1e-10), ('a', 1.0, max(1e-10, 2e-2 * (5 / intervals)**4)):
            checks.near(found[f'{short}_max']['value'], factor * peak, tolerance, f'harmonic, {intervals}: max of {short}')
            checks.near(found[f'{short}_min']['value'], -factor * peak, tolerance, f'harmonic, {intervals}: min of {short}')
            checks.near(found[f'{short}_rms']['value'], factor * math.sqrt(square), tolerance, f'harmonic, {intervals}: rms of {short}')
            checks.near(found[f'{short}_integral']['value'], 0.0, tolerance, f'harmonic, {intervals}: integral of {short}', scale=peak)


FREE = """
&mechanism links=3, coordinates=2 /
&structure cq=1, 2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=1,0,0 /
&initial coordinate=2, position=0.4, velocity={velocity} /
&body link=2, mass=1.5, centre=0,0,0 /
&body link=3, mass=0.5, centre=0,0,0 /
&drive coordinate=1, kind='segments', times={times}, values={values}, laws={laws} /
&time start=0, end=1.3, intervals={intervals} /
&output drive_forces=.true. /
"""


def test_free_body_on_a_driven_one(checks, mech9d, tmp_path):
    speed = 0.25
    pieces = pieces_of(TIMES, VALUES, LAWS, 0, 1.3)
    beside = []
    begin = 0.0
    for low, high, q in pieces:
        # the free body is at 0.4 + speed t in space
        beside.append((low, high, np.polynomial.Polynomial([0.4 + speed * begin, speed]) - q))
        begin += high - low
    for intervals in 1, 13, 40:
        text = FREE.format(velocity=speed - pieces[0][2].deriv()(0.0), times=listed(TIMES), values=listed(VALUES), laws=names(LAWS),
                           intervals=intervals)
        found = quantities_of(mech9d, tmp_path, text, {'q': 'q2', 'v': 'dq2', 'a': 'ddq2', 'force': 'F1'})
        for short in 'q', 'v', 'a', 'force':
            expected = closed_form(pieces if short == 'force' else beside, short, 1.5, 0.0)
            for take in TAKES:
                # tolerances of a step, 1e-8 of the coordinates, over some dozen steps
                checks.near(found[f'{short}_{take}']['value'], expected[take], 1e-6, f'free, {intervals}: {take} of {short}',
                            scale=max(1.0, expected['peak']))


PARAMETERS = """
&parameter name='height', sets='drive(1).values(2)' /
&parameter name='instant', sets='drive(1).times(2)' /
&parameter name='top', sets='drive(1).values(3)', 'drive(1).values(4)', value={top} /
&output gradients=.true., drive_forces=.true. /
"""


def changed(name, change):
    times, values = list(TIMES), list(VALUES)
    if name == 'height':
        values[1] += change
    elif name == 'instant':
        times[1] += change
    else:
        values[2] += change
        values[3] += change
    return pieces_of(times, values, LAWS, 0, 1.3)


def test_gradients(checks, mech9k, tmp_path):
    """Means and integrals change with the time of a jump, and an extreme at a joint moves with it."""
    step = 1e-5
    for intervals in 1, 13, 40:
        text = slide(TIMES, VALUES, LAWS, 0, 1.3, intervals) + PARAMETERS.format(top=VALUES[2])
        found = quantities_of(mech9k, tmp_path, text, COLUMNS)
        for short in 'q', 'v', 'a', 'force':
            numbers = {name: [closed_form(changed(name, s * step), short) for s in (1, -1, 2, -2)]
                       for name in ('height', 'instant', 'top')}
            for take in TAKES:
                for entry in found[f'{short}_{take}']['gradient']:
                    n = [number[take] for number in numbers[entry['parameter']]]
                    expected = (8 * (n[0] - n[1]) - (n[2] - n[3])) / (12 * step)
                    checks.near(entry['value'], expected, tolerance_of(short, take, 1.3 / intervals, GRADIENT), f'{intervals}: d({take} of {short})/d({entry["parameter"]})',
                                scale=max(1.0, abs(expected), abs(n[0])))


def test_gradients_by_the_time_of_a_jump_of_accelerations(checks, mech9k, mech9d, tmp_path):
    """The acceleration ends its first half wave at the instant that is a parameter, and jumps to zero there."""
    times, values, laws = HARMONIC
    rise, first, (later_rise, later) = values[1] - values[0], times[1], (-0.4, 0.4)
    square = (rise**2 / first**3 + later_rise**2 / later**3) * math.pi**4 / 8
    # of max and min over the run the second half wave has the larger ones, which do not change
    rms_change = -3 * rise**2 / first**4 * math.pi**4 / 16 / math.sqrt(square)
    parameter = "&parameter name='instant', sets='drive(1).times(2)' /\n&output gradients=.true., drive_forces=.true. /\n"
    driven = slide(times, values, laws, 0, 1.0, 100).replace(f'damping={DAMPING}', 'damping=0') + parameter
    free = FREE.format(velocity=0.25, times=listed(times), values=listed(values), laws=names(laws), intervals=100)
    free = free.replace('end=1.3', 'end=1.0').replace('&output drive_forces=.true. /\n', '') + parameter
    # outputs of 0.01 s: accelerations by neighbouring ones to 1e-9; in free motions tolerances of a step, 1e-8
    for program, text, columns, masses, tolerance in ((mech9k, driven, {'a': 'ddq1', 'force': 'F1'}, (1.0, MASS), 1e-7),
                                                      (mech9d, free, {'a': 'ddq2', 'force': 'F1'}, (1.0, 1.5), 1e-6)):
        found = quantities_of(program, tmp_path, text, columns)
        for short, factor in zip(columns, masses):
            number = {take: found[f'{short}_{take}']['gradient'][0]['value'] for take in TAKES}
            why = f'{program.rsplit("/", 1)[-1]}: {columns[short]}'
            checks.near(number['rms'], factor * rms_change, tolerance, f'{why}: rms', scale=1.0)
            # rates are zero at both ends of each half wave
            checks.near(number['integral'], 0.0, tolerance, f'{why}: integral', scale=1.0)
            checks.near(number['mean'], 0.0, tolerance, f'{why}: mean', scale=1.0)
            checks.near(number['peak'], 0.0, tolerance, f'{why}: peak', scale=1.0)


SAWTOOTH = """
&mechanism links=2, coordinates=1 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&initial coordinate=1, position=0, velocity=0 /
&body link=2, mass=4, centre=0,0,0 /
&load kind='coordinate', coordinate=1, force=2, law='segments', times=0, 0.4, values=0, 1, laws='constant-velocity', period=0.4 /
&time start=0, end=1.2, intervals={intervals} /
"""


def test_force_that_jumps(checks, mech9d, tmp_path):
    """A force grows from 0 to 2 N three times: a body of 4 kg has up to 0.5 m/s^2, and gets 0.1 m/s each time."""
    for intervals in 1, 6, 12, 25:
        found = quantities_of(mech9d, tmp_path, SAWTOOTH.format(intervals=intervals), {'a': 'ddq1', 'v': 'dq1'})
        expected = {'a_max': 0.5, 'a_min': 0.0, 'a_mean': 0.25, 'a_rms': 0.5 / math.sqrt(3), 'a_integral': 0.3, 'v_max': 0.3}
        for name, number in expected.items():
            checks.near(found[name]['value'], number, 1e-7, f'{intervals} intervals: {name}', scale=1.0)


def test_study_and_search(checks, mech9k, tmp_path):
    """The runs of a study and of a search have the numbers of a single run."""
    text = slide(TIMES, VALUES, LAWS, 0, 1.3, 7)
    text += "&quantity name='rms', of='dq1', take='rms' /\n&quantity name='fastest', of='dq1', take='max' /\n"
    varied = "&parameter name='instant', sets='drive(1).times(2)', low=0.2, high=0.4, count=5 /\n"
    (tmp_path / 'study.nml').write_text(text + varied + "&study kind='grid' /\n", encoding='utf-8')
    table = table_of(mech9k, tmp_path / 'study.nml', '--study')
    checks.equal(len(table['rms']), 5, 'five runs')
    for i, instant in enumerate(table['instant']):
        expected = closed_form(changed('instant', instant - TIMES[1]), 'v')
        checks.near(table['rms'][i], expected['rms'], EXACT, f'study: rms, jump at {instant} s')
        checks.near(table['fastest'][i], expected['max'], EXACT, f'study: max, jump at {instant} s')
    # the least rms of the rate over the height of the joint, from its closed form
    heights = np.linspace(0.1, 0.5, 4001)
    numbers = [closed_form(changed('height', h - VALUES[1]), 'v')['rms'] for h in heights]
    best = heights[int(np.argmin(numbers))]
    search = text + "&parameter name='height', sets='drive(1).values(2)', low=0.1, high=0.5 /\n&objective kind='quantity', of='rms' /\n"
    (tmp_path / 'search.nml').write_text(search, encoding='utf-8')
    done = run(mech9k, tmp_path / 'search.nml', '--optimize', '--report', tmp_path / 'search.json', '--no-write', folder=tmp_path)
    if done.returncode == 0:
        found = float(re.search(r'height\s*=\s*([-+.\deE]+)', done.stderr + done.stdout).group(1))
        checks.near(found, best, 2e-4, 'search: the height with the least rms')
    checks.equal(done.returncode, 0, 'the search ends well')
