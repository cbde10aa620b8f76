"""Rods between two spherical joints, which turn about themselves: the motion goes through whatever position of the angle that is held.

The right numbers come from the distance between both balls, which is the length of the rod: one equation for the angle of the
rocker, which has a solution in closed form on each of two branches.
"""
import math
import os
import re

import numpy as np
import pytest

from ball_mechanisms import Rssr, direction, triple
from mech9_cases import run, table_of


def nearest_branch(rssr, theta, rocker):
    """The branch, continued, on which the first angle of the rocker is, and the largest difference from it."""
    _, one, other = rssr.solve(theta)
    errors = []
    for branch in (one, other):
        branch = branch + 2 * math.pi * np.round((rocker[0] - branch[0]) / (2 * math.pi))
        errors.append(float(np.max(np.abs(rocker - branch))))
    return min(errors)


def follow_equation(checks, rssr, program, folder, text, name):
    """The rocker's angle is that of the distance equation at each angle of the crank; what the program said and its table, if it ran."""
    path = os.path.join(folder, 'case.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)
    done = run(program, path, '--no-write')
    if not checks.equal(done.returncode, 0, f'{name} turns'):
        print(done.stderr)
        return done, None
    table = table_of(program, path)
    error = nearest_branch(rssr, table['q1'], table['q8'])
    margin = float(np.min(rssr.solve(table['q1'])[0]))
    # round-off times the conditioning of the chain, which is worst next to a dead point
    checks.true(error < 1e-12 / margin, f'{name}: the rocker follows the distance equation ({error:.2g})')
    return done, table


SEEDS = range(12)


@pytest.mark.parametrize('seed', SEEDS)
def test_driven_crank(checks, mech9k, tmp_path, seed):
    """Cranks that turn on and on: each position of the rocker is that of the distance equation."""
    turns = 3
    rssr = Rssr(seed)
    text = rssr.pairs(seed % 3 > 0) + f"&drive coordinate=1, kind='polynomial', coefficients=0, 1 /\n" \
        f'&time end={2 * math.pi * turns!r}, intervals={60 * turns} /\n'
    follow_equation(checks, rssr, mech9k, tmp_path, text, f'crank {seed}')


@pytest.mark.parametrize('seed', SEEDS)
def test_free_crank(checks, mech9d, tmp_path, seed):
    """The same mechanisms moved by gravity and their own motion, with rods without mass or without inertia about their line."""
    rssr = Rssr(seed)
    text = rssr.pairs(seed % 3 > 0) + '&gravity acceleration=1.3,-2.4,5.0 /\n' \
        '&body link=2, mass=2, centre=0.02,0.05,0.01, inertia=0.3,0.4,0.5,0,0,0 /\n' \
        '&body link=4, mass=1, centre=0.1,-0.05,0.2, inertia=0.05,0.06,0.07,0,0,0 /\n' \
        '&initial coordinate=1, position=0, velocity=6 /\n&time end=3, intervals=60 /\n' \
        '&solver relative_tolerance=1e-11, absolute_tolerance=1e-12 /\n'
    if seed % 2:
        # an inertia about the rod's line that is round-off of the others counts as none; else steps become ever shorter
        line = np.outer(rssr.in_rod, rssr.in_rod) / rssr.length ** 2
        inertia = 2e-4 * (np.eye(3) - line) + (1e-10 if seed % 4 == 1 else 0.0) * line
        text += f'&body link=3, mass=0.05, centre={triple(0.4 * rssr.in_rod)}, inertia={triple(np.diag(inertia))},' \
            f'{triple((inertia[0, 1], inertia[0, 2], inertia[1, 2]))} /\n'
    done, table = follow_equation(checks, rssr, mech9d, tmp_path, text, f'free crank {seed}')
    if table is None:
        return
    checks.equal('negligible moment of inertia' in done.stderr, seed % 2 == 1, f'free crank {seed}: the note')
    steps = int(re.search(r'(\d+) steps', done.stderr + done.stdout).group(1))
    checks.true(steps < 1000, f'free crank {seed}: {steps} steps')
    spread = float(np.ptp(table['E.total']))
    # some hundred times the tolerance of the integration
    checks.true(spread < 1e-8 * float(np.max(np.abs(table['E.kinetic']))), f'free crank {seed}: its energy keeps ({spread:.2g})')
    checks.true(float(np.ptp(table['q1'])) > 2 * math.pi, f'free crank {seed}: it turns round')


def test_two_gimbal_locks_at_once(checks, mech9k, tmp_path):
    """A parallelogram of hinges about y: the angles of both ball joints come to gimbal lock at once, and the rod keeps its direction."""
    text = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,1,0 /
&pair coordinates=2,3,4, links=2,3, kind='spherical', point=0.3,0,0, moving_point=0,0,0 /
&pair coordinates=5,6,7, links=3,4, kind='spherical', point=1,0,0, moving_point=0.3,0,0 /
&pair coordinate=8, links=1,4, kind='revolute', axis=0,1,0, point=1,0,0, moving_point=0,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0.5, 1 /
&initial coordinate=8, position=0.5 /
&initial coordinate=3, position=-0.5 /
&initial coordinate=6, position=0.5 /
&time end=2, intervals=40 /
"""
    path = tmp_path / 'parallelogram.nml'
    path.write_text(text, encoding='utf-8')
    table = table_of(mech9k, path)
    for name, sign in (('q8', 1), ('q3', -1), ('q6', 1), ('dq8', 1), ('dq3', -1), ('dq6', 1)):
        expected = sign * (np.ones(41) if name.startswith('d') else table['q1'])
        checks.near(table[name], expected, 1e-13, f'a parallelogram through two gimbal locks at once: {name}')


@pytest.mark.parametrize('seed', SEEDS[::4])
@pytest.mark.parametrize('legs', [False, True], ids=['sliding', 'legs'])
def test_platform(checks, mech9k, tmp_path, seed, legs):
    """A platform on six rods between balls. Their lower ends slide; or they are legs of a cylinder and a piston, whose lengths are
    driven. All rods have their lengths, and closed paths come back."""
    random = np.random.default_rng(100 + seed)
    angles = np.repeat([0, 2, 4], 2) * math.pi / 3 + np.tile([-0.4, 0.4], 3)
    base = np.stack([np.cos(angles), np.sin(angles), np.zeros(6)], axis=1) + random.uniform(-0.1, 0.1, (6, 3))
    turned_by = angles + np.tile([-0.5, 0.5], 3)
    top = 0.6 * np.stack([np.cos(turned_by), np.sin(turned_by), np.zeros(6)], axis=1) + random.uniform(-0.05, 0.05, (6, 3))
    height = np.array([0, 0, random.uniform(0.8, 1.1)])
    text = '&structure cq=1,2,3,4,5,6 /\n'
    lengths = []
    for i in range(6):
        z, x = direction(random), direction(random)
        offset = top[i] + height - base[i]
        lengths.append(float(np.linalg.norm(offset)))
        below = f"&pair coordinates={7 + 6 * i},{8 + 6 * i},{9 + 6 * i}, links=%s, kind='spherical', point=%s, moving_point=0,0,0, " \
            f'axis={triple(z)}, zero={triple(x)} /\n'
        slide = f"&pair coordinate={i + 1}, links=%s, kind='prismatic', axis=%s, point=%s, moving_point=0,0,0 /\n"
        if legs:
            # the piston is the reference link of the slide in every other leg
            along = offset / lengths[-1]
            text += below % (f'1,{i + 2}', triple(base[i]))
            text += slide % (f'{i + 2},{i + 8}', triple(along), '0,0,0') if i % 2 else \
                slide % (f'{i + 8},{i + 2}', triple(-along), '0,0,0')
        else:
            text += slide % (f'1,{i + 2}', '0,0,1', triple(base[i])) + below % (f'{i + 2},{i + 8}', '0,0,0')
        z, x = direction(random), direction(random)
        text += f"&pair coordinates={10 + 6 * i},{11 + 6 * i},{12 + 6 * i}, links={i + 8},14, kind='spherical', " \
            f'point={triple(offset)}, moving_point={triple(top[i])}, axis={triple(z)}, zero={triple(x)} /\n'
        text += f"&drive coordinate={i + 1}, kind='harmonic', amplitude={random.uniform(0.02, 0.08)!r}, angular_frequency={1 + i % 3} /\n" \
            f"&point name='A{i + 1}', link={i + 2}, position=0,0,0 /\n&point name='B{i + 1}', link=14, position={triple(top[i])} /\n"
    text += f'&time end={4 * math.pi!r}, intervals=80 /\n'
    path = tmp_path / 'platform.nml'
    path.write_text(text, encoding='utf-8')
    done = run(mech9k, path, '--no-write')
    if not checks.equal(done.returncode, 0, f'platform {seed} moves'):
        print(done.stderr)
        return
    said = 'note: links 2, 8 can turn by themselves between the spherical joint of coordinates 7, 8, 9' if legs else \
        'note: link 8 can turn by itself between the spherical joint of coordinates 7, 8, 9'
    checks.true(said in done.stderr, f'platform {seed}: the note', done.stderr)
    table = table_of(mech9k, path)
    for i in range(6):
        ends = [np.stack([table[f'{name}{i + 1}.{axis}'] for axis in 'xyz'], axis=1) for name in 'AB']
        length = lengths[i] + (table[f'q{i + 1}'] if legs else 0.0)
        error = float(np.max(np.abs(np.linalg.norm(ends[1] - ends[0], axis=1) - length)))
        checks.true(error < 1e-12, f'platform {seed}: rod {i + 1} has its length ({error:.2g})')
        error = float(np.max(np.abs(ends[1][40] - ends[1][0])))
        checks.true(error < 1e-12, f'platform {seed}: ball {i + 1} comes back ({error:.2g})')
