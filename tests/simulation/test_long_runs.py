"""Chains stay closed however long a run is: mech9k over many positions, mech9d over a long time.

Compares the program with itself in part: positions before and after whole turns; closures are round-off by themselves.
"""
import os

import numpy as np
import pytest

from mech9_cases import REFERENCE, TREE, report_of, table_of

EPSILON = np.finfo(float).eps
FIG1 = os.path.join(REFERENCE, 'kinematics_fig1.nml')
N_FOUR_BAR = os.path.join(TREE, 'examples', 'n_four_bar', 'n_four_bar_2.nml')
A_TURN = 1000          # positions
SIZE = 4.0             # longer than any side of Fig. 1 [m]
# A closure is round-off where it is no larger than this part of the mechanism's length: a chain of some ten
# poses, each of them right to an epsilon in its turn and its place.
CLOSED = 32 * EPSILON


@pytest.fixture
def positions(build):
    """A million in the optimised build; with checks at run time they would take minutes."""
    return 1000000 if build.optimised else 20000


def test_many_positions_stay_closed(checks, mech9k, positions):
    """Fig. 1 turns and turns. Its coordinates grow with the turns, and no chain can be closed better than the last
    digit of its coordinates allows: an error of half a digit in each of the five of the longer chain."""
    turns = positions // A_TURN
    end = turns * 2 * np.pi / 6.0
    report = report_of(mech9k, FIG1, '--set', f'time.end={end!r}', '--set', f'time.intervals={positions}')
    angle = 0.5 + 6.0 * end
    checks.equal(report['positions'], positions + 1, 'all positions are found')
    checks.true(report['largest_closure'] <= (CLOSED + 5 * EPSILON / 2 * angle) * SIZE,
                f'{positions} positions stay closed', report['largest_closure'])


def test_everything_is_back_after_turns(checks, mech9k, positions):
    """After whole turns everything is where it was, but for the digits that the coordinates have lost."""
    turns = positions // A_TURN
    first = table_of(mech9k, FIG1, '--set', 'time.end=0', '--set', 'time.intervals=0')
    end = turns * 2 * np.pi / 6.0
    last = table_of(mech9k, FIG1, '--set', f'time.end={end!r}', '--set', f'time.intervals={turns * 10}')
    for k in range(1, 8):
        before, after = first[f'q{k}'][0], last[f'q{k}'][-1]
        difference = (after - before + np.pi) % (2 * np.pi) - np.pi
        # the driven coordinate itself has lost them; 8: how much faster than it another one moves at most
        checks.true(abs(difference) <= 8 * EPSILON * (0.5 + 6.0 * end), f'q{k} after {turns} turns', difference)


def test_long_time_stays_closed(checks, build, mech9d):
    """Coordinates that swing do not grow, and closures have no part of the integrator's error."""
    seconds = 10000 if build.optimised else 50
    report = report_of(mech9d, N_FOUR_BAR, '--set', f'time.end={seconds}', '--set', 'time.intervals=50')
    # links of 1 m, three in each chain
    checks.true(report['largest_closure'] <= CLOSED * 3.0, f'{seconds} s stay closed',
                report['largest_closure'])
