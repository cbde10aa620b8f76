"""The units of a new data file, asked for before the first length: their words, and a motion in them against its closed form."""
import os

import numpy as np
import pytest

import data_file
import dialogue_scripts as scripts
from conversations import answers_of, first_missing, in_one_line, piped
from mech9_cases import read_table, table_of, text_of

UNITS = scripts.PRESS_UNITS[0]
BEFORE = scripts.PRESS[:3]
STRUCTURE = ('[pairs]', '')


@pytest.fixture
def folder(tmp_path):
    return os.fspath(tmp_path)


def draft_after(checks, program, folder, answers, said=()):
    """The group mechanism of the draft after some answers about units, the last of which is taken."""
    steps = BEFORE + [('angle_unit [', answer) for answer in answers] + [STRUCTURE]
    done = piped(program, folder=folder, answers=answers_of(steps))
    checks.true(first_missing(done.stderr, steps) is None, f'{answers}: all prompts come', done.stderr)
    for words in said:
        checks.true(words in in_one_line(done.stderr), f'{answers}: {words}', done.stderr)
    groups = data_file.parse(text_of(os.path.join(folder, 'crank_press.draft.nml')))
    return {name: value[0] for name, value in groups[0][1].items() if name.endswith('_unit')}, done.stderr


@pytest.mark.parametrize('answer, units', [
    ('', {}), ('deg', {'angle_unit': 'deg'}), ('d', {'angle_unit': 'deg'}), ('RAD', {'angle_unit': 'rad'}), ('mm', {'length_unit': 'mm'}),
    ('m', {'length_unit': 'm'}), ('inches, degrees', {'length_unit': 'in', 'angle_unit': 'deg'}), ('deg mm', {'length_unit': 'mm', 'angle_unit': 'deg'}),
    ('mm deg kN t rpm', {'length_unit': 'mm', 'angle_unit': 'deg', 'force_unit': 'kN', 'mass_unit': 't', 'rate_unit': 'rpm'}),
    ('in lbf lb deg/s', {'length_unit': 'in', 'force_unit': 'lbf', 'mass_unit': 'lb', 'rate_unit': 'deg/s'}), ('g n', {'mass_unit': 'g', 'force_unit': 'N'})])
def test_words_of_units(checks, mech9k, folder, answer, units):
    """Each unit is told by its word alone; what an answer does not name keeps its default, as Enter and `deg` always did."""
    checks.equal(draft_after(checks, mech9k, folder, [answer])[0], units, answer)


@pytest.mark.parametrize('answer, said', [
    ('cm', "'cm' is none of the units"), ('mm in', 'two units of one kind'), ('mm deg rad', 'two units of one kind'), ('80 mm', "'80' is none"),
    ('no', "'no' is none"), ('?', 'Later answers may name other units'), ('m' * 300, 'is none of the units')])
def test_wrong_words(checks, mech9k, folder, answer, said):
    """They are refused, change nothing, and the question comes again."""
    units, _ = draft_after(checks, mech9k, folder, [answer, 'mm'], [said])
    checks.equal(units, {'length_unit': 'mm'}, answer)


def test_steps_back(checks, mech9k, folder):
    """`back` shows the units that were named, which an answer changes and `default` takes away."""
    steps = BEFORE + [(UNITS, 'mm rpm'), ('[pairs]', 'back'), ('length_unit [mm], angle_unit [rad], rate_unit [rpm]: ', 'in'),
                      ('[pairs]', 'back'), ('length_unit [in], angle_unit [rad], rate_unit [rpm]: ', 'default'), ('[pairs]', 'back'),
                      (UNITS, 'back'), ('coordinates [4]', ''), (UNITS, 'mm'), STRUCTURE]
    done = piped(mech9k, folder=folder, answers=answers_of(steps))
    checks.true(first_missing(done.stderr, steps) is None, 'all prompts come', done.stderr)
    checks.equal(in_one_line(done.stderr).count('lengths in m, mm or in'), 1, 'the units are told once')


def slider(crank):
    """Place of the ram and angle of the rod, from the closed triangle of crank, rod and guide."""
    y = scripts.PRESS_OFFSET - scripts.PRESS_CRANK*np.sin(crank)
    along = np.sqrt(scripts.PRESS_ROD**2 - y**2)
    return scripts.PRESS_CRANK*np.cos(crank) + along, np.degrees(np.arctan2(y, along))


