"""Synthesis of motions under forces by mech9d --optimize: springs, masses, velocities at the start, dimensions and drives with closed
forms; a slider-crank whose numbers are found again; limits; one result from any number of threads, and after --continue; mistakes.
"""
import os
import shutil

import numpy as np
import pytest

from mech9_cases import TREE, run, text_of
from synthesis_cases import DATA, DONE, FILE, USAGE, Cases, is_recovered

# Free motions are integrated with tolerances of 1e-10; the numbers that are found have errors of some hundreds of it.
EXACT = 1e-7
SOLVER = '&solver relative_tolerance=1e-10, absolute_tolerance=1e-12 /\n'
OSCILLATOR = SOLVER + """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=2 /
&load kind='coordinate', coordinate=1, stiffness=30 /
&initial coordinate=1, position=0.1 /
&time end=1, intervals=20 /
&parameter name='k', sets='load(1).stiffness', low=20, high=300 /
&quantity name='x', of='q1', take='at', at=0.25 /
&quantity name='a', of='ddq1', take='peak' /
"""
THROWN = SOLVER + """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,1,0 /
&body link=3, mass=0.7 /
&gravity acceleration=0,-9.81,0 /
&initial coordinate=1, position=0, velocity=1 /
&initial coordinate=2, position=0.4, velocity=1 /
&time end=1.5, intervals=15 /
&parameter name='u', sets='initial(1).velocity', low=-5, high=10 /
&parameter name='v', sets='initial(2).velocity', low=-5, high=20 /
&quantity name='x', of='q1', take='end' /
&quantity name='y', of='q2', take='end' /
"""
BALANCED = SOLVER + """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&body link=2, mass=1.5, centre=0.4,0,0, inertia=0.1,0.1,0.1,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&load kind='force', link=2, position=-0.3,0,0, force=0,-10,0 /
&initial coordinate=1, position=0.2 /
&time end=0.5, intervals=10 /
&parameter name='counterweight', sets='load(1).force(2)', value=10, factors=-1, low=5, high=60 /
&quantity name='angle', of='q1', take='end' /
&objective kind='quantity', of='angle', goal=0.2 /
&optimum starts=4 /
"""
WEIGHT = 1.5*9.81*0.4/0.3   # [N]
ATWOOD = SOLVER + """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0, point=1,0,0 /
&coupling kind='linear', coordinates=1,2, coefficients=1,1, constant=0.5 /
&body link=2, mass=3 /
&body link=3, mass=1 /
&gravity acceleration=0,-9.81,0 /
&initial coordinate=1, position=0.3 /
&time end=0.5, intervals=10 /
&parameter name='mass', sets='body(2).mass', low=0.5, high=6 /
&quantity name='place', of='q1', take='end' /
&objective kind='quantity', of='place', goal=0.1 /
&optimum starts=4 /
"""


# The stiffness with which the mass has a period of one second.
STIFFNESS = 2*(2*np.pi)**2


@pytest.fixture
def cases(checks, tmp_path, mech9d):
    return Cases(checks, tmp_path, mech9d)


def test_a_spring_by_a_goal(cases):
    """A mass on a spring is at the middle after a quarter of a second where its period is one second."""
    goal = "&objective kind='quantity', of='x', goal=0 /\n&optimum starts=4 /\n"
    best = os.path.join(cases.folder, 'best.nml')
    designs, report, _ = cases.search(OSCILLATOR + goal, 'spring by a goal', '--out', best)
    cases.checks.near(designs['k'][0], STIFFNESS, EXACT, 'spring by a goal', scale=STIFFNESS)
    cases.checks.equal((report['optimum']['starts'], report['optimum']['reached'], report['program']), (4, 4, 'mech9d'), 'its report')
    motion = cases.motion(text_of(best))
    cases.checks.near(motion['q1'][::5], [0.1, 0, -0.1, 0, 0.1], EXACT, 'spring by a goal: the best file has the period', scale=0.1)


