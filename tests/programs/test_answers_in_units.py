"""Answers beside a run in units that &mechanism names: studies, searches, modes, equilibria, linearised equations, an accuracy.

Compares the program with itself in part: one mechanism in SI and in other units; closed forms are formulas.
"""
import json
import math
import os

import numpy as np
import pytest

import data_file
import file_units
from four_bars import SPRUNG
from mech9_cases import read_table, run
from unit_runs import NAMED

SI = file_units.FileUnits()
# parameters by the kinds of the numbers that they set; a load, a motor and a drive that belong to coordinates
FOUR_BAR = SPRUNG
DRIVE = "&drive coordinate=1, kind='polynomial', coefficients=0.4, 5 /\n"
START = '&initial coordinate=1, position=0.4, velocity=0.5 /\n'


class Answers:
    def __init__(self, checks, folder):
        self.checks, self.folder = checks, folder

    def written(self, text, units):
        """The path of a data file in other units; parameters are given in them already."""
        path = os.path.join(self.folder, 'case.nml')
        groups = file_units.in_units(data_file.parse(text), units, self.folder)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(data_file.write(groups))
        return path

    def answer(self, program, text, units, *options):
        """The columns of an answer in SI, its report, and what was said."""
        table, report = (os.path.join(self.folder, name) for name in ('answer.dat', 'answer.json'))
        done = run(program, self.written(text, units), '--table', table, '--report', report, *options, folder=self.folder)
        self.checks.equal(done.returncode, 0, f'{units}: {done.stderr}')
        with open(table, encoding='utf-8') as file:
            content = file.read()
        heads = file_units.head_units(content)
        rows = {name: np.array(values, dtype=float) * (1.0 if name == 'error' else file_units.si_of(heads[name]))
                for name, values in read_table(content).items()}
        with open(report, encoding='utf-8') as file:
            return rows, json.load(file), done.stderr, heads

    def same(self, rows, expected, tolerance, why, leave=()):
        self.checks.equal(sorted(rows), sorted(expected), f'{why}: the columns')
        for name, values in expected.items():
            if name in leave:
                continue
            largest = max(np.max(np.abs(values)), 1e-3)
            self.checks.near(rows[name], values, tolerance, f'{why}: {name}', scale=largest)


@pytest.fixture
def answers(checks, tmp_path):
    return Answers(checks, tmp_path)


def parameter(name, sets, size, more='', **values):
    """A group &parameter whose values are in units of this size."""
    return f"&parameter name='{name}', sets='{sets}', {more}" + ', '.join(f'{key}={value / size!r}' for key, value in values.items()) + ' /\n'


@pytest.mark.parametrize('named', NAMED, ids=str)
@pytest.mark.parametrize('kind', ["kind='grid'", "kind='sobol', runs=8"], ids=['grid', 'sobol'])
def test_studies(answers, mech9k, named, kind):
    """Values of parameters and quantities, each by the unit of its head."""
    found = []
    for units in (SI, named):
        spread = {'low': 0.25, 'high': 0.35} if 'grid' in kind else {'spread': 0.02}
        text = FOUR_BAR + DRIVE + '&time end=1, intervals=40 /\n&output drive_forces=.true. /\n'
        text += parameter('crank', 'pair(2).point(1)', units.L, 'count=3, ' if 'grid' in kind else '', **spread)
        spread = {'low': 2.0, 'high': 3.0} if 'grid' in kind else {'spread': 0.1}
        text += parameter('mass', 'body(2).mass', units.M, 'count=2, ' if 'grid' in kind else '', **spread)
        spread = {'low': 4.0, 'high': 6.0} if 'grid' in kind else {'spread': 0.3}
        text += parameter('rate', 'drive.coefficients(2)', units.r, 'count=2, ' if 'grid' in kind else '', **spread)
        text += ("&quantity name='torque', of='F1', take='peak' /\n&quantity name='reach', of='P.x', take='max' /\n"
                 f"&quantity name='speed', of='dq4', take='rms' /\n&quantity name='swing', of='q4', take='range' /\n&study {kind} /\n")
        found.append(answers.answer(mech9k, text, units, '--study'))
    answers.same(found[1][0], found[0][0], 1e-9, f'{named}: a study', leave=('run', 'exit_code'))
    answers.checks.equal([found[1][3]['crank'], found[1][3]['mass']], [named.words['length_unit'], named.words['mass_unit']], f'{named}: of parameters')
    answers.checks.equal(found[1][3]['torque'], f'{named.words["force_unit"]}_{named.words["length_unit"]}', f'{named}: the unit of a torque')


