"""Laws of loads and motors over coordinates, rates and points: a cubic spring and torque over speed against closed forms, gas force over
crank angle against virtual work, potentials of all laws against integrals of forces and by the balance of energy, stiffness and damping of
modes against static and moving drive forces, setpoints and voltages over coordinates against linear systems; what is refused.

Compares the program with itself in part: differences of runs at other values of a parameter; drive forces of mech9k and modes of mech9d;
radians and degrees; methods of integration.
"""
import json
import os

import numpy as np
import pytest

from dynamic_derivatives import SOLVER, Case
from law_mechanisms import DEGREE, FOUR_BAR, NEAR, SLIDER_CRANK
from mech9_cases import run

SLIDE = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=2 /
&initial coordinate=1, position=0.4, velocity={velocity} /
"""
# Loads of all kinds with laws of all kinds over dependent coordinates, rates and a point.
MANY = """&load kind='force', link=3, position=0.4,0.1,0, force=1,2,0, law='harmonic', mean=1, amplitude=3, angular_frequency=4, phase=0.5,
      over='P.x' /
&load kind='torque', link=4, torque=0,0,1, law='polynomial', coefficients=1,-0.02,0.3, over='q4' /
&load kind='spring', links=1,3, position=0.4,0,0, second_position=0.4,0.3,0, stiffness=20, free_length=0.1, damping=1,
      law='segments', times=-9,-1,0.5,9, values=1,2,0.5,3, laws='cycloidal', over='P.vy' /
&load kind='coordinate', coordinate=3, stiffness=2, rest=0.7, law='segments', times=0,1.5,6, values=1,2,1, laws='harmonic', period=6,
      over='q2' /
&load kind='coordinate', coordinate=1, damping=0.1, law='polynomial', coefficients=1,0.05, over='dq3' /
"""
PARAMETERS = (
    ('crank', 'pair(2).point(1)', 0.2), ('mass', 'body(2).mass', 0.5), ('spot', 'point(1).position(1)', 0.4), ('push', 'load(1).force(2)', 2.0),
    ('often', 'load(1).angular_frequency', 4.0), ('phase', 'load(1).phase', 0.5), ('swing', 'load(1).amplitude', 3.0),
    ('bend', 'load(2).coefficients(3)', 0.3), ('later', 'load(3).times(3)', 0.5), ('high', 'load(3).values(2)', 2.0),
    ('stiff', 'load(4).stiffness', 2.0), ('knee', 'load(4).times(2)', 1.5), ('damper', 'load(5).damping', 0.1),
    ('more', 'load(5).coefficients(2)', 0.05))


@pytest.fixture
def case(checks, tmp_path, mech9k, mech9d):
    return Case(checks, tmp_path, mech9k, mech9d)


def mean(a, b):
    """The arithmetic-geometric mean of Gauss."""
    while abs(a - b) > 1e-16 * a:
        a, b = (a + b) / 2, np.sqrt(a * b)
    return a


@pytest.mark.parametrize('method', ('auto', 'bdf', 'adams'))
def test_cubic_spring_has_the_period_of_an_elliptic_integral(case, method):
    """Duffing: m x'' = -k x - c x^3 from rest at A swings as A cn, in the period 2 pi/(w agm(1, sqrt(1 - p)))."""
    m, k, c, a = 2.0, 3.0, 50.0, 0.4
    square = (k + c * a**2) / m
    period = 2 * np.pi / (np.sqrt(square) * mean(1.0, np.sqrt(1 - c * a**2 / (2 * m * square))))
    text = SLIDE.format(velocity=0) + ("&load kind='coordinate', coordinate=1, force=-1, law='polynomial', coefficients=0,3,0,50, over='q1' /\n"
                                       f"&time end={5 * period!r}, intervals=20 /\n")
    found = case.table(text + SOLVER, '--set', f'solver.method={method}')
    tolerance = 1e-7 if method != 'auto' else NEAR
    case.close(found['q1'][::4], np.full(6, a), tolerance, 'back after each period')
    case.close(found['q1'][2::4], np.full(5, -a), tolerance, 'on the other side after half of it')
    case.close(found['E.potential'], k * found['q1']**2 / 2 + c * found['q1']**4 / 4, 1e-14, 'the potential')
    case.close(found['E.total'], np.full(21, found['E.total'][0]), tolerance, 'the balance of energy')


def test_torque_over_speed_and_damper_curve_have_closed_forms(case):
    """dw/dt = (T0 - k w)/J, in degrees; dv/dt = -(b v + d v^3)/m is Bernoulli's equation."""
    flywheel = ("&mechanism angle_unit='deg' /\n&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /\n"
                "&initial coordinate=1, position=0 /\n&body link=2, mass=1, inertia=0,0,0.5,0,0,0 /\n&time end=1, intervals=10 /\n")
    load = "&load kind='{}, {}, law='polynomial', coefficients=6,-0.01, over='dq1' /\n"
    slope = 0.01 / DEGREE
    for kind in (load.format("torque', link=2", 'torque=0,0,1'), load.format("coordinate', coordinate=1", 'force=1')):
        found = case.table(flywheel + kind + SOLVER)
        case.close(found['dq1'] * DEGREE, 6 / slope * (1 - np.exp(-slope / 0.5 * found['t'])), NEAR, f'speed by {kind}')
        case.close(found['E.potential'], np.zeros(11), 0, 'torque over speed has no potential')
    b, d, m, v = 3.0, 5.0, 2.0, 1.5
    text = SLIDE.format(velocity=v) + "&load kind='coordinate', coordinate=1, damping=1, law='polynomial', coefficients=3,0,5, over='dq1' /\n"
    found = case.table(text + SOLVER)
    decay = np.exp(-b / m * found['t'])
    case.close(found['dq1'], v * decay / np.sqrt(1 + d / b * v**2 * (1 - decay**2)), NEAR, 'a damper curve')


