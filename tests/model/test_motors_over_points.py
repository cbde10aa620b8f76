"""Motors whose laws are over the position or velocity of a point: accelerations, rest, modes, exponents, multipliers against closed
forms; a slider whose point and coordinate are the same variable; derivatives by parameters; limits; units of the file; what is refused.

Compares the program with itself in part: a point and the coordinate that it follows; differences of runs at other values of a parameter;
SI and other units.
"""
import json
import os

import numpy as np
import pytest

from dynamic_derivatives import SOLVER, Case
from law_mechanisms import DEGREE, FOUR_BAR, NEAR, SLIDER_CRANK
from mech9_cases import run

# A rotor about z with a point at the radius 0.3, beside the axis; no gravity.
ROTOR = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0.9, velocity=1.7 /
&body link=2, mass=1, inertia=0,0,0.04,0,0,0 /
&point name='P', link=2, position=0.3,0,0.1 /
"""
RADIUS, INERTIA, VOLTAGE, RESISTANCE, CONSTANT, INDUCTANCE = 0.3, 0.04, -2.0, 0.7, 0.25, 0.05
DC = (f"&motor coordinate=1, kind='dc', voltage={VOLTAGE}, resistance={RESISTANCE}, constant={CONSTANT}{{}}, law='polynomial', "
      "coefficients={}, over='{}' /\n")
PID = "&motor coordinate=1, kind='pid', proportional=6{}, law='polynomial', coefficients=0.1,1.5,-2, over='{}' /\n"


@pytest.fixture
def case(checks, tmp_path, mech9k, mech9d):
    return Case(checks, tmp_path, mech9k, mech9d)


def report(case, text, *options):
    """The JSON report of mech9d."""
    path, told = os.path.join(case.directory, 'r.nml'), os.path.join(case.directory, 'r.json')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)
    done = run(case.mech9d, path, '--quiet', '--no-write', '--report', told, *options)
    case.checks.equal(done.returncode, 0, f'a report by {options}: {done.stderr}')
    with open(told, encoding='utf-8') as file:
        return json.load(file)


def numbers_of(path):
    """The data sets of an HDF5 file that hold numbers."""
    h5py = pytest.importorskip('h5py')
    found = {}

    def take(name, item):
        if isinstance(item, h5py.Dataset) and item.dtype.kind == 'f':
            found[name] = np.atleast_1d(item[()])
    with h5py.File(path) as file:
        file.visititems(take)
    return found


def test_torques_have_closed_forms(case):
    """Accelerations of the rotor by its angle and rate at the outputs."""
    end = '&time end=1, intervals=20 /\n' + SOLVER
    found = case.table(ROTOR + DC.format('', '1,0.5,3', 'P.y') + end)
    y = RADIUS * np.sin(found['q1'])
    torque = CONSTANT / RESISTANCE * (VOLTAGE * (1 + 0.5 * y + 3 * y**2) - CONSTANT * found['dq1'])
    case.close(found['M1.torque'], torque, NEAR, 'a voltage over a position')
    case.close(found['ddq1'], torque / INERTIA, NEAR, 'the acceleration that it gives')
    found = case.table(ROTOR + DC.format('', '1,0.5', 'P.vx') + end)
    v = -RADIUS * np.sin(found['q1']) * found['dq1']
    torque = CONSTANT / RESISTANCE * (VOLTAGE * (1 + 0.5 * v) - CONSTANT * found['dq1'])
    case.close(found['ddq1'], torque / INERTIA, NEAR, 'a voltage over a velocity')
    found = case.table(ROTOR + PID.format(', derivative=0.5, limit=4', 'P.x') + end)
    x, dx = RADIUS * np.cos(found['q1']), -RADIUS * np.sin(found['q1']) * found['dq1']
    demand = 6 * (0.1 + 1.5 * x - 2 * x**2 - found['q1']) + 0.5 * ((1.5 - 4 * x) * dx - found['dq1'])
    case.checks.true((abs(demand) > 4).any() and (abs(demand) < 4).any(), 'the limit is left on the way')
    case.close(found['ddq1'], np.clip(demand, -4, 4) / INERTIA, NEAR, 'a setpoint over a position, with its rate and a limit')
    case.close(found['M1.torque'], np.clip(demand, -4, 4), NEAR, 'its torque')


def integrate(rate, y, times):
    """Gragg's rule with Richardson's extrapolation: values at the times, of order 12."""
    rows = [y]
    for start, end in zip(times, times[1:]):
        pieces = 40
        for piece in range(pieces):
            h = (end - start) / pieces
            table = []
            for k in range(1, 7):
                n = 2 * k
                step = h / n
                before, now = rows[-1] if piece == 0 else y, None
                now = before + step * rate(before)
                for _ in range(n - 1):
                    before, now = now, before + 2 * step * rate(now)
                smooth = (before + now + step * rate(now)) / 2
                row = [smooth]
                for j in range(1, k):
                    factor = ((2 * k) / (2 * (k - j)))**2
                    row.append(row[-1] + (row[-1] - table[-1][j - 1]) / (factor - 1))
                table.append(row)
            y = table[-1][-1]
        rows.append(y)
    return np.array(rows)


@pytest.mark.parametrize('method', ('auto', 'bdf', 'prince-dormand'))
def test_currents_and_integrals_follow_points(case, method):
    """States of motors between outputs, too: dense output takes their second derivatives, with the acceleration of the point."""
    times = np.linspace(0, 1.5, 61)
    end = '&time end=1.5, intervals=60 /\n&solver method=\'' + method + "', relative_tolerance=1e-10, absolute_tolerance=1e-11 /\n"
    for over, bend, variable in (('P.y', 3, lambda q, w: RADIUS * np.sin(q)), ('P.vy', 0, lambda q, w: RADIUS * np.cos(q) * w)):
        found = case.table(ROTOR + DC.format(f', inductance={INDUCTANCE}', f'1,0.5,{bend}', over) + end)

        def rate(y, variable=variable, bend=bend):
            q, w, i = y
            x = variable(q, w)
            return np.array([w, CONSTANT * i / INERTIA,
                             (VOLTAGE * (1 + 0.5 * x + bend * x**2) - RESISTANCE * i - CONSTANT * w) / INDUCTANCE])
        expected = integrate(rate, np.array([0.9, 1.7, 0.0]), times)
        case.close(found['q1'], expected[:, 0], 1e-6, f'the angle with a voltage over {over}')
        case.close(found['M1.current'], expected[:, 2], 1e-6, f'the current with a voltage over {over}')
    found = case.table(ROTOR + PID.format(', integral=4, derivative=0.3', 'P.y') + end)

    def controlled(y):
        q, w, z = y
        x, dx = RADIUS * np.sin(q), RADIUS * np.cos(q) * w
        e = 0.1 + 1.5 * x - 2 * x**2 - q
        return np.array([w, (6 * e + 4 * z + 0.3 * ((1.5 - 4 * x) * dx - w)) / INERTIA, e])
    expected = integrate(controlled, np.array([0.9, 1.7, 0.0]), times)
    case.close(found['q1'], expected[:, 0], 1e-6, 'the angle with a setpoint over a position')
    case.close(found['M1.integral'], expected[:, 2], 1e-6, 'the integral')


def test_rest_modes_and_exponents_have_closed_forms(case):
    """A voltage in proportion to P.y is a spring k = -c V r/R cos q1 behind the back-voltage; with inductance the roots are those of
    a cubic. The sum of the exponents of a motion is that of these roots."""
    load = "&load kind='torque', link=2, torque=0,0,0.08 /\n"
    factor = CONSTANT / RESISTANCE
    angle = np.arcsin(0.08 / (-factor * VOLTAGE * RADIUS))
    stiffness, damping = -factor * VOLTAGE * RADIUS * np.cos(angle), factor * CONSTANT
    rotor = ROTOR.replace('position=0.9, velocity=1.7', 'position=0.2')
    for over, roots in (('P.y', np.roots([INERTIA, damping, stiffness])),):
        text = rotor + load + DC.format('', '0,1', over)
        case.checks.near(case.table(text, '--equilibrium')['q1'][0], angle, 1e-11, 'the position of rest', scale=1)
        modes = case.table(text, '--modes')
        mine = np.array(modes['eigenvalue.re']) + 1j * np.array(modes['eigenvalue.im'])
        case.checks.near(abs(mine - roots[roots.imag >= 0]).max(), 0.0, 1e-9, 'modes without inductance', scale=1)
    text = rotor + load + DC.format(f', inductance={INDUCTANCE}', '0,1', 'P.y')
    system = np.array([[0, 1, 0], [0, 0, CONSTANT / INERTIA],
                       [VOLTAGE * RADIUS * np.cos(angle) / INDUCTANCE, -CONSTANT / INDUCTANCE, -RESISTANCE / INDUCTANCE]])
    roots = np.linalg.eigvals(system)
    modes = case.table(text, '--modes')
    mine = np.sort_complex(np.array(modes['eigenvalue.re']) + 1j * np.array(modes['eigenvalue.im']))
    expected = np.sort_complex(roots[roots.imag >= 0])
    case.checks.equal(len(mine), len(expected), 'the number of modes')
    case.checks.near(abs(mine - expected).max(), 0.0, 1e-9, 'modes with inductance', scale=1)
    # a velocity in its place: the force -c V r cos q1 dq1/R is damping
    text = (rotor.replace('position=0.2', 'position=0') + "&load kind='coordinate', coordinate=1, stiffness=0.5 /\n"
            + DC.format(f', inductance={INDUCTANCE}', '0,1', 'P.vy'))
    system = np.array([[0, 1, 0], [-0.5 / INERTIA, 0, CONSTANT / INERTIA],
                       [0, (VOLTAGE * RADIUS - CONSTANT) / INDUCTANCE, -RESISTANCE / INDUCTANCE]])
    roots = np.linalg.eigvals(system)
    modes = case.table(text, '--modes')
    mine = np.sort_complex(np.array(modes['eigenvalue.re']) + 1j * np.array(modes['eigenvalue.im']))
    case.checks.near(abs(mine - np.sort_complex(roots[roots.imag >= 0])).max(), 0.0, 1e-9, 'modes over a velocity', scale=1)
    told = report(case, text + '&time end=20 /\n&exponents time=15 /\n' + SOLVER, '--exponents', '3')
    case.checks.near(sum(told['exponents']), sum(roots.real), 1e-6, 'the sum of the exponents is the divergence', scale=10)


def test_product_of_multipliers_is_that_of_the_divergence(case):
    """Liouville: the divergence is that of the current alone, -R/L, whatever the law over P.y is."""
    text = (ROTOR.replace('position=0.9, velocity=1.7', 'position=0.2') + DC.format(f', inductance={INDUCTANCE}', '0,1,0.4', 'P.y')
            + "&load kind='torque', link=2, torque=0,0,0.05, law='harmonic', amplitude=1, angular_frequency=6.283185307179586 /\n"
            '&periodic period=1 /\n' + SOLVER)
    told = report(case, text, '--periodic')['periodic']
    product = np.prod([complex(*one) for one in told['multipliers']])
    case.checks.near(np.log(abs(product)), -RESISTANCE / INDUCTANCE, 1e-6, 'the logarithm of the product', scale=10)


MOTORS = (DC.format(f', inductance={INDUCTANCE}', '1,0.5,0.3', '{}'), DC.format('', '1,0.5,0.3', '{}'),
          PID.format(', integral=2, derivative=0.3, limit=0.5', '{}'), PID.format('', '{}'))


@pytest.mark.parametrize('kind', range(4))
def test_a_point_and_the_coordinate_that_it_follows_are_one_variable(case, kind):
    """The piston B of a slider-crank stands at q4: all columns, derivatives by parameters, rest, modes and linearised equations."""
    crank = (SLIDER_CRANK + "&body link=2, mass=1, inertia=0,0,0.02,0,0,0 /\n&body link=3, mass=0.4, centre=0.12,0.02,0, inertia=0,0,0.003,0,0,0 /\n"
             "&initial coordinate=1, position=0.4, velocity=3 /\n&gravity acceleration=0,-9.81,0 /\n"
             "&load kind='coordinate', coordinate=4, stiffness=300, rest=0.33, damping=2 /\n&time end=0.4, intervals=8 /\n")
    parameters = ''.join(f"&parameter name='{name}', sets='{sets}', value={value!r} /\n" for name, sets, value in (
        ('crank', 'pair(2).point(1)', 0.1), ('rod', 'pair(3).point(1)', 0.3), ('bend', 'motor(1).coefficients(2)', (0.5, 0.5, 1.5, 1.5)[kind])))
    pairs = [('B.x', 'q4'), ('B.vx', 'dq4')] if kind < 2 or kind == 3 else [('B.x', 'q4')]
    for of_point, of_coordinate in pairs:
        for options in ([], ['--equilibrium'], ['--modes'], ['--linear']):
            if kind == 2 and options:      # its integral has no setpoint at rest
                continue
            texts = []
            for over in (of_point, of_coordinate):
                text = crank + MOTORS[kind].format(over) + SOLVER
                if not options:
                    text += parameters + '&output sensitivities=.true. /\n'
                if options[:1] == ['--linear']:
                    path = os.path.join(case.directory, 'a.nml')
                    with open(path, 'w', encoding='utf-8') as file:
                        file.write(text)
                    done = run(case.mech9d, path, '--quiet', '--linear', os.path.join(case.directory, 'a.h5'))
                    case.checks.equal(done.returncode, 0, f'linearised over {over}: {done.stderr}')
                    texts.append(numbers_of(os.path.join(case.directory, 'a.h5')))
                else:
                    texts.append(case.table(text, *options))
            case.checks.true(len(texts[0]) > 0 and texts[0].keys() == texts[1].keys(), 'the same columns', str(texts))
            for name in texts[0]:
                case.close(texts[0][name], texts[1][name], 2e-8, f'{of_point} and {of_coordinate}: {name} {options}')


@pytest.mark.parametrize('kind', range(4))
def test_derivatives_by_parameters(case, kind):
    """A point of the coupler of a four-bar, which moves with dimensions, its own place, and the law."""
    parameters = (('spot', 'point(1).position(1)', 0.4), ('side', 'point(1).position(2)', 0.3), ('crank', 'pair(2).point(1)', 0.2),
                  ('bend', 'motor.coefficients(3)', 0.3 if kind < 2 else -2.0),
                  ('gain', 'motor.resistance' if kind < 2 else 'motor.proportional', 0.7 if kind < 2 else 6.0))
    for over in ('P.x', 'P.vy') if kind < 2 else ('P.y',):
        case.against_runs(FOUR_BAR + MOTORS[kind].format(over) + '&time end=0.3, intervals=3 /\n', parameters, f'motor {kind} over {over}')


def test_in_space(case):
    """A ball joint carries a rod; a motor turns the base by the height of its end: derivatives, and the closed form of its torque."""
    text = """&structure cq=1,2,3,4 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinates=2,3,4, links=2,3, kind='spherical', point=0.2,0,0.5 /
