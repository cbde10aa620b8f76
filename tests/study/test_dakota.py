"""One evaluation for Dakota: its two forms of parameters files, values and gradients in its results file, failures, mistakes.
"""
import os
import signal
import subprocess
import time

import numpy as np
import pytest

from mech9_cases import PATIENCE, run, text_of

DONE, USAGE, DATA, FILE, INTERRUPTED = 0, 2, 3, 8, 130
# The stroke of a slider-crank without offset is twice its crank; at the end of the drive the crank points along the slider.
SLIDER_CRANK = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1.1,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, zero=0,1,0, moving_point=0,0,0 /
&initial coordinate=4, position=1.2 /
&drive coordinate=1, kind='polynomial', coefficients=0, 6.283185307179586 /
&point name='B', link=4 /
&time end=1, intervals=40 /
&output table='never.dat' /
&quantity name='stroke', of='B.x', take='range' /
&quantity name='far', of='B.x', take='end' /
&parameter name='crank', sets='pair(2).point(1)' /
&parameter name='rod', sets='pair(3).point(1)' /
"""
PENDULUM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0.4 /
&body link=2, mass=1, centre=0,-0.5,0, inertia=0,0,0.1,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&time end=1, intervals=20 /
&parameter name='mass', sets='body.mass' /
&quantity name='swing', of='q1', take='start' /
"""
# A stone that falls: its height at the end is start + rate - gravity/2.
STONE = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&initial coordinate=1, position=3, velocity=4 /
&body link=2, mass=2 /
&gravity acceleration=0,-9.81,0 /
&time end=1, intervals=10 /
&parameter name='rate', sets='initial.velocity' /
&parameter name='start', sets='initial.position' /
&parameter name='pull', sets='gravity.acceleration(2)' /
&quantity name='height', of='q1', take='end' /
&quantity name='sum', of='q1', take='integral' /
&quantity name='gap', of='closure', take='max' /
"""


def standard(variables, responses, by=()):
    """A parameters file in the standard form, as Dakota 6 writes it."""
    lines = [f'{len(variables)} variables'] + [f'{value:.15e} {name}' for name, value in variables]
    lines += [f'{len(responses)} functions'] + [f'{active} ASV_{i}:{name}' for i, (name, active) in enumerate(responses, 1)]
    lines += [f'{len(by)} derivative_variables'] + [f'{k} DVV_{i}:{variables[k - 1][0]}' for i, k in enumerate(by, 1)]
    lines += ['0 analysis_components', '7 eval_id', '0 metadata']
    return ''.join(f'{line:>60}\n' for line in lines)


def aprepro(variables, responses, by=()):
    """The same in the form of APREPRO."""
    lines = [f'DAKOTA_VARS     = {len(variables)}'] + [f'{name} = {value:.15e}' for name, value in variables]
    lines += [f'DAKOTA_FNS      = {len(responses)}'] + [f'ASV_{i}:{name} = {active}' for i, (name, active) in enumerate(responses, 1)]
    lines += [f'DAKOTA_DER_VARS = {len(by)}'] + [f'DVV_{i}:{variables[k - 1][0]} = {k}' for i, k in enumerate(by, 1)]
    lines += ['DAKOTA_AN_COMPS = 0', 'DAKOTA_EVAL_ID  = 7', 'DAKOTA_METADATA = 0']
    return ''.join(f'                    {{ {line} }}\n' for line in lines)


class Cases:
    def __init__(self, checks, folder):
        self.checks, self.folder = checks, folder

    def write(self, text, name='case.nml'):
        path = os.path.join(self.folder, name)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return path

    def evaluate(self, program, text, parameters, *more):
        """One evaluation: the finished program, and the text of its results file (None without one)."""
        results = os.path.join(self.folder, 'results.out')
        if os.path.exists(results):
            os.remove(results)
        self.write(parameters, 'params.in')
        done = run(program, self.write(text), '--dakota', 'params.in', 'results.out', *more, folder=self.folder)
        return done, text_of(results) if os.path.exists(results) else None


FORMS = pytest.mark.parametrize('form', (standard, aprepro), ids=('standard', 'aprepro'))


@pytest.fixture
def cases(checks, tmp_path):
    return Cases(checks, tmp_path)


@FORMS
def test_values(cases, mech9k, mech9d, form):
    check, why = cases.checks, form.__name__
    done, results = cases.evaluate(mech9k, SLIDER_CRANK, form([('rod', 1.0), ('crank', 0.25)], [('far', 1), ('stroke', 1)]))
    check.true(done.returncode == DONE and done.stderr == '', f'{why}: the evaluation is made', done.stderr)
    words = [line.split() for line in results.splitlines()]
    check.equal([word[1] for word in words], ['far', 'stroke'], f'{why}: descriptors in the order of the responses')
    check.near([float(word[0]) for word in words], [1.25, 0.5], 1e-10, f'{why}: values')
    _, results = cases.evaluate(mech9k, SLIDER_CRANK, form([('crank', 0.25)], [('stroke', 0), ('far', 1)]))
    words = [line.split() for line in results.splitlines()]
    check.true(len(words) == 1 and words[0][1] == 'far' and abs(float(words[0][0]) - 1.35) < 1e-10,
               f'{why}: a variable that Dakota leaves out keeps its value; a response that is not active is left out', results)
    done, results = cases.evaluate(mech9d, PENDULUM, form([('mass', 2.0)], [('swing', 1)]))
    check.near(float(results.split()[0]), 0.4, 1e-12, f'{why}: mech9d')
    check.true(not os.path.exists(os.path.join(cases.folder, 'never.dat')), 'the table of the data file is not written')


def test_a_value_with_set(cases, mech9k):
    _, results = cases.evaluate(mech9k, SLIDER_CRANK, standard([('crank', 0.25)], [('far', 1)]), '--set', 'parameter(2).value=1.2')
    cases.checks.near(float(results.split()[0]), 1.45, 1e-10, 'with --set')


@FORMS
def test_gradients(cases, mech9k, form):
    """far = crank + rod, stroke = 2 crank."""
    check = cases.checks
    _, results = cases.evaluate(mech9k, SLIDER_CRANK, form([('rod', 1.0), ('crank', 0.25)], [('far', 3), ('stroke', 2)], (2, 1)))
    lines = results.splitlines()
    check.true(len(lines) == 3 and lines[0].split()[1] == 'far' and all(line.startswith('[') and line.endswith(']') for line in lines[1:]),
               'values first, then gradients', results)
    found = np.array([line.strip('[]').split() for line in lines[1:]], float)
    check.near(found, [[1, 1], [2, 0]], 1e-8, 'gradients in the order of the derivative variables')


@FORMS
def test_gradients_of_a_free_motion(cases, mech9d, form):
    check = cases.checks
    done, results = cases.evaluate(mech9d, STONE, form([('start', 2.0), ('pull', -2.0), ('rate', 1.0)], [('sum', 2), ('height', 3)], (3, 1, 2)))
    check.true(done.returncode == DONE and done.stderr == '', 'mech9d: the evaluation is made', done.stderr)
    lines = results.splitlines()
    check.near(float(lines[0].split()[0]), 2.0, 1e-7, 'mech9d: the value')
    found = np.array([line.strip('[]').split() for line in lines[1:]], float)
    check.near(found, [[0.5, 1, 1 / 6], [1, 1, 0.5]], 1e-7, 'mech9d: the gradients')


def test_a_value_alone(cases, mech9d):
    """It is that of a run without derivatives."""
    _, results = cases.evaluate(mech9d, STONE, standard([('start', 2.0)], [('height', 1), ('gap', 0), ('sum', 0)], (1,)))
    cases.checks.near(float(results.split()[0]), 6 - 9.81 / 2, 1e-7, 'mech9d: a value alone')


def test_a_quantity_without_derivative(cases, mech9d):
    done, results = cases.evaluate(mech9d, STONE, standard([('start', 2.0)], [('height', 3), ('gap', 2)], (1,)))
    cases.checks.true(done.returncode == DONE and results.startswith("fail quantity 'gap' has no derivative"), 'a quantity without derivative', results)


def test_no_hessians(cases, mech9k):
    done, results = cases.evaluate(mech9k, SLIDER_CRANK, standard([('crank', 0.2)], [('far', 5)]))
    cases.checks.true(done.returncode == DATA and results is None and 'no_hessians' in done.stderr, 'no Hessians', done.stderr)


@pytest.mark.parametrize('crank', (1.3, 1e300))
def test_failures_are_told(cases, mech9k, crank):
    """A crank that is too long, and a value that the data file refuses: Dakota is told, and the program has done its work."""
    done, results = cases.evaluate(mech9k, SLIDER_CRANK, standard([('crank', crank)], [('far', 1)]))
    cases.checks.true(done.returncode == DONE and results.split()[0] == 'fail' and 'the run failed' in done.stderr, f'crank {crank}: fail',
                      (results, done.stderr))


def test_ctrl_c_ends_an_evaluation(cases, mech9k):
    """An evaluation that its user ends is none: its program ends as one does, without results."""
    results = os.path.join(cases.folder, 'none.out')
    cases.write(standard([('crank', 0.25)], [('far', 1)]), 'params.in')
    process = subprocess.Popen([mech9k, cases.write(SLIDER_CRANK), '--dakota', 'params.in', results, '--set', 'time.intervals=50000000'],
                               cwd=cases.folder, stderr=subprocess.DEVNULL)
    time.sleep(1.5)
    process.send_signal(signal.SIGINT)
    cases.checks.equal(process.wait(60 * PATIENCE), INTERRUPTED, 'Ctrl-C ends the evaluation')
    cases.checks.true(not os.path.exists(results), 'and there are no results')


GOOD = standard([('crank', 0.25)], [('far', 1)])


@pytest.mark.parametrize('parameters, message', (
    (GOOD.replace('crank', 'krank'), "the variable 'krank'; did you mean 'crank'?"),
    (GOOD.replace('far', 'response_fn_1'), "no &quantity has the name of the response 'response_fn_1'"),
    (standard([('crank', 0.25), ('crank', 0.3)], [('far', 1)]), "the variable 'crank' stands there twice"),
    (GOOD.replace('2.500000000000000e-01', 'long'), "params.in:2: 'long' is not a number"),
    (GOOD.replace('1 ASV_1', '9 ASV_1'), 'params.in:4: the active set vector has numbers from 0 to 7'),
    (standard([('crank', 0.25)], [('far', 1)], (1,)).replace('1 DVV', '2 DVV'), 'params.in:6: there is 1 variable, and this is the number of none'),
    (GOOD.replace('1 variables', '2 variables'), "params.in:4: the number of functions is expected here"),
    ('\n'.join(GOOD.splitlines()[:3]), 'the file ends before'),
    (GOOD.replace('1 variables', '-1 variables'), 'params.in:1: this is no length of a list'),
    ('', 'params.in: the whole file is empty'),
    ('{ }\n', 'params.in:1: a value and a tag are expected'),
    ('{}', 'params.in:1: a value and a tag are expected'),
    ('{', 'params.in:1: a value and a tag are expected'),
    ('1e99 variables', 'params.in:1: this is no length of a list'),
    ('\n\n', 'params.in:1: a value and a tag are expected')),
    ids=('variable', 'response', 'twice', 'a word', 'active set', 'derivative', 'no functions', 'cut', 'a negative length', 'empty', 'braces in a line',
         'braces', 'a brace', 'a length', 'empty lines'))
def test_wrong_files_of_parameters(cases, mech9k, parameters, message):
    done, results = cases.evaluate(mech9k, SLIDER_CRANK, parameters)
    cases.checks.true(done.returncode == DATA and results is None and message in done.stderr, message, f'{done.returncode}: {done.stderr} {results}')


@pytest.mark.parametrize('words, code, message', (
    (('--dakota', 'params.in'), USAGE, '--dakota needs two files: --dakota PARAMS RESULTS'),
    (('--dakota', 'params.in', 'params.in'), USAGE, 'would overwrite'),
    (('--dakota', 'params.in', 'case.nml'), USAGE, 'would overwrite'),
    (('--dakota', 'none.in', 'x.out'), FILE, 'none.in'),
    (('--dakota', 'params.in', 'none/x.out'), FILE, 'none/x.out'),
    (('--study', '--dakota', 'params.in', 'x.out'), USAGE, 'leave --study out'),
    (('--table', 'x.dat', '--dakota', 'params.in', 'x.out'), USAGE, 'leave --table out')),
    ids=('one file', 'over the parameters', 'over the data file', 'no file', 'no folder', 'study', 'table'))
def test_wrong_options(cases, mech9k, words, code, message):
    cases.write(GOOD, 'params.in')
    path = cases.write(SLIDER_CRANK)
    done = run(mech9k, path, *words, folder=cases.folder)
    cases.checks.true(done.returncode == code and message in done.stderr, f'{words}: {message}', f'{done.returncode}: {done.stderr}')
    cases.checks.equal(text_of(path), SLIDER_CRANK, 'nothing is written over')
