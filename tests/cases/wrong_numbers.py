"""A user's force that names links and coordinates that do not exist: code 3, with the procedure, the number and the load's place.

usage: wrong_numbers.py WRONG_NUMBERS_D      WRONG_NUMBERS_D: mech9d with user_forces/wrong_numbers.f90
"""
import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from mech9_cases import Checks, run

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
PROCEDURES = (('loads%add_force', 'link', 3), ('loads%add_torque', 'link', 3), ('loads%add_generalized', 'coordinate', 2),
              ('state%position', 'link', 3), ('state%velocity', 'link', 3), ('state%turned', 'link', 3))


def main():
    program = os.path.abspath(sys.argv[1])
    checks = Checks()
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'case.nml')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(CASE)

        def ended(kind, number):
            return run(program, path, '--no-write', '--set', f'user.parameters={kind},{number}', folder=folder)

        for kind, (procedure, counted, greatest) in enumerate(PROCEDURES, 1):
            for number in (1, greatest):
                checks.equal(ended(kind, number).returncode, 0, f'{procedure}: {counted} {number} exists')
            for number in (-2000000, 0, greatest + 1, 40, 4000000):
                done = ended(kind, number)
                checks.equal(done.returncode, 3, f'{procedure}: {counted} {number} does not exist')
                checks.true(f'{procedure} with {counted} {number},' in done.stderr, f'{procedure}: it is named', done.stderr)
                checks.true(f'{counted}s of this mechanism are 1 to {greatest};' in done.stderr,
                            f'{procedure}: those that there are are told', done.stderr)
                checks.true('case.nml:10:' in done.stderr, f'{procedure}: the message points to the load', done.stderr)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(BALL)
        for kind, (procedure, counted, _) in enumerate(PROCEDURES, 1):
            greatest = 4 if counted == 'coordinate' else 3
            checks.equal(ended(kind, greatest).returncode, 0, f'{procedure}: {counted} {greatest} exists beside a ball')
            done = ended(kind, greatest + 1)
            checks.true(done.returncode == 3 and f'{counted}s of this mechanism are 1 to {greatest};' in done.stderr,
                        f'{procedure}: {counted} {greatest + 1} is of no use beside a ball', f'{done.returncode}: {done.stderr}')
        checks.true('with link 7,' in ended(7, 7).stderr, 'the first fault of a call is told')
    checks.finish()


main()
