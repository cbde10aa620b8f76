"""A mechanism that is drawn closed keeps its drawn assembly at a start elsewhere, and says so where it cannot: closed forms of a
toggle press and of four-bars.
"""
import os

import numpy as np
import pytest

from mech9_cases import read_table, run

# Round-off of positions over the conditioning of these loops, about 0.1.
ROUND_OFF = 1e-12
# Central differences of the closed form with steps of 1e-5 rad: round-off over the step, in parts of the largest torque.
DIFFERENCE = 1e-8

CRANK, UPPER, JOINT, RAM = (np.array(place) for place in ((0.05, 0.0), (0.3, 0.3), (0.32, 0.02), (0.3, -0.25)))
CRANK_ROCKER = """
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', point=0,0,0, axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.05,0,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.32,0.02,0, axis=0,0,1 /
&pair coordinate=4, links=1,4, kind='revolute', point=0.3,0.3,0, axis=0,0,1 /
"""
PRESS = f"""{CRANK_ROCKER}
&mechanism links=6, coordinates=7 /
&pair coordinate=5, links=4,5, kind='revolute', point=0.32,0.02,0, axis=0,0,1 /
&pair coordinate=6, links=5,6, kind='revolute', point=0.3,-0.25,0, axis=0,0,1 /
&pair coordinate=7, links=1,6, kind='prismatic', point=0.3,-0.25,0, axis=0,1,0 /
&load kind='force', link=6, position=0.3,-0.25,0, force=0,1000,0 /
&output drive_forces=.true. /
"""
# Grashof's double rocker with the coupler as shortest link: the input has two ranges, beyond which its chain does not close.
DOUBLE_ROCKER = """
&mechanism links=4, coordinates=4, angle_unit='deg' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', point=0,0,0, axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.5,0.8660254037844386,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.9,0.9,0, axis=0,0,1 /
&pair coordinate=4, links=1,4, kind='revolute', point=1,0,0, axis=0,0,1 /
"""
STOPPED = 'the mechanism is drawn closed, but its motion from there to the start meets a singular position at q1 = -30.80'


def meet(a, b, radius_a, radius_b, side):
    """The point at given distances from two others, on the side `side` (1: left) of the line from a to b."""
    between = b - a
    distance = np.hypot(*between)
    along = (radius_a ** 2 - radius_b ** 2 + distance ** 2) / (2 * distance)
    across = side * np.sqrt(radius_a ** 2 - along ** 2)
    x, y = between / distance
    return a + along * np.array([x, y]) + across * np.array([-y, x])


def ram(angle):
    """(angle of the upper link against the drawing, way of the ram) on the drawn assembly, at an angle of the crank."""
    pin = 0.05 * np.array([np.cos(angle), np.sin(angle)])
    side = np.sign(np.cross(UPPER - CRANK, JOINT - CRANK))
    joint = meet(pin, UPPER, np.hypot(*(JOINT - CRANK)), np.hypot(*(JOINT - UPPER)), side)
    (x, y), (u, v) = joint - UPPER, JOINT - UPPER
    return np.arctan2(u * y - v * x, u * x + v * y), joint[1] - np.sqrt(np.hypot(*(RAM - JOINT)) ** 2 - (joint[0] - 0.3) ** 2) + 0.25


def written(folder, text):
    path = folder / 'case.nml'
    path.write_text(text, encoding='utf-8')
    return os.fspath(path)


def table_of(program, path, *options):
    done = run(program, path, '--table', '-', *options, folder=os.path.dirname(path))
    if done.returncode != 0:
        raise RuntimeError(f'{program} ended with {done.returncode}:\n{done.stderr}')
    return read_table(done.stdout), done.stderr


@pytest.mark.parametrize('angle', [0.4, np.pi / 2, np.pi, -np.pi, 4.0, -2.5, 2 * np.pi + 1, 600.0])
def test_a_press_that_starts_away_from_its_drawing(checks, mech9d, tmp_path, angle):
    """Its links and its torque are those of the drawn assembly."""
    path = written(tmp_path, f"{PRESS}&drive coordinate=1, kind='polynomial', coefficients={angle!r}, 1 /\n"
                             '&time start=0, end=1e-3, intervals=1 /\n')
    row, said = table_of(mech9d, path)
    turn, way = ram(angle)
    checks.near(row['q1'][0], angle, ROUND_OFF, 'the start is where the drive says')
    checks.near(np.sin(row['q4'][0] - turn), 0.0, ROUND_OFF, 'the upper link is that of the drawn assembly', scale=1.0)
    checks.true(np.cos(row['q4'][0] - turn) > 0, 'and not turned by half a turn')
    checks.near(row['q7'][0], way, ROUND_OFF, 'so is the ram', scale=1.0)
    step = 1e-5
    torque = -1000 * (ram(angle + step)[1] - ram(angle - step)[1]) / (2 * step)
    checks.near(row['F1'][0], torque, DIFFERENCE, 'the torque is the work of the load', scale=100.0)
    checks.true('drawn' not in said, 'nothing is said about a start that was reached', said)


