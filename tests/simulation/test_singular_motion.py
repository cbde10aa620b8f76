"""Motions through singular positions, and of an overconstrained mechanism, for ten seconds: the N-four-bar, Bricard's
mechanism, a four-bar that swings through the dead point of its independent coordinate.

Compares the program with itself in part: a four-bar by its rocker and by its crank, and by several methods; the other
motions have references.
"""
import os

import numpy as np
import pytest

import n_four_bar
from mech9_cases import REFERENCE, TREE, read_csv, table_and_report, text_of

G = 9.81


def example(name):
    return os.path.join(TREE, 'examples', name + '.nml')


def run_with(mech9d, data, tolerance, *settings):
    """Table and report at a tolerance, chains closed in every row."""
    options = [f'solver.relative_tolerance={tolerance}', f'solver.absolute_tolerance={tolerance}', *settings]
    return table_and_report(mech9d, data, *[word for option in options for word in ('--set', option)])


def check_closed(checks, table, report, why):
    checks.true(np.all(table['closure'] <= 1e-13 * report['size']), f'{why}: chains are closed to 1e-13 of the size',
                np.max(table['closure']) / report['size'])


# --- N-four-bar ---------------------------------------------------------------------------------------------------

def stiffness(n):
    """k of phi'' = k sin phi, phi of the uprights from the vertical: moments over the moment of inertia."""
    return G * ((n + 1) / 2 + n) / ((n + 1) / 3 + n)


def time_of(phi, k):
    """When the uprights are at the angles phi >= 0: the integral of dphi/phi', where phi'^2 = 1 + 2 k (1 - cos phi). Gauss
    quadrature over pieces of 1/8 rad, in which the integrand is smooth: exact to round-off."""
    nodes, weights = np.polynomial.legendre.leggauss(12)
    edges = np.linspace(0.0, 1.0, int(8 * np.max(phi)) + 2)
    middle, half = (edges[1:] + edges[:-1]) / 2, (edges[1:] - edges[:-1]) / 2
    places = (middle[:, None] + half[:, None] * nodes).ravel()
    parts = (half[:, None] * weights).ravel()
    angles = np.multiply.outer(phi, places)
    return phi * ((1.0 / np.sqrt(1.0 + 2.0 * k * (1.0 - np.cos(angles)))) @ parts)


def n_four_bar_errors(table, n, phi=None):
    """Largest error over rows and coordinates: on the parallelogram branch all uprights turn alike, and couplers
    stay as they are, which turn against uprights then. Without phi given, the closed form is asked for the time."""
    uprights = np.array([-table[f'q{i}'] for i in range(1, n + 2)])
    couplers = np.array([table[f'q{i}'] for i in range(n + 2, 3 * n + 2)])
    if phi is not None:
        return max(np.max(np.abs(uprights - phi)), np.max(np.abs(couplers - phi)))
    apart = max(np.max(np.abs(uprights - uprights[0])), np.max(np.abs(couplers - uprights[0])))
    return apart + np.max(np.abs(time_of(uprights[0], stiffness(n)) - table['t']) * -table['dq1'])


def n_four_bar_reference(n):
    """The reference and its angles phi, which go on over whole turns; None for numbers of windows without one."""
    if n not in (2, 40):
        return None, None
    reference = read_csv(os.path.join(REFERENCE, f'a02_nfourbar_N{n}.csv'))
    return reference, np.unwrap(np.arctan2(reference['x_B0'], reference['y_B0']))


@pytest.mark.parametrize('n', [2, 40])
def test_n_four_bar_as_published(checks, n):
    reference, phi = n_four_bar_reference(n)
    # the closed form of this file against the reference's elliptic functions
    checks.near(time_of(phi, stiffness(n)), reference['t'], 1e-14 * 20, f'N = {n}: closed form and reference')
    generated = n_four_bar.data_file(n, reference['t'][-1])
    checks.equal(text_of(example(f'n_four_bar/n_four_bar_{n}')), generated, f'N = {n}: the example as generated')


# Windows; tolerance, intervals and limit of the error of angles.
WINDOWS = [(n, *case) for n in (2, 10, 40, 200) for case in (
    (1e-7, 200, 1e-3),      # the published limit of high precision, with outputs inside steps
    (1e-7, 10, 1e-3),       # steps as long as the tolerance lets them be: some 80, each of whose errors of the rate,
    (1e-10, 10, 1e-6),      # at 7/s, turns into one of the angle that is ten times as large: below 1e4 tolerances
    (1e-12, 200, 1e-8))[:2 if n > 100 else 4]]