def piston(phi, r=0.1, length=0.3):
    """Place of the piston and its derivative by the crank angle."""
    rod = np.sqrt(length**2 - (r * np.sin(phi))**2)
    return r * np.cos(phi) + rod, -r * np.sin(phi) - r**2 * np.sin(phi) * np.cos(phi) / rod


def periodic_spline(x, y):
    """The periodic cubic spline through points by a full cyclic matrix, as a function."""
    n, h = len(x) - 1, np.diff(x)
    slope = np.diff(y) / h
    matrix, right = np.zeros((n, n)), np.zeros(n)
    for i in range(n):
        matrix[i, i - 1] += h[i - 1]
        matrix[i, i] += 2 * (h[i - 1] + h[i])
        matrix[i, (i + 1) % n] += h[i]
        right[i] = 6 * (slope[i] - slope[i - 1])
    bend = np.append(np.linalg.solve(matrix, right), 0)
    bend[-1] = bend[0]

    def value(at):
        at = x[0] + np.mod(at - x[0], x[-1] - x[0])
        i = np.clip(np.searchsorted(x, at, side='right') - 1, 0, n - 1)
        b = (at - x[i]) / h[i]
        a = 1 - b
        return a * y[i] + b * y[i + 1] + ((a**3 - a) * bend[i] + (b**3 - b) * bend[i + 1]) * h[i]**2 / 6
    return value


@pytest.mark.parametrize('unit', ('deg', 'rad'))
def test_gas_force_over_crank_angle_by_virtual_work(case, unit):
    """An indicator diagram over two turns in a file: the torque of an even crank by d'Alembert and virtual work; the speed of a free
    crank by the work of the gas."""
    one = DEGREE if unit == 'rad' else 1.0
    angles = np.array([0, 10, 25, 45, 80, 130, 180, 250, 360, 500, 640, 690, 712, 720.0]) * one
    forces = np.array([5200, 6000, 3900, 1900, 800, 350, 100, -20, -60, 40, 300, 1500, 4200, 5200.0])
    np.savetxt(os.path.join(case.directory, 'gas.dat'), np.stack((angles, forces), axis=1), fmt='%.17g')
    rad = 1.0 if unit == 'rad' else DEGREE
    gas = periodic_spline(angles * rad, forces)
    load = f"&load kind='force', link=4, force=-1,0,0, law='table', file='gas.dat', over='q1', period={720 * one!r} /\n"
    head = f"&mechanism angle_unit='{unit}' /\n"
    omega = 150.0
    driven = (head + SLIDER_CRANK + load + f"&drive coordinate=1, kind='polynomial', coefficients={-1.3 / rad!r},{omega / rad!r} /\n"
              '&time end=0.2, intervals=200 /\n')
    for program in (case.mech9k, case.mech9d):
        found = case.table(driven + '&output drive_forces=.true. /\n' + (SOLVER if program == case.mech9d else ''), program=program)
        phi = found['q1'] * rad
        _, slope = piston(phi)
        _, above = piston(phi + 1e-5)
        _, below = piston(phi - 1e-5)
        expected = 0.7 * (above - below) / 2e-5 * omega**2 * slope + gas(phi) * slope
        case.close(found['F1'], expected, 1e-9, f'torque of the crank in {unit}')
    start = 0.4
    free = (head + SLIDER_CRANK.replace('link=4, mass=0.7', "link=4, mass=0.7 /\n&body link=2, mass=1, inertia=0,0,0.3,0,0,0") + load
            + f"&initial coordinate=1, position={start / rad!r}, velocity={100 / rad!r} /\n&time end=0.15, intervals=30 /\n")
    found = case.table(free + SOLVER)
    phi = found['q1'] * rad
    nodes, weights = np.polynomial.legendre.leggauss(12)
    work = [0.0]
    for a, b in zip(phi[:-1], phi[1:]):
        ends = np.linspace(a, b, 41)
        at = (ends[:-1, None] + ends[1:, None]) / 2 + np.diff(ends)[:, None] / 2 * nodes
        work.append(work[-1] - (np.diff(ends)[:, None] / 2 * weights * gas(at) * piston(at)[1]).sum())
    case.close(found['E.kinetic'] - found['E.kinetic'][0], np.array(work), 1e-6, f'work of the gas in {unit}')


