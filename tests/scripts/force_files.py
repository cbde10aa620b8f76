"""Data files for tests of forces: bodies on mechanisms, the same mechanism in other numbers and places, forces as arrays, and their
comparison with equations of balance in absolute coordinates (dense_forces).
"""
import json
import os
import tempfile

import numpy as np

from data_file import parse, write
from dense_forces import Forces
from mech9_cases import TREE, read_table, run, text_of

try:
    import h5py
except ImportError:
    h5py = None

COMPONENTS = ('fx', 'fy', 'fz', 'mx', 'my', 'mz')
# Sums over the pairs of a link are round-off of the largest force; the program corrects them to some units in the last place, and
# the table gives accelerations with an error of as many.
BALANCE = 1e-11
# Along directions in which links are held weakly, round-off of the sums is enlarged by the conditioning, up to some thousands.
AGREEMENT = 1e-8


def forces_of(program, text, *options):
    """(table, report, unique components by pair or None) of a data file with all forces recorded."""
    with tempfile.TemporaryDirectory() as folder:
        names = {name: os.path.join(folder, name) for name in ('case.nml', 'rows.dat', 'rows.h5', 'report.json')}
        with open(names['case.nml'], 'w', encoding='utf-8') as file:
            file.write(text)
        done = run(program, names['case.nml'], '--table', names['rows.dat'], '--hdf5', names['rows.h5'], '--report', names['report.json'],
                   '--set', 'output.reactions=.true.', '--set', 'output.drive_forces=.true.', *options, folder=folder)
        if done.returncode != 0:
            raise RuntimeError(f'{program} ended with {done.returncode}:\n{done.stderr}')
        with open(names['report.json'], encoding='utf-8') as file:
            report = json.load(file)
        unique = None
        if h5py:
            with h5py.File(names['rows.h5']) as file:
                unique = file['reaction_unique'][:]
        return read_table(text_of(names['rows.dat'])), report, unique


def wrenches(table, row, pairs):
    return np.array([[table[f'R{k + 1}.{c}'][row] for c in COMPONENTS] for k in range(pairs)])


def compare(checks, program, groups, why, intervals=4):
    """Hold the forces of a data file against dense equations; gives the least uniqueness pattern as a list of texts."""
    groups = [(group, items) for group, items in groups if group != 'output']
    table, report, unique = forces_of(program, write(groups), '--set', f'time.intervals={intervals}')
    dense = Forces(groups, report['independent'])
    pairs = len(dense.pairs)
    units = [1.0 if pair.kind == 'prismatic' else float(dense.unit) for pair in dense.pairs]
    scales = np.array([1] * 3 + [dense.length] * 3)
    for row in range(len(table['t'])):
        q = [[table[f'{name}{k + 1}'][row] * units[k] * factor for k in range(pairs)]
             for name, factor in (('q', 1), ('dq', 1), ('ddq', 0.5))]
        expected, drives, null = dense.solve(q)
        found = wrenches(table, row, pairs)
        # a pendulum that is released at its side feels no force there
        largest = np.max(np.abs(expected / scales)) or 1.0
        checks.true(np.max(np.abs(found - expected) / scales) <= AGREEMENT * largest, f'{why}: wrenches of least norm in row {row}',
                    np.max(np.abs(found - expected) / scales) / largest)
        checks.true(dense.imbalance(q, found) <= BALANCE * largest, f'{why}: every link is in balance in row {row}',
                    dense.imbalance(q, found) / largest)
        for k, force in zip(report['independent'], drives):
            if f'F{k}' in table:
                checks.true(abs(force - table[f'F{k}'][row]) <= AGREEMENT * largest * max(1, dense.length), f'{why}: force of drive {k}',
                            (force, table[f'F{k}'][row]))
        # the last position may be a special one, as the first
        if unique is not None and row == 1:
            checks.true((unique == (null < 1e-9)).all(), f'{why}: the unique components are those without a part in the null space',
                        f'{unique}\n{(null < 1e-9).astype(int)}')
    checks.true(any(table[f'R{k + 1}.{c}'].any() for k in range(pairs) for c in COMPONENTS), f'{why}: there are forces')
    return None if unique is None else [''.join(c + ' ' for c, u in zip(COMPONENTS, row) if not u).strip() for row in unique]


def example(name, file=None):
    """The groups of an example's data file."""
    text = text_of(os.path.join(TREE, 'examples', name, file or f'{name}.nml'))
    return parse(text.replace('.true.', '1').replace('.false.', '0'))