def test_a_spring_by_a_limit(cases):
    """With the least peak of the acceleration among all springs that bring it there or beyond, it is the same spring."""
    limit = "&objective kind='quantity', of='a', make='least' /\n&limit kind='quantity', of='x', high=0 /\n&optimum starts=4 /\n"
    designs, _, _ = cases.search(OSCILLATOR + limit, 'spring by a limit')
    # limits are kept with a margin of 1e-9 m, which is 6e-9 of the spring's range here
    cases.checks.near(designs['k'][0], STIFFNESS, 1e-6, 'spring by a limit', scale=STIFFNESS)
    cases.checks.near(designs['value'][0], 0.1*STIFFNESS/2, 1e-6, 'its acceleration')


GOALS = "&objective kind='quantity', of='x', goal=6 /\n&objective kind='quantity', of='y', goal=1 /\n&optimum starts=3 /\n"


def test_velocity_at_the_start(cases):
    """The velocity with which a body must be thrown to be at a place after some time."""
    designs, _, _ = cases.search(THROWN + GOALS, 'thrown')
    is_recovered(cases, designs, dict(u=6/1.5, v=(1 - 0.4 + 9.81*1.5**2/2)/1.5), 'thrown', value=1e-18, tolerance=EXACT)


def test_position_at_the_start(cases):
    # a position at the start, which is that of a closed chain: its coordinates follow it
    text = THROWN.replace("name='v', sets='initial(2).velocity', low=-5, high=20",
                          "name='h', sets='initial(2).position', low=-2, high=20")
    designs, _, _ = cases.search(text + GOALS, 'dropped')
    is_recovered(cases, designs, dict(u=4, h=1 - 1.5 + 9.81*1.5**2/2), 'dropped', value=1e-18, tolerance=EXACT)


def test_differences_in_place_of_derivatives_are_told(cases):
    """A push rises from a time that is searched to the end of its period, where it jumps: derivatives by this time are refused. The speed
    at the end is the mean of the push, a half, times its length."""
    push = SOLVER + """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1 /
&load kind='force', link=2, force=1,0,0, law='segments', times=0,0.1,0.3, values=0,0,1, laws='dwell','harmonic', period=0.3 /
&initial coordinate=1, position=0, velocity=0 /
&time end=0.3, intervals=10 /
&parameter name='begin', sets='load(1).times(2)', low=0.05, high=0.25 /
&quantity name='speed', of='dq1', take='end' /
&objective kind='quantity', of='speed', goal=0.05 /
&optimum starts=2 /
"""
    designs, _, said = cases.search(push, 'push')
    is_recovered(cases, designs, dict(begin=0.2), 'push', value=1e-14, tolerance=1e-5)
    cases.checks.true("note: the search takes differences of runs in place of derivatives of the quantities: derivatives by the parameter 'begin' "
                      'are not computed: it sets numbers of a law by which' in said, 'the reason is told', said)
    _, _, said = cases.search(push, 'push, without words', '--quiet')
    cases.checks.equal(said, '', '--quiet leaves it out')
    _, _, said = cases.search(BALANCED, 'counterweight')
    cases.checks.true('note:' not in said, 'nothing is said where derivatives are known', said)


def test_counterweight_of_a_lever(cases):
    """A lever stays where it is with a counterweight of equal moment."""
    designs, _, _ = cases.search(BALANCED, 'counterweight')
    is_recovered(cases, designs, dict(counterweight=WEIGHT), 'counterweight', value=1e-18, tolerance=EXACT)


def test_second_mass_of_atwoods_machine(cases):
    """It gives the first one its acceleration."""
    designs, _, _ = cases.search(ATWOOD, "Atwood's machine")
    upwards = 2*(0.1 - 0.3)/0.5**2
    is_recovered(cases, designs, dict(mass=3*(9.81 + upwards)/(9.81 - upwards)), "Atwood's machine", value=1e-18, tolerance=EXACT)


