"""The motions that a closed chain spans, as --plan shows them: the directions that it turns about and slides along, in the
link that carries it.
"""
import re

import numpy as np
import pytest

from mech9_cases import run

# link 2 turns; on it, three links closed in a chain: pairs 2, 3 and 4
ON_LINK_2 = """
&mechanism links=4, coordinates=4 /
&structure cq=1, 2 /
&pair coordinate=1, links=1,2, kind='revolute', point=-3,2,1, axis=0.48,0.6,0.64 /
&pair coordinate=2, links=2,3, {second} /
&pair coordinate=3, links=3,4, {third} /
&pair coordinate=4, links=2,4, {fourth} /
&drive coordinate=1, kind='polynomial', coefficients=0.3, 1 /
&drive coordinate=2, kind='polynomial', coefficients=0.1, 1 /
&time start=0, end=1, intervals=2 /
"""
# the same on the frame, far from the origin
ON_FRAME = """
&mechanism links=5, coordinates=5 /
&structure cq=2, 1, 5 /
&pair coordinate=1, links=1,5, kind='revolute', point=-3,2,1, axis=0,0,1 /
&pair coordinate=5, links=5,4, kind='revolute', point=-2,1,1, axis=1,0,0 /
&pair coordinate=2, links=1,2, {second} /
&pair coordinate=3, links=2,3, {third} /
&pair coordinate=4, links=1,3, {fourth} /
&drive coordinate=1, kind='polynomial', coefficients=0, 1 /
&drive coordinate=5, kind='polynomial', coefficients=0, 1 /
&drive coordinate=2, kind='polynomial', coefficients=0.1, 1 /
&time start=0, end=1, intervals=2 /
"""
AXIS = np.array([0.0, 0.6, 0.8])
ON_AXIS = 'point=1,0.5,0.2, axis=0,0.6,0.8'
# a turn, a slide and a screw on one axis; screws of three pitches on it
CYLINDRICAL = {'turn, slide and screw': dict(second=f"kind='revolute', {ON_AXIS}", third=f"kind='prismatic', {ON_AXIS}",
                                             fourth=f"kind='helical', pitch=0.3, {ON_AXIS}"),
               'three screws': dict(second=f"kind='helical', pitch=0.1, {ON_AXIS}", third=f"kind='helical', pitch=0.2, {ON_AXIS}",
                                    fourth=f"kind='helical', pitch=0.4, {ON_AXIS}")}
# three slides across the axis
ACROSS = dict(second="kind='prismatic', axis=1,0,0", third="kind='prismatic', axis=0.6,0.64,-0.48",
              fourth="kind='prismatic', axis=0,0.8,-0.6")
# six digits are shown
SHOWN = 2e-6


def directions_of(words):
    return np.array([[float(number) for number in one.split(',')] for one in re.findall(r'\(([^()]*)\)', words)])


@pytest.fixture
def plan_of(checks, mech9k, tmp_path):
    def plan(text):
        path = tmp_path / 'case.nml'
        path.write_text(text, encoding='utf-8')
        done = run(mech9k, path, '--plan')
        checks.equal(done.returncode, 0, f'a plan; stderr: {done.stderr}')
        return done.stdout
    return plan


ON_LINKS = pytest.mark.parametrize('text, link', [(ON_LINK_2, 2), (ON_FRAME, 1)], ids=['on_link_2', 'on_frame'])


@ON_LINKS
@pytest.mark.parametrize('pairs', CYLINDRICAL.values(), ids=CYLINDRICAL)
def test_cylindrical_chain_turns_and_slides(checks, plan_of, text, link, pairs):
    plan = plan_of(text.format(**pairs))
    found = re.search(rf'turning about (\(.*?\)), sliding along (\(.*?\)) of link {link}\n', plan)
    if checks.true(found, f'a cylindrical chain turns and slides, on link {link}', plan):
        for words in found.groups():
            checks.near(np.abs(directions_of(words) @ AXIS), 1.0, SHOWN, f'along its axis, on link {link}')
    checks.true('screwing' not in plan, f'and needs no screw for it, on link {link}', plan)


@ON_LINKS
def test_slides_do_not_turn(checks, plan_of, text, link):
    plan = plan_of(text.format(**ACROSS))
    found = re.search(rf'\n    sliding along (.*) of link {link}\n', plan)
    if checks.true(found, f'slides do not turn, on link {link}', plan):
        directions = directions_of(found[1])
        checks.equal(directions.shape, (2, 3), 'two directions')
        checks.near(directions @ AXIS, 0.0, SHOWN, f'across the axis, on link {link}')
        checks.true(np.linalg.norm(np.cross(*directions)) > 0.1, 'that are not the same', directions)
    checks.true('its Jacobian is constant' in plan, 'nothing turns', plan)
