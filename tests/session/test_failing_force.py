"""A user's force that stops having a value: the run ends with code 7 and says when, and its table is complete up to there. The
program is mech9d with tests/user/user_forces/failing_force.f90."""
import json
import re

import pytest

from mech9_cases import read_table, run, text_of

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
METHODS = ('default', 'prince-dormand', 'dormand-prince', 'verner', 'fehlberg', 'merson', 'adams', 'bdf', 'auto')


@pytest.fixture
def failing(build):
    return build.program('failing_force_d')


def write(folder, method='default'):
    path = folder / 'case.nml'
    path.write_text(CASE.format(last=LAST, method='' if method == 'default' else f"method='{method}',"), encoding='utf-8')
    return path


@pytest.mark.parametrize('method', METHODS)
def test_force_that_stops_having_a_value(checks, failing, tmp_path, method):
    path = write(tmp_path, method)
    done = run(failing, path, '--table', 'table.dat', '--report', 'report.json', folder=tmp_path)
    checks.equal(done.returncode, 7, f'{method}: exit code 7')
    report = json.loads(text_of(tmp_path / 'report.json'))
    checks.equal(report['exit_code'], 7, f'{method}: which the report tells, too')
    checks.true('case.nml:7:' in done.stderr, f'{method}: the message points to the load', done.stderr)
    checks.true('not finite' in done.stderr, f'{method}: the message says what is wrong', done.stderr)
    times = [float(word) for word in re.findall(r't = ([-+.\deE]+)', done.stderr)]
    # the last step that succeeds ends before the force does; an output lies every 0.01 s
    checks.true(any(abs(t - LAST) <= 0.01 for t in times), f'{method}: the message says when', done.stderr)
    checks.true('SUNDIALS' not in done.stderr and 'CVODE' not in done.stderr and 'ARK' not in done.stderr,
                f'{method}: the integrator\'s own words do not reach the user', done.stderr)
    table = read_table(text_of(tmp_path / 'table.dat'))
    checks.equal(len(table['t']), 54, f'{method}: the rows from 0 to 0.53 s are there')
    checks.near(table['q1'], 0.5 * table['t'] ** 2, 1e-7, f'{method}: and they are right')


@pytest.mark.parametrize('last, code', ((2, 0), (-1, 7)), ids=('always a value', 'no value at the start'))
def test_force_to_the_end_and_from_the_start(checks, failing, tmp_path, last, code):
    done = run(failing, write(tmp_path, 'auto'), '--no-write', '--set', f'user.parameters={last}', folder=tmp_path)
    checks.equal(done.returncode, code, f'a force that has values until {last} s')


def test_force_that_is_not_linked(checks, mech9d, tmp_path):
    done = run(mech9d, write(tmp_path, 'auto'), '--no-write', folder=tmp_path)
    checks.equal(done.returncode, 3, 'without the procedure: a mistake in the data')
    checks.true('case.nml:7:' in done.stderr and 'none is linked' in done.stderr, 'that is explained', done.stderr)