def test_spring_rod_and_start_of_a_slider_crank(cases):
    """Spring, rod and the angle at the start of a slider-crank are found again from four numbers of its motion; the rod changes its
    closed chain, and the angle its position at the start."""
    text = text_of(os.path.join(TREE, 'examples', 'slider_crank_sundials', 'slider_crank.nml'))
    text = text.replace('end=10.0, intervals=40', 'end=2, intervals=20').replace("&output table='slider_crank.dat' /", '')
    numbers = dict(crank=('q1', 'end'), slider=('q4', 'end'), mean=('q4', 'mean'), rate=('dq1', 'end'))
    text += ''.join(f"&quantity name='{name}', of='{of}', take='{take}' /\n" for name, (of, take) in numbers.items())
    done = run(cases.program, cases.write(text), '--no-write')
    wanted = {line.split()[0]: float(line.split()[2]) for line in done.stderr.splitlines() if line.split()[1:2] == ['=']}
    cases.checks.equal(sorted(wanted), sorted(numbers), 'slider-crank: the numbers of the motion')
    text += ''.join(f"&objective kind='quantity', of='{name}', goal={value!r} /\n" for name, value in wanted.items())
    text += "&parameter name='stiffness', sets='load(2).stiffness', value=1.4, low=0.5, high=2 /\n"
    text += "&parameter name='rod', sets='pair(3).moving_point(1)', value=1.1, low=0.9, high=1.2 /\n"
    text += "&parameter name='angle', sets='initial(1).position', value=1.5, low=1.2, high=1.8 /\n&optimum starts=3 /\n"
    designs, _, _ = cases.search(text, 'slider-crank')
    # quantities are printed with twelve digits
    is_recovered(cases, designs, dict(stiffness=1, rod=1, angle=np.pi/2), 'slider-crank', value=1e-18, tolerance=1e-7)


def test_voltage_and_resistance_of_a_motor(cases):
    """They are found again from the angle of its crank at two times."""
    text = text_of(os.path.join(TREE, 'examples', 'motor_crank', 'motor_crank.nml'))
    text = text.replace('end=2, intervals=400', 'end=0.6, intervals=12')
    text = text.replace("&output table='motor_crank.dat', reactions=.true., reaction_pairs=1 /", '')
    text += "&quantity name='early', of='q1', take='at', at=0.3 /\n&quantity name='late', of='q1', take='end' /\n"
    done = run(cases.program, cases.write(text), '--no-write')
    wanted = {line.split()[0]: float(line.split()[2]) for line in done.stderr.splitlines() if line.split()[1:2] == ['=']}
    cases.checks.equal(sorted(wanted), ['early', 'late'], 'motor: the numbers of the motion')
    text += ''.join(f"&objective kind='quantity', of='{name}', goal={value!r} /\n" for name, value in wanted.items())
    text += "&parameter name='voltage', sets='motor(1).voltage', value=10, low=5, high=20 /\n"
    text += "&parameter name='resistance', sets='motor(1).resistance', value=1, low=0.4, high=2 /\n&optimum starts=3 /\n"
    designs, _, _ = cases.search(text, 'motor')
    is_recovered(cases, designs, dict(voltage=12, resistance=0.8), 'motor', value=1e-18, tolerance=1e-6)


def test_runs_of_too_many_steps(cases):
    """Their designs have no value, and the search goes on."""
    stiff = OSCILLATOR.replace('high=300', 'high=1e12').replace('1e-12 /', '1e-12, maximum_steps=200 /')
    designs, _, _ = cases.search(stiff + "&objective kind='quantity', of='x', goal=0 /\n&optimum starts=3 /\n", 'stiff springs')
    cases.checks.near(designs['k'][0], 2*(2*np.pi)**2, 1e-6, 'stiff springs: the first start has a value', scale=80)