def test_force_over_its_own_point_is_conservative(case):
    """A force along x over the place of the piston: its potential, taken by hand, and the kinetic energy have a constant sum."""
    text = (SLIDER_CRANK.replace('link=4, mass=0.7', "link=4, mass=0.7 /\n&body link=2, mass=1, inertia=0,0,0.3,0,0,0")
            + "&load kind='force', link=4, force=1,0,0, law='polynomial', coefficients=0,-800,0,900, over='B.x' /\n"
            + '&initial coordinate=1, position=0.4, velocity=5 /\n&time end=2, intervals=40 /\n')
    found = case.table(text + SOLVER)
    energy = found['E.kinetic'] + 400 * found['B.x']**2 - 225 * found['B.x']**4
    case.close(energy, np.full(41, energy[0]), NEAR, 'kinetic energy and potential')
    case.close(found['E.potential'], np.zeros(41), 0, 'a law over a point counts as work')


LAWS = {
    'polynomial': "law='polynomial', coefficients=1,-2,3,0.5",
    'harmonic': "law='harmonic', mean=0.5, amplitude=2, angular_frequency=4, phase=0.7",
    'slow harmonic': "law='harmonic', mean=0.5, amplitude=2, angular_frequency=0.2, phase=0.7",
    'table': "law='table', file='curve.dat'",
    'table that repeats': "law='table', file='wave.dat', period=0.9",
    'segments': "law='segments', times=-3,-1,-0.2,0.1,0.4,0.8,1.5,3, values=2,1,1.5,1.5,3,-1,2,0, "
                "laws='cycloidal','harmonic','dwell','modified-sine','modified-trapezoidal','polynomial345','polynomial4567'",
    'segments that repeat': "law='segments', times=0.1,0.45,0.8, values=1,2,1, laws='modified-trapezoidal','cycloidal', period=0.7",
    'segments with kinks': "law='segments', times=0.1,0.4,0.8, values=1,2,1, laws='modified-trapezoidal','constant-velocity', period=0.7",
    'segments beyond zero': "law='segments', times=0.1,0.35,2.8, values=1,2,1, laws='modified-sine','modified-trapezoidal'"}
REPEATED = ('wave.dat', np.array([-0.4, -0.2, 0, 0.15, 0.3, 0.5]), np.array([1, 2, 0.5, -1, 0.2, 1.0]))


def write_curves(directory):
    x = np.linspace(-3, 3, 25)
    np.savetxt(os.path.join(directory, 'curve.dat'), np.stack((x, np.sin(2 * x) + 0.3 * x), axis=1), fmt='%.17g')
    np.savetxt(os.path.join(directory, 'wave.dat'), np.stack(REPEATED[1:], axis=1), fmt='%.17g')


