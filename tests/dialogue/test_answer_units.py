"""Units in answers of a conversation: they are converted into those of the file, and refused where they do not fit."""
import os

import pytest

import data_file
from conversations import answers_of, first_missing, piped
from mech9_cases import run, text_of

PENDULUM = """&mechanism {units} /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis={axis} /
&initial coordinate=1, position=0, velocity=0 /
&point name='P', link=2, position=100,0,0 /
&body link=2, mass=100, centre=50,0,0, inertia=0,0,10,0,0,0 /
&load kind='coordinate', coordinate=1, stiffness=1 /
&gravity acceleration=0,-9810,0 /
&time end=1, intervals=10 /
"""
MILLIMETRES = "length_unit='mm', angle_unit='deg', mass_unit='g', rate_unit='rpm'"
# answers, the items that get them, and their numbers in mm, deg, g, rpm and in SI
ANSWERS = [('body 1 mass = 0.5 kg', ('body', 'mass'), [500], [0.5]),
           ('body 1 mass = 2 lb', ('body', 'mass'), [907.18474], [0.90718474]),
           ('gravity acceleration = -x', ('gravity', 'acceleration'), [-9810, 0, 0], [-9.81, 0, 0]),
           ('gravity acceleration = 0, 0, -9.81 m/s^2', ('gravity', 'acceleration'), [0, 0, -9810], [0, 0, -9.81]),
           ('point 1 position = 80 mm, 0.02 m, 0', ('point', 'position'), [80, 20, 0], [0.08, 0.02, 0]),
           ('point 1 position = 8 2 cm', ('point', 'position'), [80, 20, 0], [0.08, 0.02, 0]),
           ('point 1 position = 80mm', None, None, None),
           ('initial 1 velocity = 25 rad/s', ('initial', 'velocity'), [238.732414637843], [25]),
           ('initial 1 velocity = 3000 rpm', ('initial', 'velocity'), [3000], [314.159265358979]),
           ('initial 1 position = 90 deg', ('initial', 'position'), [90], [1.5707963267949]),
           ('body 1 inertia = 0, 0, 2e-5 kg m^2, 0, 0, 0', ('body', 'inertia'), [0, 0, 20000, 0, 0, 0], [0, 0, 2e-5, 0, 0, 0]),
           ('load 1 stiffness = 5 Nmm/rad', ('load', 'stiffness'), [5], [0.005]),
           ('time end = 500 ms', ('time', 'end'), [0.5], [0.5])]


def edited(folder, mech9d, units, answers, axis='0,0,1'):
    with open(os.path.join(folder, 'p.nml'), 'w', encoding='utf-8') as file:
        file.write(PENDULUM.format(units=units, axis=axis))
    steps = [('all is right', answer) for answer in answers] + [('all is right', ''), ('[both]', 'save'), ('data file [', 'q.nml')]
    return steps, piped(mech9d, '--edit', 'p.nml', folder=folder, answers=answers_of(steps))


@pytest.mark.parametrize('place, units', [(2, MILLIMETRES), (3, "angle_unit='rad'")], ids=['mm', 'SI'])
@pytest.mark.parametrize('case', [case for case in ANSWERS if case[1]], ids=lambda case: case[0])
def test_units_of_answers(checks, mech9d, tmp_path, case, place, units):
    steps, done = edited(str(tmp_path), mech9d, units, [case[0]])
    checks.true(first_missing(done.stderr, steps) is None, 'all prompts come', done.stderr)
    path = os.path.join(str(tmp_path), 'q.nml')
    if not checks.true(os.path.exists(path), 'the file is written', done.stderr):
        return
    items = next(items for group, items in data_file.parse(text_of(path)) if group == case[1][0])
    checks.near([float(x) for x in items[case[1][1]]], case[place], 1e-13, case[0])


@pytest.mark.parametrize('answer, said', [
    ('point 1 position = 8 kg', 'kg does not fit here; the unit is mm'), ('body 1 mass = 3 stones', "the unit 'stones' is not known"),
    ('initial 1 velocity = 3 rad', 'rad does not fit here; the unit is rpm'), ('time intervals = 3 s', 'whole number')])
def test_units_that_do_not_fit(checks, mech9d, tmp_path, answer, said):
    _, done = edited(str(tmp_path), mech9d, MILLIMETRES, [answer])
    checks.true(said in ' '.join(done.stderr.split()), f'{answer}: {said}', done.stderr)


@pytest.mark.parametrize('axis, point', [('0,0,1', [30, 40, 0]), ('0,-2,0', [30, 0, 40]), ('1,0,0', [0, 30, 40])])
def test_two_numbers_are_a_point_of_the_plane(checks, mech9d, tmp_path, axis, point):
    _, done = edited(str(tmp_path), mech9d, MILLIMETRES, ['point 1 position = 30, 0.04 m'.replace('30,', '30 mm,')], axis)
    path = os.path.join(str(tmp_path), 'q.nml')
    if not checks.true(os.path.exists(path), 'the file is written', done.stderr):
        return
    items = next(items for group, items in data_file.parse(text_of(path)) if group == 'point')
    checks.near([float(x) for x in items['position']], point, 1e-13, f'a point across {axis}')


def test_two_numbers_are_no_point_in_space(checks, mech9d, tmp_path):
    _, done = edited(str(tmp_path), mech9d, MILLIMETRES, ['point 1 position = 30 40'], '0,1,1')
    checks.true('takes 3' in ' '.join(done.stderr.split()) or '2 values' in done.stderr, 'three numbers are asked for', done.stderr)


def test_long_lengths_are_asked_about(checks, mech9d, tmp_path):
    """120 m is asked about once, and accepted the second time; then all lengths are."""
    steps, done = edited(str(tmp_path), mech9d, "angle_unit='rad'", ['point 1 position = 120, 0, 0'])
    checks.true('this one is 120 m' in ' '.join(done.stderr.split()), 'it is asked about', done.stderr)
    answers = [('all is right', 'point 1 position = 120, 0, 0'), ('position (m)', '120, 0, 0'), ('all is right', 'body 1 centre = 60, 0, 0'),
               ('all is right', ''), ('[both]', 'save'), ('data file [', 'r.nml')]
    done = piped(mech9d, '--edit', 'p.nml', folder=str(tmp_path), answers=answers_of(answers))
    checks.true(first_missing(done.stderr, answers) is None, 'all prompts come', done.stderr)
    checks.true('position=120, 0, 0' in text_of(os.path.join(str(tmp_path), 'r.nml')), 'it is accepted', done.stderr)


@pytest.mark.parametrize('units, noted', [('', True), ("length_unit='m', ", False), ("length_unit='mm', ", False)])
def test_long_links_are_noted(checks, mech9k, tmp_path, units, noted):
    path = os.path.join(str(tmp_path), 'long.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(f"""&mechanism {units}title='x' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=120,0,0, moving_point=0,0,0 /
&structure cq=1,2 /
&drive coordinate=1, kind='polynomial', coefficients=0,1 /
&drive coordinate=2, kind='polynomial', coefficients=0,1 /
""".replace('&structure cq=1 /\n', ''))
    done = run(mech9k, path, '--check')
    checks.equal('120 m between two pairs' in done.stdout + done.stderr, noted, f'{units}: a note')
