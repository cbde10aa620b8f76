"""Errors at the end of motions over the tolerance, by method: the table in bench/accuracy.md.

usage: tolerance_factors.py MECH9D      writes rows of a table to standard output; takes some minutes

The true end of a motion is where the highest-order method is at the least tolerance. How far another method of high
order ends from it is printed, too: factors are told for tolerances that are at least a hundred times that distance.
"""
import os
import re
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import numpy as np

from mech9_cases import REFERENCE, TREE, table_and_report

EXAMPLES = os.path.join(TREE, 'examples')
# name: data file, end [s]
MOTIONS = {
    'Fig. 1, 1 s': (os.path.join(REFERENCE, 'dynamics_fig1.nml'), 1.0),
    'open spatial chain, 1 s': (os.path.join(REFERENCE, 'dynamics_open_chain.nml'), 1.0),
    'spatial slider-crank, 1 s': (os.path.join(REFERENCE, 'dynamics_spatial_slider_crank.nml'), 1.0),
    'spatial slider-crank, 10 s': (os.path.join(REFERENCE, 'dynamics_spatial_slider_crank.nml'), 10.0),
    'spatial slider-crank, 100 s': (os.path.join(REFERENCE, 'dynamics_spatial_slider_crank.nml'), 100.0),
    'open spatial chain, 5 s': (os.path.join(REFERENCE, 'dynamics_open_chain.nml'), 5.0),
    'pendulum, 10 s': (os.path.join(EXAMPLES, 'pendulum', 'pendulum.nml'), 10.0),
    'slider-crank with damper, 10 s': (os.path.join(EXAMPLES, 'slider_crank_sundials', 'slider_crank.nml'), 10.0),
    'flyball governor, 10 s': (os.path.join(EXAMPLES, 'flyball_governor', 'flyball_governor.nml'), 10.0),
    'Andrews, 0.03 s': (os.path.join(EXAMPLES, 'andrews', 'andrews.nml'), 0.03),
    'Bricard, 10 s': (os.path.join(EXAMPLES, 'bricard', 'bricard.nml'), 10.0),
    'five-bar, whirling, 1 s': (os.path.join(REFERENCE, 'dynamics_fivebar.nml'), 1.0),
    'double pendulum, 5 s': (os.path.join(EXAMPLES, 'double_pendulum', 'double_pendulum.nml'), 5.0),
}
METHODS = ('prince-dormand', 'dormand-prince', 'verner', 'fehlberg', 'merson', 'adams', 'bdf')
TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)


def end_of(mech9d, data, end, method, tolerance):
    """Coordinates and rates at the end."""
    try:
        table, _ = table_and_report(
            mech9d, data, '--set', f'solver.method={method}', '--set', f'solver.relative_tolerance={tolerance:g}',
            '--set', f'solver.absolute_tolerance={tolerance:g}', '--set', 'time.intervals=1', '--set', f'time.end={end!r}')
    except RuntimeError:      # steps so long that they meet a singular position
        return np.nan
    return np.array([column[-1] for name, column in table.items() if name[0] in 'qd' and not name.startswith('ddq')])


def error(found, truth):
    return float(np.max(np.abs(found - truth) / np.maximum(1.0, np.abs(truth))))


def plain(number):
    """One digit, as people write it."""
    number = float(f'{number:.1g}')
    return f'{number:g}' if 0.01 <= number < 1000 else re.sub(r'e([-+])0', lambda sign: 'e' + sign[1].strip('+'), f'{number:.0e}')


def main():
    mech9d = os.path.abspath(sys.argv[1])
    wanted = sys.argv[2:] or MOTIONS
    print('| motion | ' + ' | '.join(METHODS) + ' |')
    print('| --- |' + ' --- |' * len(METHODS))
    for name in wanted:
        data, end = MOTIONS[name]
        truth = end_of(mech9d, data, end, 'prince-dormand', 1e-14)
        doubt = error(end_of(mech9d, data, end, 'verner', 1e-13), truth)
        cells = []
        for method in METHODS:
            factors = [error(end_of(mech9d, data, end, method, tolerance), truth) / tolerance
                       for tolerance in TOLERANCES if tolerance > 100 * doubt]
            cells.append(f'{plain(np.nanmin(factors))}–{plain(np.nanmax(factors))}' if factors else '')
        print(f'| {name} ({doubt:.0e}) | ' + ' | '.join(cells) + ' |', flush=True)


if __name__ == '__main__':
    main()