@pytest.mark.parametrize('law', LAWS)
def test_potential_is_the_integral_of_the_force(case, law):
    """The load of a coordinate that moves evenly through 0 is the force of its drive without mass: its integral over the coordinate,
    by Simpson's rule over 4000 intervals, is the potential."""
    write_curves(case.directory)
    first = 0.1 if law == 'segments beyond zero' else -1.8
    text = ("&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /\n&body link=2, mass=1e-9 /\n"
            f"&load kind='coordinate', coordinate=1, stiffness=4, rest=0.3, force=-1, {LAWS[law]}, over='q1' /\n"
            f"&drive coordinate=1, kind='polynomial', coefficients={first},1 /\n"
            f"&time end={2.5 - first}, intervals=4000 /\n&output drive_forces=.true. /\n")
    found = case.table(text)
    q, force, potential = found['q1'], found['F1'], found['E.potential']
    step = q[1] - q[0]
    simpson = np.concatenate(([0], np.cumsum(step / 3 * (force[:-2:2] + 4 * force[1:-1:2] + force[2::2]))))
    # kinks of force lie between outputs: errors of some squares of a step
    case.close(potential[::2] - potential[0], simpson, 1e-6, f'{law}: the integral of the force')
    at = 0.0 if first < 0 else first
    near = np.argmin(np.abs(q - at))
    case.checks.near(potential[near], force[near] * (q[near] - at), 1e-5, f'{law}: zero at {at}', scale=1)


@pytest.mark.parametrize('law', LAWS)
def test_energy_is_constant_on_every_curve(case, law):
    write_curves(case.directory)
    text = (SLIDE.format(velocity=0.3) + f"&load kind='coordinate', coordinate=1, force=-1, {LAWS[law]}, over='q1' /\n"
            "&load kind='coordinate', coordinate=1, stiffness=3, rest=0.5, law='polynomial', coefficients=1,0.5,2, over='q1' /\n"
            '&load kind=\'coordinate\', coordinate=1, stiffness=30, rest=0.6 /\n&time end=3, intervals=60 /\n')
    found = case.table(text + SOLVER)
    # steps meet kinks by their control of errors
    case.close(found['E.total'], np.full(61, found['E.total'][0]), 1e-8, f'{law}: the balance of energy')


@pytest.mark.parametrize('law', [law for law in LAWS if law != 'segments with kinks'])
def test_energies_vary_with_the_numbers_of_all_laws(case, law):
    write_curves(case.directory)
    numbers = {'polynomial': (('a', 'load(1).coefficients(2)', -2.0),),
               'harmonic': (('a', 'load(1).angular_frequency', 4.0), ('b', 'load(1).phase', 0.7), ('c', 'load(1).mean', 0.5)),
               'slow harmonic': (('a', 'load(1).angular_frequency', 0.2), ('b', 'load(1).amplitude', 2.0)),
               'segments': (('a', 'load(1).times(4)', 0.1), ('b', 'load(1).times(5)', 0.4), ('c', 'load(1).values(5)', 3.0)),
               'segments that repeat': (('a', 'load(1).times(2)', 0.45), ('b', 'load(1).values(2)', 2.0)),
               'segments beyond zero': (('a', 'load(1).times(2)', 0.35), ('b', 'load(1).values(2)', 2.0))}
    parameters = (('stiff', 'load(1).stiffness', 4.0), ('rest', 'load(1).rest', 0.3), ('force', 'load(1).force', -1.0)) + numbers.get(law, ())
    text = (SLIDE.format(velocity=0.3) + f"&load kind='coordinate', coordinate=1, stiffness=4, rest=0.3, force=-1, {LAWS[law]}, over='q1' /\n"
            "&load kind='coordinate', coordinate=1, stiffness=60, rest=0.7 /\n&time end=0.5, intervals=3 /\n")
    case.against_runs(text, parameters, law, 2.0**-10)


def test_many_laws_by_differences_of_runs(case):
    case.against_runs(FOUR_BAR + MANY + '&time end=0.5, intervals=3 /\n', PARAMETERS, 'a four-bar linkage', 2.0**-9)


