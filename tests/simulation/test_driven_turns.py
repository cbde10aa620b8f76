"""Quantities of driven motions whose pairs turn back or rest with friction: forces jump there, on both sides of which quantities stand.

Compares the program with itself: few and many outputs."""
import json
from math import acos, pi, sin, sqrt

import pytest

from mech9_cases import read_table, run, text_of

SLIDER = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=2 /
&gravity acceleration=0,-9.81,0 /
&friction coordinate=1, static=0.3, dynamic=0.3 /
&drive coordinate=1, kind='harmonic', amplitude=0.4, angular_frequency=3, phase={phase!r} /
"""
CRANK = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, point=0,0.1,0, moving_point=0,0,0 /
&initial coordinate=4, position=1.2 /
&body link=4, mass=2 /
&gravity acceleration=0,-9.81,0 /
&friction coordinate=4, static=0.2, dynamic=0.2 /
&drive coordinate=1, kind='polynomial', coefficients=0.4, 1 /
"""
TAKEN = ('min', 'max', 'mean', 'rms')


def quantities(program, folder, text, column, end, intervals):
    """Least and greatest value, mean and root mean square of a column of forces."""
    path, report = folder / 'turns.nml', folder / 'turns.json'
    text += f'&time end={end!r}, intervals={intervals} /\n&output drive_forces=.true., reactions=.true. /\n'
    text += ''.join(f"&quantity name='{take}', of='{column}', take='{take}' /\n" for take in TAKEN)
    path.write_text(text, encoding='utf-8')
    done = run(program, path, '--report', report, '--table', folder / 'turns.dat')
    assert done.returncode == 0, done.stderr
    found = {quantity['name']: quantity['value'] for quantity in json.loads(report.read_text())['quantities']}
    return [found[take] for take in TAKEN]


@pytest.mark.parametrize('phase', [0.0, 0.3])
def test_a_slider(checks, mech9k, tmp_path, phase):
    """The drive gives m x'' and takes the friction of the weight; four outputs in a period stand on the turns if the phase is 0."""
    inertia, friction = 2 * 0.4 * 3**2, 0.3 * 2 * 9.81
    wanted = [-inertia - friction, inertia + friction, 0.0, sqrt(inertia**2 / 2 + friction**2)]
    for intervals in (4, 7, 60):
        found = quantities(mech9k, tmp_path, SLIDER.format(phase=phase), 'F1', 2 * pi / 3, intervals)
        # tolerance: sums by Gauss's formula over parts of 0.1 m, and turns to round-off of time
        checks.near(found, wanted, 1e-9, f'least, greatest, mean and rms force with {intervals} intervals', scale=inertia)


# greatest acceleration of a law for the way 1 in the time 1, and the mean of its square in parts of its square
LAWS = {'harmonic': (pi**2/2, 1/2), 'cycloidal': (2*pi, 1/2), 'modified-sine': (4*pi**2/(4 + pi), 1/2),
        'modified-trapezoidal': (8*pi/(2 + pi), 3/4)}


@pytest.mark.parametrize('law', LAWS)
@pytest.mark.parametrize('dwell_first', [False, True])
def test_moves_from_rest_to_rest(checks, mech9k, tmp_path, law, dwell_first):
    """A pair with friction begins to move at the start or behind a dwell, and comes to rest before a dwell or at the end.

    Friction counts from the first moment of a move to its last one, and as zero in dwells, where nothing else acts. The fourth
    derivatives of modified laws jump within their segments."""
    if dwell_first:
        drive = f"times=0,0.5,1, values=0,0,0.2, laws='dwell','{law}'"
        moves = [(0.2, 0.5)]
        end = 1
    else:
        drive = f"times=0,0.5,0.9,1.9, values=0,0.2,0.2,-0.1, laws='{law}','dwell','{law}'"
        moves = [(0.2, 0.5), (-0.3, 1.0)]
        end = 1.9
    text = ''.join(line if 'drive' not in line else f"&drive coordinate=1, kind='segments', {drive} /\n"
                   for line in SLIDER.splitlines(keepends=True))
    friction = 0.3 * 2 * 9.81
    greatest = [LAWS[law][0]*abs(way)/duration**2 for way, duration in moves]
    signs = [1 if way > 0 else -1 for way, _ in moves]
    # the acceleration of a move has the mean 0, and friction its constant sign
    square = sum((LAWS[law][1]*4*a**2 + friction**2)*duration for a, (_, duration) in zip(greatest, moves))
    wanted = [min(-2*a + s*friction for a, s in zip(greatest, signs)), max(2*a + s*friction for a, s in zip(greatest, signs)),
              sum(s*friction*duration for s, (_, duration) in zip(signs, moves))/end, sqrt(square/end)]
    for intervals in (4, 7, 38):
        found = quantities(mech9k, tmp_path, text, 'F1', end, intervals)
        # tolerance: squares of a half wave between two joints, by ten points
        checks.near(found, wanted, 2e-8, f'least, greatest, mean and rms force with {intervals} intervals', scale=greatest[0])


