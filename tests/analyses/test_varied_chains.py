"""Derivatives of free motions of chains of many kinds by parameters, against differences of whole runs: closed in space, with planar
parts, geared, of several loops, with two freedoms, with a drive whose numbers vary, off their plane, along curves. What the derivatives cost.

Compares the program with itself: differences of runs at other values of a parameter, and the cost with that of a plain run.
"""
import json
import os
import resource

import pytest

from dynamic_derivatives import FOUR_BAR, FOUR_BAR_PARAMETERS, SOLVER, Case, declared
from mech9_cases import run

# A crank and a rocker in space, joined by a rod with a ball joint and a universal joint; a spring between rod and frame.
RSUR = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=1,0,0, point=0.2,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,1,0, point=0.2,0,0 /
&pair coordinate=4, links=4,5, kind='revolute', axis=0,0,1, point=0.2,0,0 /
&pair coordinate=5, links=5,6, kind='revolute', axis=0.5,0,-0.1, point=0.3,0.5,0.5 /
&pair coordinate=6, links=6,7, kind='revolute', axis=0,1,0, point=0.3,0.5,0.5 /
&pair coordinate=7, links=1,7, kind='revolute', axis=1,0,0, point=0.3,0.5,-0.1 /
&initial coordinate=1, position=0, velocity=2 /
&body link=2, mass=2, centre=0.1,0.02,0, inertia=0.02,0.03,0.04,0.001,0.002,0.003 /
&body link=5, mass=1, centre=0.25,0.25,0.2, inertia=0.05,0.06,0.07,0.004,0.005,0.006 /
&body link=7, mass=1.5, centre=0.3,0.5,0.2, inertia=0.03,0.03,0.04,0,0.001,0 /
&gravity acceleration=0,-3,-9 /
&load kind='spring', links=1,5, position=0.3,-0.2,0.6, second_position=0.2,0.3,0.1, stiffness=9, free_length=0.3, damping=0.4 /
&load kind='force', link=7, position=0.3,0.45,0.3, force=1,2,0.5, frame='link' /
&time end=0.4, intervals=4 /
"""
RSUR_PARAMETERS = (
    ('crank', "'pair(2).point(1)','pair(3).point(1)','pair(4).point(1)'", 0.2), ('rocker', "'pair(7).point(3)'", -0.1),
    ('tilt', "'pair(1).axis(1)'", 0.0), ('slant', "'pair(7).axis(2)'", 0.0), ('cross', "'pair(5).axis(2)'", 0.0),
    ('mass', "'body(2).mass'", 1.0), ('centre', "'body(2).centre(3)'", 0.2), ('product', "'body(2).inertia(4)'", 0.004),
    ('end', "'load(1).second_position(2)'", 0.3), ('damper', "'load(1).damping'", 0.4), ('arm', "'load(2).position(2)'", 0.45),
    ('pull', "'load(2).force(1)'", 1.0), ('start', "'initial(1).position'", 0.0), ('fall', "'gravity.acceleration(2)'", -3.0))

# The four-bar turns a wheel by a gear, and another wheel by a table of the crank's angle.
GEARED = FOUR_BAR + """&pair coordinate=5, links=1,5, kind='revolute', axis=0,0,1, point=-0.5,0,0 /
&pair coordinate=6, links=3,6, kind='revolute', axis=0,0,1, point=0.35,0.2,0 /
&body link=5, mass=1, centre=-0.4,0.05,0, inertia=0.01,0.01,0.02,0,0,0 /
&body link=6, mass=0.5, centre=0.5,0.1,0, inertia=0.02,0.02,0.03,0,0,0 /
&coupling coordinates=1,5, kind='gear', ratio=2, phase=0.2 /
&coupling coordinates=5,6, kind='gear', ratio=-0.7 /
"""
GEARED_PARAMETERS = (('ratio', "'coupling(1).ratio'", 2.0), ('second', "'coupling(2).ratio'", -0.7), ('crank', "'pair(2).point(1)'", 0.3),
                     ('wheel', "'body(5).centre(1)'", 0.5), ('at', "'pair(6).point(2)'", 0.2))

# Two closed chains on one another, and an arm beyond them.
SIX_BAR = FOUR_BAR.replace('cq=1', 'cq=1,8') + """&pair coordinate=5, links=3,5, kind='revolute', axis=0,0,1, point=0.4,0.2,0, moving_point=0,0,0 /
&pair coordinate=6, links=1,6, kind='revolute', axis=0,0,1, point=1.2,0.9,0, moving_point=0,0,0 /
&pair coordinate=7, links=6,5, kind='revolute', axis=0,0,1, point=0.8,0,0, moving_point=0.9,0,0 /
&pair coordinate=8, links=5,7, kind='revolute', axis=0,0,1, point=0.3,0.1,0, moving_point=0,0,0 /
&initial coordinate=5, position=0.6 /
&initial coordinate=6, position=0.3 /
&initial coordinate=8, position=-0.4, velocity=1.5 /
&body link=5, mass=1, centre=0.4,0.1,0, inertia=0.03,0.03,0.05,0,0,0 /
&body link=6, mass=1.2, centre=0.4,0,0, inertia=0.03,0.03,0.05,0,0,0 /
&body link=7, mass=0.8, centre=0.3,0.1,0, inertia=0.01,0.01,0.02,0,0,0 /
&load kind='coordinate', coordinate=7, stiffness=2, damping=0.1 /
"""
SIX_BAR_PARAMETERS = (
    ('crank', "'pair(2).point(1)'", 0.3), ('couple', "'pair(5).point(2)'", 0.2), ('rocker', "'pair(7).point(1)'", 0.8),
    ('link', "'pair(7).moving_point(2)'", 0.0), ('arm', "'pair(8).moving_point(1)'", 0.0), ('mass', "'body(4).mass'", 1.0),
    ('swing', "'initial(6).velocity'", 1.5), ('stiff', "'load(4).stiffness'", 2.0))

# The arms of a pendulum turn about parallel axes; a parameter tilts one of them.
TILTED = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.5,0,0 /
&initial coordinate=1, position=-0.3, velocity=1 /
&initial coordinate=2, position=0.4 /
&body link=2, mass=1, centre=0.3,0.1,0.05, inertia=0.02,0.03,0.04,0.001,0.002,0 /
&body link=3, mass=0.7, centre=0.8,0,0.1, inertia=0.01,0.02,0.02,0,0.001,0 /
&gravity acceleration=0,-9.81,0 /
&time end=0.5, intervals=4 /
"""
TILTED_PARAMETERS = (('tilt', "'pair(2).axis(1)'", 0.0), ('lean', "'pair(1).axis(2)'", 0.0), ('height', "'body(2).centre(3)'", 0.1))


