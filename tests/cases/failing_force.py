"""A user's force that stops having a value: the run ends with code 7 and says when, and its table is complete up to there.

usage: failing_force.py FAILING_FORCE_D MECH9D      FAILING_FORCE_D: mech9d with user_forces/failing_force.f90
"""
import json
import os
import re
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from mech9_cases import Checks, read_table, run, text_of

LAST = 0.537
# a mass of 1 kg under a force of 1 N
CASE = """
&mechanism links=2, coordinates=1 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&initial coordinate=1, position=0.0, velocity=0.0 /
&body link=2, mass=1.0 /
&load kind='user' /
&user parameters = {last} /
&time start=0.0, end=1.0, intervals=100 /
&solver {method} relative_tolerance=1e-9, absolute_tolerance=1e-9 /
"""


def main():
    failing, mech9d = map(os.path.abspath, sys.argv[1:3])
    checks = Checks()
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'case.nml')
        for method in ('default', 'prince-dormand', 'dormand-prince', 'verner', 'fehlberg', 'merson', 'adams', 'bdf', 'auto'):
            with open(path, 'w', encoding='utf-8') as file:
                file.write(CASE.format(last=LAST, method='' if method == 'default' else f"method='{method}',"))
            done = run(failing, path, '--table', 'table.dat', '--report', 'report.json', folder=folder)
            checks.equal(done.returncode, 7, f'{method}: exit code 7')
            report = json.loads(text_of(os.path.join(folder, 'report.json')))
            checks.equal(report['exit_code'], 7, f'{method}: which the report tells, too')
            checks.true('case.nml:7:' in done.stderr, f'{method}: the message points to the load', done.stderr)
            checks.true('not finite' in done.stderr, f'{method}: the message says what is wrong', done.stderr)
            times = [float(word) for word in re.findall(r't = ([-+.\deE]+)', done.stderr)]
            # the last step that succeeds ends before the force does; an output lies every 0.01 s
            checks.true(any(abs(t - LAST) <= 0.01 for t in times), f'{method}: the message says when', done.stderr)
            checks.true('SUNDIALS' not in done.stderr and 'CVODE' not in done.stderr and 'ARK' not in done.stderr,
                        f'{method}: the integrator\'s own words do not reach the user', done.stderr)
            table = read_table(text_of(os.path.join(folder, 'table.dat')))
            checks.equal(len(table['t']), 54, f'{method}: the rows from 0 to 0.53 s are there')
            checks.near(table['q1'], 0.5 * table['t'] ** 2, 1e-7, f'{method}: and they are right')
            os.remove(os.path.join(folder, 'table.dat'))
        done = run(failing, path, '--no-write', '--set', 'user.parameters=2', folder=folder)
        checks.equal(done.returncode, 0, 'a force that has a value all the time')
        done = run(failing, path, '--no-write', '--set', 'user.parameters=-1', folder=folder)
        checks.equal(done.returncode, 7, 'a force that has no value at the start')
        done = run(mech9d, path, '--no-write', folder=folder)
        checks.equal(done.returncode, 3, 'without the procedure: a mistake in the data')
        checks.true('case.nml:7:' in done.stderr and 'none is linked' in done.stderr, 'that is explained', done.stderr)
    checks.finish()


main()
