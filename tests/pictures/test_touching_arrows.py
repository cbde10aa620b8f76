"""Arrows of stops, dry friction and contacts. At rest, and in a slow motion, all that acts on a link is in balance; the arrows themselves
are those of closed forms. Stops and friction are parts of the arrow of their pair, contacts are not."""
from math import atan2, cos, pi, radians, sin
from xml.etree import ElementTree

import numpy as np
import pytest

from force_pages import ROUNDED, Arrows, check_balance, page_of
from mech9_cases import run
from svg_pictures import SVG

G = 9.81
SLOPE = radians(30)
UP = np.array([cos(SLOPE), sin(SLOPE), 0])
AT_REST = '&time end=0.1, intervals=4 /\n&output force_arrows=.true. /\n'
WEIGHT = '&gravity acceleration=0,-9.81,0 /\n'
# a block of 2 kg on a guide that climbs by 30 degrees; the block hangs beside the guide
BLOCK = f"""&structure cq=1 /
&link number=2, name='block' /
&pair coordinate=1, links=1,2, kind='prismatic', axis={cos(SLOPE)!r},{sin(SLOPE)!r},0, point=0.1,0.2,0, moving_point=0,0,0, name='guide' /
&body link=2, mass=2, centre=0.1,0.05,0, inertia=0.01,0.01,0.01,0,0,0 /
&initial coordinate=1, position=0.3, velocity=0 /
""" + WEIGHT
# an arm of 2 kg whose mass centre is 0.4 m beside its bearing
ARM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0.1,0.1,0, moving_point=0,0,0 /
&body link=2, mass=2, centre=0.4,0,0, inertia=0.01,0.01,0.01,0,0,0 /
&initial coordinate=1, position=0, velocity=0 /
""" + WEIGHT


def near(checks, arrows, title, true):
    """Whether an arrow has these components, to what the page rounds."""
    if not checks.true(title in arrows.ways, f'there is {title}', sorted(arrows.ways)):
        return
    true = np.asarray(true, float)
    largest = max(size for name, size in arrows.told.items() if arrows.is_torque(name) == arrows.is_torque(title))
    checks.true(np.abs(arrows.ways[title] - true).max() < ROUNDED * largest, f'{title} is right', [arrows.ways[title][0], true])
    told = np.linalg.norm(np.broadcast_to(true, arrows.ways[title].shape), axis=1).max()
    checks.near(arrows.told[title], told, 1e-3, f'{title}: its greatest size is told')


@pytest.mark.parametrize('group, title', [
    ('&stop coordinate=1, low=0.3 /\n', 'stop 1: force in pair 1 (guide)'),
    (f'&stop coordinate=1, low={0.3 + 2*G*sin(SLOPE)/5000!r}, stiffness=5000 /\n', 'stop 1: force in pair 1 (guide)'),
    ('&friction coordinate=1, static=0.9, dynamic=0.5 /\n', 'friction: force in pair 1 (guide)')], ids=('rigid stop', 'compliant stop', 'friction'))
def test_what_holds_a_block(checks, mech9d, tmp_path, group, title):
    """A stop or friction holds a block on a slope: m g sin(slope) up the guide, which the arrow of the pair contains."""
    arrows = Arrows(page_of(checks, mech9d, tmp_path, BLOCK + group + AT_REST))
    near(checks, arrows, title, 2*G*sin(SLOPE)*UP)
    check_balance(checks, arrows, {'the block': [('force in pair 1 (guide)', 1), ('moment in pair 1 (guide)', 1),
                                                 ('weight of link 2 (block)', 1)]})
    # without its part along the guide, the force of the guide stands across it
    along = (arrows.ways['force in pair 1 (guide)'] - arrows.ways[title]) @ UP
    checks.true(np.abs(along).max() < ROUNDED*2*G, 'it is a part of the force in the pair', along)


@pytest.mark.parametrize('group, title', [
    ('&stop coordinate=1, low=0, high=2 /\n', 'stop 1: torque in pair 1'),
    ('&friction coordinate=1, static=9, dynamic=5, radius=0.1 /\n', 'friction: torque in pair 1')], ids=('stop', 'friction'))
def test_what_holds_an_arm(checks, mech9d, tmp_path, group, title):
    arrows = Arrows(page_of(checks, mech9d, tmp_path, ARM + group + AT_REST))
    near(checks, arrows, title, [0, 0, 2*G*0.4])
    near(checks, arrows, 'moment in pair 1', [0, 0, 2*G*0.4])
    checks.equal(arrows.shapes[title], 'ring', 'a torque is round its axis')


def test_upper_end_of_a_reversed_pair(checks, mech9d, tmp_path):
    """The frame is the moving link of the pair: the stop pushes the frame down, and so the block up."""
    text = BLOCK.replace('links=1,2', 'links=2,1').replace('position=0.3', 'position=-0.3').replace('point=0.1,0.2,0, moving_point=0,0,0',
                                                                                                 'point=0,0,0, moving_point=0.1,0.2,0')
    arrows = Arrows(page_of(checks, mech9d, tmp_path, text + '&stop coordinate=1, high=-0.3 /\n' + AT_REST))
    near(checks, arrows, 'stop 1: force in pair 1 (guide)', -2*G*sin(SLOPE)*UP)
    check_balance(checks, arrows, {'the block': [('force in pair 1 (guide)', -1), ('moment in pair 1 (guide)', -1),
                                                 ('weight of link 2 (block)', 1)]})


def test_friction_of_a_thread(checks, mech9d, tmp_path):
    """A nut rests on a standing screw of the lead h for a radian and the radius r: friction along the thread is m g sin(a), tan(a) = h/r."""
    lead, radius = 0.01, 0.04
    slope = atan2(lead, radius)
    text = f"""&structure cq=1 /
