"""Derivatives of free motions by parameters: of a double pendulum against eighth-order differences of motions in extended precision;
of closed chains, through changes of the independent coordinates, with springs, forces and drives, against differences of
whole runs, energies and poses of links among them; identities of scaling, of the start and of driven motions; what is refused, and why.

Compares the program with itself in part: differences of runs at other values of a parameter, and mech9d with mech9k.
"""
import os

import numpy as np
import pytest

from dynamic_derivatives import (BEAD, BY_RUNS, FOUR_BAR, FOUR_BAR_PARAMETERS, PENDULUM_FOUR_BAR, SOLVER, SPATIAL, SPATIAL_PARAMETERS, TOLERANCE,
                                 TOLERANCES, TURNING, WEIGHTS, Case, declared)
from mech9_cases import TREE, text_of

DOUBLE_PENDULUM = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point={bar!r},0,0, moving_point=0,0,0 /
&initial coordinate=1, position={first!r}, velocity={rate!r} /
&initial coordinate=2, position={second!r}, velocity=0 /
&body link=2, mass={upper!r}, centre={bar!r},0,0 /
&body link=3, mass={lower!r}, centre={swing!r},0,0 /
&gravity acceleration=0,{fall!r},0 /
&time start=0, end=1.5, intervals=6 /
"""
# name, its targets, value
PENDULUM_PARAMETERS = (
    ('bar', "'pair(2).point(1)','body(1).centre(1)'", 1.0), ('swing', "'body(2).centre(1)'", 0.8),
    ('upper', "'body(1).mass'", 2.0), ('lower', "'body(2).mass'", 1.0), ('fall', "'gravity.acceleration(2)'", -9.81),
    ('first', "'initial(1).position'", 0.3), ('second', "'initial(2).position'", 0.4), ('rate', "'initial(1).velocity'", 0.7))
@pytest.fixture
def case(checks, tmp_path, mech9k, mech9d):
    return Case(checks, tmp_path, mech9k, mech9d)


def pendulum_accelerations(q, w, values):
    """Accelerations of both angles of the pendulum, from Lagrange's equations."""
    bar, swing, upper, lower, fall = values[:5]
    c1, c12 = np.cos(q[0]), np.cos(q[0] + q[1])
    s2, c2 = np.sin(q[1]), np.cos(q[1])
    a11 = (upper + lower) * bar**2 + lower * swing**2 + 2 * lower * bar * swing * c2
    a12 = lower * swing**2 + lower * bar * swing * c2
    a22 = lower * swing**2
    f1 = lower * bar * swing * s2 * (2 * w[0] * w[1] + w[1]**2) + fall * ((upper + lower) * bar * c1 + lower * swing * c12)
    f2 = -lower * bar * swing * s2 * w[0]**2 + fall * lower * swing * c12
    det = a11 * a22 - a12**2
    return np.array([(a22 * f1 - a12 * f2) / det, (a11 * f2 - a12 * f1) / det])


def pendulum_energies(q, w, values):
    """Kinetic, potential and total energy of the pendulum, whose centres turn about the z axis."""
    bar, swing, upper, lower, fall = values[:5]
    square = (bar * w[0])**2 + (swing * (w[0] + w[1]))**2 + 2 * bar * swing * w[0] * (w[0] + w[1]) * np.cos(q[1])
    kinetic = (upper * (bar * w[0])**2 + lower * square) / 2
    potential = -fall * ((upper + lower) * bar * np.sin(q[0]) + lower * swing * np.sin(q[0] + q[1]))
    return np.array([kinetic, potential, kinetic + potential])


def pendulum_motion(values, times):
    """q, dq, ddq and energies at times, by extrapolation of the midpoint rule (Gragg, Bulirsch and Stoer) in extended precision."""
    y = np.array([values[5], values[6], values[7], 0], dtype=np.longdouble)
    rows = []

    def rate(y):
        return np.concatenate([y[2:], pendulum_accelerations(y[:2], y[2:], values)])

    def step(y, length):
        counts = [2 * k for k in range(1, 11)]
        table = []
        for k, count in enumerate(counts):
            h = length / count
            before, here = y, y + h * rate(y)
            for _ in range(count - 1):
                before, here = here, before + 2 * h * rate(here)
            row = [(here + before + h * rate(here)) / 2]
            for j in range(k):
                ratio = (np.longdouble(count) / counts[k - 1 - j])**2
                row.append(row[j] + (row[j] - table[k - 1][j]) / (ratio - 1))
            table.append(row)
        return table[-1][-1]

    for i, t in enumerate(times):
        if i > 0:
            for _ in range(4):
                y = step(y, np.longdouble(t - times[i - 1]) / 4)
        rows.append(np.concatenate([y[:2], y[2:], pendulum_accelerations(y[:2], y[2:], values), pendulum_energies(y[:2], y[2:], values)]))
    return np.array(rows)


