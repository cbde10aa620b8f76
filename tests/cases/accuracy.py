"""Errors of positions, velocities and accelerations over whole cycles, against the motion in extended precision.

Prints a table of their distribution: half of all numbers, 99 of 100, the worst. Positions in rad and parts of the
mechanism's length, rates and accelerations in parts of the greatest one of their mechanism.

usage: accuracy.py MECH9K TIMES [FILE]     (FILE: where the table is written, too, as Markdown)
"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
import numpy as np

import data_file
import true_motion
from mech9_cases import REFERENCE, TREE, Checks, table_of, text_of

# Data file; end of one cycle; what multiplies round-off there: the worst least singular value of its chains.
MECHANISMS = (
    ('Fig. 1', os.path.join(REFERENCE, 'kinematics_fig1.nml'), 2 * np.pi / 6),
    ('slider-crank', os.path.join(REFERENCE, 'kinematics_slider_crank.nml'), 2 * np.pi / 10),
    ('spatial slider-crank', os.path.join(REFERENCE, 'kinematics_spatial_slider_crank.nml'), 2 * np.pi / 4),
    ('seven revolutes', os.path.join(REFERENCE, 'kinematics_general_7r.nml'), 0.6),
    ('R-S-U-R', os.path.join(TREE, 'examples', 'rsur', 'rsur.nml'), 1.0),
    ('Jansen leg', os.path.join(TREE, 'examples', 'jansen_leg', 'jansen_leg.nml'), 1.0),
    ('class III group', os.path.join(TREE, 'examples', 'class_three_group', 'class_three_group.nml'), 1.0),
    ('Stewart-Gough platform', os.path.join(REFERENCE, 'stewart_gough_by_hand.nml'), 1.0),
)
# A position is closed to round-off; 1e-13 for it and 1e-11 for accelerations are asked of chains well away from
# their singular positions, as all of these are.
LIMITS = (1e-13, 1e-12, 1e-11)
QUANTITIES = (('positions', 'q'), ('velocities', 'dq'), ('accelerations', 'ddq'))


def errors_of(checks, mech9k, name, path, end, times):
    """The errors of the three quantities, all coordinates and times together."""
    groups = data_file.parse(text_of(path))
    table = table_of(mech9k, path, '--set', f'time.end={end!r}', '--set', f'time.intervals={times}')
    mechanism = true_motion.Mechanism(groups)
    count = len(mechanism.pairs)
    unit = np.array([1.0 if p.kind == 'prismatic' else float(mechanism.unit) for p in mechanism.pairs])[:, None]
    computed = [np.array([table[f'{head}{k + 1}'] for k in range(count)]) * unit for _, head in QUANTITIES]
    truth, gap = mechanism.follow(table['t'], computed[0])
    size = max(float(np.abs(p.fixed[1]).max()) for p in mechanism.pairs)
    checks.true(gap < 1e-16 * size * 100, f'{name}: the reference closes in extended precision', gap)
    result = []
    for order in range(3):
        if order == 0:
            scale = np.array([[size if p.kind == 'prismatic' else 1.0] for p in mechanism.pairs])
        else:
            scale = float(np.abs(truth[order]).max())
        result.append((np.abs(computed[order] - truth[order]).astype(float) / scale).ravel())
    return result


def main():
    mech9k, times = sys.argv[1], int(sys.argv[2])
    checks = Checks()
    lines = ['| mechanism | quantity | half below | 99 % below | worst |', '| --- | --- | --- | --- | --- |']
    for name, path, end in MECHANISMS:
        for (quantity, _), limit, errors in zip(QUANTITIES, LIMITS, errors_of(checks, mech9k, name, path, end, times)):
            half, most, worst = np.quantile(errors, [0.5, 0.99, 1.0])
            lines.append(f'| {name} | {quantity} | {half:.1e} | {most:.1e} | {worst:.1e} |')
            checks.true(worst <= limit, f'{name}: {quantity} within {limit:.0e}', f'worst error {worst:.2e}')
    print('\n'.join(lines))
    if len(sys.argv) > 3:
        with open(sys.argv[3], 'w', encoding='utf-8') as file:
            file.write('\n'.join(lines) + '\n')
    checks.finish()


main()
