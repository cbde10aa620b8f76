"""Symbols of joints with several freedoms, of pairs along curves, and of couplings: each joint is drawn once, with the names of
all its coordinates, and the links that the program makes itself are not named; wheels that mesh touch each other.
"""
import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from mech9_cases import run
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

# two belts from one shaft, one of them crossed, and a pair of gears that turn about opposite axes
BELTS = """&mechanism title='belts' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='revolute', axis=0,0,1, point=0.4,0.1,0 /
&pair coordinate=3, links=4,1, kind='revolute', axis=0,0,1, moving_point=-0.4,0.1,0, point=0,0,0 /
&pair coordinate=4, links=1,5, kind='revolute', axis=0,0,-1, point=0,0.3,0 /
&coupling kind='belt', coordinates=1,2, radii=0.05,0.1 /
&coupling kind='belt', coordinates=1,3, radii=0.06,0.12 /
&coupling kind='gear', coordinates=1,4, ratio=0.5 /
&drive coordinate=1, kind='polynomial', coefficients=0,3 /
&time end=2, intervals=50 /
"""


def picture(checks, program, data, folder, *options):
    """The picture of the mechanism of a data file."""
    path = folder / 'symbols.svg'
    done = run(program, data, '--no-write', '--quiet', '--sketch', path, *options)
    checks.equal(done.returncode, 0, f'{data}: it is drawn\n{done.stderr}')
    return ElementTree.parse(path).getroot()


def drawn(checks, program, text, folder):
    """The picture of a text of data, its joints by the names of their coordinates, and the number of its items of each class."""
    data = folder / 'symbols.nml'
    data.write_text(text, encoding='utf-8')
    svg = picture(checks, program, data, folder)
    joints, classes = {}, {}
    for group in svg.iter(SVG + 'g'):
        words = (group.get('class') or '').split()[:2]
        if words:
            classes[words[0]] = classes.get(words[0], 0) + 1
        if group.get('data-joint'):
            joints.setdefault(group.get('data-joint'), []).append((' '.join(words[:1] + [w for w in words[1:] if w == 'sheet']), group))
    return svg, joints, classes


def test_planar_joint_is_drawn_once(checks, mech9k, tmp_path):
    svg, joints, classes = drawn(checks, mech9k, PLANES, tmp_path)
    checks.equal(sorted(joints), ['q1 q2 q3', 'q4', 'q5 q6 q7'], 'a planar joint is drawn once')
    for names in ('q1 q2 q3', 'q5 q6 q7'):
        checks.equal([style for style, _ in joints[names]], ['plate sheet'], f'{names}: the face with which the link lies on the plane')
    checks.equal(classes.get('block', 0), 0, 'and has no blocks')
    checks.equal((classes.get('guide', 0), classes.get('hatch', 0)), (1, 1), 'the plane of the frame has a rim and is hatched')
    texts = texts_of(svg)
    checks.true({'2', '3', '4'} <= set(texts) and not {'5', '6', '7', '8'} & set(texts), 'links have the numbers of the file', texts)


def test_free_joint_is_three_lines(checks, mech9k, tmp_path):
    svg, joints, classes = drawn(checks, mech9k, FREE, tmp_path)
    checks.equal(list(joints), ['q1 q2 q3 q4 q5 q6'], 'a free joint is drawn once')
    group = joints['q1 q2 q3 q4 q5 q6'][0][1]
    corners = corners_of(group.find(SVG + 'path').get('d'))
    checks.equal(len(corners), 6, 'as three lines')
    checks.near(corners[::2] + corners[1::2], 2 * corners.mean(axis=0) * np.ones((3, 1)), 0.05, 'through one point')
    checks.equal({name: classes.get(name, 0) for name in ('block', 'guide', 'ball', 'pin', 'stand', 'hatch')},
                 dict.fromkeys(('block', 'guide', 'ball', 'pin', 'stand', 'hatch'), 0), 'and nothing holds it')
    checks.true('3' not in texts_of(svg), 'no link of its own is named')


def test_pairs_along_curves(checks, mech9k, tmp_path):
    angle = np.linspace(0, 2 * np.pi, 41)
    np.savetxt(tmp_path / 'curve.dat', np.column_stack([0.5 * np.cos(angle), 0.3 * np.sin(angle)]))
    _, joints, classes = drawn(checks, mech9k, PATHS, tmp_path)
    checks.equal({names: [style for style, _ in found] for names, found in joints.items()}, {'q1': ['plate sheet'], 'q2': ['block']},
                 'a square that does not turn, and a block that does')
    checks.equal(classes.get('free', 0), 0, "and not the symbol of a user's procedure")


def test_ball_on_a_slide(checks, mech9k, tmp_path):
    _, joints, classes = drawn(checks, mech9k, BALL_ON_RACK, tmp_path)
    checks.equal((classes.get('ball', 0), classes.get('cross', 0)), (1, 0), 'a ball on a slide is a ball')