def test_double_pendulum_in_extended_precision(case):
    values = {name: value for name, _, value in PENDULUM_PARAMETERS}
    found = case.sensitivities(DOUBLE_PENDULUM.format(**values) + SOLVER, PENDULUM_PARAMETERS)
    exact = [np.longdouble(value) for value in values.values()]
    for number, name in enumerate(values):
        step, expected = np.longdouble(2.0**-8), 0
        for i, weight in enumerate(WEIGHTS, 1):
            weight = (np.longdouble(4) / 5, -np.longdouble(1) / 5, np.longdouble(4) / 105, -np.longdouble(1) / 280)[i - 1]
            above, below = (pendulum_motion([v + (sign * i * step if k == number else 0) for k, v in enumerate(exact)], found['t'])
                            for sign in (1, -1))
            expected = expected + weight * (above - below) / step
        for k, column in enumerate(('q1', 'q2', 'dq1', 'dq2', 'ddq1', 'ddq2', 'E.kinetic', 'E.potential', 'E.total')):
            case.close(found[f'd({column})/d({name})'], expected[:, k], TOLERANCES * TOLERANCE, f'double pendulum: {column} by {name}')


# with equal masses
EQUAL_PENDULUM = DOUBLE_PENDULUM.format(bar=1.0, swing=0.8, upper=1.0, lower=1.0, fall=-9.81, first=0.3, second=0.4, rate=0.7) + SOLVER


def test_factor_of_all_masses(case):
    masses = "'body(1).mass','body(2).mass'"
    found = case.sensitivities(EQUAL_PENDULUM, (('all', masses, 1.0),))
    for column, numbers in found.items():
        if column.startswith('d(E'):
            # this factor is 1, and energies are in proportion to it
            case.close(numbers, found[column[2:column.index(')')]], 1e-9, f'a factor of all masses changes energies alike: {column}')
        elif column.startswith('d('):
            case.checks.true(np.abs(numbers).max() <= 1e-9, f'a factor of all masses changes no motion: {column}', f'{numbers}')


def test_factor_of_lengths_and_gravity(case):
    lengths = (('size', "'pair(2).point(1)','body(1).centre(1)','body(2).centre(1)','gravity.acceleration(2)'", 1.0),)
    scaled = EQUAL_PENDULUM + declared(lengths).replace(' /', ', factors=1,1,0.8,-9.81 /') + '&output sensitivities=.true. /\n'
    found = case.table(scaled)
    for column, numbers in found.items():
        if column.startswith('d(E'):
            case.close(numbers, 2 * found[column[2:column.index(')')]], 1e-9, f'energies are in proportion to its square: {column}')
        elif column.startswith('d('):
            case.checks.true(np.abs(numbers).max() <= 1e-9, f'a factor of lengths and gravity changes no angle: {column}', f'{numbers}')


def test_derivatives_at_the_start(case):
    start = (('first', 'initial(1).position', 0.3), ('rate', 'initial(1).velocity', 0.7))
    found = case.sensitivities(EQUAL_PENDULUM, start)
    for name, expected in (('first', [1, 0, 0, 0]), ('rate', [0, 0, 1, 0])):
        case.checks.near([found[f'd({q})/d({name})'][0] for q in ('q1', 'q2', 'dq1', 'dq2')], expected, 1e-14, f'at the start, by {name}',
                         scale=1)


def test_driven_motions_have_the_same_derivatives_in_both_programs(case):
    """Driven motions in mech9d have the derivatives that they have in mech9k."""
    driven = FOUR_BAR.replace(', velocity=1.0', '') + "&drive coordinate=1, kind='polynomial', coefficients=0.2,3 /\n"
    parameters = tuple(p for p in FOUR_BAR_PARAMETERS if p[0] not in ('first', 'rate')) + (('speed', 'drive.coefficients(2)', 3.0),)
    mine, others = (case.sensitivities(driven, parameters, program=program) for program in (case.mech9d, case.mech9k))
    for column in others:
        if column.startswith('d('):
            case.close(mine[column], others[column], 1e-12, f'a driven motion in mech9d: {column}')
    case.against_runs(driven, parameters, 'a driven motion in mech9d')