&initial coordinate=1, position=0.1, velocity=0.5 /
&initial coordinate=2, position=0.4, velocity=0.3 /
&initial coordinate=3, position=0.2, velocity=-0.4 /
&initial coordinate=4, position=0.1, velocity=1 /
&body link=2, mass=2, centre=0.1,0,0.2, inertia=0.1,0.1,0.1,0,0,0 /
&body link=3, mass=1, centre=0.3,0.05,0.1, inertia=0.05,0.06,0.07,0,0,0 /
&gravity acceleration=0,0,-9.81 /
&point name='E', link=3, position=0.6,0.1,0.2 /
&time end=0.3, intervals=3 /
"""
    motor = "&motor coordinate=1, kind='pid', proportional=8, derivative=1.5{}, law='polynomial', coefficients=0.2,0.8,-0.5, over='E.z' /\n"
    found = case.table(text + motor.format('') + SOLVER)
    z, dz = found['E.z'], found['E.vz']
    expected = 8 * (0.2 + 0.8 * z - 0.5 * z**2 - found['q1']) + 1.5 * ((0.8 - z) * dz - found['dq1'])
    case.close(found['M1.torque'], expected, NEAR, 'the torque by the height of the end')
    parameters = (('height', 'point(1).position(3)', 0.2), ('joint', 'pair(2).point(3)', 0.5), ('bend', 'motor.coefficients(2)', 0.8))
    case.against_runs(text + motor.format(', integral=3'), parameters, 'a motor over a point in space')


def test_units_of_the_file(case):
    """In mm, degrees and rpm the voltage is over mm, and the setpoint in degrees."""
    end = '&time end=0.5, intervals=10 /\n' + SOLVER
    head = "&mechanism length_unit='mm', angle_unit='deg', rate_unit='rpm', force_unit='N' /\n"
    rotor = f"""&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position={0.9 / DEGREE!r}, velocity={1.7 * 30 / np.pi!r} /