@pytest.mark.parametrize('place, tubes', (('0.5', 1), ('1.5', 0)))
def test_tube_or_lever(checks, mech9k, tmp_path, place, tubes):
    _, _, classes = drawn(checks, mech9k, SLIDE.replace('PLACE', place), tmp_path)
    checks.equal(classes.get('tube', 0), tubes, f'a point at {place} m along a slide whose rod ends at 1 m')


def test_legs_of_a_platform_stand(checks, mech9k, tmp_path):
    svg = picture(checks, mech9k, example('stewart_gough'), tmp_path)
    stands = [group for group in svg.iter(SVG + 'g') if (group.get('class') or '') == 'stand']
    checks.equal(sum(group.find(SVG + 'g') is not None for group in stands), 0, 'none of six legs hangs')
    checks.equal(len(stands), 6, 'each of six legs has a stand')


def lines_of(svg):
    """The corners of each line that shows a link [px]."""
    groups = [group for group in svg.iter(SVG + 'g') if (group.get('class') or '').split()[:1] == ['plate']]
    return [corners_of(group.find(SVG + 'path').get('d')) for group in groups]


def circles_of(svg):
    """Middle and radius of each circle of a wheel that is seen along its axis [px]: 72 corners after a spoke, and the first one again."""
    rims = [line[1:-1] for line in lines_of(svg) if len(line) == 74]
    return [(rim.mean(axis=0), np.hypot(*(rim - rim.mean(axis=0)).T).mean()) for rim in rims]


def test_wheels_of_a_planetary_gear_touch(checks, mech9k, tmp_path):
    # pictures give hundredths of a px
    planet, sun, ring = sorted(circles_of(picture(checks, mech9k, example('planetary_gear'), tmp_path)), key=lambda circle: circle[1])
    checks.near([sun[1] / planet[1], ring[1] / planet[1]], [20 / 16, 52 / 16], 1e-3, 'pitch circles have the ratio of the teeth')
    checks.near(np.hypot(*(sun[0] - planet[0])), sun[1] + planet[1], 0.05, 'sun and planet touch from outside')
    checks.near(np.hypot(*(ring[0] - planet[0])), ring[1] - planet[1], 0.05, 'ring and planet from inside')
    checks.near(ring[0], sun[0], 0.05, 'sun and ring have one axis')


def test_rack_touches_its_pinion(checks, mech9d, tmp_path):
    svg = picture(checks, mech9d, example('rack_and_pinion'), tmp_path)
    (pinion,) = circles_of(svg)
    upright = [bar for bar in lines_of(svg) if len(bar) == 2 and np.ptp(bar[:, 0]) < 0.05]
    checks.true(any(abs(abs(bar[0, 0] - pinion[0][0]) - pinion[1]) < 0.05 and bar[:, 1].min() < pinion[0][1] < bar[:, 1].max()
                    for bar in upright), 'the rack touches its pinion', (pinion, upright))


def test_bevel_gears(checks, mech9d, tmp_path):
    """Seen from above at the start, the side gears are upright lines of 0.12 m and the pinion a level one of 0.06 m."""
    svg = picture(checks, mech9d, example('differential'), tmp_path, '--view', 'xy')
    sizes = sorted(tuple(np.ptp(line[1:], axis=0)) for line in lines_of(svg) if len(line) == 74)
    checks.equal(len(sizes), 3, 'three bevel gears')
    checks.near(np.array(sizes)[:, 1] / sizes[2][0], [2.0, 2.0, 0.0], 0.01, 'side gears of twice the diameter of the pinion')


def test_roller_touches_its_cam(checks, mech9k, tmp_path):
    """The roller of 10 mm is a circle that touches the cam, whose least radius is 40.8 - 10 mm, at (8, 40) mm from its axis."""
    svg = picture(checks, mech9k, example('dwell_cam'), tmp_path)
    roller, profile = sorted((corners_of(group.find(SVG + 'path').get('d')) for group in svg.iter(SVG + 'g')
                              if (group.get('class') or '').split()[:1] == ['cam']), key=len)
    axis, = [np.array([float(number) for number in re.findall(r'[-.0-9]+', group.get('transform'))[:2]])
             for group in svg.iter(SVG + 'g') if group.get('data-joint') == 'q1']
    centre, radius = roller.mean(axis=0), np.hypot(*(roller - roller.mean(axis=0)).T).mean()
    scale = radius / 0.01
    checks.near((centre - axis) / scale, [0.008, -0.04], 1e-5, 'the roller stands where the follower does', scale=1.0)
    # 300 points of the curve: straight lines between them miss it by 1e-5 m
    checks.near(np.hypot(*(profile - centre).T).min() / scale, 0.01, 2e-5, 'it touches the cam', scale=1.0)
    checks.near(np.hypot(*(profile - axis).T).min() / scale, np.hypot(0.008, 0.04) - 0.01, 2e-5, 'the least radius of the cam', scale=1.0)