def test_hdf5_file_has_the_derivatives_of_energies(case):
    """Derivatives of energies in the HDF5 file are those of the table."""
    try:
        import h5py
    except ImportError:
        case.checks.left_out('h5py is not installed (Debian: python3-h5py)')
        return
    path = os.path.join(case.directory, 'a.h5')
    found = case.sensitivities(FOUR_BAR, FOUR_BAR_PARAMETERS[:3], '--hdf5', path)
    with h5py.File(path) as file:
        for part in ('kinetic', 'potential', 'total'):
            data = file[f'sensitivity/E_{part}']
            case.checks.equal((data.shape, data.dims[1][0].name), ((5, 3), '/parameter'), f'shape and scale of E_{part}')
            for p, (name, _, _) in enumerate(FOUR_BAR_PARAMETERS[:3]):
                case.checks.true((data[:, p] == found[f'd(E.{part})/d({name})']).all(), f'E_{part} by {name}')


@pytest.mark.parametrize('mechanism', ('free four-bar linkage', 'open chain in space', 'driven four-bar linkage'))
def test_derivatives_of_poses(case, mechanism):
    """Derivatives of the poses of links in the HDF5 file, against differences of runs."""
    try:
        import h5py
    except ImportError:
        case.checks.left_out('h5py is not installed (Debian: python3-h5py)')
        return
    path = os.path.join(case.directory, 'a.h5')
    text, parameters, program = {
        'free four-bar linkage': (FOUR_BAR + SOLVER, (FOUR_BAR_PARAMETERS[0], FOUR_BAR_PARAMETERS[7]), case.mech9d),
        'open chain in space': (SPATIAL + SOLVER, SPATIAL_PARAMETERS[:2], case.mech9d),
        'driven four-bar linkage': (FOUR_BAR.replace(', velocity=1.0', '') + "&drive coordinate=1, kind='polynomial', coefficients=0.2,3 /\n",
                                    FOUR_BAR_PARAMETERS[:1], case.mech9k)}[mechanism]

    def poses(*options):
        case.table(text + declared(parameters) + '&output poses=.true. /\n', '--hdf5', path, *options, program=program)
        with h5py.File(path) as file:
            found = {name: file[name][()] for name in ('origin', 'rotation')}
            found.update({f'd {name}': file[f'sensitivity/{name}'][()] for name in found if 'sensitivity' in file})
            return found

    found = poses('--set', 'output.sensitivities=.true.')
    case.checks.equal(found['d rotation'].shape, (*found['rotation'].shape, len(parameters)), 'the parameter is the last dimension')
    for p, (name, _, value) in enumerate(parameters):
        step = 2.0**-9 * max(abs(value), 0.1)
        runs = [[poses('--set', f'parameter({p + 1}).value={value + sign * i * step!r}') for sign in (1, -1)] for i in (1, 2, 3, 4)]
        for data in ('origin', 'rotation'):
            expected = sum(weight * (above[data] - below[data]) / step for weight, (above, below) in zip(WEIGHTS, runs))
            case.close(found[f'd {data}'][..., p], expected, BY_RUNS, f'{data} of all links by {name}')


@pytest.mark.parametrize('part', (2.0**-9, 2.0**-6))
def test_stiff_governor(case, part):
    """Stiff springs: the stiff governor of the gallery, by the place of one of its rods and others, with two steps of differences."""
    text = text_of(os.path.join(TREE, 'examples', 'flyball_governor', 'flyball_governor.nml'))
    text = '\n'.join(line for line in text.splitlines() if not line.startswith(('&solver', '&output'))) + '\n'
    text = text.replace('end=10.0, intervals=200', 'end=0.6, intervals=4')
    case.against_runs(text, (('place', 'pair(3).point(1)', 0.05), ('ball', 'body(2).mass', 5.3), ('stiff', 'load(1).stiffness', 8e5)),
                      'governor', part)


