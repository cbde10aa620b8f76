"""A check refuses what the run refuses, with the same exit code, the same words and the same place.

Compares the program with itself: the refusals of a check and of a run.

usage: refusals.py MECH9K MECH9D
"""
import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from mech9_cases import TREE, Checks, run

DATA, SINGULAR = 3, 6

# a bar that a table turns from t = 0 to t = 3
TABLE = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&drive coordinate=1, kind='table', file='table.dat' /
&time start={start}, end={end}, intervals=10 /
"""

# A parallelogram that starts with all bars in one line, where both of its branches meet. Its crank rests, so that
# nothing tells how it goes on.
FLAT = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', point=0,0,0, axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=1,0,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point=3,0,0, axis=0,0,1 /
&pair coordinate=4, links=4,1, kind='revolute', point=2,0,0, axis=0,0,1 /
&drive coordinate=1, kind='polynomial', coefficients=0 /
"""


def main():
    mech9k, mech9d = (os.path.abspath(path) for path in sys.argv[1:3])
    checks = Checks()
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, 'table.dat'), 'w', encoding='utf-8') as file:
            file.write('t q\n0 0\n1 0.1\n2 0.3\n3 0.2\n')

        def refused(program, text, code, words, *options):
            path = os.path.join(folder, 'case.nml')
            with open(path, 'w', encoding='utf-8') as file:
                file.write(text)
            said = []
            for check in ((), ('--check',)):
                done = run(program, path, '--quiet', '--no-write', *options, *check, folder=folder)
                checks.equal(done.returncode, code, f'{words} {check}: exit code')
                checks.true(words in done.stderr, f'{words} {check}: said', done.stderr)
                said.append(done.stderr)
            return said

        pendulum = os.path.join(TREE, 'examples', 'pendulum', 'pendulum.nml')
        with open(pendulum, encoding='utf-8') as file:
            pendulum = file.read()
        for program, text in ((mech9d, pendulum), (mech9k, TABLE.format(start=0, end=1))):
            for value in ('1', '2.5'):
                words = f"'relative_tolerance' must be >0 and <1, not {value}"
                run_said, check_said = refused(program, text, DATA, words, '--set', f'solver.relative_tolerance={value}')
                checks.equal(run_said, check_said, 'a check says the same of a tolerance as a run')
                refused(program, text + f'&solver relative_tolerance={value} /\n', DATA, 'case.nml:')
        for start, end, words in ((0, 4, 'after t = 3 s, and the run goes on to t = 4 s'),
                                  (-1, 2, 'before t = 0 s, and the run begins at t = -1 s'),
                                  (4, 1, 'after t = 3 s, and the run begins at t = 4 s'),
                                  (2, -1, 'before t = 0 s, and the run goes on to t = -1 s'),
                                  # more than round-off
                                  (0, 3.0000001, 'after t = 3 s, and the run goes on to t = 3.0000001 s')):
            for program in (mech9k, mech9d):
                said = refused(program, TABLE.format(start=start, end=end), DATA,
                               f'the table of the drive of coordinate 1 has no value {words}; lengthen the table or shorten &time')
                checks.true(all('case.nml:3:1:' in one for one in said), 'with the place of the drive', said)
        for law, words in (("law='table', file='table.dat'", 'the table of the load has no value after t = 3 s'),
                           ("law='segments', times=0,3, values=0,1, laws='harmonic'",
                            'the law in segments of the load has no value after t = 3 s')):
            said = refused(mech9d, pendulum + f"&load kind='coordinate', coordinate=1, force=1, {law} /\n", DATA,
                           f'{words}, and the run goes on to t = 4 s', '--set', 'time.end=4')
            checks.true(all(f'case.nml:{pendulum.count(chr(10)) + 1}:1:' in one for one in said), 'with the place of the load', said)
        refused(mech9k, FLAT, SINGULAR, 'starts in a singular position of closed chain 1')
    checks.finish()


if __name__ == '__main__':
    main()
