"""Searches by --optimize in a folder of their own, a four-bar linkage whose lengths are found, and the conditions of an optimum."""
import json
import os

import numpy as np

from mech9_cases import read_table, run, text_of

DONE, USAGE, DATA, ASSEMBLY, FILE = 0, 2, 3, 5, 8
FOUR_BAR = """&mechanism angle_unit='deg' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0, moving_point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=CRANK,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=COUPLER,0,0, moving_point=ROCKER,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', axis=0,0,1, point=2,0.1,0, moving_point=0,0,0 /
&initial coordinate=2, position=50 /
&initial coordinate=3, position=60 /
&initial coordinate=4, position=100 /
&point name='P', link=3, position=0.7,0.6,0 /
&drive coordinate=1, kind='polynomial', coefficients=10, 30 /
&time end=12, intervals=24 /
"""
LENGTHS = """&parameter name='crank', sets='pair(2).point(1)', low=0.2, high=0.8 /
&parameter name='coupler', sets='pair(3).point(1)', low=1, high=3 /
&parameter name='rocker', sets='pair(3).moving_point(1)', low=1, high=3 /
"""


class Cases:
    def __init__(self, checks, folder, program):
        self.checks, self.folder, self.program = checks, folder, program

    def write(self, text, name='case.nml'):
        path = os.path.join(self.folder, name)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return path

    def motion(self, text, *options):
        """The table of a single run."""
        table = os.path.join(self.folder, 'motion.dat')
        done = run(self.program, self.write(text, 'motion.nml'), '--table', table, '--quiet', *options, folder=self.folder)
        self.checks.true(done.returncode == DONE, 'the motion runs', done.stderr)
        return read_table(text_of(table))

    def search(self, text, why, *options):
        """The designs that a search finds, its report, and what it prints."""
        table, report = (os.path.join(self.folder, name) for name in ('designs.dat', 'report.json'))
        done = run(self.program, self.write(text), '--optimize', '--table', table, '--report', report, *options, folder=self.folder)
        self.checks.true(done.returncode == DONE, f'{why}: goes through', done.stderr)
        with open(report, encoding='utf-8') as file:
            return read_table(text_of(table)), json.load(file), done.stderr

    def refused(self, text, words, code=DATA, *options):
        done = run(self.program, self.write(text), '--optimize', *options, folder=self.folder)
        self.checks.true(done.returncode == code and words in done.stderr, f'refused: {words}',
                         f'code {done.returncode}\n{done.stderr}')


def with_numbers(text, **numbers):
    for name, value in numbers.items():
        text = text.replace(name, f'{float(value)!r}')
    return text


def targets(cases, columns):
    cases.write('\n'.join(' '.join(f'{float(x)!r}' for x in row) for row in np.transpose(columns)) + '\n', 'targets.dat')


def is_recovered(cases, designs, expected, why, value=1e-24, tolerance=1e-9):
    """The best design is the one that made the targets. Steps end at round-off, which only exact derivatives bring about."""
    cases.checks.true(designs['value'][0] <= value, f'{why}: nothing is left of the differences', str(designs['value']))
    for name, number in expected.items():
        cases.checks.near(designs[name][0], number, tolerance, f'{why}: {name} is found again')


def gradient(function, x, step=1e-6):
    """Central differences."""
    columns = []
    for i in range(len(x)):
        move = np.zeros(len(x))
        move[i] = step
        columns.append((np.asarray(function(x + move)) - np.asarray(function(x - move)))/(2*step))
    return np.array(columns)


def is_optimal(checks, slope, walls, why, tolerance):
    """The slope of a function that is least is a sum of the slopes of active limits (not negative where they are kept) with
    multipliers that are not negative."""
    multipliers, _, _, _ = np.linalg.lstsq(np.transpose(walls), slope, rcond=None)
    rest = slope - np.transpose(walls) @ multipliers
    checks.true(np.linalg.norm(rest) <= tolerance*np.linalg.norm(slope), f'{why}: the slope is one of the limits', f'{rest} of {slope}')
    checks.true(np.all(multipliers > -tolerance*np.linalg.norm(slope)), f'{why}: the multipliers are not negative', str(multipliers))


def contents_of(path):
    """All data sets but those of the origin in the HDF5 file of a search, as bytes."""
    import h5py
    contents = {}
    with h5py.File(path) as file:
        def take(name, item):
            if isinstance(item, h5py.Dataset) and not name.startswith('provenance/'):
                contents[name] = (item.shape, b'\0'.join(item[...].flat) if item.dtype.kind == 'O' and item.shape
                                  else item[()] if item.dtype.kind == 'O' else item[...].tobytes())
        file.visititems(take)
    return contents
