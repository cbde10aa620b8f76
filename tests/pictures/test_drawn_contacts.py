"""Contacts of links in pictures and films: the ball has its radius about its point, and touches its plane, or the other ball, where the gap
of the same run is zero. Marks on a rolling ball turn with it.
"""
import re
from xml.etree import ElementTree

import numpy as np

from mech9_cases import read_table, run, text_of
from svg_pictures import SVG, example, film_of, nodes_of, picture_of, place_in

# places in films are rounded to a hundred-thousandth of the width
NEAR = 1e-4

PLANAR = """&mechanism title='ball, floor and stone' /
&structure cq=1,2,3 /
&pair coordinates=1,2,3, links=1,2, kind='planar', axis=0,0,1 /
&initial coordinate=1, position=0.02, velocity=0.3 /
&initial coordinate=2, position=0.9, velocity=0 /
&initial coordinate=3, position=0, velocity=1 /
&body link=2, mass=1, inertia=0,0,0.004,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&point name='C', link=2, position=0.03,0,0 /
&contact point='C', radius=0.1, normal=0,1,0, origin=0,-0.1,0, friction=0.3, restitution=0.5 /
&contact point='C', kind='sphere', radius=0.1, other_radius=0.2, origin=0,0.2,0, friction=0.3, restitution=0.6 /
&time end=1.2, intervals=60 /
"""


class Film:
    """A film, its picture, and the rows of its run."""

    def __init__(self, checks, program, data, folder):
        done = run(program, data, '--quiet', '--animate', folder / 'film.html', '--table', folder / 'film.dat')
        checks.equal(done.returncode, 0, f'the film is made; {done.stderr}')
        text = text_of(folder / 'film.html')
        self.film, self.rows = film_of(text), read_table(text_of(folder / 'film.dat'))
        self.svg = picture_of(text)
        self.groups = {int(group.get('data-i')): group for group in self.svg.iter(SVG + 'g') if group.get('data-i')}
        self.places = [nodes_of(self.film, frame) for frame in range(len(self.film['times']))]
        self.px = self.film['symbol'] / self.film['scale']

    def items(self, kind):
        return [i for i, group in sorted(self.groups.items()) if (group.get('class') or '').split()[:1] == [kind]]

    def nodes(self, i, frame):
        return self.places[frame][self.film['items'][i - 1]['nodes']]

    def radius(self, i):
        return float(self.groups[i].find(SVG + 'circle').get('r')) * self.px


def distance_to_plane(place, corners):
    normal = np.cross(corners[1] - corners[0], corners[-1] - corners[0])
    return (place - corners[0]) @ normal / np.linalg.norm(normal)


def test_ball_on_a_cloth_and_on_a_turntable(checks, mech9d, tmp_path):
    for name, radius in (('rolling_ball', 0.0286), ('turntable_ball', 0.05)):
        film = Film(checks, mech9d, example(name), tmp_path)
        (ball,), (plane,) = film.items('sphere'), film.items('surface')
        checks.near(film.radius(ball), radius, 1e-3, f'{name}: its radius')
        for frame in range(0, len(film.places), 7):
            corners = film.nodes(plane, frame)
            center = film.nodes(ball, frame)[0]
            checks.near(abs(distance_to_plane(center, corners)), radius, 2e-4, f'{name}: it touches the plane', scale=1.0)
            sides = corners[1] - corners[0], corners[-1] - corners[0]
            for side in sides:
                along = (center - corners[0]) @ side / (side @ side)
                checks.true(0 < along < 1, f'{name}: the plane reaches to the ball', along)
            for line in film.items('rolling'):
                checks.near(np.linalg.norm(film.nodes(line, frame) - center, axis=1), radius, 2e-4, f'{name}: lines on the ball', scale=1.0)
        titles = {film.groups[i].findtext(SVG + 'title') for i in (ball, plane)}
        checks.equal(titles, {'contact 1'}, f'{name}: named under the pointer')


def test_planar_contacts(checks, mech9d, tmp_path):
    data = tmp_path / 'ball.nml'
    data.write_text(PLANAR, encoding='utf-8')
    film = Film(checks, mech9d, data, tmp_path)
    stone, ball = film.items('sphere')
    checks.near([film.radius(stone), film.radius(ball)], [0.2, 0.1], 5e-4, 'the radii of both balls')
    floor, = [i for i in film.items('ground') if np.ptp(film.nodes(i, 0)[:, 1]) < NEAR and
              abs(film.nodes(i, 0)[0, 1] - film.nodes(stone, 0)[0, 1] + 0.3) < NEAR]
    for frame in range(len(film.places)):
        center = film.nodes(ball, frame)[0]
        checks.near(center[1] - film.nodes(floor, frame)[0, 1] - 0.1, film.rows['K1.gap'][frame], 2 * NEAR, 'the gap to the floor', scale=1.0)
        checks.near(np.linalg.norm(center - film.nodes(stone, frame)[0]) - 0.3, film.rows['K2.gap'][frame], 2 * NEAR,
                    'the gap to the stone', scale=1.0)
        cross, = film.items('rolling')
        spoke = film.nodes(cross, frame)[1] - film.nodes(cross, frame)[0]
        checks.near(np.hypot(*spoke[:2]), 0.2, 2 * NEAR, 'a diameter of the ball')
        if frame == 0:
            first = np.arctan2(spoke[1], spoke[0])
        turned = np.arctan2(spoke[1], spoke[0]) - first - film.rows['q3'][frame]
        checks.near((turned + np.pi) % (2 * np.pi), np.pi, 2e-3, 'it turns with the ball')


def test_contacts_in_every_kind_of_picture(checks, mech9d, tmp_path):
    """Balls and surfaces are inside the page; a point in place of a ball has no circle."""
    data = tmp_path / 'ball.nml'
    data.write_text(PLANAR, encoding='utf-8')
    for options in (['--sketch', 'a.svg'], ['--check', '--sketch', 'a.svg'], ['--animate', 'a.svg']):
        done = run(mech9d, data, '--quiet', '--no-write', *options, folder=tmp_path)
        checks.equal(done.returncode, 0, f'{options}: {done.stderr}')
        svg = ElementTree.parse(tmp_path / 'a.svg').getroot()
        width, height = map(float, svg.get('viewBox').split()[2:])
        balls = [group for group in svg.iter(SVG + 'g') if (group.get('class') or '').split()[:1] == ['sphere']]
        checks.equal(len(balls), 2, f'{options}: both balls')
        for group in balls:
            radius = float(next(group.iter(SVG + 'circle')).get('r')) * float((re.findall(r'scale\((\S+)\)', ElementTree.tostring(
                group, encoding='unicode')) or ['1'])[0])
            moves = [animation.get('values').split(';') for animation in group.iter(SVG + 'animateTransform')]
            places = np.array([list(map(float, word.split())) for word in moves[0]]) if moves else [place_in(group.get('transform'))]
            for place in places:
                checks.true(all(radius <= place) and all(place + radius <= [width, height]), f'{options}: inside the page',
                            (place, radius))
    data.write_text(PLANAR.replace('radius=0.1,', 'radius=0,').replace('other_radius=0,', 'other_radius=0.2,'), encoding='utf-8')
    run(mech9d, data, '--quiet', '--no-write', '--check', '--sketch', 'b.svg', folder=tmp_path)
    svg = ElementTree.parse(tmp_path / 'b.svg').getroot()
    checks.equal([(group.get('class') or '').split()[:1] for group in svg.iter(SVG + 'g')].count(['sphere']), 1, 'a point is no ball')