&body link=2, mass=1, inertia=0,0,{0.04e6!r},0,0,0 /
&point name='P', link=2, position=300,0,100 /
"""
    dc = DC.replace(f'constant={CONSTANT}', f'constant={CONSTANT * 1e3!r}')
    for over, bend in (('P.y', 3.0), ('P.vy', 0.1)):
        plain = case.table(ROTOR + DC.format(f', inductance={INDUCTANCE}', f'1,0.5,{bend}', over) + end)
        named = case.table(head + rotor + dc.format(f', inductance={INDUCTANCE}', f'1,0.0005,{bend * 1e-6!r}', over) + end)
        case.close(named['q1'] * DEGREE, plain['q1'], NEAR, f'the angle over {over}')
        case.close(named['M1.current'], plain['M1.current'], NEAR, f'the current over {over}')
    pid = ("&motor coordinate=1, kind='pid', proportional=6000, derivative=500, law='polynomial', "
           f"coefficients={0.1 / DEGREE!r},{1.5e-3 / DEGREE!r},{-2e-6 / DEGREE!r}, over='P.x' /\n")
    plain = case.table(ROTOR + PID.format(', derivative=0.5', 'P.x') + end)
    case.close(case.table(head + rotor + pid + end)['q1'] * DEGREE, plain['q1'], NEAR, 'a setpoint in degrees over mm')


def test_refused(case):
    motor = "&motor coordinate=1, kind='pid', proportional=3{}, law='polynomial', coefficients=1,2, over='{}' /\n"
    for over in ('P.vx', 'dq1'):
        case.refused(ROTOR + motor.format(', derivative=1', over), 3, 'this is an acceleration')
    for over, words in (('P.ax', 'accelerations follow from the forces'), ('N.x', "there is no variable 'N.x'"), ('P.w', "there is no variable 'P.w'")):
        case.refused(ROTOR + motor.format('', over), 3, words)
    text = ROTOR + "&motor coordinate=1, kind='dc', resistance=1, constant=1, law='segments', times=0,0.1,0.2, values=1,2,1, laws='cycloidal', over='P.y' /\n"
    case.refused(text + '&time end=1 /\n', 7, 'P.y')
    path = os.path.join(case.directory, 'a.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(ROTOR + motor.format(', integral=1', 'P.y'))
    done = run(case.mech9d, path, '--quiet', '--equilibrium')
    case.checks.true(done.returncode == 3 and 'P.y' in done.stderr, 'an integral has no setpoint at rest over a point', done.stderr)
