"""Derivatives of motions with motors by parameters: of a flywheel with a direct-current motor and of a slide with a controller against
complex steps in exponentials of matrices; of a four-bar linkage, with limits, laws and integral parts, and of a motion through changes of the
independent coordinates, against differences of whole runs; at outputs within steps and with all methods alike; HDF5 and gradients.

Compares the program with itself in part: differences of runs at other values of a parameter; other methods of integration.
"""
import json
import os

import numpy as np
import pytest

from dynamic_derivatives import PENDULUM_FOUR_BAR, SOLVER, TOLERANCE, TOLERANCES, Case, declared
from law_mechanisms import FOUR_BAR
from mech9_cases import run

FLYWHEEL = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0.1, velocity=0.3 /
&body link=2, mass=1, inertia=0,0,0.02,0,0,0 /
&motor coordinate=1, kind='dc', voltage=12, resistance=0.8, inductance=0.02, constant=0.05, gear_ratio=20 /
&time end=0.3, intervals=6 /
"""
FLYWHEEL_PARAMETERS = (('voltage', 'motor.voltage', 12.0), ('resistance', 'motor.resistance', 0.8), ('inductance', 'motor.inductance', 0.02),
                       ('constant', 'motor.constant', 0.05), ('ratio', 'motor.gear_ratio', 20.0), ('inertia', 'body.inertia(3)', 0.02),
                       ('speed', 'initial.velocity', 0.3))
SLIDE = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&initial coordinate=1, position=0.1, velocity=0.2 /
&body link=2, mass=2 /
&load kind='coordinate', coordinate=1, stiffness=50, damping=1 /
&motor coordinate=1, kind='pid', proportional=80, integral=60, derivative=7, setpoint=0.4 /
&time end=0.5, intervals=5 /
"""
SLIDE_PARAMETERS = (('proportional', 'motor.proportional', 80.0), ('integral', 'motor.integral', 60.0), ('derivative', 'motor.derivative', 7.0),
                    ('setpoint', 'motor.setpoint', 0.4), ('mass', 'body.mass', 2.0), ('stiffness', 'load.stiffness', 50.0),
                    ('damping', 'load.damping', 1.0), ('start', 'initial.position', 0.1))
LINKAGE = FOUR_BAR + """&motor coordinate=1, {} /
&time end=0.3, intervals=3 /
"""
MECHANISM_PARAMETERS = (('mass', 'body(2).mass', 0.5), ('crank', 'pair(2).point(1)', 0.2), ('start', 'initial(1).position', 0.3))


@pytest.fixture
def case(checks, tmp_path, mech9k, mech9d):
    return Case(checks, tmp_path, mech9k, mech9d)


def exponential(matrix):
    """Of a small matrix, of complex numbers too: Taylor's series of a part of it, squared again and again."""
    squarings = 12
    part = matrix / 2**squarings
    total = term = np.eye(len(matrix), dtype=complex)
    for k in range(1, 16):
        term = term @ part / k
        total = total + term
    for _ in range(squarings):
        total = total @ total
    return total


def flywheel(values, times):
    """Columns of the flywheel: J w' = k i and L i' = V - R i - k w with k = constant times ratio."""
    voltage, resistance, inductance, constant, ratio, inertia, speed = values
    k = constant * ratio
    matrix = np.zeros((4, 4), dtype=complex)
    matrix[0, 1] = 1
    matrix[1, 2] = k / inertia
    matrix[2, 1:] = [-k / inductance, -resistance / inductance, voltage / inductance]
    states = np.array([exponential(matrix * t) @ np.array([0.1, speed, 0, 1], dtype=complex) for t in times])
    q, w, current = states[:, 0], states[:, 1], states[:, 2]
    return {'q1': q, 'dq1': w, 'ddq1': k * current / inertia, 'M1.current': current, 'M1.torque': k * current, 'R1.mz': k * current,
            'E.kinetic': inertia * w**2 / 2}


def slide(values, times):
    """Columns of the slide: m v' = -c x - b v + F with F = P e + I (integral of e) - D v and e = setpoint - x."""
    proportional, integral, derivative, setpoint, mass, stiffness, damping, start = values
    matrix = np.zeros((4, 4), dtype=complex)
    matrix[0, 1] = 1
    force = np.array([-proportional, -derivative, integral, proportional * setpoint], dtype=complex)
    matrix[1] = (force + np.array([-stiffness, -damping, 0, 0])) / mass
    matrix[2] = [-1, 0, 0, setpoint]
    states = np.array([exponential(matrix * t) @ np.array([start, 0.2, 0, 1], dtype=complex) for t in times])
    return {'q1': states[:, 0], 'dq1': states[:, 1], 'ddq1': states @ matrix[1], 'M1.integral': states[:, 2], 'M1.torque': states @ force,
            'E.kinetic': mass * states[:, 1]**2 / 2, 'E.potential': stiffness * states[:, 0]**2 / 2}


@pytest.mark.parametrize('name, text, parameters, motion', (
    ('flywheel', FLYWHEEL, FLYWHEEL_PARAMETERS, flywheel), ('slide', SLIDE, SLIDE_PARAMETERS, slide)), ids=('flywheel', 'slide'))