def test_belts_are_tangent_to_their_pulleys(checks, mech9k, tmp_path):
    svg, _, _ = drawn(checks, mech9k, BELTS, tmp_path)
    circles = circles_of(svg)
    checks.equal(len(circles), 6, 'two pulleys for each belt and two gears')
    strands = [corners_of(group.find(SVG + 'path').get('d')) for group in svg.iter(SVG + 'g')
               if (group.get('class') or '').split()[:1] == ['curve']]
    checks.equal(len(strands), 4, 'two straight parts of each belt')
    for strand in strands:
        along = (strand[1] - strand[0]) / np.hypot(*(strand[1] - strand[0]))
        for end in strand:
            apart = [abs((middle - end) @ along) + abs(np.hypot(*(middle - end)) - radius) for middle, radius in circles]
            checks.true(min(apart) < 0.1, 'a belt is tangent to a pulley at its end', apart)
    # the gears turn about opposite axes by a positive ratio: they mesh from outside, with radii 1/3 and 2/3 of 0.3 m
    upper = min(circles, key=lambda circle: circle[0][1])
    checks.true(any(abs(np.hypot(*(upper[0] - middle)) - upper[1] - radius) < 0.05 and abs(upper[1] / radius - 2) < 1e-2
                    for middle, radius in circles), 'gears touch')


# sun, carrier and planet beside a held ring, by equations of angles against the frame; the wheels have 20, 16 and 52 teeth
PLANETARY = """&mechanism title='planetary gear' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='revolute', axis=0,0,{sense} /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0.036,0,0, moving_point=0,0,0 /
&coupling kind='linear', coordinates=1,2,3, coefficients=20,{less},16 /
&coupling kind='linear', coordinates=2,3, coefficients={ring},16 /
&drive coordinate=1, kind='polynomial', coefficients=0, 9 /
&time end=1, intervals=20 /
"""


@pytest.mark.parametrize('sense', (1, -1))
def test_wheels_of_linear_couplings(checks, mech9k, tmp_path, sense):
    """Sun 20 (w1 - wc) + 16 (wp - wc) = 0 and ring 52 (0 - wc) = 16 (wp - wc): the pitch circles have these radii and touch."""
    data = tmp_path / 'gear.nml'
    data.write_text(PLANETARY.format(sense=sense, less=-20 * sense, ring=52 * sense), encoding='utf-8')
    planet, sun, ring = sorted(circles_of(picture(checks, mech9k, data, tmp_path)), key=lambda circle: circle[1])
    unit = ring[1] / 52
    checks.near([planet[1] / unit, sun[1] / unit], [16, 20], 0.01, 'teeth of planet and sun')
    checks.near(np.hypot(*(planet[0] - sun[0])) / unit, 36, 0.01, 'sun and planet touch')
    checks.near(np.hypot(*(ring[0] - sun[0])) / unit, 0, 0.05, 'sun and ring have one axis')


def test_wheels_about_one_axis(checks, mech9k, tmp_path):
    """A ring of twice the teeth of the sun, whose planets are no links, is drawn with one of them."""
    data = tmp_path / 'gear.nml'
    data.write_text("""&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='revolute', axis=0,0,1 /
&pair coordinate=3, links=1,4, kind='revolute', axis=0,0,1 /
&coupling kind='linear', coordinates=1,2,3, coefficients=1,2,-3 /
&point name='A', link=4, position=0.1,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0, 1 /
&drive coordinate=2, kind='polynomial', coefficients=0, 0.5 /
&time end=1, intervals=20 /
""", encoding='utf-8')
    planet, sun, ring = sorted(circles_of(picture(checks, mech9k, data, tmp_path)), key=lambda circle: circle[1])
    checks.near([sun[1] / ring[1], planet[1] / ring[1]], [0.5, 0.25], 0.01, 'sizes by the teeth')
    checks.near(np.hypot(*(planet[0] - sun[0])) / ring[1], 0.75, 0.01, 'the planet is between both')


def test_linear_couplings_that_are_no_gears(checks, mech9k, tmp_path):
    """Equal angles, sums of slides, and angles about axes that are not parallel have no wheels."""
    data = tmp_path / 'none.nml'
    text = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='{kind}', axis={axis}, point=0.5,0,0 /
&coupling kind='linear', coordinates=1,2, coefficients={numbers} /
&point name='A', link=2, position=0.1,0,0 /
&point name='B', link=3, position=0.1,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0, 1 /
&time end=1, intervals=20 /
"""
    for kind, axis, numbers in (('revolute', '0,0,1', '1,-1'), ('prismatic', '1,0,0', '1,2'), ('revolute', '0,1,0.1', '1,2')):
        data.write_text(text.format(kind=kind, axis=axis, numbers=numbers), encoding='utf-8')
        checks.equal(circles_of(picture(checks, mech9k, data, tmp_path)), [], f'{kind} {axis} {numbers}: no wheels')
    data.write_text(text.format(kind='revolute', axis='0,0,1', numbers='2,1'), encoding='utf-8')
    small, large = sorted(circles_of(picture(checks, mech9k, data, tmp_path)), key=lambda circle: circle[1])
    checks.near(large[1] / small[1], 2, 0.01, 'two wheels of the frame by a linear equation')