def test_a_free_press(checks, mech9d, tmp_path):
    """A position in &initial is reached from the drawing, too."""
    path = written(tmp_path, PRESS.replace('drive_forces=.true.', '') + '&initial coordinate=1, position=3.141592653589793, velocity=0 /\n'
                   "&body link=2, mass=1, centre=0,0,0, inertia=1,1,1,0,0,0 /\n&time start=0, end=1e-3, intervals=1 /\n")
    row, said = table_of(mech9d, path)
    turn, way = ram(np.pi)
    checks.near([row['q4'][0], row['q7'][0]], [turn, way], ROUND_OFF, 'the position is that of the drawn assembly', scale=1.0)
    checks.true('drawn' not in said, 'nothing is said', said)


def test_guesses_choose_another_assembly(checks, mech9k, tmp_path):
    """Guesses of dependent coordinates at the start come before the drawing."""
    angle = 3.0
    pin = 0.05 * np.array([np.cos(angle), np.sin(angle)])
    lengths = np.hypot(*(JOINT - CRANK)), np.hypot(*(JOINT - UPPER))
    sides = [meet(pin, UPPER, *lengths, side) for side in (1, -1)]
    for joint in sides:
        turns = [np.arctan2(*np.flip(now)) - np.arctan2(*np.flip(then))
                 for now, then in ((joint - pin, JOINT - CRANK), (joint - UPPER, JOINT - UPPER))]
        guesses = turns[0] - angle, turns[1] - turns[0], turns[1]
        path = written(tmp_path, f"{CRANK_ROCKER}&drive coordinate=1, kind='polynomial', coefficients={angle!r}, 1 /\n"
                       '&time start=0, end=1e-3, intervals=1 /\n'
                       + ''.join(f'&initial coordinate={k + 2}, position={guess:.2f} /\n' for k, guess in enumerate(guesses)))
        row, _ = table_of(mech9k, path)
        checks.near(np.sin(row['q4'][0] - turns[1]), 0.0, ROUND_OFF, 'the assembly of the guesses', scale=1.0)


def test_a_start_beyond_a_dead_point(checks, mech9k, tmp_path):
    """The second range of a double rocker is not reached from the first: a line says so in a run and in a check."""
    path = written(tmp_path, f"{DOUBLE_ROCKER}&drive coordinate=1, kind='polynomial', coefficients=-120, 1 /\n"
                             '&time start=0, end=1, intervals=1 /\n')
    row, said = table_of(mech9k, path)
    expected = f'note: {STOPPED}'
    lines = [line for line in said.splitlines() if line.startswith(expected)]
    checks.equal(len(lines), 1, 'one line in a run')
    checks.true('may belong to another assembly' in said, 'it tells what may be otherwise', said)
    checks.true('&initial' in said and '--branches' in said, 'and the remedy', said)
    checks.near(row['q1'][0], -120.0, ROUND_OFF, 'the run begins at its start')
    quiet = run(mech9k, path, '--quiet', '--table', '-', folder=tmp_path)
    checks.true('drawn' not in quiet.stderr, 'nothing is said where nothing shall be said', quiet.stderr)
    check = run(mech9k, path, '--check', folder=tmp_path)
    checks.equal(sum(line.startswith(expected) for line in check.stdout.splitlines()), 1, 'one line in a check')


def test_the_other_way_round(checks, mech9k, tmp_path):
    """An angle of -359 degrees beyond a dead point is reached by 1 degree."""
    path = written(tmp_path, f"{DOUBLE_ROCKER}&drive coordinate=1, kind='polynomial', coefficients=-359, 1 /\n"
                             '&time start=0, end=1, intervals=1 /\n')
    row, said = table_of(mech9k, path)
    near, _ = table_of(mech9k, path, '--set', 'drive.coefficients=1,1')
    checks.true(f'note: {STOPPED}' in said and 'the other way round' in said, 'a line says so', said)
    checks.near([row[f'q{k}'][0] for k in (2, 3, 4)], [near[f'q{k}'][0] for k in (2, 3, 4)], ROUND_OFF, 'the position is the same',
                scale=100.0)