def test_linear_motions_by_complex_steps_of_their_closed_forms(case, name, text, parameters, motion):
    found = case.table(text + SOLVER + declared(parameters) + '&output sensitivities=.true., reactions=.true. /\n')
    values = np.array([value for _, _, value in parameters], dtype=complex)
    plain = motion(values, found['t'])
    for column in plain:
        case.close(found[column], plain[column].real, TOLERANCES * TOLERANCE, f'{name}: {column} is that of the run')
    for number, (parameter, _, _) in enumerate(parameters):
        shifted = values.copy()
        shifted[number] += 1e-30j
        for column, numbers in motion(shifted, found['t']).items():
            case.close(found[f'd({column})/d({parameter})'], numbers.imag / 1e-30, TOLERANCES * TOLERANCE, f'{name}: {column} by {parameter}')


DC = "kind='dc', voltage=12, resistance=0.8, inductance=0.02, constant=0.05, gear_ratio=20"
PID = "kind='pid', proportional=30, integral=40{}, setpoint=1.2"


@pytest.mark.parametrize('why, motor, parameters', (
    ('a motor', DC, (('inductance', 'motor.inductance', 0.02),)),
    ('no inductance', DC.replace('inductance=0.02, ', ''), (('ratio', 'motor.gear_ratio', 20.0), ('resistance', 'motor.resistance', 0.8))),
    ('voltage by a law', DC + ", law='harmonic', mean=0.2, amplitude=1, angular_frequency=9",
     (('often', 'motor.angular_frequency', 9.0), ('voltage', 'motor.voltage', 12.0))),
    ('a controller', PID.format(', derivative=3'), (('setpoint', 'motor.setpoint', 1.2), ('derivative', 'motor.derivative', 3.0))),
    ('a controller with a limit', PID.format(', derivative=3, limit=9'),
     (('limit', 'motor.limit', 9.0), ('integral', 'motor.integral', 40.0), ('derivative', 'motor.derivative', 3.0))),
    ('without a derivative part', PID.format(', limit=9'), (('limit', 'motor.limit', 9.0), ('proportional', 'motor.proportional', 30.0)))),
    ids=('motor', 'no inductance', 'voltage by a law', 'controller', 'controller with a limit', 'no derivative part'))
def test_four_bar_linkage_by_differences_of_runs(case, why, motor, parameters):
    case.against_runs(LINKAGE.format(motor), parameters + MECHANISM_PARAMETERS[:1 + 2 * (why == 'a motor')], f'four-bar linkage with {why}',
                      2.0**-9)


def test_changes_of_the_independent_coordinates(case):
    """The derivatives of a motor's state go on where other coordinates become independent."""
    motor = "&motor coordinate=4, kind='dc', voltage=5, resistance=0.8, inductance=0.5, constant=0.05, gear_ratio=20 /\n"
    case.against_runs(PENDULUM_FOUR_BAR + motor, (('mass', 'body(1).mass', 20.0), ('inductance', 'motor.inductance', 0.5)),
                      'through changes of coordinates', 2.0**-9)


def test_other_methods_of_integration(case):
    """Outputs within steps, and all methods: they differ by a thousand tolerances at most."""
    text = LINKAGE.format("kind='pid', proportional=30, integral=40, derivative=3, limit=9, setpoint=1.2").replace('intervals=3', 'intervals=30')
    text += declared((('limit', 'motor.limit', 9.0),)) + '&output sensitivities=.true. /\n'
    runs = [case.table(text + f"&solver method='{method}', relative_tolerance=1e-11, absolute_tolerance=1e-12 /\n")
            for method in ('auto', 'verner', 'bdf')]
    for other in runs[1:]:
        for column in other:
            if column.startswith('d('):
                case.close(other[column], runs[0][column], 1e-8, f'with other methods: {column}')


def test_gradient_of_a_quantity_is_that_of_the_column_at_the_end(case):
    text = FLYWHEEL + SOLVER + declared(FLYWHEEL_PARAMETERS[:2])
    found = case.table(text + '&output sensitivities=.true. /\n')
    path = os.path.join(case.directory, 'b.nml')
    report = os.path.join(case.directory, 'report.json')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text + "&quantity name='last', of='M1.torque', take='end' /\n&output gradients=.true. /\n")
    done = run(case.mech9d, path, '--quiet', '--no-write', '--report', report)
    case.checks.equal(done.returncode, 0, f'gradients alone: {done.stderr}')
    with open(report, encoding='utf-8') as file:
        told = [by['value'] for by in json.load(file)['quantities'][0]['gradient']]
    case.checks.near(told, [found[f'd(M1.torque)/d({name})'][-1] for name in ('voltage', 'resistance')], 1e-12, 'the gradient of a torque', scale=1)


def test_hdf5_file_has_the_derivatives_of_motors(case):
    try:
        import h5py
    except ImportError:
        case.checks.left_out('h5py is not installed (Debian: python3-h5py)')
        return
    hdf5 = os.path.join(case.directory, 'b.h5')
    text = FLYWHEEL + SOLVER + declared(FLYWHEEL_PARAMETERS[:2])
    found = case.table(text + '&output sensitivities=.true. /\n', '--hdf5', hdf5)
    with h5py.File(hdf5) as file:
        for column in ('current', 'torque'):
            case.checks.true((file[f'sensitivity/M1_{column}'][:, 1] == found[f'd(M1.{column})/d(resistance)']).all(), f'M1_{column} in the file')
