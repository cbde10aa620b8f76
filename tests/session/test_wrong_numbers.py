"""A user's force that names links and coordinates that do not exist: code 3, with the procedure, the number and the load's place.
The program is mech9d with tests/user/user_forces/wrong_numbers.f90."""
import pytest

from mech9_cases import run

# a pendulum on a cart
CASE = """
&mechanism links=3, coordinates=2 /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0.0, velocity=0.0 /
&initial coordinate=2, position=0.0, velocity=0.0 /
&body link=2, mass=1.0 /
&body link=3, mass=1.0, centre=1.0,0.0,0.0 /
&load kind='user' /
&user parameters = 1, 2 /
&time start=0.0, end=0.1, intervals=1 /
"""
# the same with a ball between cart and pendulum: the program makes links 4 and 5 for it, which nobody knows
BALL = CASE.replace('coordinates=2', 'coordinates=4').replace('cq=1,2', 'cq=1,2,3,4').replace(
    "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /", "&pair coordinates=2,3,4, links=2,3, kind='spherical' /").replace(
    '&body link=2', '\n'.join(f'&initial coordinate={k}, position=0 /' for k in (3, 4)) + '\n&body link=2').replace(
    'centre=1.0,0.0,0.0 /', 'centre=1.0,0.0,0.0, inertia=1,1,1,0,0,0 /')
PROCEDURES = (('add_force', 'link', 3), ('add_torque', 'link', 3), ('add_generalized', 'coordinate', 2),
              ('position', 'link', 3), ('velocity', 'link', 3), ('turned', 'link', 3))
EACH = pytest.mark.parametrize('kind', range(1, len(PROCEDURES) + 1), ids=[name for name, _, _ in PROCEDURES])


@pytest.fixture
def ended(build, tmp_path):
    """A function that makes a run of a text, whose force gives a number of a kind to its procedure."""
    def run_of(text, kind, number):
        (tmp_path / 'case.nml').write_text(text, encoding='utf-8')
        return run(build.program('wrong_numbers_d'), 'case.nml', '--no-write', '--set', f'user.parameters={kind},{number}', folder=tmp_path)
    return run_of


@EACH
def test_numbers(checks, ended, kind):
    procedure, counted, greatest = PROCEDURES[kind - 1]
    for number in (1, greatest):
        checks.equal(ended(CASE, kind, number).returncode, 0, f'{procedure}: {counted} {number} exists')
    for number in (-2000000, 0, greatest + 1, 40, 4000000):
        done = ended(CASE, kind, number)
        checks.equal(done.returncode, 3, f'{procedure}: {counted} {number} does not exist')
        checks.true(f'{procedure} with {counted} {number},' in done.stderr, f'{procedure}: it is named', done.stderr)
        checks.true(f'{counted}s of this mechanism are 1 to {greatest};' in done.stderr,
                    f'{procedure}: those that there are are told', done.stderr)
        checks.true('case.nml:10:' in done.stderr, f'{procedure}: the message points to the load', done.stderr)


@EACH
def test_numbers_beside_a_ball(checks, ended, kind):
    procedure, counted, _ = PROCEDURES[kind - 1]
    greatest = 4 if counted == 'coordinate' else 3
    checks.equal(ended(BALL, kind, greatest).returncode, 0, f'{procedure}: {counted} {greatest} exists beside a ball')
    done = ended(BALL, kind, greatest + 1)
    checks.true(done.returncode == 3 and f'{counted}s of this mechanism are 1 to {greatest};' in done.stderr,
                f'{procedure}: {counted} {greatest + 1} is of no use beside a ball', f'{done.returncode}: {done.stderr}')


def test_first_fault_of_a_call(checks, ended):
    checks.true('with link 7,' in ended(BALL, 7, 7).stderr, 'the first fault of a call is told')
