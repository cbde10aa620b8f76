"""Errors of positions, velocities and accelerations over whole cycles, against the motion in extended precision: the table in
bench/accuracy.md.

usage: kinematic_accuracy.py MECH9K [TIMES]      writes rows of a table to standard output; 1000 times a cycle unless told

The table tells their distribution: half of all numbers, 99 of 100, the worst. Positions in rad and parts of the mechanism's length,
rates and accelerations in parts of the greatest one of their mechanism.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import numpy as np

import data_file
import true_motion
from mech9_cases import REFERENCE, TREE, table_of, text_of

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
    ('pair of legs', os.path.join(TREE, 'bench', 'data', 'legs_step.nml'), 1.0),
)
QUANTITIES = (('positions', 'q'), ('velocities', 'dq'), ('accelerations', 'ddq'))


def errors_of(mech9k, path, end, times):
    """The errors of the three quantities, all coordinates and times together; and the gap of the reference over the mechanism's size."""
    groups = data_file.parse(text_of(path))
    table = table_of(mech9k, path, '--set', f'time.end={end!r}', '--set', f'time.intervals={times}')
    mechanism = true_motion.Mechanism(groups)
    count = len(mechanism.pairs)
    unit = np.array([1.0 if p.kind == 'prismatic' else float(mechanism.unit) for p in mechanism.pairs])[:, None]
    computed = [np.array([table[f'{head}{k + 1}'] for k in range(count)]) * unit for _, head in QUANTITIES]
    truth, gap = mechanism.follow(table['t'], computed[0])
    size = max(float(np.abs(p.fixed[1]).max()) for p in mechanism.pairs)
    result = []
    for order in range(3):
        if order == 0:
            scale = np.array([[size if p.kind == 'prismatic' else 1.0] for p in mechanism.pairs])
        else:
            scale = float(np.abs(truth[order]).max())
        result.append((np.abs(computed[order] - truth[order]).astype(float) / scale).ravel())
    return result, gap / size


def main():
    mech9k, times = os.path.abspath(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1000
    print('| mechanism | ' + ' | '.join(quantity for quantity, _ in QUANTITIES) + ' |')
    print('| --- |' + ' --- |' * len(QUANTITIES))
    for name, path, end in MECHANISMS:
        errors, _ = errors_of(mech9k, path, end, times)
        cells = [', '.join(f'{error:.1e}' for error in np.quantile(values, [0.5, 0.99, 1.0])) for values in errors]
        print(f'| {name} | ' + ' | '.join(cells) + ' |', flush=True)


if __name__ == '__main__':
    main()