def test_forces_of_drives_and_pairs_by_differences_of_runs(case):
    """Derivatives of inverse dynamics, in mech9k, by the virtual powers of loads whose factors follow the motion."""
    text = (FOUR_BAR + MANY + "&drive coordinate=1, kind='polynomial', coefficients=0.3,1.5,-0.4 /\n&time end=0.5, intervals=3 /\n"
            '&output sensitivities=.true., drive_forces=.true., reactions=.true. /\n')
    found = case.table(text + declared(PARAMETERS), program=case.mech9k)
    for number, (name, _, value) in enumerate(PARAMETERS, 1):
        step = 1e-4 * max(abs(value), 0.1)
        runs = [case.table(text + declared(PARAMETERS), '--set', f'parameter({number}).value={value + sign * step!r}', program=case.mech9k)
                for sign in (1, -1)]
        for column in ('F1', 'R2.fx', 'R3.fy', 'R4.fx'):
            expected = (runs[0][column] - runs[1][column]) / (2 * step)
            case.close(found[f'd({column})/d({name})'], expected, 1e-5, f'{column} by {name}')


def declared(parameters):
    return ''.join(f"&parameter name='{name}', sets='{target}', value={value!r} /\n" for name, target, value in parameters)


def drive_force(case, laws, q, rate):
    """The drive force of the crank in a position and with a rate, without acceleration, by mech9k."""
    text = FOUR_BAR.replace('&initial coordinate=1, position=0.3 /\n', '') + laws + (f"&drive coordinate=1, kind='polynomial', coefficients={q!r},{rate!r} /\n&time end=0, intervals=0 /\n"
                              '&output drive_forces=.true. /\n')
    return case.table(text, program=case.mech9k)['F1'][0]


def test_modes_by_stiffness_and_damping_of_drive_forces(case):
    """Stiffness and damping as derivatives of the drive force of the crank by its place and rate; inertia by the kinetic energy."""
    rest = case.table(FOUR_BAR + MANY, '--equilibrium')
    q = rest['q1'][0]
    case.checks.near(drive_force(case, MANY, q, 0.0), 0.0, 1e-10, 'no force holds the equilibrium', scale=1)
    h = 1e-4
    stiffness = (8 * (drive_force(case, MANY, q + h, 0.0) - drive_force(case, MANY, q - h, 0.0))
                 - drive_force(case, MANY, q + 2 * h, 0.0) + drive_force(case, MANY, q - 2 * h, 0.0)) / (12 * h)
    damping = (drive_force(case, MANY, q, h) - drive_force(case, MANY, q, -h)) / (2 * h)
    moving = FOUR_BAR.replace('position=0.3 /', f'position={q!r}, velocity=1 /') + '&time end=0, intervals=0 /\n'
    inertia = 2 * case.table(moving)['E.kinetic'][0]
    modes = case.table(FOUR_BAR + MANY, '--modes')
    root = np.sqrt(complex((damping / inertia)**2 / 4 - stiffness / inertia)) - damping / inertia / 2
    case.checks.near([modes['eigenvalue.re'][0], abs(modes['eigenvalue.im'][0])], [root.real, abs(root.imag)], 1e-7, 'the mode', scale=abs(root))


def test_weight_on_a_spring_curve(case):
    """m g = k x + c x^3 by Cardano's formula, and the frequency of small vibrations there."""
    m, k, c, g = 2.0, 30.0, 500.0, 9.81
    text = SLIDE.format(velocity=0) + ("&gravity acceleration=9.81,0,0 /\n&load kind='coordinate', coordinate=1, force=-1, law='polynomial', "
                                       "coefficients=0,30,0,500, over='q1' /\n")
    half, third = m * g / (2 * c), k / (3 * c)
    root = np.sqrt(half**2 + third**3)
    x = np.cbrt(half + root) + np.cbrt(half - root)
    case.checks.near(case.table(text, '--equilibrium')['q1'][0], x, 1e-12, 'the position of rest', scale=1)
    frequency = np.sqrt((k + 3 * c * x**2) / m) / (2 * np.pi)
    case.checks.near(case.table(text, '--modes')['frequency'][0], frequency, 1e-12, 'the frequency', scale=1)


def test_equilibrium_beside_the_end_of_a_table(case):
    """The search does not fail where a step would lead beyond a curve: the weight rests shortly before its end."""
    write_curves(case.directory)
    x = np.linspace(0, 0.4, 9)
    np.savetxt(os.path.join(case.directory, 'stiff.dat'), np.stack((x, 20 * x + 900 * x**3), axis=1), fmt='%.17g')
    text = SLIDE.format(velocity=0).replace('0.4', '0.05') + (
        "&gravity acceleration=30,0,0 /\n&load kind='coordinate', coordinate=1, force=-1, law='table', file='stiff.dat', over='q1' /\n")
    root = np.roots([900, 0, 20, -60])
    expected = root[abs(root.imag) < 1e-12].real[0]
    case.checks.near(case.table(text, '--equilibrium')['q1'][0], expected, 1e-10, 'the position of rest', scale=1)