@pytest.mark.parametrize('n, tolerance, intervals, limit', WINDOWS)
def test_n_four_bar(checks, mech9d, tmp_path, n, tolerance, intervals, limit):
    """One number of windows. The energy of N windows is N/2 times that of two, and so is the limit of its error."""
    reference, phi = n_four_bar_reference(n)
    data = tmp_path / 'case.nml'
    data.write_text(n_four_bar.data_file(n), encoding='utf-8')
    table, report = run_with(mech9d, data, tolerance, f'time.intervals={intervals}')
    why = f'N = {n}, tolerance {tolerance:.0e}, {intervals} intervals'
    checks.equal(len(table['t']), intervals + 1, f'{why}: it ran to the end')
    check_closed(checks, table, report, why)
    every = 200 // intervals
    error = n_four_bar_errors(table, n, None if phi is None else phi[:201:every])
    checks.true(error <= limit, f'{why}: every coordinate at every time on the parallelogram branch', error)
    if reference is not None:
        for column, name in (('B0.x', 'x_B0'), ('B0.y', 'y_B0'), ('dq1', 'w')):
            values = reference[name][:201:every] * (-1.0 if name == 'w' else 1.0)
            # rates of change by the pendulum's own, sqrt(k) = 3.4 a second
            checks.near(table[column], values, 4 * limit, f'{why}: {column}')
    change = np.max(np.abs(table['E.total'] - table['E.total'][0]))
    # (N + (N + 1)/3) kg m^2 times the rate of at most 7/s times its error, which is 4 limits as above
    checks.true(change <= 50 * n * limit, f'{why}: energy', change)
    checks.true(change <= 0.1 * n / 2, f'{why}: energy within the published limit', change)
    print(f'{why}: error {error:.1e}, energy {change:.1e} J, {report["steps"]} steps, '
          f'least conditioning {report["least_conditioning"]:.1e}, {report["seconds_solving"]:.3f} s')
    if n == 2:
        checks.near(table['E.total'][0] / 35.835, 1.0, 1e-14, 'the energy at the start, as published')


# --- Bricard's mechanism ------------------------------------------------------------------------------------------

@pytest.mark.parametrize('tolerance, intervals, limit', [
    (1e-5, 200, 1e-3), (1e-4, 4, 1e-1), (1e-7, 4, 1e-4), (1e-10, 4, 1e-7), (1e-12, 200, 1e-11)])
