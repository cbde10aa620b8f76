"""Parameters: a run with a parameter is the run of a file in which its numbers are written; contradictions with --set are told.
"""
import os

import numpy as np
import pytest

from mech9_cases import run, table_of

DONE, DATA = 0, 3
CRANK = """&mechanism title='crank', angle_unit='deg' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point={crank},0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, zero=0,1,0, moving_point=0,0,0 /
&initial coordinate=4, position=1.2 /
&point name='B', link=4 /
&body link=2, mass=2, centre={centre},0,0, inertia=0,0,0.1,0,0,0 /
&body link=4, mass=1 /
&gravity acceleration=0,-9.81,0 /
&time end=0.5, intervals=20 /
"""
START = '&initial coordinate=1, position=20, velocity={rate} /\n'
DRIVE = "&drive coordinate=1, kind='polynomial', coefficients=20, {rate} /\n"
PARAMETERS = """&parameter name='crank', sets='pair(2).point(1)','body(1).centre(1)', factors=1,0.5, value=0.32 /
&parameter name='rate', sets='{rate}' /
"""


def write(folder, name, text):
    path = os.path.join(folder, name)
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)
    return path


class Varied:
    """A program with the data file that has parameters, and one in which their numbers are written."""

    def __init__(self, program, folder, motion, target):
        self.program, self.name = program, os.path.basename(program)
        self.written = write(folder, 'written.nml', CRANK.format(crank=0.32, centre=0.16) + motion.format(rate=90))
        self.path = write(folder, 'varied.nml', CRANK.format(crank=7, centre=7) + motion.format(rate=40) + PARAMETERS.format(rate=target))


@pytest.fixture(params=('mech9k', 'mech9d'))
def varied(request, build, tmp_path):
    motion, target = {'mech9k': (DRIVE, 'drive.coefficients(2)'), 'mech9d': (START, 'initial(2).velocity')}[request.param]
    return Varied(build.program(request.param), tmp_path, motion, target)


def test_parameters_give_the_bits_of_the_file_with_their_numbers(checks, varied):
    tables = [table_of(varied.program, path, '--set', setting)
              for path, setting in ((varied.written, 'time.start=0'), (varied.path, 'parameter(2).value=90'))]
    checks.true(all(np.array_equal(tables[0][column], tables[1][column]) for column in tables[0]),
                f'{varied.name}: parameters give the bits of the file with their numbers')


def test_a_later_set_is_told(checks, varied):
    done = run(varied.program, varied.path, '--set', 'parameter(1).value=0.33', '--set', 'pair(2).point(1)=0.4')
    checks.true(done.returncode == DONE and "note: --set pair(2).point(1)=0.4 decides, not parameter 'crank'\n" in done.stderr,
                f'{varied.name}: a later --set is told', done.stderr)


def test_nothing_is_told_with_quiet(checks, varied):
    done = run(varied.program, varied.path, '--set', 'pair(2).point(1)=0.4', '--set', 'parameter(1).value=0.33', '--quiet')
    checks.true(done.returncode == DONE and done.stderr == '', f'{varied.name}: nothing is told with --quiet', done.stderr)


def test_check_tells_parameters_and_contradictions(checks, varied):
    done = run(varied.program, varied.path, '--check', '--set', 'pair(2).point(1)=0.4', '--set', 'parameter(1).value=0.33')
    checks.true('note: --set parameter(1).value=0.33 stands after --set pair(2).point(1)=0.4 and decides\n' in done.stdout
                and '  crank = 0.33 sets pair(2).point(1), body(1).centre(1)\n' in done.stdout, f'{varied.name}: --check tells both', done.stdout)


@pytest.mark.parametrize('setting, message', (
    # an unknown number has its place and the nearest name
    ('parameter(1).sets=pair(2).pont(1)', "--set: unknown name 'pont' in &pair; did you mean 'point'?"),
    ('parameter(1).sets=pair.point(1)', 'there are 4 groups &pair; say which one: pair(2).point(1)'),
    ("parameter(1).sets='pair(2).point(1)','pair(2).point(1)'", 'this number is named twice'),
    ("parameter(2).sets='pair(2).point(1)'", "parameter 'crank' sets this number already"),
    ('parameter(3).value=1', 'this file has 2 groups &parameter, and --set adds another one'),
    ('parameter(4).value=1', 'this file has 2 groups &parameter only')),
    ids=('unknown name', 'which pair', 'twice', 'set already', 'a third parameter', 'a fourth parameter'))
def test_refused(checks, varied, setting, message):
    done = run(varied.program, varied.path, '--set', setting)
    checks.true(done.returncode == DATA and message in done.stderr, f'{varied.name}: {setting}: {message}', done.stderr)
