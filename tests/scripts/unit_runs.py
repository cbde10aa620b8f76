"""Runs of one mechanism in several units, compared with each other."""
import copy
import json
import math
import os
import re

import numpy as np

import data_file
import file_units
from mech9_cases import read_table, run, tolerance_of

UNITS = (1e3, 1e-3)     # numbers of lengths in millimetres, in kilometres, against those in metres
LIMIT = 1e-9            # of a dead point, as promised
GRAVITY = 9.81          # m/s2

SHORT = ('--set', 'time.intervals=1', '--set', 'time.end=1e-6')   # runs of dynamics end soon after their start


def sliding(groups):
    """The coordinates of slides, by their numbers, and the couplings whose forces act along slides, as C1."""
    slides = {pair['coordinate'][0] for group, pair in groups if group == 'pair' and pair['kind'][0] in ('prismatic', 'path')}
    joints = {'free': 3, 'planar': 2}        # they slide by their first coordinates
    for group, pair in groups:
        if group == 'pair' and 'coordinates' in pair:
            slides |= set(pair['coordinates'][:joints.get(pair['kind'][0], 0)])
    couplings = [items for group, items in groups if group == 'coupling']
    return slides | {f'C{i}' for i, items in enumerate(couplings, 1) if items['coordinates'][-1] in slides}


def groups_of_run(text):
    """The groups of a data file without those of its parameters, and without derivatives by them: their values would replace the numbers
    that are converted."""
    groups = [(group, items) for group, items in data_file.parse(text) if group not in ('parameter', 'study', 'objective', 'limit', 'optimum')]
    for _, items in groups:
        for name in ('sensitivities', 'gradients'):
            items.pop(name, None)
    return groups


def scaled(groups, s):
    """The groups with lengths that are s times as large: kg and s stay, so that forces are s times as large and moments s^2."""
    slides = sliding(groups)
    powers = {'point': {'position': 1}, 'body': {'centre': 1, 'inertia': 2}, 'gravity': {'acceleration': 1},
              'pair': {'point': 1, 'moving_point': 1, 'pitch': 1},
              'coupling': {'radius': 1, 'radii': 1, 'pitch': 1},
              'spring': {'position': 1, 'second_position': 1, 'free_length': 1},
              'friction': {'radius': 1, 'face_radius': 1, 'arm': 1}, 'contact': {'origin': 1, 'radius': 1, 'other_radius': 1},
              'force': {'position': 1, 'force': 1}, 'torque': {'torque': 2}}
    along = {'initial': {'position': 1, 'velocity': 1},
             'drive': {'coefficients': 1, 'mean': 1, 'amplitude': 1, 'values': 1},
             'coordinate': {'rest': 1, 'force': 1}, 'stop': {'low': 1, 'high': 1}}
    for group, items in groups:
        kind = items['kind'][0] if group == 'load' else group
        change = dict(powers.get(kind, {}))
        if kind in along and items['coordinate'][0] in slides:
            change = along[kind]
        elif kind == 'coordinate':
            change = {'stiffness': 2, 'damping': 2, 'force': 2}
        for name, power in change.items():
            if name in items:
                items[name] = [float(value) * s ** power for value in items[name]]
        if group == 'contact' and 'file' in items:
            items['scale'] = [float(items.get('scale', [1.0])[0]) * s]
        if 'dh' in items:
            items['dh'] = [float(value) * (s if i in (0, 2) else 1.0) for i, value in enumerate(items['dh'])]
    return slides


def in_degrees(groups):
    """The groups with angles in degrees, by the rules of the data file: forces and stiffnesses stay those per rad."""
    slides = sliding(groups)
    of_laws = ['angular_frequency', 'phase']
    of_turns = {'initial': ['position', 'velocity'], 'drive': ['coefficients', 'mean', 'amplitude', 'values'],
                'coordinate': ['rest'], 'stop': ['low', 'high']}
    for group, items in groups:
        kind = items['kind'][0] if group == 'load' else group
        names = list(of_laws if group in ('drive', 'load') else [])
        if kind in of_turns and items['coordinate'][0] not in slides:
            names += of_turns[kind]
        for name in names:
            if name in items:
                items[name] = [math.degrees(float(value)) for value in items[name]]
        if group == 'load' and 'over' in items and 'coefficients' in items:
            over = re.fullmatch(r'd?q(\d+)', items['over'][0])
            if over and int(over[1]) not in slides:
                items['coefficients'] = [float(value) / math.degrees(1) ** k for k, value in enumerate(items['coefficients'])]
        if 'dh' in items:
            items['dh'] = [math.degrees(float(value)) if i in (1, 3) else value for i, value in enumerate(items['dh'])]
        if group == 'mechanism':
            items['angle_unit'] = ['deg']
    return slides


