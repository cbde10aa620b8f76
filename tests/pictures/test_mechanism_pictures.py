"""Sketches and films of mechanisms: they are well formed, show what they should where it is, and hold nothing else.

Where joints are is computed here: on Fig. 1 by intersecting circles, on Bricard's loop from the start that its data
file gives, in all frames of a film from the table of the same run.
"""
import math
import os
import re
import shutil
import stat
import subprocess
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from mech9_cases import PATIENCE, read_table, run, text_of
from svg_pictures import SVG, corners_of, example, film_of, nodes_of, picture_of, place_in, texts_of

# pictures give hundredths of a px; a place and the two that fix the scale are rounded
PX = 0.02


def joints_of(svg):
    """The place of each joint in the picture, by the names of its coordinates."""
    joints = {}
    for group in svg.iter(SVG + 'g'):
        for name in group.get('data-joint', '').split():
            if group.get('transform'):
                joints[name] = place_in(group.get('transform'))
            else:
                joints[name] = corners_of(group.find(SVG + 'path').get('d')).mean(axis=0)
    return joints


def meeting(a, ra, b, rb, near):
    """The point at the distance ra from a and rb from b, of two the one nearer to a third."""
    d = np.hypot(*(b - a))
    along = (ra ** 2 - rb ** 2 + d ** 2) / (2 * d)
    across = math.sqrt(ra ** 2 - along ** 2)
    e = (b - a) / d
    points = [a + along * e + sign * across * np.array([-e[1], e[0]]) for sign in (1, -1)]
    return min(points, key=lambda point: np.hypot(*(point - near)))


def fig1_joints():
    """The joints of Fig. 1 at the start, q5 = 0.5, from its dimensions and the guesses of its data file."""
    crank, rocker, second = np.array([0.0, 0.0]), np.array([4.0, 0.0]), np.array([-1.0, 2.5])
    a = crank + [math.cos(0.5), math.sin(0.5)]
    b = meeting(a, 3.2, rocker, 2.6, rocker + 2.6 * np.array([math.cos(1.8), math.sin(1.8)]))
    e = (b - a) / 3.2
    c = a + 1.6 * e + 1.2 * np.array([-e[1], e[0]])
    d = meeting(second, 1.8, c, 2.0, second + 1.8 * np.array([math.cos(-1.0), math.sin(-1.0)]))
    return {'q5': crank, 'q6': rocker, 'q1': second, 'q4': a, 'q7': b, 'q3': c, 'q2': d}


def check_similar(checks, drawn, true, first, second, why):
    """Places on a page against true ones, to the right and upwards: the first two fix scale and origin."""
    scale = np.hypot(*(drawn[second] - drawn[first])) / np.hypot(*(true[second] - true[first]))
    for name, place in true.items():
        expected = drawn[first] + scale * (place - true[first]) * [1, -1]
        checks.true(np.abs(drawn[name] - expected).max() < PX * max(1.0, np.abs(place - true[first]).max()
                    / np.abs(true[second] - true[first]).max()), f'{why}: {name} is drawn where it is',
                    f'{drawn[name]} instead of {expected}')


