"""Derivatives by parameters where a motion is special: mechanisms that turn as a whole, pairs along curves, ball joints beside and through
gimbal lock, rods that turn about themselves; and in files of comma-separated values.

Compares the program with itself in part: differences of runs at other values of a parameter.
"""
import csv
import json
import os

import numpy as np
import pytest

from ball_mechanisms import DRIVE, SLIDER, Rssr
from kinematic_derivatives import FOUR_BAR, PARALLELOGRAM, Case, of_motion
from mech9_cases import run

PATH = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', point=0.02,0.01,0, axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.25,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.9,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='path', file='curve.dat', orientation='{}', point=0.1,0.05,0, zero=1,0,0, moving_point=0,0,0 /
&initial coordinate=4, position=0.6 /
&drive coordinate=1, kind='polynomial', coefficients=0.3,2 /
&point name='P', link=4, position=0.1,0.2,0 /
&time end=1, intervals=8 /
&output sensitivities=.true. /
"""


# the drive, times and results of the slider-crank of ball_mechanisms
RUN = DRIVE.format(start='0.2') + '&time end=6.5, intervals=13 /\n&output sensitivities=.true. /\n'


@pytest.fixture
def case(checks, tmp_path, mech9k, mech9d):
    return Case(checks, tmp_path, mech9k, mech9d)


def test_a_mechanism_that_turns_as_a_whole(case):
    """Everything that belongs to the frame turns about a line through the origin: coordinates stay, points turn."""
    line = np.array([0.3, -0.2, 1.0])
    vectors = [('pair(1).point', (0.01, 0.02, 0)), ('pair(1).axis', (0, 0, 1)), ('pair(1).zero', (1, 0, 0)),
               ('pair(4).point', (1, 0, 0)), ('pair(4).axis', (0, 0, 1)), ('pair(4).zero', (1, 0, 0))]
    names, factors, terms = [], [], []
    for name, vector in vectors:
        for i, (change, number) in enumerate(zip(np.cross(line, vector), vector), 1):
            if change == 0:
                continue
            names.append(f"'{name}({i})'")
            factors.append(repr(float(change)))
            terms.append(repr(float(number)))
    text = FOUR_BAR.replace("axis=0,0,1, moving_point=0,0,0 /\n&pair coordinate=2", "axis=0,0,1, zero=1,0,0, moving_zero=1,0,0, moving_point=0,0,0 "
                            "/\n&pair coordinate=2").replace("point=1,0,0, axis=0,0,1,", 'point=1,0,0, axis=0,0,1, zero=1,0,0, moving_zero=1,0,0,')
    text = text.replace('zero=1,0,0, moving_zero', 'zero=1,0,0, moving_axis=0,0,1, moving_zero')
    names, rows = case.table(text + f"&parameter name='turn', value=0, sets={','.join(names)}, factors={','.join(factors)}, "
                             f"terms={','.join(terms)} /\n")
    for kind, columns in of_motion(names).items():
        found = rows[:, [names.index(f'd({names[i]})/d(turn)') for i in columns]]
        expected = np.cross(line, rows[:, columns]) if kind.startswith('P.') else 0 * found
        case.checks.near(found, expected, 1e-10, f'everything turns: {kind}', scale=max(1.0, float(np.abs(expected).max())))


@pytest.fixture
def on_ellipse(case):
    """The case with a curve of points on an ellipse."""
    angle = np.linspace(0, 2 * np.pi, 81)
    with open(os.path.join(case.directory, 'curve.dat'), 'w', encoding='utf-8') as file:
        for x, y in zip(0.8 + 0.5 * np.cos(angle), 0.3 * np.sin(angle)):
            file.write(f'{float(x)!r} {float(y) if abs(y) > 1e-12 else 0.0!r}\n')
    return case


@pytest.mark.parametrize('orientation', ('fixed', 'tangent'))
def test_slider_on_an_ellipse(on_ellipse, orientation):
    """Splines have four continuous derivatives: the differences of runs are less exact than the derivatives."""
    on_ellipse.against_runs(
        PATH.format(orientation),
        (('rod', 'pair(3).point(1)', 0.9), ('place', 'pair(4).point(2)', 0.05), ('tilt', 'pair(4).zero(2)', 0.0),
         ('off', 'pair(4).moving_point(2)', 0.0), ('scale', 'pair(4).scale', 1.0)), f'path, {orientation}', 1e-7, 2.0**-10)


@pytest.mark.parametrize('links', ('1,4', '4,1'))
@pytest.mark.parametrize('orientation', ('fixed', 'tangent'))
def test_a_size_of_all_lengths_and_of_the_curve(on_ellipse, orientation, links):
    """All lengths and the curve grow by the same factor: angles stay, arc lengths and places grow by this factor."""
    text, why = PATH.format(orientation).replace('links=1,4', f'links={links}'), f'{orientation}, links {links}'
    lengths = (('pair(1).point(1)', 0.02), ('pair(1).point(2)', 0.01), ('pair(2).point(1)', 0.25), ('pair(3).point(1)', 0.9),
               ('pair(4).point(1)', 0.1), ('pair(4).point(2)', 0.05), ('pair(4).scale', 1.0), ('point.position(1)', 0.1),
               ('point.position(2)', 0.2))
    sets = ','.join(f"'{name}'" for name, _ in lengths)
    factors = ','.join(str(number) for _, number in lengths)
    names, rows = on_ellipse.table(text + f"&parameter name='size', value=1, sets={sets}, factors={factors} /\n")
    for kind, columns in of_motion(names).items():
        for i in columns:
            found = rows[:, names.index(f'd({names[i]})/d(size)')]
            grows = names[i].startswith('P.') or names[i].endswith('q4')
            expected = rows[:, i] if grows else 0 * found
            # round-off of positions, which the curvatures of the curve enlarge in accelerations
            on_ellipse.checks.near(found, expected, 1e-10, f'everything grows: {names[i]}, {why}', scale=max(1.0, float(np.abs(rows[:, columns]).max())))


@pytest.mark.parametrize('why, crank, guide, tolerance', (
    ('beside the lock', '0.2,1,0.1', '0,0.1,0.05', 1e-7), ('near the lock', '0.05,1,0.03', '0,0.03,0.02', 1e-5)), ids=('beside', 'near'))
def test_ball_joints_beside_gimbal_lock(case, why, crank, guide, tolerance):
    """Ball joints that pass beside gimbal lock at some distance. Through it the rates of angles have no derivatives."""
    case.against_runs(SLIDER.format(crank=crank, guide=guide, frame='') + RUN, (('crank', 'pair(2).point(3)', 0.3), ('rod', 'pair(3).point(1)', 1.0)),
                      f'ball, {why}', tolerance, 2.0**-10)


@pytest.mark.parametrize('seed', range(4))
def test_rods_between_two_balls(case, seed):
    """The derivatives of all that does not depend on how the rod turns about itself."""
    rssr = Rssr(seed)
    length = float(np.linalg.norm(rssr.arms[0]))
    text = rssr.pairs(seed % 3 > 0) + "&drive coordinate=1, kind='polynomial', coefficients=0, 1 /\n" \
        "&point name='P', link=4, position=0.1,0.2,0.3 /\n&time end=6, intervals=12 /\n" \
        '&output sensitivities=.true., coordinates=1,8 /\n'
    case.against_runs(text, (('arm', 'pair(3).point(1)', float(rssr.arms[0][0])), ('rod', 'pair(4).point(2)', float(rssr.in_rod[1]))),
                      f'rod {seed} of a crank of {length:.2f} m', 1e-7, 2.0**-9)


def test_table_with_commas_has_the_same_columns(case):
    crank = "&parameter name='crank', sets='pair(2).point(1)' /\n"
    names, rows = case.table(FOUR_BAR + crank)
    path = os.path.join(case.directory, 'a.csv')
    done = run(case.mech9k, os.path.join(case.directory, 'a.nml'), '--quiet', '--table', path)
    case.checks.equal(done.returncode, 0, 'a table with commas')
    with open(path, encoding='utf-8', newline='') as file:
        lines = [line for line in csv.reader(file) if line and not line[0].startswith('#')]
    heads = [head.split(' [')[0] for head in lines[0]]
    case.checks.equal(heads, names, 'its headings')
    numbers = np.array([[float(x) for x in line] for line in lines[1:] if line[0][:1] in '-0123456789'])
    case.checks.true(np.array_equal(numbers, rows), 'its numbers')


def test_counts_up_to_a_position_without_derivatives(case):
    """A run that ends at a position without derivatives counts nothing beyond it, although later positions are worked out before the
    derivatives of this one: the same as a run without derivatives that ends there."""
    flat = PARALLELOGRAM.replace('coefficients=1,1', 'coefficients=-2,1').replace('position=-1', 'position=2') \
        .replace('coordinate=4, position=1', 'coordinate=4, position=-2').replace('intervals=4', 'intervals={count}')
    plain = flat.replace('sensitivities=.true.', 'sensitivities=.false.')
    facts = []
    for text, code in ((flat.format(end=4.0, count=16), 6), (plain.format(end=2.0, count=8), 0)):
        path, report = (os.path.join(case.directory, name) for name in ('counts.nml', 'counts.json'))
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        done = run(case.mech9k, path, '--quiet', '--no-write', '--report', report)
        case.checks.equal(done.returncode, code, f'counts: code {code}')
        with open(report, encoding='utf-8') as file:
            facts.append(json.load(file))
    case.checks.equal([one['positions'] for one in facts], [8, 9], 'the position without derivatives has no row')
    for name in ('steps', 'halvings', 'newton_iterations', 'special_positions_passed', 'largest_closure', 'least_conditioning',
                 'least_conditioning_time', 'frames_placed', 'factorizations', 'rate_solutions', 'acceleration_solutions'):
        case.checks.equal(facts[0][name], facts[1][name], f'{name} up to a position without derivatives')