&pair coordinate=1, links=1,2, kind='helical', axis=0,1,0, pitch={2*pi*lead!r} /
&body link=2, mass=2, centre=0,0,0, inertia=0.01,0.01,0.01,0,0,0 /
&initial coordinate=1, position=0, velocity=0 /
&friction coordinate=1, static=0.5, dynamic=0.5, radius={radius} /
""" + WEIGHT
    arrows = Arrows(page_of(checks, mech9d, tmp_path, text + AT_REST, '--view', 'iso'))
    near(checks, arrows, 'friction: force in pair 1', [0, 2*G*sin(slope)**2, 0])
    near(checks, arrows, 'friction: torque in pair 1', [0, 2*G*sin(slope)*cos(slope)*radius, 0])


@pytest.mark.parametrize('orientation', ('tangent', 'fixed'))
@pytest.mark.parametrize('links', ('1,2', '2,1'))
def test_stop_on_a_curve(checks, mech9d, tmp_path, orientation, links):
    """A bead rests at a stop of a straight wire that climbs by 30 degrees, whichever of both links moves; the wire follows the bead then."""
    wire = ''.join(f'{0.1*i*cos(SLOPE)!r} {0.1*i*sin(SLOPE)!r} 0\n' for i in range(11))
    (tmp_path / 'wire.dat').write_text(wire, encoding='utf-8')
    if links == '2,1':
        # the wire is a part of the link that moves, and slides downwards along the frame's point
        low, sign, zero = 'high=0.5', -1, ''
        if orientation == 'tangent':
            zero = f', moving_zero={cos(SLOPE)!r},{sin(SLOPE)!r},0'
    else:
        low, sign, zero = 'low=0.5', 1, ''
    text = f"""&structure cq=1 /
&pair coordinate=1, links={links}, kind='path', file='wire.dat', orientation='{orientation}'{zero} /
&body link=2, mass=2, centre=0,0,0, inertia=0.01,0.01,0.01,0,0,0 /
&initial coordinate=1, position=0.5, velocity=0 /
&stop coordinate=1, {low} /
""" + WEIGHT
    arrows = Arrows(page_of(checks, mech9d, tmp_path, text + AT_REST))
    near(checks, arrows, 'stop 1: force in pair 1', sign*2*G*sin(SLOPE)*UP)


DISC = """&structure cq=1,2,3 /
&pair coordinates=1,2,3, links=1,2, kind='planar', axis=0,0,1 /
&link number=2, name='disc' /
&body link=2, mass=2, inertia=0.01,0.01,0.01,0,0,0 /
&point name='C', link=2, position=0,0,0 /
"""


def disc_at(x, y):
    return ''.join(f'&initial coordinate={k}, position={q!r}, velocity=0 /\n' for k, q in enumerate((x, y, 0), 1))


def test_disc_that_rolls_not(checks, mech9d, tmp_path):
    """A rope at the upper rim holds a disc on a slope: it pulls with m g sin(slope)/2, and so does friction at the lower rim."""
    radius = 0.1
    normal = np.array([-sin(SLOPE), cos(SLOPE), 0])
    centre, rim = 0.3*UP + radius*normal, radius*normal
    pull = G*sin(SLOPE)*UP
    text = DISC + disc_at(*centre[:2]) + WEIGHT + (
        f"&load kind='force', link=2, force={pull[0]!r},{pull[1]!r},0, position={rim[0]!r},{rim[1]!r},0 /\n"
        f"&contact point='C', radius={radius}, normal={normal[0]!r},{normal[1]!r},0, friction=0.8 /\n")
    arrows = Arrows(page_of(checks, mech9d, tmp_path, text + AT_REST))
    touching = 'contact 1: force on link 2 (disc)'
    near(checks, arrows, touching, 2*G*cos(SLOPE)*normal + pull)
    check_balance(checks, arrows, {'the disc': [(touching, 1), ('weight of link 2 (disc)', 1), ('load 1: force on link 2 (disc)', 1)]})
    checks.equal(arrows.told['force in pair 1'], 0, 'the joint of the free disc passes on nothing, not even round-off')
    # it begins where the disc touches the slope
    foot = arrows.feet[touching] - arrows.feet['weight of link 2 (disc)']
    checks.true(np.abs(foot + rim).max() < 1e-3*radius*5, 'it begins at the slope', foot[0])


def test_both_links_of_a_contact(checks, mech9d, tmp_path):
    """A disc lies on a plate, beside the middle of the plate's guide, which a drive holds."""
    text = DISC.replace('cq=1,2,3', 'cq=1,2,3,4') + disc_at(0.2, 0.6) + WEIGHT + """
&pair coordinate=4, links=1,3, kind='prismatic', axis=0,1,0 /
&body link=3, mass=1, centre=0,-0.1,0 /
&drive coordinate=4, kind='polynomial', coefficients=0.5 /
&contact point='C', radius=0.1, link=3, normal=0,1,0, friction=0.2 /
"""
    arrows = Arrows(page_of(checks, mech9d, tmp_path, text + AT_REST))
    near(checks, arrows, 'contact 1: force on link 2 (disc)', [0, 2*G, 0])
    near(checks, arrows, 'contact 1: force on link 3', [0, -2*G, 0])
    check_balance(checks, arrows, {
        'the disc': [('contact 1: force on link 2 (disc)', 1), ('weight of link 2 (disc)', 1)],
        'the plate': [('contact 1: force on link 3', 1), ('weight of link 3', 1), ('force in pair 4', 1), ('moment in pair 4', 1)]})


