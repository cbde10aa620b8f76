"""Quantities of driven motions whose pairs turn back with friction: forces jump there, on both sides of which quantities stand.

Compares the program with itself: few and many outputs."""
import json
from math import pi, sqrt

import pytest

from mech9_cases import run

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


@pytest.mark.parametrize('column', ['R3.fx', 'R4.fx', 'F1'])
def test_outputs_do_not_matter(checks, mech9k, tmp_path, column):
    """At the dead points of a slider-crank the friction of the slider turns round."""
    wanted = quantities(mech9k, tmp_path, CRANK, column, 2 * pi, 10)
    for intervals in (37, 400):
        found = quantities(mech9k, tmp_path, CRANK, column, 2 * pi, intervals)
        checks.near(found, wanted, 1e-10, f'quantities of {column} with {intervals} intervals', scale=1)
