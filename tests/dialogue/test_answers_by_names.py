"""Answers by names of links and pairs, which stay in the data file of the conversation, and by formulas of numbers."""
import math
import os

from conversations import piped
from four_bars import NAMED_BARS
from mech9_cases import run, text_of

DONE = 0
FOUR_BAR = NAMED_BARS + """&point name='P', link=3, position=0.5,0.1,0 /
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
    checks.true("&point name='P', link='crank'," in text and "  coordinate = 3\n  links = 3, 'rocker'\n" in text, f'answers stay names: {text}')
    checks.true("&link number=1, name='base' /" in text and "&link number=2, name='crank' /" in text and "name = 'C'\n" in text, f'names stay: {text}')
    checks.true("&structure cq='A' /" in text and "&initial coordinate='D'," in text and "links='crank', 3" in text, f'those of the file, too: {text}')
    checks.equal(run(mech9k, os.path.join(tmp_path, 'bars.nml'), '--check').returncode, DONE, 'the file is right')


def test_unknown_names_in_answers(checks, mech9k, tmp_path):
    text, said = edited(checks, mech9k, tmp_path, 'point 1 link', 'crankk', 'D', 'rocker')
    checks.true("&point name='P', link='rocker'," in text and "'link' takes whole numbers" in said, f'names that no link has are refused: {said}')


def test_formulas_in_answers(checks, mech9k, tmp_path):
    text, said = edited(checks, mech9k, tmp_path, 'point 1 position = 0.3*sqrt(2), -1/4, 2*pi - 6', 'time end = 2/8', 'pair 2 point', '1/0, 0, 0',
                        '2*a, 0, 0', '(0.6)/2, 0, 0')
    position = ', '.join(str(value) for value in (0.3 * math.sqrt(2), -0.25, 2 * math.pi - 6))
    checks.true(f'position={position} /' in text and 'end=0.25,' in text, f'formulas become numbers: {text}')
    checks.true('point=0.3, 0, 0' in text and 'this divides by zero' in said and "'a' is none" in ' '.join(said.split()), f'wrong formulas are refused: {said}')


def test_names_that_change(checks, mech9k, tmp_path):
    """A link with another name has it wherever it was named, and its number where it has no name any more."""
    text, said = edited(checks, mech9k, tmp_path, 'list', 'link 1 name = arm', 'remove link 2')
    checks.true("links=1, 'arm'," in text and "links='arm', 3," in text, f'another name: {text}')
    checks.true('links=3, 4,' in text and 'links=1, 4,' in text and 'rocker' not in text, f'no name: {text}')
    checks.true('links crank, 3' in ' '.join(said.split()) and 'cq A' in said, f'the list of answers has names: {said}')
    checks.equal(run(mech9k, os.path.join(tmp_path, 'bars.nml'), '--check').returncode, DONE, 'the file is right')


def test_joints_by_names(checks, mech9d, tmp_path):
    """Coordinates of a joint are called by its name and their places: B(2)."""
    path = os.path.join(tmp_path, 'ball.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write("""&mechanism links=2, coordinates=3, title='ball' /
&structure cq='B(1)', 'B(2)', 3 /
&pair coordinates=1,2,3, links=1,2, kind='spherical', name='B' /
&initial coordinate='B(1)', position=0.1 /
&initial coordinate='B(2)', position=0.3 /
&initial coordinate=3, position=0 /
&body link=2, mass=1, centre=0,0,-1, inertia=1,1,1,0,0,0 /
&gravity acceleration=0,0,-9.81 /
&time end=0.1, intervals=2 /
""")
    done = piped(mech9d, '--edit', 'ball.nml', folder=tmp_path, answers='time end = 0.2\n\nsave\n\n')
    checks.equal(done.returncode, DONE, done.stderr)
    text = text_of(path)
    checks.true("cq='B(1)', 'B(2)', 3" in text and "coordinate='B(2)'" in text, f'names of coordinates stay: {text}')
    checks.equal(run(mech9d, path, '--check').returncode, DONE, 'the file is right')