PRESSED = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=1,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=-0.52, 4e-5 /
&drive coordinate=2, kind='polynomial', coefficients=0, 1e-4 /
&body link=2, mass=2, centre=0.3,0.05,0 /
&point name='tip', link=2, position=0.6,0,0 /
&contact point='tip', radius=0.05, link=3, normal=0.1,1,0, origin=0.5,-0.3,0, stiffness=2e4 /
&stop coordinate=2, high=0.05, stiffness=3000 /
&time end=1000, intervals=20 /
&output force_arrows=.true. /
""" + WEIGHT


def test_slow_motion_in_both_programs(checks, mech9k, mech9d, tmp_path):
    """A lever is pressed into a wedge that slides below it, into a compliant stop at last: the same arrows in both programs, in balance."""
    found = {name: Arrows(page_of(checks, program, tmp_path, PRESSED)) for name, program in (('mech9k', mech9k), ('mech9d', mech9d))}
    for name, arrows in found.items():
        check_balance(checks, arrows, {
            f'the lever ({name})': [('contact 1: force on link 2', 1), ('weight of link 2', 1), ('force in pair 1', 1), ('moment in pair 1', 1)],
            f'the wedge ({name})': [('contact 1: force on link 3', 1), ('force in pair 2', 1), ('moment in pair 2', 1)]})
        travel = np.array([frame for frame in np.linspace(0, 0.1, 21)])
        near(checks, arrows, 'stop 1: force in pair 2', np.outer(-3000*np.maximum(0, travel - 0.05), [1, 0, 0]))
    for title, ways in found['mech9k'].ways.items():
        largest = max(found['mech9k'].told.values())
        checks.true(np.abs(ways - found['mech9d'].ways[title]).max() < ROUNDED*largest, f'{title}: the same in both programs')


def test_arrows_that_never_act(checks, mech9d, tmp_path):
    """Stops that are not reached and contacts that stay open have no arrows; no reaction is drawn on the frame."""
    text = BLOCK + '&stop coordinate=1, low=-9, high=9 /\n' + "&point name='P', link=2, position=0,0,0 /\n&contact point='P', normal=0,1,0, origin=0,-9,0 /\n"
    arrows = Arrows(page_of(checks, mech9d, tmp_path, text + AT_REST))
    checks.true(not any(title.startswith(('stop', 'contact', 'friction')) for title in arrows.ways), 'no such arrows', sorted(arrows.ways))


def test_other_pictures(checks, mech9d, tmp_path):
    """Drawings and SVG films have the arrows, too, inside the picture, in a colour of their own."""
    (tmp_path / 'case.nml').write_text(DISC + disc_at(0.2, 0.1) + WEIGHT + "&contact point='C', radius=0.1, normal=0,1,0 /\n" + AT_REST,
                                       encoding='utf-8')
    done = run(mech9d, tmp_path / 'case.nml', '--quiet', '--no-write', '--sketch', 'start.svg', '--animate', 'film.svg', folder=tmp_path)
    checks.equal(done.returncode, 0, done.stderr)
    for name in ('start.svg', 'film.svg'):
        svg = ElementTree.parse(tmp_path / name).getroot()
        titles = [group.findtext(SVG + 'title') for group in svg.iter(SVG + 'g') if group.get('class') == 'touching']
        checks.equal(titles, ['contact 1: force on link 2 (disc), at most 19.62 N'], name)
        checks.true('.touching path{stroke-width:2.2;stroke:#b35900' in ''.join(svg.itertext()), f'{name}: their colour')
