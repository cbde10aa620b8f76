"""Parameters that are formulas of others: values against Python's own evaluation of random formulas, derivatives against closed forms
and differences of runs, studies and searches against runs with the numbers written, and the places of errors.

Compares the program with itself: derivatives with differences of runs, and formulas with their numbers.
"""
import math
import os
import random

import numpy as np
import pytest

from mech9_cases import read_table, run, table_of

DONE, DATA = 0, 3
A, B, C = 1.3, 0.7, -0.4

NAMES = {name: getattr(math, name) for name in ('sqrt', 'sin', 'cos', 'tan', 'asin', 'acos', 'atan', 'atan2', 'exp', 'log', 'pi')}
NAMES |= {'abs': math.fabs, 'min': min, 'max': max, 'a': A, 'b': B, 'c': C}

FOUR_BAR = """&mechanism title='four-bar' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0.8,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', axis=0,0,1, point=0.9,0,0, moving_point=0,0,0 /
&initial coordinate=4, position=1.2 /
&point name='P', link=3, position=0.5,0.1,0 /
&body link=3, mass=2, centre=0.5,0,0, inertia=0,0,0.1,0,0,0 /
&time end=0.2, intervals=8 /
"""
DRIVE = "&drive coordinate=1, kind='polynomial', coefficients=0.4, 10 /\n"
START = '&initial coordinate=1, position=0.4, velocity=3 /\n'
FORMULAS = """&parameter name='twice', formula='2*diagonal - 0.4', sets='point.position(1)' /
&parameter name='diagonal', formula='sqrt(a^2 + b^2) - 0.2', sets='pair(2).point(1)','body.mass', factors=1,2, terms=0,1 /
&parameter name='a', value=0.3 /
&parameter name='b', value=0.4, sets='point.position(2)', factors=0.25 /
"""


def write(folder, text, name='case.nml'):
    path = os.path.join(folder, name)
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)
    return path


def formula(draw, depth):
    """A random formula, with blanks at random places."""
    def blank():
        return draw.choice(('', '', ' ', '  '))
    if depth == 0 or draw.random() < 0.15:
        return draw.choice(('a', 'b', 'c', 'pi', str(draw.randint(0, 9)), f'{draw.uniform(0, 5):.3g}', '.5', '2e-1', '3.', '1E+1'))
    kind = draw.random()
    if kind < 0.5:
        return formula(draw, depth - 1) + blank() + draw.choice('+-*/^') + blank() + formula(draw, depth - 1)
    if kind < 0.6:
        return draw.choice('+-') + blank() + formula(draw, depth - 1)
    if kind < 0.75:
        return '(' + formula(draw, depth - 1) + ')'
    name = draw.choice([name for name in NAMES if name not in ('pi', 'a', 'b', 'c')])
    count = {'atan2': 2, 'min': draw.randint(2, 4), 'max': 2}.get(name, 1)
    return name + '(' + (',' + blank()).join(formula(draw, depth - 1) for _ in range(count)) + ')'


def value(text):
    """The value of a formula by Python; None where it has none, or one that is no sensible number."""
    try:
        number = eval(text.replace('^', '**'), {'__builtins__': {}}, NAMES)       # the text is made above
    except (ZeroDivisionError, ValueError, OverflowError, TypeError):
        return None
    return None if isinstance(number, complex) or not abs(number) < 1e60 else number


def test_random_formulas_have_the_values_of_python(checks, mech9k, tmp_path):
    draw = random.Random(33)
    texts = [text for text in (formula(draw, draw.randint(1, 5)) for _ in range(4000)) if len(text) < 400]
    good = [text for text in texts if value(text) is not None]
    checks.true(len(good) > 2000, 'most formulas have a value')
    given = ''.join(f"&parameter name='{name}', value={number} /\n" for name, number in (('a', A), ('b', B), ('c', C)))
    path = write(tmp_path, FOUR_BAR + DRIVE + given + "&parameter name='all', formula='a + b + c' /\n"
                 + ''.join(f"&parameter name='f{i}', formula='{text}' /\n" for i, text in enumerate(good)))
    done = run(mech9k, path, '--check')
    checks.true(done.returncode == DONE, f'formulas with values are read: {done.stderr[:300]}')
    found = [line.split(' = ')[-1] for line in done.stdout.splitlines() if line.startswith('  f')]
    for text, number in zip(good, found, strict=True):
        checks.near(float(number), value(text), 2e-11, f'the value of {text}')      # it is printed with 12 digits