# a slider-crank whose slide is pressed back: the forces of the rod, and of the pin at the right end, point to the right
PRESSED = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=1, 6 /
&load kind='force', link=4, force=-400,0,0 /
&time start=0, end=1, intervals=12 /
&output force_arrows=.true. /
"""


def test_arrows_of_forces_are_in_the_picture(checks, mech9k, tmp_path):
    """The tips of all arrows are inside, in a sketch and in each frame of a page that shows the run."""
    data = tmp_path / 'pressed.nml'
    data.write_text(PRESSED, encoding='utf-8')
    run(mech9k, data, '--sketch', 'pressed.svg', '--animate', 'film.svg', '--quiet', folder=tmp_path)
    for name in ('pressed.svg', 'film.svg'):
        svg = ElementTree.parse(tmp_path / name).getroot()
        _, _, width, height = map(float, svg.get('viewBox').split())
        arrows = [group for group in svg.iter(SVG + 'g') if 'force' in group.get('class', '').split()]
        checks.true(len(arrows) == 4, f'{name}: four arrows', len(arrows))
        ways = [part for arrow in arrows for element in arrow.iter()
                for part in [element.get('d', ''), *element.get('values', '').split(';')] if part.startswith('M')]
        places = np.concatenate([corners_of(way) for way in ways])
        checks.true(places[:, 0].min() >= 0 and places[:, 0].max() <= width and places[:, 1].min() >= 0
                    and places[:, 1].max() <= height, f'{name}: the arrows are inside {width} x {height}',
                    [places.min(axis=0), places.max(axis=0)])


@pytest.mark.parametrize('why, options', (('with a run', []), ('without a run', ['--check'])), ids=('run', 'check'))
def test_fig1_is_drawn_where_it_is(checks, mech9k, tmp_path, why, options):
    path = tmp_path / 'fig1.svg'
    done = run(mech9k, example('fig1'), '--no-write', '--sketch', path, *options)
    checks.equal(done.returncode, 0, f'{why}: done')
    svg = ElementTree.parse(path).getroot()
    check_similar(checks, joints_of(svg), fig1_joints(), 'q5', 'q6', why)
    paths = [group for group in svg.iter(SVG + 'g') if (group.get('class') or '').startswith('trace')]
    checks.equal(len(paths), 0 if options else 2, f'{why}: the paths of its two points, if it moves')
    texts = texts_of(svg)
    checks.true({'P', 'Q', '2', '6', 'q5', 'q1'} <= set(texts), f'{why}: points, links and coordinates have names')
    checks.true(texts.count('Fig. 1: two closed chains, one degree of freedom') == 1, f'{why}: it has its title')


def test_every_link_of_fig1_is_drawn(checks, mech9k, tmp_path):
    path = tmp_path / 'fig1.svg'
    run(mech9k, example('fig1'), '--no-write', '--sketch', path, '--check')
    classes = [(group.get('class') or '').split()[:2] for group in ElementTree.parse(path).getroot().iter(SVG + 'g')]
    checks.equal(sum(words == ['plate', 'sheet'] for words in classes), 2, 'links 3 and 5 are plates')
    checks.equal(sum(words[:1] == ['plate'] for words in classes), 5, 'every link is drawn')
    checks.equal(sum(words[:1] == ['stand'] for words in classes), 3, 'three joints stand on the frame')


def seen(direction, place):
    """A place seen from a direction, z up: to the right and upwards."""
    toward = np.array(direction, float) / np.linalg.norm(direction)
    right = np.cross([0, 0, 1], toward)
    right /= np.linalg.norm(right)
    return np.array([right @ place, np.cross(toward, right) @ place])


@pytest.mark.parametrize('view', ('1,-2,0.7', '-3,0.5,-1', 'iso', 'xy', 'zy', 'xz'))
def test_bricard_from_any_side(checks, mech9d, tmp_path, view):
    """Its pairs at the start are those that the data file gives: every coordinate is zero there."""
    places = {'q1': (0, 0, 0), 'q2': (1, 0, 0), 'q3': (1, -1, 0), 'q4': (1, -1, 1), 'q5': (0, -1, 1), 'q6': (0, 0, 1)}
    path = tmp_path / 'bricard.svg'
    axes = {'xy': [[1, 0, 0], [0, 1, 0]], 'zy': [[0, 0, 1], [0, 1, 0]], 'xz': [[1, 0, 0], [0, 0, 1]]}
    done = run(mech9d, example('bricard'), '--check', '--sketch', path, f'--view={view}')
    checks.equal(done.returncode, 0, f'Bricard from {view}: done')
    if view in axes:
        true = {name: np.array(axes[view]) @ place for name, place in places.items()}
    else:
        direction = (1, -1, 0.8) if view == 'iso' else [float(word) for word in view.split(',')]
        true = {name: seen(direction, place) for name, place in places.items()}
    check_similar(checks, joints_of(ElementTree.parse(path).getroot()), true, 'q1', 'q4', f'Bricard from {view}')


def test_mass_centres_are_marked(checks, mech9d, tmp_path):
    path = tmp_path / 'bricard.svg'
    run(mech9d, example('bricard'), '--check', '--sketch', path)
    svg = ElementTree.parse(path).getroot()
    centres = sum((group.get('class') or '') == 'centre' for group in svg.iter(SVG + 'g'))
    checks.equal(centres, 5, 'mech9d marks the centres of its five bodies')


SCREW = """&mechanism title='screw jack', links=4, coordinates=4 /
&structure cq=1,4 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='helical', axis=0,0,1, pitch=0.05, point=0,0,0.3 /
&pair coordinate=3, links=1,3, kind='prismatic', axis=0,0,1, point=0.2,0,0.3 /
&pair coordinate=4, links=3,4, kind='revolute', axis=1,0,0, point=0.2,0,0.5 /
&point name='T', link=4, position=0.2,0.2,0.6 /
&drive coordinate=1, kind='polynomial', coefficients=0,12 /
&drive coordinate=4, kind='polynomial', coefficients=0,3 /
"""


# a load of every kind that is drawn: on three coordinates, and between points of which three are fixed
LOADS = """&mechanism title='springs and dampers', links=5, coordinates=5 /
&structure cq=1,5 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=1,0.2,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=2,0.8,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, point=2,0.8,0 /
&pair coordinate=5, links=1,5, kind='revolute', axis=0,0,1, point=2.5,-0.8,0 /
&body link=2, mass=1, centre=0.5,0.1,0, inertia=1,1,1,0,0,0 /
&body link=3, mass=1, centre=1.5,0.5,0, inertia=1,1,1,0,0,0 /
&body link=4, mass=1, centre=2,0.8,0, inertia=1,1,1,0,0,0 /
&body link=5, mass=1, centre=2.5,-1.2,0, inertia=1,1,1,0,0,0 /
&load kind='spring', links=1,2, position=0.2,1.3,0, second_position=0.6,0.12,0, stiffness=50, free_length=1 /
&load kind='spring', links=1,3, position=1.1,1.4,0, second_position=1.3,0.38,0, damping=5 /
&load kind='spring', links=1,5, position=1.5,-1.3,0, second_position=2.5,-1.2,0, stiffness=40, free_length=0.9, damping=5 /
&load kind='coordinate', coordinate=1, stiffness=3 /
&load kind='coordinate', coordinate=5, damping=3 /
&load kind='coordinate', coordinate=3, force=3 /
&load kind='coordinate', coordinate=4, stiffness=30, damping=3 /
&initial coordinate=1, position=0 /
&initial coordinate=5, position=0 /
&time end=0.5, intervals=10 /
"""


def test_wall_at_the_fixed_end_of_a_spring(checks, mech9d, tmp_path):
    """The hatched line at the fixed end of a spring goes through that end, and across the spring."""
    nml, path = tmp_path / 'loads.nml', tmp_path / 'loads.svg'
    nml.write_text(LOADS, encoding='utf-8')
    done = run(mech9d, nml, '--no-write', '--quiet', '--sketch', path)
    checks.equal(done.returncode, 0, 'springs and dampers are drawn')
    svg = ElementTree.parse(path).getroot()
    lines = {name: [corners_of(group.find(SVG + 'path').get('d')) for group in svg.iter(SVG + 'g')
                    if (group.get('class') or '').split()[:1] == [name]] for name in ('spring', 'ground')}
    ends = lines['spring'][0][[0, -1]]
    near = min(lines['ground'], key=lambda wall: np.hypot(*(wall.mean(axis=0) - ends[0])))
    checks.near(near.mean(axis=0), ends[0], PX, 'the wall is at the fixed end')
    checks.near((near[1] - near[0]) @ (ends[1] - ends[0]) / np.hypot(*(near[1] - near[0])), 0, 4 * PX, 'and across the spring')


TEXTS = {'loads': LOADS, 'screw': SCREW}
# program, mechanism, and how many symbols of some kinds there are
SYMBOLS = (
    # six legs: universal joint (two bars of a cross), tube and rod, ball
    ('mech9k', 'stewart_gough', {'cross': 12, 'tube': 6, 'ball': 6, 'pin': 0, 'ring': 0, 'block': 0}),
    # two universal joints between two shafts
    ('mech9k', 'double_hooke', {'cross': 4, 'pin': 2, 'ball': 0}),
    # three pairs at E, two at A, one each at O, F, B, G, H; the spring
    ('mech9d', 'andrews', {'ring': 7, 'stand': 3, 'spring': 1, 'ground': 1, 'centre': 7}),
    # crank, pin, and the block with the other pin on a guide of the frame
    ('mech9k', 'slider_crank', {'ring': 3, 'block': 1, 'guide': 1, 'ground': 1, 'hatch': 1, 'stand': 1}),
    # four single hinges, none parallel to another
    ('mech9k', 'bennett', {'pin': 4, 'ring': 0, 'stand': 2}),
    # a wall for each of three fixed ends and that of the spring on the slide, whose guide has its ground besides
    ('mech9d', 'loads', {'spring': 3, 'damper': 3, 'coil': 1, 'cup': 1, 'ground': 5, 'block': 1}),
    ('mech9k', 'screw', {'thread': 1, 'block': 2, 'pin': 1, 'guide': 1}))


@pytest.mark.parametrize('program, name, expected', SYMBOLS, ids=[name for _, name, _ in SYMBOLS])
def test_symbols_of_pairs_and_loads(checks, build, tmp_path, program, name, expected):
    """The numbers of symbols in each picture are those of the pairs of its mechanism."""
    data, path = example(name), tmp_path / 'symbols.svg'
    if name in TEXTS:
        data = tmp_path / 'data.nml'
        data.write_text(TEXTS[name], encoding='utf-8')
    done = run(build.program(program), data, '--no-write', '--quiet', '--sketch', path)
    checks.equal(done.returncode, 0, f'{name}: drawn')
    svg = ElementTree.parse(path).getroot()
    classes = [(group.get('class') or ' ').split()[0:1] for group in svg.iter(SVG + 'g')]
    for kind, count in expected.items():
        checks.equal(classes.count([kind]), count, f'{name}: number of symbols of the kind {kind}')


FOUR_BAR = """&mechanism title='four-bar', links=4, coordinates=4 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=1,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=3,2,HEIGHT /
&pair coordinate=4, links=4,1, kind='revolute', axis=0,0,1, point=3,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0,1 /
"""


def test_far_point_of_an_axis(checks, mech9k, tmp_path):
    """A pair whose point lies far along its axis is the same pair, and is drawn where its links are."""
    nml, path = tmp_path / 'far.nml', tmp_path / 'far.svg'

    def drawn(height, view):
        nml.write_text(FOUR_BAR.replace('HEIGHT', height), encoding='utf-8')
        run(mech9k, nml, '--quiet', '--sketch', path, '--view', view)
        return text_of(path)

    checks.equal(drawn('900', 'iso'), drawn('0', 'iso'), 'a point far off is drawn near')
    joints = joints_of(ElementTree.fromstring(drawn('0.5', 'xz')))
    slope = (joints['q2'] - joints['q3'])[1] / (joints['q4'] - joints['q2'])[0]
    checks.near(slope, 0.5 / 2.0, 1e-3, 'one that is near enough stays where it is')


@pytest.mark.parametrize('program, name, points', (('mech9d', 'double_pendulum', {'A', 'B'}), ('mech9k', 'rsur', {'O', 'A', 'B', 'C'})),
                         ids=('double_pendulum', 'rsur'))
def test_page_has_the_points_of_the_table(checks, build, tmp_path, program, name, points):
    """A page: every frame has the points of the mechanism where the table of the run has them."""
    path, table = tmp_path / 'film.html', tmp_path / 'film.dat'
    done = run(build.program(program), example(name), '--table', table, '--animate', path, '--quiet')
    if not checks.equal(done.returncode, 0, f'{name}: the page is made'):
        return
    html, rows = text_of(path), read_table(text_of(table))
    checks.equal(set(re.findall(r'\w+://[^"\s]*', html)), {'http://www.w3.org/2000/svg'}, f'{name}: nothing from elsewhere')
    markup = re.sub(r'<script>.*</script>', '', html, flags=re.S)
    checks.true(not re.search(r'\b(src|href|@import|url)\s*[=(]', markup), f'{name}: no other file')
    checks.true("default-src 'none'" in markup, f'{name}: and the browser may load none')
    svg = picture_of(html)
    film = film_of(html)
    checks.equal(len(film['times']), len(film['poses']), f'{name}: a pose for each time')
    checks.equal(len(film['poses']), len(rows['t']), f'{name}: a frame for each output')
    checks.near(film['times'], rows['t'], 1e-8, f'{name}: times to nine digits')
    checks.equal(['t'] + film['names'], list(rows), f'{name}: the columns of the table')
    checks.equal(len(film['units']), len(film['names']), f'{name}: with their units')
    values, table_values = np.array(film['values']), np.column_stack([rows[column] for column in film['names']])
    # six digits; the table has more
    checks.true(np.all(np.abs(values - table_values) <= 5.1e-6 * np.abs(table_values)), f'{name}: the values of the table')
    elements = [int(group.get('data-i')) for group in svg.find(f"{SVG}g[@id='scene']")]
    checks.equal(sorted(elements), list(range(1, len(film['items']) + 1)), f'{name}: an element for each item')
    dots = {}
    for group in svg.iter(SVG + 'g'):
        text = group.find(SVG + 'text')
        if text is not None and (text.get('class') or '').startswith('name'):
            dots[text.text] = film['items'][int(group.get('data-i')) - 1]['nodes'][0]
    if not checks.equal(set(dots), set(points), f'{name}: its points'):
        return
    # steps of a width of 1e-5, turned by quaternions of 1e-5: some 1e-5 of the size each
    size = film['unit'] * 1e5
    worst = 0.0
    origin = None
    for frame in range(0, len(film['poses']), 7):
        nodes = nodes_of(film, frame)
        for point, node in dots.items():
            true = np.array([rows[f'{point}.{axis}'][frame] for axis in 'xyz'])
            origin = nodes[node] - true if origin is None else origin
            worst = max(worst, np.abs(nodes[node] - true - origin).max() / size)
    checks.true(worst < 6e-5, f'{name}: points are where the table has them', f'{worst:.1e} of the size away')


def check_clock_strip(checks, svg, times):
    """The clock of a picture without a script: for each frame, the text that is in the window shows its time."""
    window = svg.find(f"{SVG}svg[@id='time']")
    strip = window.find(SVG + 'g')
    shifts = [float(value.split()[1]) for value in strip.find(SVG + 'animateTransform').get('values').split(';')]
    height = float(window.get('height'))
    shown = []
    for shift in shifts:
        seen_texts = [text.text for text in strip.findall(SVG + 'text') if 0 < float(text.get('y')) + shift < height]
        shown.append(float(re.fullmatch(r't = (\S+) s', seen_texts[0]).group(1)) if len(seen_texts) == 1 else math.nan)
    # as many decimals as tell the frames apart, and less than a third of the time between two is lost
    checks.true(len(shown) == len(times) and np.abs(np.array(shown) - times).max() < 0.34 * np.diff(times).min(), 'its clock shows each time', shown)


def test_moving_svg(checks, mech9k, tmp_path):
    path, table = tmp_path / 'film.svg', tmp_path / 'moving.dat'
    run(mech9k, example('slider_crank'), '--table', table, '--quiet', '--animate', path,
        '--set', 'time.intervals=30')
    svg = ElementTree.parse(path).getroot()
    moving = list(svg.iter(SVG + 'animate')) + list(svg.iter(SVG + 'animateTransform'))
    checks.true(len(moving) > 5, 'things move in a picture')
    checks.equal({len(one.get('values').split(';')) for one in moving}, {31}, 'each has a value for each frame')
    checks.equal({(one.get('repeatCount'), one.get('dur')) for one in moving}, {('indefinite', moving[0].get('dur'))},
                 'and all begin again together')
    # a viewer that plays nothing shows what an element says itself
    for group in svg.iter(SVG + 'g'):
        for one in group.findall(SVG + 'animateTransform'):
            checks.equal(group.get('transform'), f"translate({one.get('values').split(';')[0]})", 'a place of its own: the first')
    checks.equal([len(list(svg.find(f"{SVG}g[@id='{name}']"))) for name in ('scale', 'axes')], [2, 4],
                 'a bar with its length, two axes with their names')
    for path in svg.iter(SVG + 'path'):
        for one in path.findall(SVG + 'animate'):
            checks.equal(path.get('d'), one.get('values').split(';')[0], 'a form of its own: the first')
    rows = read_table(text_of(table))
    check_clock_strip(checks, svg, rows['t'])
    for point in 'BM':
        label, = [group for group in svg.iter(SVG + 'g') if group.findtext(SVG + 'text') == point]
        values = label.find(SVG + 'animateTransform').get('values').split(';')
        drawn = np.array([[float(word) for word in value.split()] for value in values])
        true = np.column_stack([rows[point + '.x'], -rows[point + '.y']])
        drawn, true = drawn - drawn[0], true - true[0]
        scale = np.sqrt(np.sum(drawn ** 2) / np.sum(true ** 2))
        checks.true(np.abs(drawn - scale * true).max() < PX, f'{point} moves as in the table, frame after frame')


def test_many_outputs_make_some_hundred_frames(checks, mech9k, tmp_path):
    path = tmp_path / 'long.html'
    run(mech9k, example('fig1'), '--no-write', '--quiet', '--animate', path, '--set', 'time.intervals=5000')
    film = film_of(text_of(path))
    checks.true(200 < len(film['times']) <= 301, 'of many outputs some hundred frames', len(film['times']))
    checks.equal((film['times'][0], film['times'][-1]), (0, 1), 'the first and the last among them')
    checks.true(np.ptp(np.diff(film['times'])[:-1]) < 1e-9, 'evenly in time')


def gif_frames(data):
    """Counts the pictures of a GIF by its blocks."""
    def skip(at):
        while data[at]:
            at += data[at] + 1
        return at + 1
    table = 3 * 2 ** ((data[10] & 7) + 1) if data[10] & 128 else 0
    at, frames = 13 + table, 0
    while data[at] != 0x3b:
        if data[at] == 0x21:
            at = skip(at + 2)
        elif data[at] == 0x2c:
            frames += 1
            at = skip(at + 11 + (3 * 2 ** ((data[at + 9] & 7) + 1) if data[at + 9] & 128 else 0))
        else:
            raise ValueError(f'no GIF at byte {at}')
    return frames


def polygons_of(script):
    """The corners of what gnuplot is told to draw."""
    return [np.array([[float(word) for word in corner.split(',')] for corner in line.split(' to ')])
            for line in re.findall(r'polygon from (\S+(?: to \S+)*)', script)]


def words_of_gif(program, path, data=None):
    """The call that makes a film of Fig. 1, or of another data file, in 21 frames."""
    return [program, data or example('fig1'), '--no-write', '--animate', str(path), '--set', 'time.intervals=20']


def frames_of_gif(checks, program, folder, data=None):
    """The lines by which gnuplot draws each frame."""
    script, fake = folder / 'script', folder / 'gnuplot'
    fake.write_text(f'#!/bin/sh\n"{shutil.which("cat")}" > "{script}"\n', encoding='utf-8')
    fake.chmod(stat.S_IRWXU)
    done = subprocess.run(words_of_gif(program, folder / 'film.gif', data), env=dict(os.environ, PATH=str(folder)),
                          stderr=subprocess.DEVNULL, timeout=60 * PATIENCE)
    checks.equal(done.returncode, 8, 'a gnuplot that draws nothing')
    return text_of(script).split('unset object; unset label\n')[1:]


def test_script_of_a_gif(checks, mech9k, tmp_path):
    """The script for gnuplot: the frames of the whole run, one after the other, each with its own picture."""
    frames = frames_of_gif(checks, mech9k, tmp_path)
    times = [float(re.search(r"set label 't = (\S+) s'", frame).group(1)) for frame in frames]
    # a clock of four digits
    checks.near(times, np.arange(21) / 20, 1e-4, 'its frames follow one another')
    # the bar of the scale: its length on the page against that of the crank, which is 1 m long
    for frame in frames[:2]:
        length = float(re.search(r"set label '(\S+) m'", frame).group(1))
        bars = [corners for corners in polygons_of(frame) if len(corners) == 8 and np.ptp(corners[:, 1]) == 5.0]
        pins = [np.array([float(x), float(y)]) for x, y in re.findall(r'circle at (\S+),(\S+) size 5 ', frame)]
        pixels = np.ptp(bars[0][:, 0]) / length
        checks.true(any(abs(np.hypot(*(a - b)) - pixels) < PX for a in pins for b in pins), 'its scale is that of the crank', pixels)
        checks.true(all(f"set label '{axis}' at" in frame for axis in 'xy') and "set label 'z'" not in frame, 'it has its two axes')
    checks.equal(len({re.sub(r"'t = .*? s'", '', frame) for frame in frames}), 21, 'and no two are alike')


@pytest.mark.parametrize('sense, why', ((-1, 'above a double pendulum'), (1, 'below links that stand upright')))
def test_stand_of_a_gif(checks, mech9k, tmp_path, sense, why):
    """The stand is on the other side of its joint than the links. Pixels of the script count downwards, as those of pages."""
    data = tmp_path / 'two.nml'
    data.write_text(f"""&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0,{sense},0 /
