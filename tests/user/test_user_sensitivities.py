"""Derivatives by the numbers that users' procedures receive: a pair, a drive and a coupling, each in both forms, against closed forms
and against differences of runs; energies, forces and free motions by those of a pair; forces and free motions by those of a load.

Compares the program with itself in part: differences of runs at other values of a parameter.
"""
import os

import numpy as np
import pytest

from mech9_cases import TREE, read_table, run, text_of

ROOT = os.path.join(TREE, 'user_procs')
WEIGHTS = (4 / 5, -1 / 5, 4 / 105, -1 / 280)
# Procedures in Taylor form lose two digits in differences by the parameter; those in plain values, which are differentiated in time by
# differences too, some three more in accelerations.
TAYLOR, PLAIN = 1e-9, 1e-7


def rows_of(program, directory, text, *options):
    path = os.path.join(directory, 'a.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)
    done = run(program, path, '--quiet', '--table', '-', *options)
    if done.returncode != 0:
        raise RuntimeError(f'{program} {options} ended with {done.returncode}:\n{done.stderr}')
    return read_table(done.stdout)


def compare(checks, found, parameter, expected, tolerance, why):
    """Columns of one kind, as all rates, are judged by the largest one of them."""
    kinds = {}
    for name in expected:
        kinds.setdefault(name.rstrip('0123456789xyz'), []).append(name)
    for kind, names in kinds.items():
        mine = np.array([found[f'd({name})/d({parameter})'] for name in names])
        right = np.array([expected[name] for name in names])
        largest = np.abs(right).max()
        error = np.abs(mine - right).max()
        checks.true(error <= tolerance * max(largest, 1e-3), f'{why}: {kind} by {parameter}', f'error {error:.2e} of {largest:.2e}')


def sample(name, intervals):
    text = text_of(os.path.join(ROOT, name, f'{name}.nml'))
    lines = [line.split('!')[0] if 'intervals' in line else line for line in text.splitlines() if not line.startswith('&output')]
    return '\n'.join(line.replace(line.split('intervals=')[1].split()[0], str(intervals)) if 'intervals=' in line else line
                     for line in lines) + '\n&output sensitivities=.true. /\n'


def differences(program, directory, text, values, number):
    """Differences of runs by one parameter."""
    plain = text.replace('sensitivities=.true.', 'sensitivities=.false.')
    step, total = abs(values[number]) / 128, {}
    for i, weight in enumerate(WEIGHTS, 1):
        above, below = (rows_of(program, directory, plain, '--set', f'parameter({number + 1}).value={values[number] + sign * i * step!r}')
                        for sign in (1, -1))
        for name in above:
            if name not in ('t', 'closure'):
                total[name] = total.get(name, 0) + weight * (above[name] - below[name]) / step
    return total


def closed_trammel(t, a):
    """P is 0.2 from A on AB of length a: (a - 0.2) cos q, 0.2 sin q."""
    q = 0.3 + 2 * t
    nought = 0 * t
    return {'P.x': np.cos(q), 'P.vx': -2 * np.sin(q), 'P.ax': -4 * np.cos(q), 'P.y': nought, 'P.vy': nought, 'P.ay': nought}


def closed_drive(t, rise, duration):
    """q = h (t/T - sin(2 pi t/T)/2 pi), by h and by T."""
    turn, share = 2 * np.pi, t / duration
    s, c = np.sin(turn * share), np.cos(turn * share)
    by_rise = {'q4': share - s / turn, 'dq4': (1 - c) / duration, 'ddq4': turn * s / duration**2}
    by_duration = {'q4': -rise * share / duration * (1 - c), 'dq4': -rise * (1 - c + turn * share * s) / duration**2,
                   'ddq4': -rise * turn * (2 * s + turn * share * c) / duration**3}
    return by_rise, by_duration


def closed_coupling(t, angle):
    """tan q2 = tan q1 / cos(angle): the derivative by the angle, and its derivatives in time by extended differences."""
    def slope(t):
        q = 0.3 + 2 * t + t**2
        return np.sin(angle) * np.sin(q) * np.cos(q) / (np.sin(q)**2 + (np.cos(angle) * np.cos(q))**2)

    step = np.longdouble(2.0**-9)
    t, angle = t.astype(np.longdouble), np.longdouble(angle)

    def rate(function):
        return lambda t: sum(w * (function(t + i * step) - function(t - i * step)) / step for i, w in enumerate(
            (np.longdouble(4) / 5, -np.longdouble(1) / 5, np.longdouble(4) / 105, -np.longdouble(1) / 280), 1))

    return {'q2': slope(t).astype(float), 'dq2': rate(slope)(t).astype(float), 'ddq2': rate(rate(slope))(t).astype(float)}


# name, values of its numbers, their closed forms
SAMPLES = (('trammel', (0.5,), lambda t, v: (closed_trammel(t, *v),)),
           ('cycloidal_drive', (0.4, 2.0), lambda t, v: closed_drive(t, *v)),
           ('cardan_coupling', (0.3,), lambda t, v: (closed_coupling(t, *v),)))


@pytest.mark.parametrize('form, tolerance', (('', TAYLOR), ('_values', PLAIN)), ids=('in Taylor form', 'in plain reals'))
@pytest.mark.parametrize('name, values, closed', SAMPLES, ids=[sample[0] for sample in SAMPLES])
def test_samples_by_closed_forms_and_differences_of_runs(checks, tmp_path, build, name, values, closed, form, tolerance):
    text = sample(name, 10) + ''.join(f"&parameter name='p{i}', sets='user.parameters({i})', value={value} /\n"
                                      for i, value in enumerate(values, 1))
    program = build.program(f'{name}{form}_k')
    found = rows_of(program, tmp_path, text)
    for i, expected in enumerate(closed(found['t'], values)):
        compare(checks, found, f'p{i + 1}', expected, tolerance, f'{name}{form}, closed form')
        compare(checks, found, f'p{i + 1}', differences(program, tmp_path, text, values, i), tolerance, f'{name}{form}, runs')


# the pair the other way round: the moving link is now the one that its procedure describes the other in
REVERSED = sample('trammel', 10).replace('links=1,2, kind', 'links=2,1, kind') + "&parameter name='p1', sets='user.parameters(1)', value=0.5 /\n"
HEAVY = (REVERSED + '&body link=2, mass=2, centre=0.1,0.2,0, inertia=0.1,0.1,0.2,0,0,0 /\n&body link=4, mass=3 /\n&gravity acceleration=1,-9.81,0 /\n') \
    .replace('sensitivities=.true.', 'sensitivities=.true., reactions=.true., drive_forces=.true.')
FREE = ' '.join(line for line in HEAVY.splitlines(keepends=True) if not line.startswith(('&drive', '&time'))) \
    + ('&initial coordinate=1, position=0.3, velocity=2 /\n&time end=0.5, intervals=4 /\n'
       '&solver relative_tolerance=1e-12, absolute_tolerance=1e-12 /\n')


@pytest.mark.parametrize('program, text, tolerance, why', (
    ('trammel_k', REVERSED, TAYLOR, 'reversed pair'),
    # energies of a driven motion
    ('trammel_d', HEAVY, TAYLOR, 'energies and forces'),
    # differences of runs at tolerances of 1e-12 know seven digits
    ('trammel_d', FREE, PLAIN, 'a free motion')), ids=('reversed pair', 'energies and forces', 'free motion'))
def test_a_pair_by_differences_of_runs(checks, tmp_path, build, program, text, tolerance, why):
    program = build.program(program)
    compare(checks, rows_of(program, tmp_path, text), 'p1', differences(program, tmp_path, text, (0.5,), 0), tolerance, why)


@pytest.mark.parametrize('program', ('air_drag_k', 'air_drag_d'))
def test_force_of_a_drive_against_a_load(checks, tmp_path, build, program):
    """The force of a drive against the drag k v^2 has a closed form."""
    drag = ("&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /\n&load kind='user' /\n"
            "&drive coordinate=1, kind='polynomial', coefficients=0,1,3 /\n&user parameters=2,0,0,0,0.1 /\n&body link=2, mass=2 /\n"
            "&parameter name='k', sets='user.parameters(5)' /\n&time end=1, intervals=8 /\n"
            "&output sensitivities=.true., drive_forces=.true., reactions=.true. /\n")
    found = rows_of(build.program(program), tmp_path, drag)
    for column in ('F1', 'R1.fz'):
        checks.near(found[f'd({column})/d(k)'], found['dq1']**2, 1e-12, f'{program}: {column} by the drag')


def test_a_free_motion_in_air(checks, tmp_path, build):
    """A load of the user, by differences of runs."""
    text = text_of(os.path.join(ROOT, 'air_drag', 'air_drag.nml')).replace('intervals=50', 'intervals=5').replace('1e-10', '1e-12')
    text = text.replace("&output table='air_drag.dat' /", '&output sensitivities=.true. /')
    values = (0.1, 0.04, 0.3)
    targets = ('user.parameters(5)', 'user.parameters(10)', 'user.parameters(7)')
    text += ''.join(f"&parameter name='p{i}', sets='{target}', value={value} /\n" for i, (target, value) in enumerate(zip(targets, values), 1))
    program = build.program('air_drag_d')
    found = rows_of(program, tmp_path, text)
    for i in range(len(values)):
        expected = {name: column for name, column in differences(program, tmp_path, text, values, i).items() if f'd({name})/d(p{i + 1})' in found}
        if i > 0:
            # the wheel turns about a vertical
            del expected['E.potential']
            checks.true((found[f'd(E.potential)/d(p{i + 1})'] == 0).all(), f'p{i + 1} changes no height')
        compare(checks, found, f'p{i + 1}', expected, PLAIN, 'a free motion in air')