def test_formulas_without_value_are_refused(checks, mech9k, tmp_path):
    draw = random.Random(34)
    texts = [text for text in (formula(draw, draw.randint(1, 4)) for _ in range(1000)) if len(text) < 400 and value(text) is None][:40]
    for text in texts:
        path = write(tmp_path, FOUR_BAR + DRIVE + f"&parameter name='a', value={A} /\n&parameter name='b', value={B} /\n"
                     f"&parameter name='c', value={C} /\n&parameter name='x', formula='{text}' /\n"
                     "&parameter name='y', formula='a + b + c', sets='point.position(1)' /\n")
        done = run(mech9k, path, '--check')
        checks.true(done.returncode == DATA and "the formula of parameter 'x' fails: " in done.stderr, f'{text} has no value: {done.stderr[:200]}')


def test_derivatives_are_total(checks, build, tmp_path):
    """A point of link 1 stands still at (f, g, 0): its derivatives are those of f and g."""
    text = """&mechanism /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&drive coordinate=1, kind='polynomial', coefficients=0, 1 /
&point name='P', link=1 /
&time end=0.1, intervals=1 /
&output sensitivities=.true. /
&parameter name='a', value=1.3 /
&parameter name='b', value=0.7, sets='point.position(3)' /
&parameter name='f', formula='g*sin(a*b) + a^b', sets='point.position(1)' /
&parameter name='g', formula='exp(b/a) + atan2(a, b)', sets='point.position(2)', factors=-2, terms=1 /
"""
    a, b = 1.3, 0.7
    g = math.exp(b / a) + math.atan2(a, b)
    g_by = {'a': -b / a**2 * math.exp(b / a) + b / (a * a + b * b), 'b': math.exp(b / a) / a - a / (a * a + b * b)}
    f_by = {'a': g_by['a'] * math.sin(a * b) + g * b * math.cos(a * b) + b * a**(b - 1),
            'b': g_by['b'] * math.sin(a * b) + g * a * math.cos(a * b) + a**b * math.log(a)}
    for name in ('mech9k', 'mech9d'):
        table = table_of(build.program(name), write(tmp_path, text))
        checks.true(not any(column.endswith(('/d(f)', '/d(g)')) for column in table), f'{name}: formulas have no columns')
        for parameter in 'ab':
            expected = {'P.x': f_by[parameter], 'P.y': -2 * g_by[parameter], 'P.z': float(parameter == 'b')}
            for column, number in expected.items():
                # linear functions of the numbers: differences of the readers are exact to round-off
                checks.near(table[f'd({column})/d({parameter})'][-1], number, 1e-13, f'{name}: {column} by {parameter}')


@pytest.mark.parametrize('motion', (DRIVE, START), ids=('driven', 'free'))
def test_derivatives_of_motions_are_slopes_of_runs(checks, build, motion, tmp_path):
    path = write(tmp_path, FOUR_BAR + motion + FORMULAS + '&output sensitivities=.true. /\n&solver relative_tolerance=1e-12, absolute_tolerance=1e-13 /\n')
    program = build.program('mech9k' if motion is DRIVE else 'mech9d')
    table = table_of(program, path)
    h = 2.0**-9
    for number, (parameter, at) in enumerate((('a', 0.3), ('b', 0.4)), 3):
        runs = {i: table_of(program, path, '--set', f'parameter({number}).value={at + i * h!r}', '--set', 'output.sensitivities=.false.')
                for i in (-3, -2, -1, 1, 2, 3)}
        for column in ('q4', 'dq4', 'ddq4', 'P.x', 'P.ay'):
            slope = sum(w * (runs[i][column] - runs[-i][column]) for i, w in ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))) / h
            size = max(1.0, np.abs(slope).max())
            # truncation of sixth order; the integration is exact to 1e-10 or so
            checks.true(np.abs(table[f'd({column})/d({parameter})'] - slope).max() < 2e-7 * size, f'{column} by {parameter}')