@pytest.mark.parametrize('law', ('cycloidal', 'polynomial345'))
def test_smooth_joints_of_laws(case, law):
    """Drives that move between rests by smooth laws have no jumps of their rates but round-off: derivatives go on behind the joints."""
    text = f"""&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&drive coordinate=1, kind='segments', times=0,0.2,0.3,0.7, values=0,0,0.05,0, laws='{law}' /
&initial coordinate=2, position=0.3 /
&body link=3, mass=5, centre=0,-3,0 /
&gravity acceleration=0,-9.81,0 /
&time end=0.7, intervals=7 /
"""
    case.against_runs(text, (('depth', 'body(1).centre(2)', -3.0),), f'joints of {law}')


# A pendulum on a slide that a drive moves in segments.
CARRIED = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&drive coordinate=1, kind='segments', {law} /
&initial coordinate=2, position=0.3 /
&body link=3, mass=5, centre=0,-3,0 /
&gravity acceleration=0,-9.81,0 /
&time {times}, intervals=5 /
"""
# A double pendulum on such a slide, whose joint a controller with a limit moves.
CONTROLLED = """&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0,-1,0 /
&drive coordinate=1, kind='segments', times=0,0.2,0.4,2, values=0,0,0.05,0.05, laws='dwell','constant-velocity','dwell' /
&motor coordinate=3, kind='pid', proportional=30, derivative=4, integral=5, limit=20, law='segments', times=0,0.3,0.5,2,
       values=0,0,1,1, laws='dwell','cycloidal','dwell' /
&initial coordinate=2, position=0.3 /
&initial coordinate=3, position=0.1 /
&body link=3, mass=2, centre=0,-0.5,0, inertia=0,0,0.1,0,0,0 /
&body link=4, mass=1, centre=0.1,-0.5,0, inertia=0,0,0.1,0,0,0 /
&load kind='coordinate', coordinate=2, damping=0.5 /
&gravity acceleration=0,-9.81,0 /
&time end=0.8, intervals=5 /
"""
# A five-bar whose first crank a drive turns from rest to rest: one coordinate of its closed chain is free.
FIVE_BAR = """&structure cq=1,5 /
&pair coordinate=1, links=1,2, kind='revolute', point=0,0,0, axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.3,0,0, axis=0,0,1, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.7,0,0, axis=0,0,1, moving_point=0.6,0,0 /
&pair coordinate=4, links=4,5, kind='revolute', point=0,0,0, axis=0,0,1, moving_point=0.4,0,0 /
&pair coordinate=5, links=1,5, kind='revolute', point=0.8,0,0, axis=0,0,1, moving_point=0,0,0 /
&drive coordinate=1, kind='segments', times=0,0.1,0.37,2, values=1.2,1.2,1.6,1.6, laws='dwell','harmonic','dwell' /
&initial coordinate=2, position=-0.9 /
&initial coordinate=3, position=-1.5 /
&initial coordinate=4, position=0.4 /
&initial coordinate=5, position=1.4, velocity=0.3 /
&body link=3, mass=1, centre=0.3,0.05,0, inertia=0,0,0.05,0,0,0 /
&body link=4, mass=1.5, centre=0.3,0,0, inertia=0,0,0.04,0,0,0 /
&body link=5, mass=2, centre=0.2,0,0, inertia=0,0,0.03,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&load kind='coordinate', coordinate=5, damping=0.2 /
&point name='P', link=3, position=0.4,0.2,0 /
&time end=0.6, intervals=5 /
"""


# Times and values of laws in segments as parameters: beyond a joint whose time varies the derivatives of the free rates have jumped by
# the jump of the accelerations. Outputs lie between the joints.

@pytest.mark.parametrize('law', ('cycloidal', 'harmonic', 'polynomial345'))
def test_times_of_a_law(case, law):
    text = CARRIED.format(law=f"times=0,0.2,0.3,0.7, values=0,0,0.05,0, laws='{law}'", times='end=0.62')
    case.against_runs(text, (('from', 'drive.times(2)', 0.2), ('to', 'drive.times(3)', 0.3), ('over', 'drive.values(3)', 0.05)),
                      f'times of {law}')


def test_times_of_the_drive_of_a_five_bar(case):
    case.against_runs(FIVE_BAR, (('from', 'drive.times(2)', 0.1), ('to', 'drive.times(3)', 0.37),
                                 ('angle', "'drive.values(3)','drive.values(4)'", 1.6)),
                      'times of the drive of a five-bar')


def test_a_shift_of_both_times_is_the_sum_of_both(case):
    delayed = (('shift', "'drive.times(2)','drive.times(3)'", 0.1),)
    text = declared(delayed).replace(' /', ', terms=0,0.27 /')
    found = case.table(FIVE_BAR + SOLVER + text + '&output sensitivities=.true. /\n')
    apart = case.sensitivities(FIVE_BAR + SOLVER, (('from', 'drive.times(2)', 0.1), ('to', 'drive.times(3)', 0.37)))
    for column in ('q5', 'dq5', 'ddq5', 'P.vx', 'E.total'):
        case.close(found[f'd({column})/d(shift)'], apart[f'd({column})/d(from)'] + apart[f'd({column})/d(to)'], 1e-9,
                   f'a shift of both times is the sum of both: {column}')


def test_times_of_the_law_of_a_load(case):
    bent = FOUR_BAR.replace("law='harmonic', mean=1, amplitude=0.5, angular_frequency=3",
                            "law='segments', times=0,0.2,0.33,1, values=0,0,1,1, laws='dwell','harmonic','dwell'")
    case.against_runs(bent, (('from', 'load(2).times(2)', 0.2), ('to', 'load(2).times(3)', 0.33), ('mass', 'body(2).mass', 1.0)),
                      'times of the law of a load')


def test_times_of_the_setpoint_of_a_controller(case):
    led = BEAD.replace("&drive coordinate=1, kind='{law}' /", """&initial coordinate=1, position=0 /