&point name='P', link=3, position=0,{sense},0 /
&drive coordinate=1, kind='polynomial', coefficients=0,0.1 /
&drive coordinate=2, kind='polynomial', coefficients=0,0.1 /
&time start=0, end=1, intervals=20 /
""", encoding='utf-8')
    for frame in frames_of_gif(checks, mech9k, tmp_path, data):
        # the first corner is the joint, the others are its base
        stand = next(corners for corners in polygons_of(frame) if len(corners) == 4 and np.ptp(corners[1:3, 1]) == 0.0 and np.ptp(corners[:, 1]))
        pins = np.array([[float(x), float(y)] for x, y in re.findall(r'circle at (\S+),(\S+) size 5 ', frame)])
        other = pins[np.argmax(np.hypot(*(pins - stand[0]).T))]
        checks.true((stand[1, 1] - stand[0, 1]) * (other[1] - stand[0, 1]) < 0, f'a stand {why}', (stand, other))


def test_no_gif_without_gnuplot(checks, mech9k, tmp_path):
    path = tmp_path / 'film.gif'
    done = subprocess.run(words_of_gif(mech9k, path), env=dict(os.environ, PATH=str(tmp_path)), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True, timeout=60 * PATIENCE)
    checks.equal(done.returncode, 8, 'without gnuplot there is no GIF')
    checks.true('gnuplot' in done.stderr and '.html' in done.stderr, 'which is said, with what to do', done.stderr)
    checks.true(not path.exists(), 'and no file is left')


def test_gif(checks, mech9k, tmp_path):
    if not checks.has('gnuplot', 'gnuplot-nox'):
        return
    path = tmp_path / 'film.gif'
    done = run(*words_of_gif(mech9k, path))
    checks.equal(done.returncode, 0, 'a GIF is made')
    data = path.read_bytes()
    checks.equal(data[:6], b'GIF89a', 'it begins as one')
    checks.equal(gif_frames(data), 21, 'it has a frame for each output')
    checks.true(b'NETSCAPE2.0' in data, 'and repeats')


@pytest.mark.parametrize('ending', ('svg', 'html', 'gif'))
def test_hostile_title(checks, mech9k, tmp_path, ending):
    title = """</title></svg><script>alert(1)</script> & "x" ' `rm -r *` $(rm) \\ %s ]]> <!-- \u00e9"""
    data = re.sub(r"title = '[^']*'", lambda found: "title = '" + title.replace("'", "''") + "'", text_of(example('fig1')))
    nml, path = tmp_path / 'hostile.nml', tmp_path / f"it's $(a) `b`.{ending}"
    nml.write_text(data, encoding='utf-8')
    done = run(mech9k, nml, '--no-write', '--quiet', '--animate', path, '--set', 'time.intervals=3')
    if ending == 'gif':
        checks.true(done.returncode == 0 or 'not here' in done.stderr, 'a GIF takes any title and name', done.stderr)
        return
    checks.equal(done.returncode, 0, f'{ending}: any title will do')
    text = text_of(path)
    checks.true('<script>alert' not in text, f'{ending}: no part of a title is a script')
    svg = picture_of(text)
    # in as many lines as it takes
    checks.true(title in ' '.join(texts_of(svg)), f'{ending}: the title stands as it is')
    checks.equal(svg.findtext(SVG + 'title'), title, f'{ending}: and whole as the name of the picture')


