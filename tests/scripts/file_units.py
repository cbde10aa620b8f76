"""Data files in other units: a table of what kind each number of the groups is, made from the mechanics and not from the program.

A kind is a product of powers of length, force, mass, angle and rate; numbers that belong to a coordinate depend on how its pair moves.
"""
import math
import os
import re

import numpy as np

# one unit in SI
LENGTHS = {'m': 1.0, 'mm': 1e-3, 'in': 0.0254}
FORCES = {'N': 1.0, 'kN': 1e3, 'lbf': 0.45359237 * 9.80665}
MASSES = {'kg': 1.0, 'g': 1e-3, 't': 1e3, 'lb': 0.45359237}
ANGLES = {'rad': 1.0, 'deg': math.pi / 180}
RATES = {'rad/s': 1.0, 'deg/s': math.pi / 180, 'rpm': math.pi / 30}
WORDS = {**LENGTHS, **FORCES, **MASSES, **ANGLES, 'rpm': math.pi / 30, 'J': 1.0, 'W': 1.0, 'Hz': 1.0, 's': 1.0, '1': 1.0, 'A': 1.0, 'V': 1.0}

FIXED = {'point': {'position': 'L'}, 'body': {'mass': 'M', 'centre': 'L', 'inertia': 'M L L'}, 'gravity': {'acceleration': 'L'},
         'pair': {'point': 'L', 'moving_point': 'L', 'pitch': 'L'}, 'coupling': {'radius': 'L', 'radii': 'L', 'pitch': 'L'},
         'spring': {'position': 'L', 'second_position': 'L', 'free_length': 'L', 'stiffness': 'F /L', 'damping': 'F /L'},
         'force': {'position': 'L', 'force': 'F'}, 'torque': {'torque': 'F L'}, 'cam': {'point': 'L', 'roller': 'L'},
         'friction': {'radius': 'L', 'face_radius': 'L', 'arm': 'L'}, 'contact': {'origin': 'L', 'radius': 'L', 'other_radius': 'L'},
         'objective': {'length': 'L'}, 'limit': {'at_least': 'a'}}
OF_COORDINATE = {'initial': {'position': 'q', 'velocity': 'r'},
                 'drive': {'coefficients': 'q, r, q', 'mean': 'q', 'amplitude': 'q', 'values': 'q'},
                 'coordinate': {'rest': 'q', 'force': 'f', 'stiffness': 'k', 'damping': 'k'},
                 'friction': {'preload': 'f', 'transition': 'r'}, 'stop': {'low': 'q', 'high': 'q', 'stiffness': 'p', 'damping': 'd'},
                 'pid': {'proportional': 'k', 'integral': 'k', 'derivative': 'k', 'limit': 'f', 'setpoint': 'q',
                         'coefficients': 'q, r, q', 'mean': 'q', 'amplitude': 'q', 'values': 'q'},
                 'dc': {'constant': 'f'}}
OF_LAWS = {'angular_frequency': 'r', 'phase': 'a'}


class FileUnits:
    """Units by their names, as &mechanism has them."""

    def __init__(self, length='m', angle='rad', force='N', mass='kg', rate=None):
        self.words = {'length_unit': length, 'angle_unit': angle, 'force_unit': force, 'mass_unit': mass}
        if rate:
            self.words['rate_unit'] = rate
        self.L, self.F, self.M, self.a = LENGTHS[length], FORCES[force], MASSES[mass], ANGLES[angle]
        self.r = RATES[rate] if rate else self.a

    def __str__(self):
        return ', '.join(self.words.values())

    def size(self, kind, motion, exponent=1.0):
        """One unit of a kind in SI; `motion` of the coordinate is 'turn', 'slide' or 'user'."""
        turn = motion == 'turn'
        own = {'L': self.L, '/L': 1 / self.L, 'F': self.F, 'M': self.M, 'a': self.a}
        if motion is None:
            own['r'] = self.r
        else:
            force = self.F * (1.0 if motion == 'slide' else self.L)
            depth = self.L if motion == 'slide' else 1.0
            own.update(q=self.a if turn else depth, r=self.r if turn else depth, f=force, k=force / depth, p=force / depth ** exponent,
                       d=force / depth ** (exponent + 1))
        return math.prod(own[part] for part in kind.split())


