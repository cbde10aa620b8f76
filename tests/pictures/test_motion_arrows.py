"""Arrows of velocities and accelerations: each begins in its point, and has the direction and, beside the longest one, the length that the
columns of the same run give. The velocity pole of a coupler is drawn where the lines of crank and rocker meet.
"""
from xml.etree import ElementTree

import numpy as np
import pytest

from mech9_cases import read_table, run, text_of
from svg_pictures import SVG, corners_of, example, film_of, nodes_of, picture_of


def arrows_of(text):
    """By their titles: (frames, 3) feet and (frames, 3) ways [m]."""
    film, svg = film_of(text), picture_of(text)
    places = [nodes_of(film, frame) for frame in range(len(film['times']))]
    found = {}
    for group in svg.iter(SVG + 'g'):
        if (group.get('class') or '') in ('velocity', 'acceleration', 'force'):
            nodes = film['items'][int(group.get('data-i')) - 1]['nodes']
            ends = np.array([place[nodes[:2]] for place in places])
            found[group.findtext(SVG + 'title')] = ends[:, 0], ends[:, 1] - ends[:, 0]
    return film, found


@pytest.mark.parametrize('name', ('slider_crank', 'rssr_function', 'stewart_gough'))
def test_arrows_are_rates_of_points(checks, mech9k, tmp_path, name):
    data = tmp_path / 'case.nml'
    data.write_text(text_of(example(name)).replace("file='", f"file='{example(name).rsplit('/', 1)[0]}/"), encoding='utf-8')
    done = run(mech9k, data, '--quiet', '--animate', 'film.html', '--table', 'film.dat', '--set', 'output.velocity_arrows=.true.',
               '--set', 'output.acceleration_arrows=.true.', folder=tmp_path)
    checks.equal(done.returncode, 0, f'{name}: {done.stderr}')
    film, arrows = arrows_of(text_of(tmp_path / 'film.html'))
    rows = read_table(text_of(tmp_path / 'film.dat'))
    kept = np.abs(rows['t'][:, None] - film['times']).argmin(axis=0)
    points = sorted({column[:-2] for column in rows if column.endswith('.x')})
    checks.true(set(arrows) >= {f'velocity of {point}' for point in points if rows[point + '.vx'].any()}, f'{name}: all points', arrows)
    for kind, letter in (('velocity', 'v'), ('acceleration', 'a')):
        true = {point: np.column_stack([rows[f'{point}.{letter}{axis}'][kept] for axis in 'xyz']) for point in points}
        greatest = max(np.linalg.norm(value, axis=1).max() for value in true.values())
        drawn = {point: arrows[f'{kind} of {point}'] for point in points if f'{kind} of {point}' in arrows}
        longest = max(np.linalg.norm(way, axis=1).max() for _, way in drawn.values())
        for point, (foot, way) in drawn.items():
            checks.near(way / longest, true[point] / greatest, 2e-3, f'{name}: {kind} of {point}')
            place = np.column_stack([rows[f'{point}.{axis}'][kept] for axis in 'xyz'])
            checks.near(foot - foot[0], place - place[0], 2e-4, f'{name}: it begins in {point}', scale=1.0)


def test_longest_arrow(checks, mech9k, tmp_path):
    """The longest arrow of each kind is 0.22 of the diagonal of the box around pairs and points at the start."""
    done = run(mech9k, example('slider_crank'), '--quiet', '--animate', 'film.html', '--table', 'film.dat', '--set',
               'output.velocity_arrows=.true.', '--set', 'output.acceleration_arrows=.true.', folder=tmp_path)
    checks.equal(done.returncode, 0, done.stderr)
    arrows = arrows_of(text_of(tmp_path / 'film.html'))[1]
    first = {name: values[0] for name, values in read_table(text_of(tmp_path / 'film.dat')).items()}
    upmost = max(0.3 * np.sin(first['q1']), first['B.y'], first['M.y'])
    for kind in ('velocity', 'acceleration'):
        longest = max(np.linalg.norm(way, axis=1).max() for name, (_, way) in arrows.items() if name.startswith(kind))
        checks.near(longest, 0.22 * np.hypot(first['B.x'], upmost), 1e-3, f'{kind}: the longest arrow')


def test_arrows_without_recorded_rates(checks, mech9k, tmp_path):
    """Arrows do not need columns of rates."""
    films = []
    for order in ('0', '2'):
        done = run(mech9k, example('slider_crank'), '--quiet', '--no-write', '--animate', 'film.html', '--set',
                   'output.acceleration_arrows=.true.', '--set', f'output.derivatives={order}', folder=tmp_path)
        checks.equal(done.returncode, 0, f'derivatives={order}: {done.stderr}')
        films.append(arrows_of(text_of(tmp_path / 'film.html'))[1])
    checks.equal(sorted(films[0]), ['acceleration of B', 'acceleration of M'], 'both points')
    for name in films[1]:
        checks.near(films[0][name][1], films[1][name][1], 1e-4, f'{name}: the same arrows', scale=1.0)