def test_bricard(checks, mech9d, tolerance, intervals, limit):
    data, reference = example('bricard/bricard'), read_csv(os.path.join(REFERENCE, 'a04_bricard.csv'))
    columns = [('P3.x', 'x'), ('P3.y', 'y'), ('P3.z', 'z'), ('P3.vx', 'vx'), ('P3.vy', 'vy'), ('P3.vz', 'vz')]
    table, report = run_with(mech9d, data, tolerance, f'time.intervals={intervals}')
    why = f'tolerance {tolerance:.0e}, {intervals} intervals'
    check_closed(checks, table, report, why)
    every = slice(None, None, 200 // intervals)
    # an integrator errs by at most a few hundred steps times the tolerance; the motion returns every 5 s, so that
    # errors of its rate turn into errors of the place ten times as large
    worst = max(np.max(np.abs(table[mine] - reference[theirs][every])) for mine, theirs in columns)
    checks.true(worst <= limit, f'{why}: P3 and its velocity at every time', worst)
    change = np.max(np.abs(table['E.total'] - table['E.total'][0]))
    # its rate of change with a velocity is a momentum, of 10 kg m/s and less; round-off of 30 J aside
    checks.true(change <= max(1e-13 * 100, 10 * limit), f'{why}: energy', change)
    if limit <= 1e-3:
        checks.true(change <= 1e-3, f'{why}: energy within the published limit', change)
    print(f'{why}: error {worst:.1e}, energy {change:.1e} J, {report["steps"]} steps')


# --- a four-bar driven by a pendulum ------------------------------------------------------------------------------

PENDULUM_FOUR_BAR = example('pendulum_four_bar/pendulum_four_bar')
TIGHT = 1e-12


@pytest.fixture(scope='module')
def by_rocker(mech9d):
    """Table and report of the motion by the rocker, which stands still in every swing."""
    return run_with(mech9d, PENDULUM_FOUR_BAR, TIGHT)


@pytest.fixture(scope='module')
def by_crank(mech9d, by_rocker, tmp_path_factory):
    """Table and report of the same motion by the crank, which nothing stops."""
    text = text_of(PENDULUM_FOUR_BAR)
    start = by_rocker[0]['q1'][0]
    text = text.replace('cq=4', 'cq=1').replace('coordinate=1, position=-1.3', f'coordinate=1, position={float(start)!r}')
    text = text.replace('position=-0.55, velocity=0', 'position=-0.55')
    path = tmp_path_factory.mktemp('pendulum_four_bar') / 'by_crank.nml'
    path.write_text(text, encoding='utf-8')
    return run_with(mech9d, path, TIGHT)


def test_four_bar_through_the_dead_point_of_its_coordinate(checks, by_rocker, by_crank):
    """The same motion by its rocker and by its crank."""
    (by_rocker, report), (by_crank, crank_report) = by_rocker, by_crank
    checks.true(len(report['coordinate_changes']) >= 1, 'the independent coordinates were changed', report['coordinate_changes'])
    for event in report['coordinate_changes']:
        checks.true(4 not in event['independent'] and 0 < event['t'] < 10, 'another took the place of the rocker', event)
    checks.equal(crank_report['coordinate_changes'], [], 'by the crank there is no need to')
    # dead points of the rocker beside those where all stand still
    turns = np.flatnonzero(np.diff(np.sign(by_crank['dq4'])) != 0)
    swings = np.flatnonzero(np.diff(np.sign(by_crank['dq1'])) != 0)
    checks.true(len(turns) >= len(swings) + 8, 'the rocker turns back while the crank swings on', (turns, swings))
    # the pendulum's phase: errors of energy of 1e-12 of 400 J, times the rate of its period and 10 s; two runs of some
    # 500 steps, and the state handed over where the first is already ill-conditioned, by 16 and more
    for column in by_crank:
        if column != 'closure':
            scale = max(1.0, np.max(np.abs(by_crank[column])))
            checks.near(by_rocker[column] / scale, by_crank[column] / scale, 1e-9, f'{column} by rocker and by crank')
    for table, which, told in ((by_rocker, 'rocker', report), (by_crank, 'crank', crank_report)):
        check_closed(checks, table, told, f'by the {which}')
        change = np.max(np.abs(table['E.total'] - table['E.total'][0]))
        # each step errs by the tolerance in the rates, whose squares the energy holds
        checks.true(change <= 2 * told['steps'] * TIGHT * np.max(table['E.kinetic']), f'energy by the {which}', change)
        print(f'by the {which}: energy {change:.1e} J, {told["steps"]} steps, events {told["coordinate_changes"]}')


# of the methods that take the same number for every trial of a step
EVALUATIONS = {'prince-dormand': 13, 'dormand-prince': 6, 'verner': 8, 'merson': 5}


@pytest.mark.parametrize('method, each', EVALUATIONS.items())
def test_counts_go_on_over_changes_of_coordinates(checks, mech9d, method, each):
    """The evaluations of a run with one output are those of its steps, but for a few where an integration begins, at outputs, and of
    trials that are refused before their end."""
    _, report = run_with(mech9d, PENDULUM_FOUR_BAR, 1e-8, f"solver.method='{method}'", 'time.intervals=1')
    tried = report['steps'] + report['error_test_failures'] + report['refusals']
    checks.true(len(report['coordinate_changes']) >= 1, f'{method}: in other coordinates', report['coordinate_changes'])
    checks.true(abs(report['evaluations'] - each * tried) <= 20 * (len(report['coordinate_changes']) + 1),
                f'{method}: evaluations belong to steps', (report['steps'], tried, report['evaluations']))


@pytest.mark.parametrize('tolerance', [1e-5, 1e-8])
@pytest.mark.parametrize('method', ['prince-dormand', 'dormand-prince', 'merson', 'adams', 'bdf', 'auto'])
def test_dead_point_by_any_method(checks, mech9d, by_crank, method, tolerance):
    """Whatever the method and however coarse the tolerance, the dead point is passed and the motion is right."""
    right, _ = by_crank
    table, report = run_with(mech9d, PENDULUM_FOUR_BAR, tolerance, f"solver.method='{method}'", 'time.intervals=20')
    error = max(np.max(np.abs(table[f'q{k}'] - right[f'q{k}'][::10])) for k in range(1, 5))
    # a thousand steps and more for the two of low order, and bdf errs by several times its tolerance
    checks.true(error <= 1e4 * tolerance, f'{method}, {tolerance:.0e}: the same motion', error)
    checks.true(len(report['coordinate_changes']) >= 1, f'{method}, {tolerance:.0e}: in other coordinates', report['coordinate_changes'])
    print(f'{method}, {tolerance:.0e}: error {error:.1e}, {report["steps"]} steps')