def test_press_in_millimetres(checks, mech9k, folder):
    """The press of the tutorial: its ram and the angle of its rod against the triangle; one turn a second, as 60 rpm says."""
    done = piped(mech9k, folder=folder, answers=answers_of(scripts.PRESS))
    checks.true(first_missing(done.stderr, scripts.PRESS) is None, 'all prompts come', done.stderr)
    found = read_table(text_of(os.path.join(folder, 'crank_press.dat')))
    place, angle = slider(2*np.pi*found['t'])
    checks.near(found['ram.x'], place, 1e-11, 'ram [mm]')
    checks.near(found['ram.y'], np.full(len(place), scripts.PRESS_OFFSET), 1e-12, 'guide [mm]')
    checks.near(found['L3.phi'], angle, 1e-11, 'angle of the rod [deg]')
    text = text_of(os.path.join(folder, 'crank_press.nml'))
    for part in ("number=2, name='crank'", "number=3, name='rod'", "name='guide'", "length_unit='mm'"):
        checks.true(part in text, f'the data file has {part}', text)


ASKED = 'convert or keep [keep]: '


def changed(checks, program, folder, steps, said):
    """The data file of the press after steps at its end."""
    steps = scripts.PRESS[:-4] + steps + [*scripts.END[:1], ('[both]', 'save'), ('data file [', '')]
    done = piped(program, folder=folder, answers=answers_of(steps))
    checks.true(first_missing(done.stderr, steps) is None, 'all prompts come', done.stderr)
    for words in said:
        checks.true(words in in_one_line(done.stderr), words, done.stderr)
    return os.path.join(folder, 'crank_press.nml')


def test_later_change(checks, mech9k, folder):
    """A unit is changed at the end, as any other answer is; the digits are kept where that is the answer."""
    path = changed(checks, mech9k, folder, [
        ('Enter if all is right', 'mechanism length_unit = in'), (ASKED, ''), ('Enter if all is right', 'mechanism angle_unit'),
        ('angle_unit [deg]: ', 'rad'), (ASKED, '?'), (ASKED, 'keep')], ['The numbers so far are in mm.', 'The digits are kept: they are in in now.'])
    text = text_of(path)
    checks.true("length_unit='in'" in text and "angle_unit='rad'" in text, 'both are changed', text)
    checks.true('point=35' in text, 'the digits are as typed', text)


def test_converted_numbers(checks, mech9k, folder):
    """The press in inches, radians and revolutions a minute, converted: the same motion as that of the closed triangle in millimetres."""
    path = changed(checks, mech9k, folder, [
        ('Enter if all is right', 'mechanism length_unit = in'), (ASKED, 'convert'), ('Enter if all is right', 'mechanism angle_unit = rad'),
        (ASKED, 'convert'), ('Enter if all is right', 'mechanism rate_unit = rpm'), (ASKED, 'convert')], ['Converted: '])
    found = table_of(mech9k, path)
    place, angle = slider(2*np.pi*found['t'])
    checks.near(25.4*found['ram.x'], place, 1e-11, 'ram')
    checks.near(np.degrees(found['L3.phi']), angle, 1e-11, 'angle of the rod')
    checks.near(found['dq1'], np.full(len(place), 60), 1e-12, 'rate of the crank')


# Parameters of lengths, angles, masses and stiffnesses, laws over an angle, a rate and a point, motors of both kinds, drives in segments.
PARAMETERS = """&mechanism title='press' / &structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', name='left_pin', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.1,0,0, moving_point=0,0,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.3,0,0, moving_point=0,0,0, axis=0,0,1 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0 /
&initial coordinate='left_pin', position=0.4, velocity=3 / &initial coordinate=4, position=0.38 /
&body link=2, mass=1.2, inertia=0.02,0.02,0.02,0,0,0 / &body link=4, mass=0.7 /
&point name='B', link=4, position=0,0.01,0 /
&load kind='force', link=4, force=-20,0,0, law='harmonic', mean=1, amplitude=0.5, angular_frequency=2, phase=0.3, over='left_pin.q' /
&load kind='coordinate', coordinate=4, damping=3, force=1, law='polynomial', coefficients=1,0.2,0.05, over='B.vx' /
&load kind='torque', link=2, torque=0,0,0.3, law='segments', times=0,2,7, values=1,2,1, laws='cycloidal', period=7, over='q1' /
&load kind='force', link=4, force=5,0,0, law='polynomial', coefficients=1,0.2,0.1 /
&motor coordinate=1, kind='pid', proportional=0.5, derivative=0.1, law='polynomial', coefficients=0.2,1.5,-3, over='B.x' /
&motor coordinate=1, kind='dc', resistance=2, constant=0.3, law='polynomial', coefficients=6,-0.04, over='dq1' /
&parameter name='rod', sets='pair(3).point(1)', value=0.3, low=0.25, high=0.4, spread=0.001 /
&parameter name='both', sets='pair(2).point(1)', 'point(1).position(2)', factors=1,0.1, terms=0,0.005, value=0.1 /
&parameter name='start', sets='initial(1).position', value=0.4, low=0.3, high=0.5 /
&parameter name='mass', sets='body(2).mass', value=0.7 /
&parameter name='bend', sets='motor(1).coefficients(3)', value=-3 /
&parameter name='wave', sets='load(1).angular_frequency', value=2 /
&branch parameter='rod', low=0.26, high=0.39 /
&time end=0.5, intervals=10 / &solver relative_tolerance=1e-11 /
"""


