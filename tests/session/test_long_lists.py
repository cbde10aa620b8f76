"""Lists of many numbers are read, and driven by, in time that is linear in their number.

The crank of a slider-crank is driven by the first n terms of the geometric series a/(1 - t/2), whose sum and derivatives have closed forms. Work
that grew with the square of n would take hours; each run is given two minutes at most.
"""
import pytest

from mech9_cases import run, table_of

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


def write(folder, drive):
    """A data file with the crank driven by these words."""
    path = folder / 'case.nml'
    path.write_text(f"{HEAD}&drive coordinate=1, kind='polynomial',\n{drive} /\n", encoding='utf-8')
    return path


def test_coefficients(checks, mech9k, tmp_path):
    path = write(tmp_path, 'coefficients = ' + ',\n'.join(map(repr, coefficients(100000))))
    check_motion(checks, mech9k, path, '100,000 coefficients')


def test_coefficients_by_their_numbers(checks, mech9k, tmp_path):
    path = write(tmp_path, '\n'.join(f'coefficients({k}) = {c!r}' for k, c in enumerate(coefficients(100000), 1)))
    check_motion(checks, mech9k, path, '100,000 coefficients, each by its number')


def test_coefficients_by_set(checks, mech9k, tmp_path):
    path = write(tmp_path, 'coefficients = 0')
    check_motion(checks, mech9k, path, 'coefficients by --set', '--set', 'drive(1).coefficients=' + ','.join(map(repr, coefficients(2000))))


def test_million_numbers_by_set(checks, mech9k, tmp_path):
    done = run(mech9k, write(tmp_path, 'coefficients = 0'), '--no-write', '--set', 'drive(1).coefficients=1000000*1e-7', folder=tmp_path)
    checks.equal(done.returncode, 0, 'a million numbers by --set')


def test_drive_that_grows_beyond_all_numbers(checks, build, mech9k, tmp_path):
    if not build.optimised:
        pytest.skip('the programs of this build trap overflow')
    path = tmp_path / 'case.nml'
    path.write_text(CRANK, encoding='utf-8')
    done = run(mech9k, path, '--no-write', folder=tmp_path)
    checks.equal(done.returncode, 3, 'a drive that grows beyond all numbers ends the run')
    checks.true('case.nml:5:' in done.stderr and 'beyond all numbers at t = 2 s' in done.stderr, 'and says where and when', done.stderr)