def test_motors_over_coordinates(case):
    """A voltage in proportion to the rate of another coordinate, and a setpoint in proportion to another coordinate, make linear systems:
    accelerations at the outputs, and modes against the characteristic polynomial."""
    slides = ("&structure cq=1,2 /\n&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /\n"
              "&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0 /\n&body link=2, mass=2 /\n&body link=3, mass=3 /\n"
              "&initial coordinate=1, position=0.4, velocity=0.2 /\n&initial coordinate=2, position=-0.3 /\n"
              "&load kind='coordinate', coordinate=1, stiffness=50, damping=1 /\n&load kind='coordinate', coordinate=2, stiffness=20 /\n"
              '&time end=1, intervals=10 /\n')
    pid = ("&motor coordinate=2, kind='pid', proportional=30, derivative=4{}, law='polynomial', coefficients=0.1,0.5, over='q1' /\n")
    found = case.table(slides + pid.format('') + SOLVER)
    force = 30 * (0.1 + 0.5 * found['q1'] - found['q2']) + 4 * (0.5 * found['dq1'] - found['dq2'])
    case.close(found['ddq2'], (force - 20 * found['q2']) / 3, NEAR, 'a setpoint over another coordinate')
    case.close(found['M1.torque'], force, NEAR, 'its force')
    dc = ("&motor coordinate=2, kind='dc', voltage=2, resistance=4{}, constant=3, law='polynomial', coefficients=1,0.5,0.2, over='dq1' /\n")
    found = case.table(slides + dc.format('') + SOLVER)
    factor = 1 + 0.5 * found['dq1'] + 0.2 * found['dq1']**2
    case.close(found['ddq2'], (3 * (2 * factor - 3 * found['dq2']) / 4 - 20 * found['q2']) / 3, NEAR, 'a voltage over a rate')
    # the current: L i' = V(dq1) - R i - k dq2; eigenvalues of the whole linear system about rest
    modes = case.table(slides + dc.format(', inductance=0.5') + SOLVER, '--modes')
    system = np.zeros((5, 5))
    system[0, 2] = system[1, 3] = 1
    system[2] = [-25, 0, -0.5, 0, 0]
    system[3] = [0, -20 / 3, 0, 0, 1]
    system[4] = [0, 0, 2 * 0.5 / 0.5, -3 / 0.5, -4 / 0.5]
    expected = np.sort_complex(np.linalg.eigvals(system))
    expected = expected[expected.imag >= 0]
    mine = np.sort_complex(np.array(modes['eigenvalue.re']) + 1j * np.array(modes['eigenvalue.im']))
    case.checks.equal(len(mine), len(expected), 'the number of modes')
    case.checks.near(np.abs(mine - expected).max(), 0.0, 1e-9, 'modes with a voltage over a rate', scale=10)
    parameters = (('mass', 'body(1).mass', 2.0), ('slope', 'motor.coefficients(2)', 0.5), ('stiff', 'load(1).stiffness', 50.0))
    short = slides.replace('end=1, intervals=10', 'end=0.4, intervals=3')
    case.against_runs(short + pid.format(', limit=3'), parameters, 'a setpoint with a limit', 2.0**-9)
    case.against_runs(short + dc.format(', inductance=0.5'), parameters, 'a voltage with inductance', 2.0**-9)