def edited(program, folder, text, answers):
    """The draft of a file after changes of its units, and the words of the conversation."""
    path = os.path.join(folder, 'press.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)
    done = piped(program, '--edit', path, folder=folder, answers=answers)
    return os.path.join(folder, 'press.draft.nml'), in_one_line(done.stderr), path


def test_parameters_and_laws_are_converted(checks, mech9d, folder):
    """Numbers of parameters have the unit of what they set, those of laws that of their variable: the motion stays what it is."""
    answers = ''.join(f'mechanism {unit}\nconvert\n' for unit in ('length_unit = mm', 'angle_unit = deg', 'rate_unit = rpm', 'force_unit = lbf',
                                                                  'mass_unit = lb'))
    draft, said, path = edited(mech9d, folder, PARAMETERS, answers)
    checks.true(said.count('Converted: ') == 5, 'five units are changed', said)
    text = text_of(draft)
    groups = data_file.parse(text)
    rod = [group[1] for group in groups if group[0] == 'parameter'][0]
    checks.near([rod[name][0] for name in ('value', 'low', 'high', 'spread')], [300, 250, 400, 1], 1e-12, 'a length with its range', scale=1)
    both = [group[1] for group in groups if group[0] == 'parameter'][1]
    checks.near([*both['factors'], *both['terms'], both['value'][0]], [1, 0.1, 0, 5, 100], 1e-12, 'factors stay, terms do not', scale=1)
    start = [group[1] for group in groups if group[0] == 'parameter'][2]
    checks.near([start[name][0] for name in ('value', 'low', 'high')], np.degrees([0.4, 0.3, 0.5]), 1e-12, 'an angle', scale=1)
    branch = [group[1] for group in groups if group[0] == 'branch'][0]
    checks.near([branch['low'][0], branch['high'][0]], [260, 390], 1e-12, 'the range of a branch', scale=1)
    plain, named = table_of(mech9d, path), table_of(mech9d, draft)
    checks.near(np.radians(named['q1']), plain['q1'], 1e-9, 'the angle of the crank', scale=1)
    checks.near(named['B.x']/1e3, plain['B.x'], 1e-9, 'the place of the piston', scale=1)
    checks.near(named['M1.torque']*4.4482216152605e-3, plain['M1.torque'], 1e-9, 'the torque of the controller', scale=1)
    checks.near(named['M2.current'], plain['M2.current'], 1e-9, 'the current', scale=1)


@pytest.mark.parametrize('parameter, left', [
    ("name='r', sets='point.position(1)','initial(1).position', value=0.5", 'parameter 1 value'), ("name='r', formula='2*s'", 'parameter 1 formula'),
    ("name='r', sets='stop.stiffness', value=3", 'stop 1 stiffness, parameter 1 value')])
def test_numbers_of_unknown_units(checks, mech9k, folder, parameter, left):
    """A parameter of a length and an angle, a formula, and the stiffness of a stop: nothing is converted, and the unit comes back."""
    text = f"""&mechanism title='press', length_unit='mm' / &structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 / &drive coordinate=1, kind='polynomial', coefficients=0, 1 /
&point name='P', link=2, position=35,0,0 / &initial coordinate=1, position=0 /
&parameter {parameter} / &parameter name='s', sets='point.position(2)', value=4 /
""" + ("&stop coordinate=1, high=3, stiffness=3, exponent=1.5 /\n" if 'stop' in left else '')
    _, said, _ = edited(mech9k, folder, text, 'mechanism length_unit = m\nconvert\nmechanism length_unit\n\n\nneither\n')
    checks.true(f'{left}. Nothing is converted, and the units are mm as before.' in said and 'length_unit [mm]' in said, 'refused', said)


@pytest.mark.parametrize('answers', ('quit\n', ''), ids=('quit', 'end'))
def test_left_without_an_answer(checks, mech9k, folder, answers):
    """Whoever leaves at the question keeps the units that the numbers have."""
    path = os.path.join(folder, 'press.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write("""&mechanism title='press', length_unit='mm' / &structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 / &drive coordinate=1, kind='polynomial', coefficients=0, 1 /
&point name='P', link=2, position=35,0,0 /
""")
    piped(mech9k, '--edit', path, folder=folder, answers='mechanism length_unit = m\n' + answers)
    text = text_of(os.path.join(folder, 'press.draft.nml'))
    checks.true("length_unit='mm'" in text and 'position=35' in text, 'the draft', text)
