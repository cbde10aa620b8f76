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


def test_numbers_of_unknown_units(checks, mech9k, folder):
    """A parameter has the unit of what it sets: nothing is converted, and the unit comes back."""
    path = os.path.join(folder, 'press.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write("""&mechanism length_unit='mm' / &structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 / &drive coordinate=1, kind='polynomial', coefficients=0, 1 /
&point name='P', link=2, position=35,0,0 / &parameter name='r', sets='point.position(1)', value=35 /
""")
    done = piped(mech9k, '--edit', path, folder=folder, answers='mechanism length_unit = m\nconvert\nmechanism length_unit\n\n\nneither\n')
    said = in_one_line(done.stderr)
    checks.true('parameter 1 value. Nothing is converted, and the units are mm as before.' in said and 'length_unit [mm]' in said, 'refused', done.stderr)


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