def test_gradients_of_quantities(case):
    text = (FOUR_BAR + MANY + declared(PARAMETERS[3:6]) + SOLVER + "&time end=0.5, intervals=50 /\n"
            "&quantity name='last', of='P.x', take='end' /\n&quantity name='work', of='E.kinetic', take='end' /\n")
    found = case.table(text + '&output sensitivities=.true. /\n')
    report = os.path.join(case.directory, 'report.json')
    path = os.path.join(case.directory, 'b.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text + '&output gradients=.true. /\n')
    done = run(case.mech9d, path, '--quiet', '--no-write', '--report', report)
    case.checks.equal(done.returncode, 0, f'gradients alone: {done.stderr}')
    with open(report, encoding='utf-8') as file:
        told = json.load(file)['quantities']
    for quantity, column in zip(told, ('P.x', 'E.kinetic')):
        case.checks.near([by['value'] for by in quantity['gradient']],
                         [found[f'd({column})/d({name})'][-1] for name, _, _ in PARAMETERS[3:6]], 1e-10, f'gradient of {column}', scale=1)


@pytest.mark.parametrize('program', ('mech9k', 'mech9d'))
def test_motion_beyond_a_curve_ends_with_code_7(case, program):
    drive = "&drive coordinate=1, kind='polynomial', coefficients=0,40 /\n"
    text = ("&mechanism angle_unit='deg' /\n&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /\n&body link=2, mass=1 /\n"
            "&load kind='torque', link=2, torque=0,0,1 /\n{}&load kind='torque', link=2, torque=0,0,1, law='segments', times=0,20,30, "
            "values=1,2,1, laws='cycloidal'{}, over='q1' /\n&time end=1, intervals=10 /\n&output drive_forces=.true. /\n")
    path = os.path.join(case.directory, 'a.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text.format(drive, ''))
    done = run(getattr(case, program), path, '--quiet', '--table', '-')
    case.checks.equal(done.returncode, 7, 'beyond the last segment')
    words = ' '.join(done.stderr.split())
    for word in ('load 2', 'q1 = 0 deg to q1 = 30 deg', 'leads to q1 = 3', 'period=', 'a.nml:7:1'):
        case.checks.true(word in words, f'the message has {word}', done.stderr)
    case.checks.equal(len(done.stdout.splitlines()) > 6, True, 'the rows before are kept')
    found = case.table(text.format(drive, ', period=30'), program=getattr(case, program))
    way = 0.3 - np.sin(0.6 * np.pi) / (2 * np.pi)
    case.checks.near(found['F1'][9], -1 - (1 + way), 1e-12, 'with a period it goes on: 36 degrees are 6', scale=1)


REFUSED = (
    ("over='ddq1'", 'accelerations follow from the forces'), ("over='P.ax'", 'accelerations follow from the forces'),
    ("over='q7'", "there is no variable 'q7'"), ("over='P.y2'", "there is no variable 'P.y2'"), ("over='N.x'", "there is no variable 'N.x'"),
    ("over='Q1'", "there is no variable 'Q1'"), ("over='dd'", "there is no variable 'dd'"), ("over=''", "there is no variable ''"),
    ("over='.x'", "there is no variable '.x'"), ("over='q'", "there is no variable 'q'"))


def test_refused_variables(case):
    text = FOUR_BAR + "&load kind='torque', link=2, torque=0,0,1, law='polynomial', coefficients=1,2, {} /\n"
    for over, words in REFUSED:
        case.refused(text.format(over), 3, words)
    case.refused(FOUR_BAR + "&load kind='torque', link=2, torque=0,0,1, over='q1' /\n", 3, "'over' needs law='polynomial'")
    case.refused(FOUR_BAR + "&load kind='torque', link=2, torque=0,0,1, law='segments', times=0,1,2, values=1,2,3, laws='cycloidal', period=2, "
                 "over='q1' /\n", 3, 'would jump from 3 back to 1 over q1')
    case.refused(FOUR_BAR + "&load kind='torque', link=2, torque=0,0,1, law='segments', times=0,1,2, values=1,2,1, laws='cycloidal', period=3, "
                 "over='q1' /\n", 3, 'the segments last 2 rad, which leaves a gap in a period of 3 rad')
    write_curves(case.directory)
    case.refused(FOUR_BAR + "&load kind='torque', link=2, torque=0,0,1, law='table', file='curve.dat', period=6, over='q1' /\n", 3,
                 'the table repeats, and would jump')
    motor = "&motor coordinate=1, kind='pid', proportional=3, derivative=1, law='polynomial', coefficients=1,2, over='{}' /\n"
    case.refused(FOUR_BAR + motor.format('dq3'), 3, 'this is an acceleration')


@pytest.mark.parametrize('tolerance', (1e-8, 1e-11))
def test_kinks_over_a_coordinate_cost_no_accuracy(case, tolerance):
    """A mass flies freely, swings half a period against a spring that begins at 0, and flies back: steps meet both kinks by their
    control of errors, within some hundred tolerances."""
    text = (SLIDE.format(velocity=-2).replace('mass=2', 'mass=1').replace('0.4', '0.5')
            + "&load kind='coordinate', coordinate=1, force=-1, law='segments', times=-5,-1,0,5, values=-51,-50,0,0, "
            "laws='constant-velocity','constant-velocity','dwell', over='q1' /\n&time end=1.5, intervals=3 /\n"
            f'&solver relative_tolerance={tolerance!r}, absolute_tolerance={tolerance!r} /\n')
    found = case.table(text)
    back = 0.25 + np.pi / np.sqrt(50)
    case.checks.near([found['q1'][-1], found['dq1'][-1]], [2 * (1.5 - back), 2.0], 200 * tolerance, 'free flight behind the spring', scale=1)


def test_names_of_pairs_stand_for_coordinates(case):
    load = "&load kind='torque', link=2, torque=0,0,1, law='harmonic', amplitude=2, angular_frequency=5, over='{}' /\n&time end=0.2, intervals=2 /\n"
    named = FOUR_BAR.replace('&pair coordinate=4,', "&pair coordinate=4, name='rocker',")
    numbered = case.table(FOUR_BAR + load.format('dq4'))
    by_name = case.table(named + load.format('rocker.dq'))
    case.checks.true(all((numbered[name] == by_name[name]).all() for name in numbered), 'rocker.dq is dq4')


def test_law_over_t_is_a_law_of_time(case):
    text = FOUR_BAR + "&load kind='torque', link=2, torque=0,0,1, law='harmonic', amplitude=2, angular_frequency=5{} /\n&time end=0.2, intervals=2 /\n"
    plain, named = case.table(text.format('')), case.table(text.format(", over='t'"))
    case.checks.true(all((plain[name] == named[name]).all() for name in plain), "over='t' changes nothing")


def test_laws_count_in_the_units_of_the_file(case):
    """One slider-crank in SI, and in mm, degrees, rpm and kN: laws over an angle, its rate, a length and a point."""
    def text(head, length, angle, rate, force):
        return (head + f"""&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point={0.1 / length!r},0,0, moving_point=0,0,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point={0.3 / length!r},0,0, moving_point=0,0,0, axis=0,0,1 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0 /
&initial coordinate=1, position={0.4 / angle!r}, velocity={20 / rate!r} /
&initial coordinate=4, position={0.38 / length!r} /
&body link=4, mass=0.7 /
&body link=2, mass=1, inertia=0,0,{0.3 / length**2!r},0,0,0 /
&point name='B', link=4 /
&load kind='force', link=4, force={80 / force!r},0,0, law='harmonic', mean=0.3, amplitude=2, angular_frequency=2, phase={0.7 / angle!r},
      over='q1' /
&load kind='torque', link=2, torque=0,0,{5 / force / length!r}, law='polynomial', coefficients=1,{-0.07 * rate!r}, over='dq1' /
&load kind='force', link=4, force={90 / force!r},0,0, law='polynomial', coefficients=0,{-3 * length!r},{4 * length**2!r}, over='B.x' /
&load kind='coordinate', coordinate=4, stiffness={200 / force * length!r}, rest={0.2 / length!r}, law='segments',
      times={0.1 / length!r},{0.3 / length!r},{0.5 / length!r}, values=1,2,1.5, laws='harmonic', over='q4' /
&load kind='coordinate', coordinate=4, damping={3 / force * length!r}, law='polynomial', coefficients=1,{0.4 * length!r}, over='B.vx' /
&time end=0.6, intervals=12 /
""")
    head = "&mechanism length_unit='mm', angle_unit='deg', rate_unit='rpm', force_unit='kN' /\n"
    plain = case.table(text('', 1.0, 1.0, 1.0, 1.0) + SOLVER)
    named = case.table(text(head, 1e-3, DEGREE, np.pi / 30, 1e3) + SOLVER)
    case.close(named['q1'] * DEGREE, plain['q1'], NEAR, 'the angle of the crank')
    case.close(named['B.vx'] * 1e-3, plain['B.vx'], NEAR, 'the velocity of the piston')
    case.close(named['E.potential'], plain['E.potential'], NEAR, 'the potential, in kN mm')
    path = os.path.join(case.directory, 'a.nml')
    beyond = text(head, 1e-3, DEGREE, np.pi / 30, 1e3).replace(',500.0, values', ',390.0, values')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(beyond)
    done = run(case.mech9d, path, '--quiet', '--table', '-')
    case.checks.equal(done.returncode, 7, 'beyond 390 mm')
    case.checks.true('from q4 = 100 mm to q4 = 390 mm only' in ' '.join(done.stderr.split()), 'in the units of the file', done.stderr)
