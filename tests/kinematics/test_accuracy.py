"""Errors of positions, velocities and accelerations over whole cycles, against the motion in extended precision."""
import numpy as np
import pytest

from kinematic_accuracy import MECHANISMS, QUANTITIES, errors_of

# Times in a cycle; the table in bench/accuracy.md has more.
TIMES = 60
# A position is closed to round-off; 1e-13 for it and 1e-11 for accelerations are asked of chains well away from
# their singular positions, as all of these are.
LIMITS = (1e-13, 1e-12, 1e-11)


@pytest.mark.parametrize('path, end', [pytest.param(path, end, id=name) for name, path, end in MECHANISMS])
def test_errors_against_extended_precision(checks, mech9k, path, end):
    errors, gap = errors_of(mech9k, path, end, TIMES)
    checks.true(gap < 1e-16 * 100, 'the reference closes in extended precision', gap)
    for (quantity, _), limit, values in zip(QUANTITIES, LIMITS, errors):
        worst = np.max(values)
        checks.true(worst <= limit, f'{quantity} within {limit:.0e}', f'worst error {worst:.2e}')
