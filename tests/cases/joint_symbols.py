"""Symbols of joints with several freedoms and of pairs along curves: each joint is drawn once, with the names of all its
coordinates, and the links that the program makes itself are not named.

usage: joint_symbols.py PROGRAMS_FOLDER
"""
import os
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), 'scripts'))
import numpy as np

from mech9_cases import Checks, run
from svg_pictures import SVG, corners_of, example, texts_of

# a table of the frame on which link 2 lies, and on the arm of link 3 another one for link 4; the numbers of the first one do not increase
PLANES = """&mechanism title='planes' /
&structure cq=1,2,3,4,5,6,7 /
&pair coordinates=2,3,1, links=1,2, kind='planar', axis=0,0,1, zero=1,0,0, point=0,0,0.1 /
&pair coordinate=4, links=1,3, kind='revolute', axis=0,0,1, point=1,0,0 /
&pair coordinates=5,6,7, links=3,4, kind='planar', axis=0,1,0, point=1.5,0,0 /
&load kind='coordinate', coordinate=5, stiffness=3 /
&point name='P', link=2, position=0.3,0.1,0.1 /
&point name='Q', link=4, position=1.7,0,0 /
&drive coordinate=1, kind='harmonic', amplitude=0.2, angular_frequency=3 /
&drive coordinate=2, kind='harmonic', amplitude=0.2, angular_frequency=3 /
&drive coordinate=3, kind='harmonic', amplitude=0.1, angular_frequency=6 /
&drive coordinate=4, kind='harmonic', amplitude=0.3, angular_frequency=3 /
&drive coordinate=5, kind='harmonic', amplitude=0.1, angular_frequency=6 /
&drive coordinate=6, kind='harmonic', amplitude=0.1, angular_frequency=3 /
&drive coordinate=7, kind='harmonic', amplitude=0.1, angular_frequency=3 /
&time end=2, intervals=40 /
"""

FREE = """&mechanism title='free' /
&structure cq=1,2,3,4,5,6 /
&pair coordinates=1,2,3,4,5,6, links=1,2, kind='free', point=0,0,1 /
&point name='P', link=2, position=0.3,0.1,0.1 /
""" + ''.join(f"&drive coordinate={k}, kind='polynomial', coefficients=0,0.{k} /\n" for k in range(1, 7)) + """
&time end=2, intervals=40 /
"""

PATHS = """&mechanism title='paths' /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='path', file='curve.dat', orientation='fixed' /
&pair coordinate=2, links=1,3, kind='path', file='curve.dat', orientation='tangent', point=1.5,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0,0.4 /
&drive coordinate=2, kind='polynomial', coefficients=0,0.4 /
&time end=1, intervals=20 /
"""

# a rack that carries a ball, one of whose axes is parallel to the slide
BALL_ON_RACK = """&mechanism title='ball on a rack' /
&structure cq=1,2,3,4 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&pair coordinates=2,3,4, links=2,3, kind='spherical' /
&point name='P', link=3, position=0.3,0.1,0.1 /
""" + ''.join(f"&drive coordinate={k}, kind='polynomial', coefficients=0,0.{k} /\n" for k in range(1, 5)) + """
&time end=1, intervals=20 /
"""

# a tube and its rod, with a traced point beside the tube, and beyond the end of the rod: then it is a lever
SLIDE = """&mechanism title='tube and rod' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=1,0,0, point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', axis=0,0,1, point=0.7,-0.3,0 /
&point name='P', link=2, position=PLACE,0.1,0 /
&drive coordinate=1, kind='harmonic', amplitude=0.1, angular_frequency=3 /
&time end=1, intervals=20 /
"""


def drawn(checks, program, text, folder):
    """The picture of a data file, its joints by the names of their coordinates, and the number of its items of each class."""
    data, path = os.path.join(folder, 'symbols.nml'), os.path.join(folder, 'symbols.svg')
    with open(data, 'w', encoding='utf-8') as file:
        file.write(text)
    done = run(program, data, '--no-write', '--quiet', '--sketch', path)
    checks.equal(done.returncode, 0, f'it is drawn\n{done.stderr}')
    svg = ElementTree.parse(path).getroot()
    joints, classes = {}, {}
    for group in svg.iter(SVG + 'g'):
        words = (group.get('class') or '').split()[:2]
        if words:
            classes[words[0]] = classes.get(words[0], 0) + 1
        if group.get('data-joint'):
            joints.setdefault(group.get('data-joint'), []).append((' '.join(words[:1] + [w for w in words[1:] if w == 'sheet']), group))
    return svg, joints, classes