# A pendulum on the closed chain in space, which a drive moves.
HUNG = RSUR.replace('&initial coordinate=1, position=0, velocity=2 /', "&drive coordinate=1, kind='polynomial', coefficients=0,2,1 /") \
    .replace('cq=1', 'cq=1,8') + """&pair coordinate=8, links=5,8, kind='revolute', axis=1,1,0, point=0.25,0.25,0.2 /
&initial coordinate=8, position=0.2, velocity=-1 /
&body link=8, mass=0.4, centre=0.2,0.4,0.1, inertia=0.01,0.01,0.02,0,0,0 /
"""
HUNG_PARAMETERS = (('speed', "'drive.coefficients(2)'", 2.0), ('crank', RSUR_PARAMETERS[0][1], 0.2), ('weight', "'body(4).mass'", 0.4))


@pytest.fixture
def case(checks, tmp_path, mech9k, mech9d):
    return Case(checks, tmp_path, mech9k, mech9d)


@pytest.mark.parametrize('why, text, parameters, part', (
    ('a closed chain in space', RSUR, RSUR_PARAMETERS, 2.0**-10),
    ('gears on a four-bar', GEARED, GEARED_PARAMETERS, 2.0**-10),
    ('two chains and an arm', SIX_BAR, SIX_BAR_PARAMETERS, 2.0**-10),
    ('a pendulum that leaves its plane', TILTED, TILTED_PARAMETERS, 2.0**-9),
    ('a pendulum on a driven chain', HUNG, HUNG_PARAMETERS, 2.0**-10)),
    ids=('closed chain in space', 'gears', 'two chains and an arm', 'tilted pendulum', 'pendulum on a driven chain'))
def test_derivatives_are_differences_of_runs(case, why, text, parameters, part):
    case.against_runs(text, parameters, why, part)


# Instructions with ten parameters are some three times those of a plain run (bench/measurements.md); times are less certain, and a
# program with all run-time checks differs. Spatial motions found for each parameter and each evaluation made this more than thirty.
MOST_COST = 9.0
# The derivatives are integrated under the same error control: more steps, but not many more.
MOST_EVALUATIONS = 1.8


def test_ten_parameters_cost_a_few_plain_runs(case):
    """Derivatives by ten parameters cost a few plain runs, and evaluations do not factorize the closed chains a second time."""
    parameters = FOUR_BAR_PARAMETERS[:10]
    counts, seconds = [], []
    for extra in ('', declared(parameters) + '&output sensitivities=.true. /\n'):
        path, report = (os.path.join(case.directory, name) for name in ('cost.nml', 'cost.json'))
        with open(path, 'w') as file:
            file.write(FOUR_BAR.replace('end=0.6', 'end=4') + SOLVER + extra)

        def used(*options):
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            done = run(case.mech9d, path, '--quiet', '--hdf5', os.path.join(case.directory, 'cost.h5'), '--report', report, *options)
            case.checks.equal(done.returncode, 0, 'the run ends well')
            return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before

        short = min(used('--set', 'time.end=0.1') for _ in range(3))
        seconds.append(min(used() for _ in range(3)) - short)
        with open(report) as file:
            counts.append(json.load(file))
    case.checks.true(counts[1]['evaluations'] <= MOST_EVALUATIONS * counts[0]['evaluations'], 'derivatives need few evaluations more',
                     f"{counts[1]['evaluations']}, against {counts[0]['evaluations']}")
    case.checks.true(counts[1]['factorizations'] <= 1.05 * counts[1]['evaluations'] + 100, 'derivatives take the factors of the motion',
                     f"{counts[1]['factorizations']} in {counts[1]['evaluations']} evaluations")
    case.checks.true(seconds[1] <= MOST_COST * max(seconds[0], 0.02), 'ten parameters cost little',
                     f'{seconds[1]:.3f} s, against {seconds[0]:.3f} s without derivatives')