# columns of links that are angles, or their derivatives
TURNING = re.compile(r'L\d+\.(phi|omega|alpha[xyz]?|w[xyz])')


def degrees_in(column, slides):
    """The divisor that turns a column of an angle into radians; 1 for others."""
    if TURNING.fullmatch(column):
        return math.degrees(1.0)
    coordinate = re.fullmatch(r'd{0,2}q(\d+)', column)
    return math.degrees(1.0) if coordinate and int(coordinate.group(1)) not in slides else 1.0


def power_of(column, slides):
    """Of the unit of length in a column."""
    if column in ('E.kinetic', 'E.potential', 'E.total'):
        return 2
    coordinate = re.fullmatch(r'd{0,2}q(\d+)', column)
    if coordinate:
        return 1 if int(coordinate.group(1)) in slides else 0
    if column.endswith(('.loss', '.heat')):
        return 2
    drive = re.fullmatch(r'F(\d+)|R(\d+)\.friction', column)
    if drive:
        return 1 if int(drive.group(1) or drive.group(2)) in slides else 2
    if re.fullmatch(r'C\d+', column):
        return 1 if column in slides else 2
    if re.fullmatch(r'R\d+\.m[xyz]?', column):
        return 2
    if TURNING.fullmatch(column) or re.fullmatch(r'L\d+\.e[0-3]', column):
        return 0
    return 1 if '.' in column else 0


def vector_of(column):
    """The vector of which a column is a component, the same for the forces of all pairs; for other columns their own name."""
    component = re.fullmatch(r'(.+\.[avfm]?)[xyz]', column)
    return re.sub(r'^R\d+', 'R', component[1]) if component else column


def largest_like(column, table):
    """The largest magnitude in a column and in the other components of its vector, whose round-off each component contains."""
    return max(np.max(np.abs(table[name])) for name in table if vector_of(name) == vector_of(column))


def into_radians(groups):
    """The groups of a file in degrees with angles in rad."""
    moves = file_units.motions(groups)
    degrees = file_units.FileUnits(angle='deg')
    for group, items in groups:
        kind = items['kind'][0] if group in ('load', 'motor') else group
        turns = 'coordinate' in items and group != 'pair' and moves.get(items['coordinate'][0]) == 'turn'
        always = ['at_least'] if group == 'limit' else ['angular_frequency', 'phase'] if group in ('drive', 'load', 'motor') else []
        of_turns = [name for name, what in file_units.OF_COORDINATE.get(kind, {}).items() if set(what) & set('qr')] if turns else []
        for name in always + of_turns:
            if name in items:
                items[name] = [float(value) * degrees.a for value in items[name]]
        if 'dh' in items:
            items['dh'] = [float(v) * (degrees.a if i in (1, 3) else 1.0) for i, v in enumerate(items['dh'])]
        if group == 'coupling':
            if 'coefficients' in items:
                items['coefficients'] = [float(v) / (degrees.a if moves[k] == 'turn' else 1.0)
                                         for v, k in zip(items['coefficients'], items['coordinates'])]
            if 'phase' in items and moves[items['coordinates'][1]] == 'turn':
                items['phase'] = [float(items['phase'][0]) * degrees.a]
        if group == 'mechanism':
            items.pop('angle_unit')


NAMED = [file_units.FileUnits('mm', 'deg', 'kN', 't', 'rpm'), file_units.FileUnits('in', 'deg', 'lbf', 'lb', 'rpm'),
         file_units.FileUnits('mm', 'rad', 'N', 'g')]