def check_planes(checks, program, folder):
    svg, joints, classes = drawn(checks, program, PLANES, folder)
    checks.equal(sorted(joints), ['q1 q2 q3', 'q4', 'q5 q6 q7'], 'a planar joint is drawn once')
    for names in ('q1 q2 q3', 'q5 q6 q7'):
        checks.equal([style for style, _ in joints[names]], ['plate sheet'], f'{names}: the face with which the link lies on the plane')
    checks.equal(classes.get('block', 0), 0, 'and has no blocks')
    checks.equal((classes.get('guide', 0), classes.get('hatch', 0)), (1, 1), 'the plane of the frame has a rim and is hatched')
    texts = texts_of(svg)
    checks.true({'2', '3', '4'} <= set(texts) and not {'5', '6', '7', '8'} & set(texts), 'links have the numbers of the file', texts)


def check_free(checks, program, folder):
    svg, joints, classes = drawn(checks, program, FREE, folder)
    checks.equal(list(joints), ['q1 q2 q3 q4 q5 q6'], 'a free joint is drawn once')
    group = joints['q1 q2 q3 q4 q5 q6'][0][1]
    corners = corners_of(group.find(SVG + 'path').get('d'))
    checks.equal(len(corners), 6, 'as three lines')
    checks.near(corners[::2] + corners[1::2], 2 * corners.mean(axis=0) * np.ones((3, 1)), 0.05, 'through one point')
    checks.equal({name: classes.get(name, 0) for name in ('block', 'guide', 'ball', 'pin', 'stand', 'hatch')},
                 dict.fromkeys(('block', 'guide', 'ball', 'pin', 'stand', 'hatch'), 0), 'and nothing holds it')
    checks.true('3' not in texts_of(svg), 'no link of its own is named')


def check_paths(checks, program, folder):
    angle = np.linspace(0, 2 * np.pi, 41)
    np.savetxt(os.path.join(folder, 'curve.dat'), np.column_stack([0.5 * np.cos(angle), 0.3 * np.sin(angle)]))
    _, joints, classes = drawn(checks, program, PATHS, folder)
    checks.equal({names: [style for style, _ in found] for names, found in joints.items()}, {'q1': ['plate sheet'], 'q2': ['block']},
                 'a square that does not turn, and a block that does')
    checks.equal(classes.get('free', 0), 0, "and not the symbol of a user's procedure")


def check_balls_and_slides(checks, program, folder):
    _, joints, classes = drawn(checks, program, BALL_ON_RACK, folder)
    checks.equal((classes.get('ball', 0), classes.get('cross', 0)), (1, 0), 'a ball on a slide is a ball')
    for place, tubes in (('0.5', 1), ('1.5', 0)):
        _, _, classes = drawn(checks, program, SLIDE.replace('PLACE', place), folder)
        checks.equal(classes.get('tube', 0), tubes, f'a point at {place} m along a slide whose rod ends at 1 m')
    svg = os.path.join(folder, 'stewart.svg')
    run(program, example('stewart_gough'), '--no-write', '--quiet', '--sketch', svg)
    stands = [group for group in ElementTree.parse(svg).getroot().iter(SVG + 'g') if (group.get('class') or '') == 'stand']
    checks.equal(sum(group.find(SVG + 'g') is not None for group in stands), 0, 'none of six legs hangs')
    checks.equal(len(stands), 6, 'each of six legs has a stand')


def main():
    checks = Checks()
    program = os.path.join(os.path.abspath(sys.argv[1]), 'mech9k')
    with tempfile.TemporaryDirectory() as folder:
        check_planes(checks, program, folder)
        check_free(checks, program, folder)
        check_paths(checks, program, folder)
        check_balls_and_slides(checks, program, folder)
    checks.finish()


main()
