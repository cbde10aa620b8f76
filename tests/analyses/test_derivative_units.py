"""Units of derivatives by parameters: those of the column per those of the numbers that the parameter sets."""
import os

import pytest

from mech9_cases import run

# a turning and a sliding pair, angles in degrees
ARM = """&mechanism angle_unit='deg' /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='prismatic', point=0.5,0,0, axis=1,0,0 /
&initial coordinate=1, position=30, velocity=4 /
&initial coordinate=2, position=0.2 /
&body link=3, mass=1, centre=0,-0.5,0, inertia=0.1,0.1,0.1,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&load kind='spring', links=1,3, stiffness=20, free_length=0.4 /
&load kind='coordinate', coordinate=1, stiffness=3, force=1 /
&time end=0.1, intervals=1 /
&output sensitivities=.true. /
"""
FREE = {
    'body.mass': 'kg', 'body.inertia(3)': '(kg_m^2)', 'gravity.acceleration(2)': '(m/s^2)', 'pair(2).point(1)': 'm', 'pair(2).axis(2)': '',
    'initial(1).position': 'deg', 'initial(2).position': 'm', 'initial(1).velocity': '(deg/s)', 'load(1).stiffness': '(N/m)',
    'load(2).force': '(N_m)',
    # the table of names tells two units, and the parameter sets numbers of two units: its name stands for the unit
    'load(2).stiffness': 'number', "body.mass', 'load(2).force": 'number'}
DRIVEN = ("&drive coordinate=1, kind='polynomial', coefficients=1,2,3 /\n"
          "&drive coordinate=2, kind='harmonic', amplitude=0.1, angular_frequency=200, phase=10 /\n")
BY_DRIVES = {'drive(1).coefficients(1)': 'deg', 'drive(1).coefficients(2)': '(deg/s)', 'drive(1).coefficients(3)': '(deg/s^2)',
             'drive(2).amplitude': 'm', 'drive(2).angular_frequency': '(deg/s)', 'drive(2).phase': 'deg'}


def units_in(program, text, folder):
    """Names of the columns of a run and their units."""
    path = os.path.join(folder, 'case.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)
    done = run(program, path, '--table', '-', '--quiet')
    lines = done.stdout.splitlines()
    units = next((line for line in lines if line.startswith('# units:')), '# units:').split()[2:]
    names = next((line for line in lines if not line.startswith('#')), done.stderr).split()
    return dict(zip(names, units))


def check(checks, program, text, folder, sets, unit):
    # several numbers have no value in common
    value = ', value=1' if ',' in sets else ''
    units = units_in(program, text + f"&parameter name='number', sets='{sets}'{value} /\n", folder)
    for column, own in (('q1', 'deg'), ('dq1', 'deg/s'), ('q2', 'm')):
        checks.equal(units.get(f'd({column})/d(number)'), f'{own}/{unit}' if unit else own, f'{sets}: the unit of {column}')


@pytest.mark.parametrize('sets', FREE)
def test_units_by_numbers_of_the_mechanism(checks, tmp_path, mech9d, sets):
    check(checks, mech9d, ARM, tmp_path, sets, FREE[sets])


@pytest.mark.parametrize('sets', BY_DRIVES)
def test_units_by_numbers_of_drives(checks, tmp_path, mech9k, sets):
    text = ''.join(line for line in ARM.splitlines(True) if not line.startswith('&initial'))
    check(checks, mech9k, text + DRIVEN, tmp_path, sets, BY_DRIVES[sets])


def test_unit_of_a_gradient(checks, tmp_path, mech9d):
    """The line that tells the derivative of a quantity."""
    path = tmp_path / 'case.nml'
    path.write_text(ARM.replace('sensitivities', 'gradients') + "&parameter name='load', sets='body.mass' /\n"
                    "&quantity name='fall', of='q1', take='range' /\n", encoding='utf-8')
    done = run(mech9d, path, '--no-write')
    line = next((line for line in done.stderr.splitlines() if 'd(fall)/d(load)' in line), done.stderr)
    checks.true(line.endswith(' deg/kg'), 'degrees for each kilogram', line)