@pytest.mark.parametrize('named', NAMED, ids=str)
def test_searches(answers, mech9k, named):
    """The same designs. Squares of distances count in m^2, those of deviations of quantities in their own units."""
    times = np.linspace(0, 1, 9)
    target = np.array([times, 0.45 + 0.2 * np.cos(5 * times + 0.3), 0.35 + 0.12 * np.sin(5 * times + 0.4)]).T
    found = []
    for units in (SI, named):
        np.savetxt(os.path.join(answers.folder, 'targets.dat'), target / [1, units.L, units.L], fmt='%.17g')
        text = FOUR_BAR + DRIVE + '&time end=1, intervals=16 /\n'
        text += parameter('crank', 'pair(2).point(1)', units.L, low=0.2, high=0.4)
        text += parameter('rod', 'pair(3).point(1)', units.L, low=0.9, high=1.3)
        text += parameter('start', 'drive.coefficients(1)', units.a, low=-0.5, high=1.0)
        text += "&quantity name='swing', of='P.x', take='range' /\n"
        text += f"&limit kind='quantity', of='swing', low={0.1 / units.L!r}, high={0.9 / units.L!r} /\n"
        text += "&objective kind='path', point='P', file='targets.dat', timing='given' /\n&optimum starts=3, seed=2 /\n"
        found.append(answers.answer(mech9k, text, units, '--optimize'))
    first = [{name: values[:1] for name, values in rows.items() if name != 'starts'} for rows, _, _, _ in found]
    answers.checks.true(first[0]['value'][0] > 1e-4, 'the path is not met', first[0]['value'])
    # a minimum is known to the root of the error of its value
    answers.same(first[1], first[0], 1e-6, f'{named}: the best design')


@pytest.mark.parametrize('named', NAMED, ids=str)
def test_gradients_of_quantities(answers, mech9k, mech9d, named):
    """Derivatives of quantities per unit of the parameter."""
    for program, more in ((mech9k, DRIVE), (mech9d, START + '&solver relative_tolerance=1e-12, absolute_tolerance=1e-13 /\n')):
        found = []
        for units in (SI, named):
            text = FOUR_BAR + more + '&time end=0.5, intervals=20 /\n&output gradients=.true. /\n'
            sizes = {'crank': units.L, 'mass': units.M, 'stiffness': units.F * units.L, 'rest': units.a}
            sets = {'crank': 'pair(2).point(1)', 'mass': 'body(2).mass', 'stiffness': 'load.stiffness', 'rest': 'load.rest'}
            text += ''.join(f"&parameter name='{name}', sets='{sets[name]}' /\n" for name in sizes)
            text += ("&quantity name='reach', of='P.x', take='max' /\n&quantity name='speed', of='dq4', take='rms' /\n"
                     "&quantity name='last', of='P.vy', take='end' /\n")
            _, report, _, _ = answers.answer(program, text, units)
            found.append({(one['name'], by['parameter']): by['value'] * file_units.si_of(one['unit'].replace(' ', '_')) / sizes[by['parameter']]
                          for one in report['quantities'] for by in one['gradient']})
        answers.checks.equal(len(found[0]), 12, 'derivatives of three quantities by four parameters')
        for key, value in found[0].items():
            answers.checks.near(found[1][key], value, 1e-6, f'{named}, {program}: d{key[0]}/d{key[1]}', scale=max(abs(value), 1e-3))


@pytest.mark.parametrize('named', NAMED, ids=str)
@pytest.mark.parametrize('option', ['--equilibrium', '--modes'])
def test_rest_and_modes(answers, mech9d, named, option):
    text = FOUR_BAR + START + '&output reactions=.true. /\n'
    found = [answers.answer(mech9d, text, units, option) for units in (SI, named)]
    for rows, _, _, _ in found if option == '--modes' else ():
        # the size of a shape is free: the largest number of a shape is 1 in its unit
        shape = [name for name in rows if name.endswith(('.re', '.im')) and name.startswith('q')]
        largest = np.max([np.abs(rows[name]) for name in shape], axis=0)
        rows.update({name: rows[name] / largest for name in shape})
    answers.same(found[1][0], found[0][0], 1e-7, f'{named}: {option}', leave=('closure',))


@pytest.mark.parametrize('named', [file_units.FileUnits('mm', 'rad', 'kN', 't'), file_units.FileUnits('in', 'rad', 'lbf', 'lb')], ids=str)
def test_linear_stays_si(answers, mech9d, named):
    h5py = pytest.importorskip('h5py')
    found = []
    for units in (SI, named):
        path = os.path.join(answers.folder, 'linear.h5')
        done = run(mech9d, answers.written(FOUR_BAR + START, units), '--linear', path, folder=answers.folder)
        answers.checks.equal(done.returncode, 0, done.stderr)
        with h5py.File(path) as file:
            found.append({name: file['state_space'][name][()] for name in 'ABCD'} | {name: file['second_order'][name][()] for name in 'MCK'})
    for name, values in found[0].items():
        answers.checks.near(found[1][name], values, 1e-7, f'{named}: {name}', scale=np.max(np.abs(values)))