def test_arrows_are_inside(checks, mech9d, tmp_path):
    """A picture has room for its arrows, in both programs; a check has none and says so."""
    done = run(mech9d, example('pendulum'), '--quiet', '--no-write', '--sketch', 'a.svg', '--animate', 'b.svg', '--set',
               'output.velocity_arrows=.true.', '--set', 'output.acceleration_arrows=.true.', folder=tmp_path)
    checks.equal(done.returncode, 0, done.stderr)
    for name in ('a.svg', 'b.svg'):
        svg = ElementTree.parse(tmp_path / name).getroot()
        width, height = map(float, svg.get('viewBox').split()[2:])
        arrows = [group for group in svg.iter(SVG + 'g') if (group.get('class') or '') in ('velocity', 'acceleration')]
        checks.true(len(arrows) > 1, f'{name}: arrows', len(arrows))
        ways = [part for arrow in arrows for element in arrow.iter()
                for part in [element.get('d', ''), *element.get('values', '').split(';')] if part.startswith('M')]
        places = np.concatenate([corners_of(way) for way in ways])
        checks.true((places >= 0).all() and (places <= [width, height]).all(), f'{name}: they are inside')
    done = run(mech9d, example('pendulum'), '--check', '--sketch', 'c.svg', '--set', 'output.velocity_arrows=.true.', folder=tmp_path)
    checks.true('without effect: velocity_arrows' in done.stderr, 'a check makes no run', done.stderr)


def test_velocity_poles(checks, mech9k, tmp_path):
    """The pole of the coupler is on both lines, and is hidden where it is far away; a sketch and an SVG film have it, too."""
    done = run(mech9k, example('four_bar_homework'), '--quiet', '--no-write', '--animate', 'film.html', '--animate', 'film.svg', '--sketch',
               'start.svg', folder=tmp_path)
    checks.equal(done.returncode, 0, done.stderr)
    text = text_of(tmp_path / 'film.html')
    film, svg = film_of(text), picture_of(text)
    pole, = [group for group in svg.iter(SVG + 'g') if group.get('class') == 'pole']
    checks.equal(pole.findtext(SVG + 'title'), 'velocity pole of link 3 (coupler)', 'named under the pointer')
    item = film['items'][int(pole.get('data-i')) - 1]
    shown = np.array([letter == '1' for letter in film['holds'][item['state'] - 1]])
    places = [nodes_of(film, frame) for frame in range(len(film['times']))]
    joints = {group.get('data-joint'): film['items'][int(group.get('data-i')) - 1]['nodes'][0] for group in svg.iter(SVG + 'g')
              if group.get('data-joint')}
    rings = [np.array([place[joints[name]][:2] for place in places]) for name in ('q1', 'q2', 'q3', 'q4')]
    at = np.array([place[item['nodes'][0]][:2] for place in places])
    for foot, end, name in ((rings[0], rings[1], 'crank'), (rings[3], rings[2], 'rocker')):
        along = (end - foot) / np.linalg.norm(end - foot, axis=1)[:, None]
        off = along[:, 0] * (at - foot)[:, 1] - along[:, 1] * (at - foot)[:, 0]
        # places are rounded to a hundred-thousandth of the width, and lines of 40 mm are seen over 200 mm
        checks.true(np.abs(off[shown]).max() < 1e-4, f'it is on the line of the {name}', np.abs(off[shown]).max())
    _, _, width, height = map(float, svg.get('viewBox').split())
    page = np.array(film['middle']) + film['scale'] * at * [1, -1]
    inside = (page > 0).all(axis=1) & (page < [width, height]).all(axis=1)
    checks.true(10 < shown.sum() < len(shown) - 10, 'it is shown in some frames', shown.sum())
    checks.true((inside[shown]).all(), 'only on the page')
    first = [group for group in ElementTree.parse(tmp_path / 'start.svg').getroot().iter(SVG + 'g') if group.get('class') == 'pole']
    checks.equal(len(first), int(shown[0]), 'the sketch shows it if it is on the page')
    moving = [group for group in ElementTree.parse(tmp_path / 'film.svg').getroot().iter(SVG + 'g') if group.get('class') == 'pole']
    checks.equal(len(moving), 1, 'the SVG that moves has it')