def test_designs_follow_formulas(checks, mech9k, tmp_path):
    quantity = "&quantity name='reach', of='P.x', take='end' /\n"
    study = "&study kind='list', file='runs.dat' /\n" + quantity
    write(tmp_path, '0.3 0.4\n0.25 0.4\n0.35 0.45\n0.3 0.1\n', 'runs.dat')
    path = write(tmp_path, FOUR_BAR + DRIVE + FORMULAS + study)
    done = run(mech9k, path, '--study', '--quiet')
    rows = read_table(done.stdout)
    checks.true(list(rows) == ['run', 'a', 'b', 'reach', 'exit_code'], f'columns of a study: {list(rows)}')
    for a, b, reach, code in zip(rows['a'], rows['b'], rows['reach'], rows['exit_code'], strict=True):
        diagonal = math.hypot(a, b) - 0.2
        written = write(tmp_path, (FOUR_BAR + DRIVE).replace('point=0.3', f'point={diagonal!r}')
                        .replace('position=0.5,0.1', f'position={2 * diagonal - 0.4!r},{0.25 * b!r}'), 'written.nml')
        checks.true(code == DONE, 'a run of the study')
        checks.near(reach, table_of(mech9k, written)['P.x'][-1], 1e-12, 'a run of a study is that with its numbers written')
    failing = write(tmp_path, FOUR_BAR + DRIVE + FORMULAS.replace('sqrt(a^2 + b^2) - 0.2', 'sqrt(b - a) - 0.0162') + study, 'failing.nml')
    rows = read_table(run(mech9k, failing, '--study', '--quiet').stdout)
    checks.true(list(rows['exit_code']) == [DONE, DONE, DONE, DATA], 'a formula without a value fails in its run alone')


def test_searches_follow_formulas(checks, mech9k, tmp_path):
    """A path that the mechanism with a = 0.3 has is found again, by the lengths that follow from a."""
    parts = FORMULAS.replace("'a', value=0.3", "'a', value=0.36, low=0.22, high=0.4")
    path = write(tmp_path, FOUR_BAR + DRIVE + parts + "&objective kind='path', point='P', file='path.dat' /\n&optimum starts=8 /\n")
    rows = table_of(mech9k, write(tmp_path, FOUR_BAR + DRIVE + FORMULAS, 'right.nml'))
    write(tmp_path, ''.join(f'{x!r} {y!r}\n' for x, y in zip(rows['P.x'][1:8].tolist(), rows['P.y'][1:8].tolist(), strict=True)), 'path.dat')
    done = run(mech9k, path, '--optimize', '--out', os.path.join(tmp_path, 'best.nml'), '--table', os.path.join(tmp_path, 'best.dat'))
    checks.true(done.returncode == DONE, f'the search is made: {done.stderr[:300]}')
    with open(os.path.join(tmp_path, 'best.dat'), encoding='utf-8') as file:
        table = read_table(file.read())
    checks.near(table['a'][0], 0.3, 1e-6, 'the search finds a')
    best = run(mech9k, os.path.join(tmp_path, 'best.nml'), '--check')
    checks.true('diagonal = sqrt(a^2 + b^2) - 0.2 = 0.3' in best.stdout or 'diagonal = sqrt(a^2 + b^2) - 0.2 = 0.29999' in best.stdout,
                f'the data file of the best design keeps the formula: {best.stdout[:700]}')


@pytest.mark.parametrize('change, words, caret', (
    (("'sqrt(a^2 + b^2) - 0.2'", "'sqrt(a^2 + c) - 0.2'"), "there is no parameter 'c'", 'c)'),
    (("'sqrt(a^2 + b^2) - 0.2'", "'twice/2'"), "this formula needs its own value: 'twice' needs 'diagonal', which needs 'twice'", 'diagonal'),
    (("'sqrt(a^2 + b^2) - 0.2'", "'a + diagonal'"), "'diagonal' needs 'diagonal'", 'diagonal'),
    (("'sqrt(a^2 + b^2) - 0.2'", "'sqrt(a - b)'"), 'the square root of a negative number, -0.1', 'sqrt'),
    (("'sqrt(a^2 + b^2) - 0.2'", "'sqrt(a^2 +'"), 'a number or a name is missing here', "+'"),
    (("name='diagonal',", "name='diagonal', value=1,"), "'value' does not belong to a parameter with a formula", 'value'),
    (("name='diagonal',", "name='diagonal', low=1, high=2,"), "'low' does not belong to a parameter with a formula", 'low'),
    (("value=0.3 /", "value=0.3 /\n&parameter name='pi', value=1, sets='pair(3).point(1)' /"), 'pi is a number in formulas', "'pi'"),
    (("'a', value=0.3", "'a'"), "parameter 'a' needs 'sets'", '&parameter'),
    (("value=0.3 /", "value=0.3 /\n&parameter name='idle', value=2 /"), "parameter 'idle' sets no number, and no formula names it", '&parameter'),
    (("sets='point.position(1)'", "sets='pair(2).point(1)'"), 'sets this number already', "'pair(2).point(1)'"),
    (("2*diagonal - 0.4", "1e60*1e50*diagonal"), 'sets this number to ', "0.5"),
))
def test_wrong_formulas_are_told_with_their_place(checks, mech9k, tmp_path, change, words, caret):
    text = FOUR_BAR + DRIVE + FORMULAS
    checks.true(change[0] in text, 'the change is one')
    done = run(mech9k, write(tmp_path, text.replace(*change)), '--check')
    checks.true(done.returncode == DATA and words in done.stderr, f'{words}: {done.stderr}')
    line, carets = done.stderr.splitlines()[1:3]
    checks.true(line[carets.index('^'):].startswith(caret), f'the place of {words}: {done.stderr}')