# options, the exit code, and words of the message
REFUSED = (
    (['--sketch', 'a.svg', '--view', 'side'], 2, 'is no view'),
    (['--sketch', 'a.svg', '--view', '0,0,0'], 2, 'is no view'),
    (['--sketch', 'a.svg', '--view', 'xx'], 2, 'is no view'),
    (['--sketch', 'a.svg', '--set', "output.view='1,2'"], 3, 'is no view'),
    (['--animate', 'a.html', '--check'], 2, '--check makes none'),
    (['--animate', 'a.html', '--range'], 2, '--range makes none'),
    (['--sketch', 'a.png'], 2, 'must end in .svg'),
    (['--set', "output.sketch='a'"], 3, 'must end in .svg'),
    (['--animate', 'a.avi'], 2, '.html, .svg, .gif or .mp4'),
    (['--animate', 'a.html', '--animate', 'a.webm'], 2, "'a.webm' is no name of a moving picture"),
    (['--set', "output.animation='a'"], 3, '.html, .svg, .gif or .mp4'),
    (['--sketch', 'nowhere/a.svg'], 8, 'nowhere/a.svg'),
    (['--animate', 'nowhere/a.html'], 8, 'nowhere/a.html'),
    (['--animate', 'nowhere/a.svg'], 8, 'nowhere/a.svg'),
    (['--animate', 'a.svg', '--animate', 'a.svg'], 2, "--animate and --animate cannot both be 'a.svg'"))