&body link=2, mass=1, inertia=0.1,0.1,0.1,0,0,0 /
&motor coordinate=1, kind='pid', proportional=30, derivative=4, integral=5, law='segments', times=0,0.3,1.1,3,
       values=0,0,1,1, laws='dwell','harmonic','dwell' /""")
    case.against_runs(led, (('from', 'motor.times(2)', 0.3), ('to', 'motor.times(3)', 1.1)), 'times of the setpoint of a controller')


def test_a_law_that_repeats_and_goes_on(case):
    text = CARRIED.format(law="times=0,0.1,0.25,0.3, values=0,0.02,0.05,0.05, laws='harmonic','harmonic','dwell', period=0.3", times='end=1.13')
    # the longer steps of others would move a joint over a time of the results
    case.against_runs(text, (('period', "'drive.period','drive.times(4)'", 0.3), ('mid', 'drive.times(3)', 0.25)), 'a law that repeats', 2.0**-11)


# back in time
BACK = CARRIED.format(law="times=-2,-0.5,-0.3,2, values=0,0,0.05,0.05, laws='dwell','harmonic','dwell'", times='start=0, end=-0.9')


def test_times_of_a_law_back_in_time(case):
    case.against_runs(BACK, (('from', 'drive.times(2)', -0.5), ('to', 'drive.times(3)', -0.3)), 'back in time')


def test_jumps_back_in_time(case):
    text = BACK.replace('harmonic', 'constant-velocity')
    case.against_runs(text, (('centre', 'body.centre(2)', -3.0), ('far', "'drive.values(3)','drive.values(4)'", 0.05)), 'jumps back in time')


def test_two_joints_at_the_same_time(case):
    second = "values=0,0,0.07,0.07, laws='dwell','harmonic','dwell' /\n"
    text = SPATIAL.replace('&initial coordinate=1, position=0.2, velocity=1.5 /\n', "&drive coordinate=1, kind='segments', times=0,0.3,0.4,2, " + second)
    text = text.replace('&initial coordinate=3, position=0.1, velocity=0.2 /\n', "&drive coordinate=3, kind='segments', times=0,0.3,0.6,2, " + second)
    case.against_runs(text, (('one', 'drive(1).times(2)', 0.3), ('other', 'drive(2).times(3)', 0.6)), 'two joints at the same time')


# Rates of drives that jump at known times: derivatives of the free rates change by that of the impulse. The impulse on the bead of the hoop is
# zero; the five-bar and the open chain in space have one that depends on all dimensions.
JUMPING_HOOP = BEAD.format(law="segments', times=0,0.5,3, values=0,1,2, laws='constant-velocity','constant-velocity' / !")


def test_a_hoop_that_jumps(case):
    case.against_runs(JUMPING_HOOP, (('centre', 'body.centre(2)', -0.5), ('fast', 'drive.values(2)', 1.0), ('first', 'initial(1).position', 0.8)),
                      'a hoop that jumps')


def test_a_five_bar_whose_drive_jumps(case):
    bar = FIVE_BAR.replace("laws='dwell','harmonic','dwell'", "laws='dwell','constant-velocity','dwell'")
    case.against_runs(bar, (('angle', "'drive.values(3)','drive.values(4)'", 1.6), ('rod', 'pair(3).point(1)', 0.7),
                            ('mass', 'body(1).mass', 1.0), ('centre', 'body(2).centre(1)', 0.3), ('rate', 'initial(4).velocity', 0.3)),
                      'a five-bar whose drive jumps')


def test_a_chain_in_space_that_jumps(case):
    drive = "&drive coordinate=1, kind='segments', times=0,0.3,0.6,2, values=0.2,0.2,0.5,0.5, laws='dwell','constant-velocity','dwell' /\n"
    space = SPATIAL.replace('&initial coordinate=1, position=0.2, velocity=1.5 /\n', drive)
    case.against_runs(space, (('pitch', 'pair(1).pitch', 0.3), ('tilt', 'pair(2).axis(2)', 0.3), ('far', "'drive.values(3)','drive.values(4)'", 0.5),
                              ('product', 'body(1).inertia(4)', 0.01), ('stiff', 'load(1).stiffness', 60.0)), 'a chain in space that jumps')


def test_a_jump_beside_a_controller(case):
    case.against_runs(CONTROLLED, (('mass', 'body(2).mass', 1.0), ('when', 'motor.times(2)', 0.3), ('far', "'drive.values(3)','drive.values(4)'", 0.05),
                                   ('bar', 'pair(3).point(2)', -1.0), ('limit', 'motor.limit', 20.0)), 'a jump beside a controller')


def test_no_derivatives_beyond_a_jump_whose_time_is_a_parameter(case):
    case.refused(JUMPING_HOOP + declared((('when', 'drive.times(2)', 0.5),)) + '&output sensitivities=.true. /\n', 6,
                 "derivatives by the parameter 'when' are not computed beyond t = 0.5 s: it sets this time, at which the rates of drives jump")


def test_no_derivatives_by_the_time_of_a_force_that_jumps(case):
    bent = FOUR_BAR.replace("law='harmonic', mean=1, amplitude=0.5, angular_frequency=3",
                            "law='segments', times=0,0.2,0.3, values=0,0,1, laws='dwell','harmonic', period=0.3")
    case.refused(bent + declared((('push', 'load(2).times(2)', 0.2),)) + '&output sensitivities=.true. /\n', 3,
                 "derivatives by the parameter 'push' are not computed")


TOP = """&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='revolute', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,1,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0, velocity=0 /
&initial coordinate=2, position=1.0, velocity=3 /
&initial coordinate=3, position=0, velocity=0.1 /
&body link=4, mass=1, centre=0,0,0.1, inertia=0.002,0.002,0.001,0,0,0 /
&gravity acceleration=0,0,-9.81 /
&time start=0, end=2, intervals=4 /
&parameter name='mass', sets='body.mass' /
&output sensitivities=.true. /
"""


def test_no_derivatives_where_other_angles_are_taken(case):
    case.refused(TOP, 6, 'the motion goes on in other angles of a ball joint or of a rod than those of the data file')


@pytest.mark.parametrize('why, text, parameters, part', (
    ('four-bar with loads', FOUR_BAR, FOUR_BAR_PARAMETERS, 2.0**-10),
    ('through changes of coordinates', PENDULUM_FOUR_BAR,
     (('bar', 'pair(2).point(2)', -1.0), ('mass', 'body(1).mass', 20.0), ('start', 'initial(2).position', -0.55)), 2.0**-9),
    ('a driven hoop', TURNING, (('speed', 'drive.coefficients(2)', 7.1), ('centre', 'body.centre(2)', -0.5)), 2.0**-9),
    ('in space', SPATIAL, SPATIAL_PARAMETERS, 2.0**-9)),
    ids=('four-bar with loads', 'changes of coordinates', 'driven hoop', 'in space'))
def test_derivatives_are_differences_of_runs(case, why, text, parameters, part):
    case.against_runs(text, parameters, why, part)