class Units:
    def __init__(self, checks, folder):
        self.checks, self.folder, self.heads = checks, folder, {}

    def look(self, program, text, *options):
        """Exit code, what is said but for the path, table and report of a run, and its plan."""
        path, table, report = (os.path.join(self.folder, name) for name in ('case.nml', 'case.dat', 'case.json'))
        for name in (table, report):
            if os.path.exists(name):
                os.remove(name)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        done = run(program, path, '--table', table, '--report', report, '--quiet', *options, folder=self.folder)
        plan = run(program, path, '--plan', folder=self.folder).stdout.split('coefficients of motion')[0]
        rows = kept = None
        if os.path.exists(table):
            with open(table, encoding='utf-8') as file:
                content = file.read()
            self.heads = file_units.head_units(content)
            rows = read_table(content) if len([line for line in content.splitlines() if line[:1] != '#']) > 1 else None
        if os.path.exists(report):
            with open(report, encoding='utf-8') as file:
                kept = json.load(file)
        if rows and 'evaluations' in (kept or {}):
            # the course of an integration depends on tolerances in m and rad: of it only the start
            rows = {name: values[:1] for name, values in rows.items()}
        return done.returncode, done.stderr, rows, kept, plan

    def compare(self, why, plain, other, unit):
        """A run in other units against the one in m and rad; `unit` says what to divide a column by."""
        code, said, table, report, plan = plain
        self.checks.equal(other[0], code, f'{why}: exit code')
        self.checks.equal(other[4], plan, f'{why}: the plan')
        if code == 6:
            limits = [float(re.search(r'beyond t = (\S+) s', words).group(1)) for words in (said, other[1])]
            self.checks.near(limits[1], limits[0], LIMIT, f'{why}: where it ends')
        if (table is None) or not self.checks.true(other[2] is not None, f'{why}: a table', other[1]):
            return
        for name in ('steps', 'halvings') if 'positions' in report else ():
            if name in report and code == 0:        # the last steps up to a dead point are as long as round-off lets them
                self.checks.equal(other[3][name], report[name], f'{why}: {name}')
        least = report.get('least_conditioning', 1.0)
        for column, values in table.items():
            if column == 'closure':
                continue
            found = other[2][column] / unit(column)
            if len(found) != len(values):
                self.checks.true(False, f'{why}: {len(values)} rows', len(found))
                return
            # beside a singular position each solution loses as much as its matrix is ill conditioned
            lost = max(1.0, 0.01 / least) ** (1 + column.count('d'))
            # relative to the largest number of the column, unless they all are zeros but for round-off; accelerations of a
            # mechanism at rest are differences of forces, and have the round-off of gravity
            largest = largest_like(column, table)
            if 'evaluations' in report and re.match(r'ddq|.*\.a[xyz]$', column):
                largest = max(largest, GRAVITY)
            self.checks.near(found, values, tolerance_of(column) * lost, f'{why}: {column}',
                             scale=largest if largest > tolerance_of(column) else 1.0)

    def file(self, program, path, *options):
        """A data file in three units of length, and in degrees."""
        with open(path, encoding='utf-8') as file:
            text = re.sub(r"file='", f"file='{os.path.dirname(path)}/", file.read())
        runs = []
        for s in (1.0, *UNITS):
            groups = groups_of_run(text)
            slides = scaled(groups, s)
            self.scale_curves(groups, s)
            runs.append(self.look(program, data_file.write(groups), *options))
        self.checks.true(runs[0][2] is not None, f'{path}: it runs', runs[0][1])
        for s, other in zip(UNITS, runs[1:]):
            self.compare(f'{os.path.basename(path)}, lengths times {s:g}', runs[0], other,
                         lambda column, s=s: s ** power_of(column, slides))
        groups = groups_of_run(text)
        if dict(groups)['mechanism'].get('angle_unit') == ['deg']:
            return
        slides = in_degrees(groups)
        self.compare(f'{os.path.basename(path)}, in degrees', runs[0], self.look(program, data_file.write(groups), *options),
                     lambda column: degrees_in(column, slides))

    def named(self, program, path, *options):
        """A data file with units that &mechanism names: each column is that of SI, by the unit of its head."""
        with open(path, encoding='utf-8') as file:
            text = re.sub(r"file='", f"file='{os.path.dirname(path)}/", file.read())
        groups = groups_of_run(text)
        if dict(groups)['mechanism'].get('angle_unit') == ['deg']:
            # angles of tables in files stay: only files without any are converted to rad first
            if any('file' in items for _, items in groups):
                self.checks.left_out('a table of this file counts in degrees')
                return
            groups = [(group, dict(items)) for group, items in groups]
            into_radians(groups)
        plain = self.look(program, data_file.write(groups), *options)
        heads = self.heads
        if not self.checks.true(plain[2] is not None, f'{path}: it runs', plain[1]):
            return
        for units in NAMED:
            there = file_units.in_units(copy.deepcopy(groups), units, self.folder)
            other = self.look(program, data_file.write(there), *options)
            if not self.checks.true(other[2] is not None, f'{path}, {units}: it runs', other[1]):
                continue
            sizes = {name: file_units.si_of(self.heads[name]) / file_units.si_of(heads[name]) for name in heads if name != 'error'}
            self.compare(f'{os.path.basename(path)}, {units}', plain, other, lambda column, sizes=sizes: 1 / sizes[column])

    def scale_curves(self, groups, s):
        """Curves with lengths that are s times as large, in files of their own."""
        for group, items in groups:
            if group != 'pair' or items['kind'] != ['path']:
                continue
            with open(items['file'][0], encoding='utf-8') as file:
                points = np.array([[float(word) for word in line.split()] for line in file if re.match(r'\s*[-+.\d]', line)])
            items['file'] = [os.path.join(self.folder, f'curve{items["coordinate"][0]}.dat')]
            np.savetxt(items['file'][0], s * points, fmt='%.17g')