@pytest.mark.parametrize('named', NAMED, ids=str)
def test_accuracy_in_units(answers, mech9d, named):
    """An accuracy in mm and degrees is that many mm and degrees: the motion of a mass on a spring and of a disc, in closed form."""
    text = """
&mechanism links=3, coordinates=2 /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=1,3, kind='revolute', axis=0,0,1 /
&point name='P', link=3, position=0.7,0,0 /
&body link=2, mass=2 /
&body link=3, mass=0, inertia=0,0,0.5,0,0,0 /
&initial coordinate=1, position=0.3, velocity=0 /
&initial coordinate=2, position=0, velocity=1 /
&load kind='coordinate', coordinate=1, stiffness=50 /
&load kind='coordinate', coordinate=2, stiffness=12 /
&time end=6, intervals=60 /
"""
    accuracy = 1e-6
    rows, report, said, heads = answers.answer(mech9d, text, named, '--set', f'solver.accuracy={accuracy}')
    t = rows['t']
    errors = np.abs([(rows['q1'] - 0.3 * np.cos(5 * t)) / named.L, (rows['q2'] - np.sin(math.sqrt(24) * t) / math.sqrt(24)) / named.a,
                     (rows['P.y'] - 0.7 * np.sin(np.sin(math.sqrt(24) * t) / math.sqrt(24))) / named.L])
    answers.checks.true(np.max(errors) <= accuracy, f'{named}: within the accuracy', np.max(errors))
    # the estimate is that of the errors in these units: neither too small nor very much larger
    worst = np.max(rows['error'])
    answers.checks.true(0.5 * np.max(errors) <= worst <= accuracy, f'{named}: the column error', (worst, np.max(errors)))
    answers.checks.true(worst > 1e-3 * accuracy, f'{named}: and not much more accurate than that', worst)
    unit = f'{named.words["angle_unit"]},{named.words["length_unit"]}'
    answers.checks.equal(heads['error'], unit, f'{named}: its unit')
    answers.checks.near(report['error'], worst, 1e-12, f'{named}: the report')
    answers.checks.true(f'({unit.replace(",", ", ")}), estimated by' in said, f'{named}: in words', said)


def test_rest_in_kilonewtons(answers, mech9d):
    """A mass on a spring sinks by m g / k mm and vibrates with sqrt(k / m); a disc of t mm^2 with a stiffness of kN mm per rad."""
    text = """
&mechanism length_unit='mm', force_unit='kN', mass_unit='t', angle_unit='deg', rate_unit='rpm' /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&pair coordinate=2, links=1,3, kind='revolute', axis=0,0,1 /
&body link=2, mass=2 /
&body link=3, mass=0, inertia=0,0,50,0,0,0 /
&gravity acceleration=0,-9810,0 /
&initial coordinate=1, position=0 /
&initial coordinate=2, position=0 /
&load kind='coordinate', coordinate=1, stiffness=0.8 /
&load kind='coordinate', coordinate=2, stiffness=0.45, rest=30 /
&output reactions=.true. /
"""
    path, table = (os.path.join(answers.folder, name) for name in ('rest.nml', 'rest.dat'))
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)
    done = run(mech9d, path, '--equilibrium', '--table', table, folder=answers.folder)
    answers.checks.equal(done.returncode, 0, done.stderr)
    with open(table, encoding='utf-8') as file:
        content = file.read()
    rows, heads = read_table(content), file_units.head_units(content)
    answers.checks.near([rows['q1'][0], rows['q2'][0]], [-2 * 9.81 / 0.8, 30], 1e-9, 'places in mm and degrees', scale=30)
    answers.checks.equal([heads['q1'], heads['q2']], ['mm', 'deg'], 'their units')
    done = run(mech9d, path, '--modes', '--table', table, folder=answers.folder)
    answers.checks.equal(done.returncode, 0, done.stderr)
    with open(table, encoding='utf-8') as file:
        frequencies = sorted(read_table(file.read())['frequency'])
    expected = sorted([math.sqrt(0.8e6 / 2e3) / (2 * math.pi), math.sqrt(0.45 / 50e-3) / (2 * math.pi)])
    answers.checks.near(frequencies, expected, 1e-9, 'frequencies in Hz')
