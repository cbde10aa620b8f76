"""Arrows of forces, moments, loads and weights. In a slow motion the arrows at each link, taken with the sizes that they tell under the
pointer, are in balance: their sum and their moment are zero. Loads and weights alone are what the data file says.
"""
import re
from xml.etree import ElementTree

import numpy as np
import pytest

from force_pages import Arrows, check_balance, page_of
from mech9_cases import run, text_of
from svg_pictures import SVG, corners_of, example, film_of, nodes_of, picture_of

STYLES = ('force', 'moment', 'load', 'weight')
# names, mm and kN; the spring is stretched, and the crank turns once in 1000 s
PRESS = """&mechanism title='Press', length_unit='mm', angle_unit='deg', force_unit='kN' /
&structure cq=1 /
&link number=2, name='crank' /
&link number=3, name='rod' /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, name='A' /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=300,0,0, moving_point=0,0,0, name='B' /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1000,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=60, 0.36 /
&body link=2, mass=10000, centre=150,0,0 /
&body link=3, mass=5000, centre=500,100,0 /
&gravity acceleration=0,-9810,0 /
&load kind='force', link=4, force=-400,0,0, position=0,50,0 /
&load kind='torque', link=3, torque=0,0,-50000 /
&load kind='spring', links=1,3, position=500,-300,0, second_position=500,0,0, stiffness=1, free_length=100 /
&load kind='force', link=3, force=0,0,0 /
&load kind='coordinate', coordinate=2, stiffness=20000, rest=0 /
&time start=0, end=1000, intervals=24 /
&output force_arrows=.true. /
"""
# an arm in space of two links with oblique axes, with loads in the axes of its links; it has no closed chain
ARM = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0.2 /
&pair coordinate=2, links=2,3, kind='revolute', axis=1,1,0, point=0.5,0.1,0.1, moving_point=0,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0.3, 1e-3 /
&drive coordinate=2, kind='polynomial', coefficients=-0.4, 2e-3 /
&body link=2, mass=3, centre=0.2,0,0.1, inertia=0.1,0.1,0.1,0,0,0 /
&body link=3, mass=2, centre=0.3,0,0, inertia=0.1,0.1,0.1,0,0,0 /
&gravity acceleration=0,0,-9.81 /
&load kind='force', link=3, force=5,-20,8, position=0.6,0,0.1, frame='link' /
&load kind='torque', link=3, torque=3,4,-6, frame='link' /
&load kind='torque', link=2, torque=1,2,0.5 /
&time start=0, end=300, intervals=20 /
&output force_arrows=.true. /
"""


def test_arrows_in_the_plane_are_in_balance(checks, mech9k, tmp_path):
    arrows = Arrows(page_of(checks, mech9k, tmp_path, PRESS), 1e3, 1.0)
    check_balance(checks, arrows, {
        'the crank': [('force in pair 1 (A)', 1), ('moment in pair 1 (A)', 1), ('force in pair 2 (B)', -1), ('moment in pair 2 (B)', -1),
                      ('weight of link 2 (crank)', 1)],
        'the rod': [('force in pair 2 (B)', 1), ('moment in pair 2 (B)', 1), ('force in pair 3', -1), ('weight of link 3 (rod)', 1),
                    ('load 2: torque on link 3 (rod)', 1), ('load 3: force on link 3 (rod)', 1)],
        'the ram': [('force in pair 3', 1), ('force in pair 4', 1), ('moment in pair 4', 1), ('load 1: force on link 4', 1)]})
    checks.equal(sorted(arrows.ways), sorted([
        'force in pair 1 (A)', 'force in pair 2 (B)', 'force in pair 3', 'force in pair 4', 'moment in pair 1 (A)',
        'moment in pair 2 (B)', 'moment in pair 4', 'load 1: force on link 4', 'load 2: torque on link 3 (rod)',
        'load 3: force on link 3 (rod)', 'weight of link 2 (crank)', 'weight of link 3 (rod)']),
        'no arrows of pins without moments, and of loads that are zero')
    for title, true in (('load 1: force on link 4', [-400e3, 0, 0]), ('load 2: torque on link 3 (rod)', [0, 0, -50e3]),
                        ('weight of link 3 (rod)', [0, -5000 * 9.81, 0])):
        checks.true(np.abs(arrows.ways[title] - true).max() < 1e3, f'{title} is that of the data file', arrows.ways[title][0])
    checks.equal({arrows.shapes[title] for title in arrows.shapes if arrows.is_torque(title)}, {'ring'}, 'moments are round their axes')
    # the load on the ram begins 50 mm above its pair; the picture has y upwards
    above = arrows.feet['load 1: force on link 4'] - arrows.feet['force in pair 4']
    checks.true(np.abs(above - [0, 0.05, 0]).max() < 1e-4, 'a load begins at its point', above[0])


def test_arrows_of_a_joint_begin_where_its_forces_act(checks, mech9k, tmp_path):
    """The moment of a cylindrical joint is about the origin of its last pair, which slides away from the first one."""
    text = ARM.replace("&pair coordinate=2, links=2,3, kind='revolute', axis=1,1,0,", "&pair coordinates=2,3, links=2,3, kind='cylindrical', axis=1,1,0,")
    text = text.replace('cq=1,2', 'cq=1,2,3').replace('&body link=2', "&drive coordinate=3, kind='polynomial', coefficients=0.2, 1e-3 /\n&body link=2")
    arrows = Arrows(page_of(checks, mech9k, tmp_path, text))
    check_balance(checks, arrows, {
        'link 3': [('force in pair 2', 1), ('moment in pair 2', 1), ('weight of link 3', 1), ('load 1: force on link 3', 1),
                   ('load 2: torque on link 3', 1)]})


@pytest.mark.parametrize('view', ('iso', '1,0,0', '0.3,-1,0.2'))
def test_arrows_in_space_are_in_balance(checks, mech9k, tmp_path, view):
    arrows = Arrows(page_of(checks, mech9k, tmp_path, ARM, '--view', view))
    check_balance(checks, arrows, {
        'link 2': [('force in pair 1', 1), ('moment in pair 1', 1), ('force in pair 2', -1), ('moment in pair 2', -1),
                   ('weight of link 2', 1), ('load 3: torque on link 2', 1)],
        'link 3': [('force in pair 2', 1), ('moment in pair 2', 1), ('weight of link 3', 1), ('load 1: force on link 3', 1),
                   ('load 2: torque on link 3', 1)]})
    checks.true(abs(arrows.told['weight of link 3'] - 2 * 9.81) < 1e-2, 'the weight is told')
    checks.true(abs(arrows.told['load 2: torque on link 3'] - np.sqrt(61)) < 1e-2, 'the size of a torque is told')
    toward = np.array({'iso': [1, -1, 1], '1,0,0': [1, 0, 0], '0.3,-1,0.2': [0.3, -1, 0.2]}[view])
    along = abs(np.array([1, 2, 0.5]) @ toward) / np.linalg.norm([1, 2, 0.5]) / np.linalg.norm(toward)
    checks.equal(arrows.shapes['load 3: torque on link 2'], 'ring' if along >= 0.25 else 'double',
                 'a moment that is seen from the side has two heads')
    for title, heads in arrows.heads.items():
        if arrows.is_torque(title):
            # the barbs of the first head reach a little beyond the tip of the second one, which stands on the line of the arrow
            (tip, barbs), (second, _) = heads
            checks.true(np.abs(second - tip - 0.8 * (barbs - tip)).max() < 1e-3, f'{title}: the second head stands behind the first one')


@pytest.mark.parametrize('text, options', ((PRESS, ()), (PRESS, ('--view', 'xz')), (ARM, ()), (ARM, ('--view', 'yz'))),
                         ids=('plane', 'plane from the side', 'space', 'space from the side'))
def test_arrows_are_on_the_page(checks, mech9k, tmp_path, text, options):
    page_of(checks, mech9k, tmp_path, text, *options, '--sketch', 'start.svg', '--animate', 'film.svg')
    for name in ('start.svg', 'film.svg'):
        svg = ElementTree.parse(tmp_path / name).getroot()
        width, height = map(float, svg.get('viewBox').split()[2:])
        arrows = [group for group in svg.iter(SVG + 'g') if (group.get('class') or '') in STYLES]
        checks.true({group.get('class') for group in arrows} == set(STYLES), f'{name}: all kinds of arrows')
        ways = [part for arrow in arrows for element in arrow.iter()
                for part in [element.get('d', ''), *element.get('values', '').split(';')] if part.startswith('M')]
        places = np.concatenate([corners_of(way) for way in ways])
        checks.true((places >= 0).all() and (places <= [width, height]).all(), f'{name}: they are inside',
                    [places.min(axis=0), places.max(axis=0)])


def test_loads_stay_where_pairs_are_chosen(checks, mech9k, tmp_path):
    arrows = Arrows(page_of(checks, mech9k, tmp_path, PRESS, '--set', 'output.reactions=.true.', '--set', 'output.reaction_pairs=4'))
    checks.equal(sorted(title for title in arrows.ways if 'pair' in title), ['force in pair 4', 'moment in pair 4'], 'one pair')
    checks.equal(sum('load' in title or 'weight' in title for title in arrows.ways), 5, 'loads and weights')


def test_arrows_of_a_free_motion(checks, mech9d, tmp_path):
    """A pendulum of given numbers: its weight is told, and a massless mark of mass centres is where the weight begins."""
    done = run(mech9d, example('pendulum'), '--quiet', '--no-write', '--animate', 'film.html', '--set', 'output.force_arrows=.true.',
               folder=tmp_path)
    checks.equal(done.returncode, 0, done.stderr)
    text = text_of(tmp_path / 'film.html')
    arrows = Arrows(text)
    weight, = [title for title in arrows.ways if title.startswith('weight')]
    film, svg = film_of(text), picture_of(text)
    centre, = [group for group in svg.iter(SVG + 'g') if group.get('class') == 'centre']
    node = film['items'][int(centre.get('data-i')) - 1]['nodes'][0]
    for frame in range(0, len(film['times']), 10):
        checks.true(np.abs(nodes_of(film, frame)[node] - arrows.feet[weight][frame]).max() < 2e-4, f'it begins in the mass centre, {frame}')


def test_arrows_of_the_best_design(checks, mech9k, tmp_path):
    """The film of a search has the arrows of a run of its best design."""
    text = text_of(example('balanced_crank')).replace('&output ', '&output force_arrows=.true., ')
    text = re.sub(r'&gravity acceleration *= *[^/]*', '&gravity acceleration=0,-9.81,0 ', text)
    films = [page_of(checks, mech9k, tmp_path, text, '--optimize', '--out', 'best.nml') if name == 'search' else
             page_of(checks, mech9k, tmp_path, text_of(tmp_path / 'best.nml')) for name in ('search', 'run')]
    found, expected = (Arrows(film) for film in films)
    checks.equal(sorted(found.ways), sorted(expected.ways), 'the same arrows')
    checks.true('force in pair 1' in found.ways and any(title.startswith('weight') for title in found.ways), 'of forces and weights', found.ways)
    for title, ways in found.ways.items():
        checks.true(np.abs(ways - expected.ways[title]).max() < 1e-3 * max(found.told.values()), f'{title}: the same', ways[0])