def motions(groups):
    """How each coordinate moves, by its number."""
    found = {}
    for group, items in groups:
        if group != 'pair':
            continue
        kind = items['kind'][0]
        if 'coordinates' in items:
            moves = {'free': 'sssttt', 'planar': 'sst', 'cylindrical': 'ts'}.get(kind, 'ttt')
            found.update({k: {'s': 'slide', 't': 'turn'}[m] for k, m in zip(items['coordinates'], moves)})
        else:
            found[items['coordinate'][0]] = {'prismatic': 'slide', 'path': 'slide', 'user': 'user'}.get(kind, 'turn')
    return found


def convert_items(items, kinds, units, motion, exponent=1.0):
    for name, kind in kinds.items():
        if name not in items:
            continue
        of_each = kind.split(', ')
        for i, value in enumerate(items[name]):
            items[name][i] = float(value) / units.size(of_each[min(i, len(of_each) - 1)], motion, exponent)


def in_units(groups, units, folder):
    """The groups of a data file in SI (angles in rad), in other units; tables and curves stand in files of their own."""
    moves = motions(groups)
    for number, (group, items) in enumerate(groups):
        kind = items['kind'][0] if group in ('load', 'motor') else group
        exponent = float(items.get('exponent', [1.0])[0])
        motion = moves.get(items['coordinate'][0]) if 'coordinate' in items and group != 'pair' else None
        convert_items(items, FIXED.get(kind, {}), units, None)
        if motion:
            convert_items(items, OF_COORDINATE.get(kind, {}), units, motion, exponent)
        if kind == 'contact' and 'file' in items:
            items['scale'] = [float(items.get('scale', [1.0])[0]) / units.L]
        if kind == 'contact':
            for name, power in (('stiffness', exponent), ('damping', exponent + 1)):
                if name in items:
                    items[name] = [float(items[name][0]) * units.L ** power / units.F]
        if group in ('drive', 'load', 'motor'):
            convert_items(items, OF_LAWS, units, None)
        if group == 'load' and 'over' in items and 'coefficients' in items:
            over = re.fullmatch(r"'?(d?)q(\d+)'?", items['over'][0])
            unit = units.size('r' if over[1] else 'q', moves[int(over[2])]) if over else units.L
            items['coefficients'] = [float(v) * unit ** i for i, v in enumerate(items['coefficients'])]
        if 'dh' in items:
            items['dh'] = [float(v) / (units.L if i in (0, 2) else units.a) for i, v in enumerate(items['dh'])]
        if group == 'coupling':
            of = [units.size('q', moves[k]) for k in items['coordinates']]
            if 'coefficients' in items:
                items['coefficients'] = [float(v) * u for v, u in zip(items['coefficients'], of)]
            if 'phase' in items:
                items['phase'] = [float(items['phase'][0]) / of[1]]
        if 'file' in items and group in ('pair', 'drive', 'coupling', 'load', 'motor'):
            column = {'pair': [units.L], 'coupling': of if group == 'coupling' else None, 'load': [1.0, 1.0]}.get(group)
            if column is None:
                column = [1.0, units.size('q', motion) if kind != 'dc' else 1.0]
            items['file'] = [scaled_file(items['file'][0], column, os.path.join(folder, f'numbers{number}.dat'))]
        if group == 'mechanism':
            items.pop('angle_unit', None)
            items.update({name: [word] for name, word in units.words.items()})
    return groups


def scaled_file(path, units, target):
    """A file of numbers with its columns in other units; one unit alone holds for all."""
    with open(path, encoding='utf-8') as file:
        rows = np.array([[float(word) for word in line.replace(',', ' ').split()] for line in file if re.match(r'\s*[-+.\d]', line)])
    np.savetxt(target, rows / (np.array(units) if len(units) > 1 else units[0]), fmt='%.17g')
    return target


def si_of(unit):
    """One unit of the head of a table in SI, as of kN_mm/s^2 or mm/(kN_mm)."""
    whole = re.fullmatch(r'(.*)/\((.*)\)', unit)
    if whole:
        return si_of(whole[1]) / si_of(whole[2])
    size = 1.0
    for sign, word, power in re.findall(r'(^|[_ /])([A-Za-z1]+)(?:\^(\d))?', unit):
        if word == 'rad' and sign == '/':       # per rad, whatever the unit of angles
            continue
        size *= WORDS[word] ** (int(power or 1) * (-1 if sign == '/' else 1))
    return size


def head_units(text):
    """The units of the columns of a table, by their names."""
    lines = text.splitlines()
    units = next(line for line in lines if line.startswith('# units:'))[len('# units:'):].split()
    names = next(line for line in lines if not line.startswith('#')).split()
    return dict(zip(names, units))