def with_masses(rng, groups, flat=False):
    """Bodies on all links, gravity across no axis, and some loads; `flat`: none acts across the x-y plane."""
    links = max(max(items['links']) for group, items in groups if group == 'pair')
    groups = [(group, items) for group, items in groups if group not in ('body', 'gravity', 'load')]
    for link in range(2, links + 1):
        groups.append(('body', {'link': [link], 'mass': [float(rng.uniform(0.5, 2))], 'centre': list(map(float, rng.uniform(-0.3, 0.3, 3))),
                                'inertia': [0.3, 0.4, 0.5, 0.02, -0.03, 0.01]}))
    groups.append(('gravity', {'acceleration': [1.0, -9.0, 3.0]}))
    groups.append(('load', {'kind': ['torque'], 'link': [2], 'torque': [0.3, -0.2, 0.7]}))
    groups.append(('load', {'kind': ['force'], 'link': [links], 'position': [0.1, 0.2, 0.3], 'force': [3.0, -2.0, 1.0], 'frame': ['link']}))
    groups.append(('load', {'kind': ['spring'], 'links': [1, 2], 'position': [0.5, 0.1, 0.2], 'second_position': [0.1, 0.4, -0.2],
                            'stiffness': [20.0], 'free_length': [0.3], 'damping': [0.5]}))
    for k in (1, max(items['coordinate'][0] for group, items in groups if group == 'pair')):
        groups.append(('load', {'kind': ['coordinate'], 'coordinate': [k], 'stiffness': [2.0], 'damping': [0.7], 'force': [1.5]}))
    return in_plane(groups) if flat else groups


def in_plane(groups):
    """Bodies, gravity and loads without what acts across the x-y plane."""
    changed = []
    for group, items in groups:
        items = {name: list(values) for name, values in items.items()}
        for name in {'body': ('centre',), 'gravity': ('acceleration',), 'load': ('position', 'second_position', 'force')}.get(group, ()):
            if len(items.get(name, ())) == 3:
                items[name][2] = 0.0
        if 'torque' in items:
            items['torque'][:2] = [0.0, 0.0]
        if 'inertia' in items:
            items['inertia'][4:] = [0.0, 0.0]
        changed.append((group, items))
    return changed


def revolute(k, links, point, axis='0,0,1'):
    return f"&pair coordinate={k}, links={links}, kind='revolute', point={point}, axis={axis} /\n"


def rotation(rng):
    """A rotation at random."""
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return turn * np.linalg.det(turn)


def numbers(values):
    return [float(v) for v in values]


def rotated(groups, turn):
    """The whole mechanism turned, with its loads and gravity."""
    changed = []
    for group, items in groups:
        items = dict(items)
        if group == 'pair':
            axis = np.array(items['axis'])
            zero = np.array(items.get('zero', [1.0, 0, 0] if abs(axis[0]) <= np.sqrt(0.5) * np.linalg.norm(axis) else [0, 1.0, 0]))
            items['axis'], items['zero'] = numbers(turn @ axis), numbers(turn @ zero)
        for name in {'pair': ('point', 'moving_point'), 'point': ('position',), 'body': ('centre',), 'gravity': ('acceleration',),
                     'load': ('position', 'second_position', 'force', 'torque')}.get(group, ()):
            if len(items.get(name, ())) == 3:
                items[name] = numbers(turn @ np.array(items[name]))
        if group == 'body' and 'inertia' in items:
            xx, yy, zz, xy, xz, yz = items['inertia']
            i = turn @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ turn.T
            items['inertia'] = numbers([i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]])
        changed.append((group, items))
    return changed


def with_links(groups, new):
    """Link k gets the number new[k - 1]; a structure given by vectors or a matrix is left to the program."""
    changed = []
    for group, items in groups:
        items = {'cq': items['cq']} if group == 'structure' else dict(items)
        for name in ('link', 'links'):
            if name in items and group != 'mechanism':
                items[name] = [new[v - 1] for v in items[name]]
        changed.append((group, {**items, **({'links': [len(new)]} if group == 'mechanism' else {})}))
    return changed


def with_coordinates(groups, new):
    """Pair k gets the number new[k - 1], and so do its coordinate's drive, load and start."""
    changed = []
    for group, items in groups:
        items = {'cq': sorted(new[v - 1] for v in items['cq'])} if group == 'structure' else dict(items)
        if 'coordinate' in items:
            items['coordinate'] = [new[v - 1] for v in items['coordinate']]
        changed.append((group, items))
    return changed


def family_groups(family, rng):
    """A member of a family of families.py as a data file, its inputs driven, with masses and loads."""
    links, pairs, inputs = family(rng, 1)
    count = max(max(pair) for pair in links)
    groups = [('mechanism', {'links': [count], 'coordinates': [len(links)]}), ('structure', {'cq': list(inputs)})]
    for k, pair in enumerate(links):
        kind = 'prismatic' if not pairs.turns[0, k] else 'helical' if pairs.slides[0, k] else 'revolute'
        pitch = {'pitch': [float(2 * np.pi * pairs.slides[0, k])]} if kind == 'helical' else {}
        groups.append(('pair', {'coordinate': [k + 1], 'links': list(pair), 'kind': [kind], 'point': numbers(pairs.point[0, k]),
                                'axis': numbers(pairs.axis[0, k]), **pitch}))
    for k in inputs:
        groups.append(('drive', {'coordinate': [k], 'kind': ['polynomial'], 'coefficients': numbers([0.0, *rng.uniform(0.3, 0.9, 2)])}))
    groups.append(('time', {'start': [0], 'end': [0.1], 'intervals': [1]}))
    return with_masses(rng, groups)