@pytest.mark.parametrize('options, code, words', REFUSED, ids=[' '.join(options) for options, _, _ in REFUSED])
def test_refusals(checks, mech9k, tmp_path, options, code, words):
    done = run(mech9k, example('fig1'), '--no-write', '--quiet', *options, folder=tmp_path)
    why = ' '.join(options)
    checks.equal(done.returncode, code, f'{why}: its exit code')
    checks.true(words in done.stderr, f'{why}: says why', done.stderr)
    checks.true('Backtrace' not in done.stderr, f'{why}: no backtrace')


def test_no_place_for_a_gif(checks, mech9k, tmp_path):
    """A film of gnuplot that cannot be opened, and one on a full disk, which gnuplot takes for done."""
    if not checks.has('gnuplot', 'gnuplot-nox'):
        return
    (tmp_path / 'folder.gif').mkdir()
    targets = {'folder.gif': 'Is a directory', 'nowhere/a.gif': 'No such file'}
    if checks.has_full_disk():
        (tmp_path / 'full.gif').symlink_to('/dev/full')
        targets['full.gif'] = 'disk full'
    for target, words in targets.items():
        done = run(mech9k, example('fig1'), '--no-write', '--quiet', '--animate', target, folder=tmp_path)
        checks.equal((done.returncode, done.stdout), (8, ''), f'{target}: its exit code, nothing on standard output')
        checks.true(target in done.stderr and words in done.stderr, f'{target}: says why', done.stderr)


