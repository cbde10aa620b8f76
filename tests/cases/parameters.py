"""Parameters: a run with a parameter is the run of a file in which its numbers are written; contradictions with --set are told.

usage: parameters.py MECH9K MECH9D
"""
import os
import sys
import tempfile

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from mech9_cases import Checks, run, table_of

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


def same_runs(checks, program, motion, target, folder):
    """The table with parameters has the bits of the one with their numbers."""
    written = write(folder, 'written.nml', CRANK.format(crank=0.32, centre=0.16) + motion.format(rate=90))
    varied = write(folder, 'varied.nml', CRANK.format(crank=7, centre=7) + motion.format(rate=40) + PARAMETERS.format(rate=target))
    tables = [table_of(program, path, '--set', setting) for path, setting in ((written, 'time.start=0'), (varied, 'parameter(2).value=90'))]
    name = os.path.basename(program)
    checks.true(all(np.array_equal(tables[0][column], tables[1][column]) for column in tables[0]), f'{name}: parameters give the bits of the file with their numbers')
    return varied


def told(checks, program, path):
    name = os.path.basename(program)
    done = run(program, path, '--set', 'parameter(1).value=0.33', '--set', 'pair(2).point(1)=0.4')
    checks.true(done.returncode == DONE and "note: --set pair(2).point(1)=0.4 decides, not parameter 'crank'\n" in done.stderr,
                f'{name}: a later --set is told', done.stderr)
    done = run(program, path, '--set', 'pair(2).point(1)=0.4', '--set', 'parameter(1).value=0.33', '--quiet')
    checks.true(done.returncode == DONE and done.stderr == '', f'{name}: nothing is told with --quiet', done.stderr)
    done = run(program, path, '--check', '--set', 'pair(2).point(1)=0.4', '--set', 'parameter(1).value=0.33')
    checks.true('note: --set parameter(1).value=0.33 stands after --set pair(2).point(1)=0.4 and decides\n' in done.stdout
                and '  crank = 0.33 sets pair(2).point(1), body(1).centre(1)\n' in done.stdout, f'{name}: --check tells both', done.stdout)
    done = run(program, path, '--set', 'parameter(1).sets=pair(2).pont(1)')
    checks.true(done.returncode == DATA and "--set: unknown name 'pont' in &pair; did you mean 'point'?" in done.stderr,
                f'{name}: an unknown number has its place and the nearest name', done.stderr)
    for setting, message in (('parameter(1).sets=pair.point(1)', 'there are 4 groups &pair; say which one: pair(2).point(1)'),
                             ("parameter(1).sets='pair(2).point(1)','pair(2).point(1)'", 'this number is named twice'),
                             ("parameter(2).sets='pair(2).point(1)'", "parameter 'crank' sets this number already"),
                             ('parameter(3).value=1', 'this file has 2 groups &parameter, and --set adds another one'),
                             ('parameter(4).value=1', 'this file has 2 groups &parameter only')):
        done = run(program, path, '--set', setting)
        checks.true(done.returncode == DATA and message in done.stderr, f'{name}: {setting}: {message}', done.stderr)


def main():
    checks = Checks()
    with tempfile.TemporaryDirectory() as folder:
        for program, motion, target in ((sys.argv[1], DRIVE, 'drive.coefficients(2)'), (sys.argv[2], START, 'initial(2).velocity')):
            told(checks, program, same_runs(checks, program, motion, target, folder))
    checks.finish()


main()