def test_counterweight_of_a_driven_lever(cases):
    """The counterweight of a lever that is driven at a constant rate: its drive needs no torque."""
    text = BALANCED.replace("&initial coordinate=1, position=0.2 /", "&drive coordinate=1, kind='polynomial', coefficients=0.2,12.566370614359172 /")
    text = text.replace("&quantity name='angle', of='q1', take='end' /\n&objective kind='quantity', of='angle', goal=0.2 /",
                        "&quantity name='torque', of='F1', take='at', at=0.1 /\n&objective kind='quantity', of='torque', goal=0 /\n"
                        "&output drive_forces=.true. /")
    designs, _, _ = cases.search(text, 'driven lever')
    is_recovered(cases, designs, dict(counterweight=WEIGHT), 'driven lever', value=1e-18, tolerance=1e-9)


def test_the_same_bits_from_threads_and_from_a_continued_search(cases):
    """The same bits from one, two and four threads, and from a search that is continued."""
    text = OSCILLATOR + "&objective kind='quantity', of='x', goal=0.02 /\n&objective kind='quantity', of='a', weight=1e-4 /\n&optimum starts=6 /\n"
    tables = []
    for count in (1, 2, 4):
        table, file = (os.path.join(cases.folder, f'threads{count}.{kind}') for kind in ('dat', 'h5'))
        done = run(cases.program, cases.write(text), '--optimize', '--table', table, '--threads', str(count), '--hdf5', file)
        cases.checks.true(done.returncode == DONE, f'{count} threads', done.stderr)
        tables.append(text_of(table))
    cases.checks.true(tables[0] == tables[1] == tables[2], 'the same bits from any number of threads')
    file, table = (os.path.join(cases.folder, name) for name in ('more.h5', 'more.dat'))
    done = run(cases.program, cases.write(text.replace('starts=6', 'starts=2')), '--optimize', '--hdf5', file)
    done = run(cases.program, cases.write(text), '--optimize', '--continue', file, '--table', table)
    cases.checks.true(done.returncode == DONE and text_of(table) == tables[0], 'the same bits when it is continued', done.stderr)
    shutil.copy(file, file + '.kept')
    # the search of another program is another one
    other = text.replace("low=20, high=300", "low=30, high=300")
    done = run(cases.program, cases.write(other), '--optimize', '--continue', file)
    with open(file, 'rb') as now, open(file + '.kept', 'rb') as before:
        cases.checks.true(done.returncode == FILE and now.read() == before.read(), 'another search is refused', done.stderr)


GOOD = OSCILLATOR + "&objective kind='quantity', of='x', goal=0 /\n"


@pytest.mark.parametrize('text, words, code, options', (
    (GOOD + "&point name='P', link=2 /\n&objective kind='path', point='P', file='path.dat' /\n", 'mech9d searches by quantities of its runs', DATA, ()),
    (GOOD + "&limit kind='assembles' /\n", 'mech9d keeps limits of quantities of its runs', DATA, ()),
    (OSCILLATOR, 'this file has none', USAGE, ()),
    (GOOD.replace("take='at', at=0.25", "take='at', at=3"), 'at', DATA, ()),
    (GOOD.replace("of='q1'", "of='F1'"), "quantity 'x' is of column 'F1', which is not recorded", DATA, ()),
    (GOOD, 'mech9d --optimize draws no pictures', USAGE, ('--sketch', 'best.svg')),
    (GOOD.replace('low=20, high=300', ''), 'no parameter is varied', DATA, ()),
    (GOOD.replace('position=0.1', 'velocity=0.1'), 'has no initial position', DATA, ())),
    ids=('a path', 'a limit of assembly', 'no objective', 'a late time', 'unknown column', 'a picture', 'no range', 'no position'))
def test_refused(cases, text, words, code, options):
    cases.write('0 0\n1 0\n2 1\n', 'path.dat')
    cases.refused(text, words, code, *options)
