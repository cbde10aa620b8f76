"""Lists of many numbers are read, and driven by, in time that is linear in their number.

usage: long_lists.py MECH9K OPTIMISED      OPTIMISED: 0 where the program traps overflow

The crank of a slider-crank is driven by the first n terms of the geometric series a/(1 - t/2), whose sum and derivatives have closed forms. Work
that grew with the square of n would take hours; each run is given two minutes at most.
"""
import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from mech9_cases import Checks, run, table_of, text_of

HEAD = """
&mechanism links=4, coordinates=4 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, zero=0,1,0, moving_point=0,0,0 /
&initial coordinate=4, position=1.2 /
&time start=0, end=1, intervals=20 /
"""
CRANK = """
&mechanism links=2, coordinates=1 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&drive coordinate=1, kind='polynomial', coefficients=2000*1.0 /
&time start=0, end=5, intervals=5 /
"""
SIZE = 0.7
# round-off of Horner's rule over the some 50 terms that count, which are all positive here
ROUND_OFF = 1e-13


def coefficients(n):
    return [SIZE * 0.5 ** k if k < 300 else 0.0 for k in range(n)]


def check_motion(checks, mech9k, path, why, *arguments):
    table = table_of(mech9k, path, *arguments)
    x = 1.0 / (1.0 - 0.5 * table['t'])
    checks.equal(len(table['t']), 21, f'{why}: all positions')
    checks.near(table['q1'], SIZE * x, ROUND_OFF, f'{why}: positions')
    checks.near(table['dq1'], SIZE * 0.5 * x ** 2, ROUND_OFF, f'{why}: rates')
    checks.near(table['ddq1'], SIZE * 0.5 * x ** 3, ROUND_OFF, f'{why}: accelerations')


def main():
    mech9k = os.path.abspath(sys.argv[1])
    checks = Checks()
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'case.nml')

        def write(drive):
            with open(path, 'w', encoding='utf-8') as file:
                file.write(f"{HEAD}&drive coordinate=1, kind='polynomial',\n{drive} /\n")

        write('coefficients = ' + ',\n'.join(map(repr, coefficients(100000))))
        check_motion(checks, mech9k, path, '100,000 coefficients')
        write('\n'.join(f'coefficients({k}) = {c!r}' for k, c in enumerate(coefficients(100000), 1)))
        check_motion(checks, mech9k, path, '100,000 coefficients, each by its number')
        write('coefficients = 0')
        check_motion(checks, mech9k, path, 'coefficients by --set', '--set',
                     'drive(1).coefficients=' + ','.join(map(repr, coefficients(2000))))
        done = run(mech9k, path, '--no-write', '--set', 'drive(1).coefficients=1000000*1e-7', folder=folder)
        checks.equal(done.returncode, 0, 'a million numbers by --set')
        if sys.argv[2] == '1':
            with open(path, 'w', encoding='utf-8') as file:
                file.write(CRANK)
            done = run(mech9k, path, '--no-write', folder=folder)
            checks.equal(done.returncode, 3, 'a drive that grows beyond all numbers ends the run')
            checks.true('case.nml:5:' in done.stderr and 'beyond all numbers at t = 2 s' in done.stderr, 'and says where and when',
                        done.stderr)
    checks.finish()


main()
