"""A check refuses what the run refuses, with the same exit code, the same words and the same place.

Compares the program with itself: the refusals of a check and of a run.
"""
import os

import pytest

from mech9_cases import TREE, run, text_of

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


class Refusals:
    """A folder with a table, in which runs and checks of a program refuse the same."""

    def __init__(self, checks, folder):
        self.checks, self.folder = checks, folder
        with open(os.path.join(folder, 'table.dat'), 'w', encoding='utf-8') as file:
            file.write('t q\n0 0\n1 0.1\n2 0.3\n3 0.2\n')

    def refused(self, program, text, code, words, *options):
        """The messages of a run and of a check."""
        path = os.path.join(self.folder, 'case.nml')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        said = []
        for check in ((), ('--check',)):
            done = run(program, path, '--quiet', '--no-write', *options, *check, folder=self.folder)
            self.checks.equal(done.returncode, code, f'{words} {check}: exit code')
            self.checks.true(words in done.stderr, f'{words} {check}: said', done.stderr)
            said.append(done.stderr)
        return said


@pytest.fixture
def refusals(checks, tmp_path):
    return Refusals(checks, tmp_path)


PENDULUM = text_of(os.path.join(TREE, 'examples', 'pendulum', 'pendulum.nml'))


@pytest.mark.parametrize('value', ('1', '2.5'))
@pytest.mark.parametrize('name, text', (('mech9d', PENDULUM), ('mech9k', TABLE.format(start=0, end=1))), ids=('mech9d', 'mech9k'))
def test_a_tolerance(refusals, build, name, text, value):
    words = f"'relative_tolerance' must be >0 and <1, not {value}"
    run_said, check_said = refusals.refused(build.program(name), text, DATA, words, '--set', f'solver.relative_tolerance={value}')
    refusals.checks.equal(run_said, check_said, 'a check says the same of a tolerance as a run')
    refusals.refused(build.program(name), text + f'&solver relative_tolerance={value} /\n', DATA, 'case.nml:')


@pytest.mark.parametrize('start, end, words', (
    (0, 4, 'after t = 3 s, and the run goes on to t = 4 s'),
    (-1, 2, 'before t = 0 s, and the run begins at t = -1 s'),
    (4, 1, 'after t = 3 s, and the run begins at t = 4 s'),
    (2, -1, 'before t = 0 s, and the run goes on to t = -1 s'),
    # more than round-off
    (0, 3.0000001, 'after t = 3 s, and the run goes on to t = 3.0000001 s')))
@pytest.mark.parametrize('name', ('mech9k', 'mech9d'))
def test_a_table_that_is_too_short(refusals, build, name, start, end, words):
    said = refusals.refused(build.program(name), TABLE.format(start=start, end=end), DATA,
                            f'the table of the drive of coordinate 1 has no value {words}; lengthen the table or shorten &time')
    refusals.checks.true(all('case.nml:3:1:' in one for one in said), 'with the place of the drive', said)


@pytest.mark.parametrize('law, words', (
    ("law='table', file='table.dat'", 'the table of the load has no value after t = 3 s'),
    ("law='segments', times=0,3, values=0,1, laws='harmonic'", 'the law in segments of the load has no value after t = 3 s')),
    ids=('table', 'segments'))
def test_a_load_whose_law_is_too_short(refusals, mech9d, law, words):
    said = refusals.refused(mech9d, PENDULUM + f"&load kind='coordinate', coordinate=1, force=1, {law} /\n", DATA,
                            f'{words}, and the run goes on to t = 4 s', '--set', 'time.end=4')
    refusals.checks.true(all(f'case.nml:{PENDULUM.count(chr(10)) + 1}:1:' in one for one in said), 'with the place of the load', said)


def test_a_singular_start(refusals, mech9k):
    refusals.refused(mech9k, FLAT, SINGULAR, 'starts in a singular position of closed chain 1')
