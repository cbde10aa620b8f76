"""Answers by names of links and pairs, and by formulas of numbers: the data file of the conversation has the numbers."""
import math
import os

from conversations import piped
from mech9_cases import run, text_of

DONE = 0
FOUR_BAR = """&mechanism title='bars', links=4, coordinates=4 /
&link number=2, name='crank' /
&link number=4, name='rocker' /
&structure cq='A' /
&pair coordinate=1, name='A', links=1,'crank', kind='revolute', axis=0,0,1 /
&pair coordinate=2, links='crank',3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, name='C', links=3,'rocker', kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0.8,0,0 /
&pair coordinate=4, name='D', links=1,'rocker', kind='revolute', axis=0,0,1, point=0.9,0,0, moving_point=0,0,0 /
&initial coordinate='D', position=1.2 /
&point name='P', link=3, position=0.5,0.1,0 /
&drive coordinate='A', kind='polynomial', coefficients=0.4, 10 /
&time end=0.2, intervals=8 /
"""


def edited(checks, program, folder, *answers):
    """The data file after corrections by these answers, and what the program said."""
    with open(os.path.join(folder, 'bars.nml'), 'w', encoding='utf-8') as file:
        file.write(FOUR_BAR)
    done = piped(program, '--edit', 'bars.nml', folder=folder, answers='\n'.join((*answers, '', 'save', '')) + '\n')
    checks.equal(done.returncode, DONE, 'exit code')
    return text_of(os.path.join(folder, 'bars.nml')), done.stderr


def test_names_in_answers(checks, mech9k, tmp_path):
    text, _ = edited(checks, mech9k, tmp_path, 'point 1 link = crank', 'pair 3 links = 3, "rocker"', 'add link', '1', 'base')
    checks.true("&point name='P', link=2," in text and 'coordinate=3, links=3, 4,' in text, f'names become numbers: {text}')
    checks.true("&link number=1, name='base' /" in text and "&link number=2, name='crank' /" in text and "name='C' /" in text, f'names stay: {text}')
    checks.true('&structure cq=1 /' in text and '&initial coordinate=4,' in text, f'a file with names is opened: {text}')
    checks.equal(run(mech9k, os.path.join(tmp_path, 'bars.nml'), '--check').returncode, DONE, 'the file is right')


def test_unknown_names_in_answers(checks, mech9k, tmp_path):
    text, said = edited(checks, mech9k, tmp_path, 'point 1 link', 'crankk', 'D', 'rocker')
    checks.true("&point name='P', link=4," in text and "'link' takes whole numbers" in said, f'names that no link has are refused: {said}')


def test_formulas_in_answers(checks, mech9k, tmp_path):
    text, said = edited(checks, mech9k, tmp_path, 'point 1 position = 0.3*sqrt(2), -1/4, 2*pi - 6', 'time end = 2/8', 'pair 2 point', '1/0, 0, 0',
                        '2*a, 0, 0', '(0.6)/2, 0, 0')
    position = ', '.join(str(value) for value in (0.3 * math.sqrt(2), -0.25, 2 * math.pi - 6))
    checks.true(f'position={position} /' in text and 'end=0.25,' in text, f'formulas become numbers: {text}')
    checks.true('point=0.3, 0, 0' in text and 'this divides by zero' in said and "'a' is none" in ' '.join(said.split()), f'wrong formulas are refused: {said}')