def test_thousand_links(checks, mech9k, tmp_path):
    """A mechanism of a thousand links: a file of some megabytes, in seconds."""
    nml, path = tmp_path / 'large.nml', tmp_path / 'large.html'
    links = 1000
    lines = [f"&mechanism title='chain', links={links}, coordinates={links - 1} /", '&structure cq=1 /'.replace(
        '1', ','.join(str(k) for k in range(1, links)))]
    for k in range(1, links):
        lines.append(f"&pair coordinate={k}, links={k},{k + 1}, kind='revolute', axis=0,0,1, point={int(k > 1)},0,0,"
                     ' moving_point=0,0,0 /')
        lines.append(f"&drive coordinate={k}, kind='polynomial', coefficients=0,{0.001 * (-1) ** k} /")
    lines.append('&time intervals=400 /')
    nml.write_text('\n'.join(lines) + '\n', encoding='utf-8')
    done = run(mech9k, nml, '--no-write', '--quiet', '--sketch', tmp_path / 'large.svg', '--animate', path)
    checks.equal(done.returncode, 0, 'a chain of a thousand links is drawn')
    checks.true(os.path.getsize(path) < 8e6, 'its page has less than 8 MB', os.path.getsize(path))
    svg = ElementTree.parse(tmp_path / 'large.svg').getroot()
    checks.equal(len(joints_of(svg)), links - 1, 'with every joint')