def test_rows_at_rest(checks, mech9k, tmp_path):
    """Rows have the force behind the start of a move, and at its end that before; where the pair turns back, friction counts as zero."""
    path = tmp_path / 'rest.nml'
    for law, times in (("kind='segments', times=0,0.5,1, values=0,0,0.2, laws='dwell','harmonic'", [0.25, 0.5, 1]),
                       ("kind='harmonic', amplitude=0.2, angular_frequency=6.283185307179586, phase=-1.5707963267948966", [0, 0.5, 1])):
        text = ''.join(line if 'drive' not in line else f'&drive coordinate=1, {law} /\n' for line in SLIDER.splitlines(keepends=True))
        path.write_text(text + '&time end=1, intervals=4 /\n&output drive_forces=.true., reactions=.true. /\n', encoding='utf-8')
        done = run(mech9k, path, '--table', tmp_path / 'rest.dat')
        assert done.returncode == 0, done.stderr
        table = read_table(text_of(tmp_path / 'rest.dat'))
        friction = [-table['R1.friction'][round(4*t)] for t in times]
        if 'segments' in law:
            checks.near(friction, [0, 0.3*2*9.81, 0.3*2*9.81], 1e-12, 'friction in a dwell, at its end, and at the end', scale=1)
            assert 'at rest at 2 outputs' in done.stderr + done.stdout
        else:
            checks.near(friction, [0.3*2*9.81, 0, -0.3*2*9.81], 1e-12, 'friction at the start, at a turn and at the end', scale=1)
            assert 'at rest at 1 output,' in done.stderr + done.stdout


def test_kinks(checks, mech9k, tmp_path):
    """A slider in an arm that turns steadily in a vertical plane: its friction has kinks where the load on its guide turns round.

    The guide bears m (2 w r' + g cos) across, which passes zero while the slider goes on; there the loss is zero, and the mean of the
    magnitude has its closed form in sums over the parts between these times."""
    w, v, m, mu = 3.0, 0.8, 2.0, 0.3
    text = f"""&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=1,0,0 /
&body link=3, mass={m} /
&gravity acceleration=0,-9.81,0 /
&friction coordinate=2, static={mu}, dynamic={mu} /
&drive coordinate=1, kind='polynomial', coefficients=0,{w} /
&drive coordinate=2, kind='polynomial', coefficients=0.1,{v} /
"""
    end = 2.0
    # the load m (2 w v + g cos(w t)) is zero where cos(w t) = -2 w v/g
    first = acos(-2*w*v/9.81)
    angles = [0.0] + sorted(a for k in range(3) for a in (2*pi*k + first, 2*pi*k - first) if 0 < a < w*end) + [w*end]
    parts = [m*(2*w*v*(b - a) + 9.81*(sin(b) - sin(a)))/w for a, b in zip(angles, angles[1:])]
    wanted = [0.0, mu*v*m*(2*w*v + 9.81), mu*v*sum(map(abs, parts))/end]
    for intervals in (8, 21, 200):
        found = quantities(mech9k, tmp_path, text, 'R2.loss', end, intervals)[:3]
        # tolerance: parts of a wave by ten points; times to round-off
        checks.near(found, wanted, 1e-9, f'least, greatest and mean loss with {intervals} intervals', scale=wanted[1])


@pytest.mark.parametrize('column', ['R3.fx', 'R4.fx', 'F1'])
def test_outputs_do_not_matter(checks, mech9k, tmp_path, column):
    """At the dead points of a slider-crank the friction of the slider turns round."""
    wanted = quantities(mech9k, tmp_path, CRANK, column, 2 * pi, 10)
    for intervals in (37, 400):
        found = quantities(mech9k, tmp_path, CRANK, column, 2 * pi, intervals)
        checks.near(found, wanted, 1e-10, f'quantities of {column} with {intervals} intervals', scale=1)