def test_kinks_have_no_derivative(checks, mech9k, tmp_path):
    text = FOUR_BAR + DRIVE + FORMULAS.replace('sqrt(a^2 + b^2) - 0.2', 'abs(a - 0.3) + 0.3 + 0*b')
    path = write(tmp_path, text)
    checks.true(run(mech9k, path, '--quiet').returncode == DONE, 'a run without derivatives is made')
    done = run(mech9k, path, '--set', 'output.sensitivities=.true.')
    checks.true(done.returncode == DATA and "the formula of parameter 'diagonal' fails: it has no derivative here" in done.stderr,
                f'a kink is told: {done.stderr}')
    smooth = run(mech9k, path, '--set', 'output.sensitivities=.true.', '--set', 'parameter(3).value=0.31', '--quiet')
    checks.true(smooth.returncode == DONE, 'beside the kink there is a derivative')


def test_set_takes_formulas_of_numbers(checks, mech9k, tmp_path):
    path = write(tmp_path, FOUR_BAR + DRIVE)
    for setting, written in (('pair(2).point(1)=0.2*sqrt(2)', 0.2 * math.sqrt(2)), ('pair(2).point=3e-1, 0, 0', 0.3),
                             ('pair(2).point=min(1,0.3), sin(0), 1-1', 0.3), ('pair(2).point(1)=2*0.14', 0.28), ('pair(2).point(1)=-(-.3)', 0.3)):
        set_ = table_of(mech9k, path, '--set', setting)
        other = table_of(mech9k, path, '--set', f'pair(2).point(1)={written!r}')
        checks.true(all(np.array_equal(set_[name], other[name]) for name in set_), f'--set {setting}')
    checks.true(table_of(mech9k, path, '--set', 'drive.coefficients=2*0.2')['dq1'][0] == 0.2, '3*0.5 repeats in a list')
    checks.true(table_of(mech9k, path, '--set', 'time.intervals=2*3')['t'].size == 7, 'a whole number may be a product')
    deg = run(mech9k, path, '--set', 'mechanism.angle_unit=deg', '--set', 'drive.coefficients=acos(0.5), 1', '--quiet')
    checks.near(read_table(deg.stdout)['q1'][0], 60.0, 1e-13, 'angles are in the unit of the file')
    for setting, words, caret in (('pair(2).point(1)=2*0.1*sqrt(x)', "a formula here is of numbers alone, and 'x' is none", 'x)'),
                                  ('pair(2).point(1)=0.3*(1', 'this parenthesis is not closed', '(1'),
                                  ('pair(2).point(1)=1/0', 'this divides by zero', '/0')):
        done = run(mech9k, path, '--set', setting)
        line, carets = done.stderr.splitlines()[1:3]
        checks.true(done.returncode == DATA and words in done.stderr and line[carets.index('^'):].startswith(caret), f'{setting}: {done.stderr}')


def test_set_decides_over_formulas(checks, mech9k, tmp_path):
    done = run(mech9k, write(tmp_path, FOUR_BAR + DRIVE + FORMULAS), '--check', '--set', 'pair(2).point(1)=0.25')
    checks.true("note: --set pair(2).point(1)=0.25 decides, not parameter 'diagonal'" in done.stdout, f'the note: {done.stdout}')
    checks.true('diagonal = sqrt(a^2 + b^2) - 0.2 = 0.3 sets body.mass' in done.stdout, 'the formula keeps its other number')
