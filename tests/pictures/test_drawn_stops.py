"""Stops and frictions in pictures and films: a plate where each motion ends, in colour while it pushes, and a mark in pairs that stick.

Where a plate must be follows from the table of the same run: a block, a bar or the mouth of a tube has the gap to it that its coordinate
has to the end of the stop. When it must be coloured follows from the events and the forces of that run.
"""
import json
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
from svg_pictures import SVG, example, film_of, nodes_of, picture_of

# half the length of a block, half the thickness of a plate, that of a plate and a bar, and the distance of a plate from its joint [px]
BLOCK, PLATE, BESIDE, FROM_JOINT = 13.0, 2.7, 7.4, 23.0
# places in films are rounded to a hundred-thousandth of the width, and directions to as much; mechanisms are some m wide
NEAR = 1e-4

SPATIAL = """&mechanism title='crank in space', angle_unit='deg' /
&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0.3,-0.2,1 /
&pair coordinate=2, links=2,3, kind='helical', axis=0.1,1,0, point=0.5,0,0.1, pitch=0.2 /
&pair coordinate=3, links=3,4, kind='prismatic', axis=1,0,0.2, point=0.7,0.1,0 /
&point name='P', link=2, position=0.5,0,0.1 /
&point name='Q', link=4, position=0.9,0.3,0 /
&drive coordinate=1, kind='harmonic', amplitude=40, angular_frequency=3 /
&drive coordinate=2, kind='harmonic', amplitude=300, angular_frequency=3 /
&drive coordinate=3, kind='harmonic', amplitude=0.2, angular_frequency=3 /
&stop coordinate=1, low=-45, high=50 /
&stop coordinate=2, low=-360, stiffness=10 /
&stop coordinate=3, low=-0.22, high=0.3 /
&time end=2, intervals=40 /
"""


class Film:
    """A film and the table of its run."""

    def __init__(self, checks, program, data, folder, *options):
        page, table, report = folder / 'film.html', folder / 'film.dat', folder / 'film.json'
        done = run(program, data, '--quiet', '--animate', page, '--table', table, '--report', report, *options)
        checks.equal(done.returncode, 0, f'the film is made; {done.stderr}')
        self.film, rows = film_of(text_of(page)), read_table(text_of(table))
        # a film has a frame for some of the rows
        kept = np.abs(rows['t'][:, None] - self.film['times']).argmin(axis=0)
        self.rows = {name: column[kept] for name, column in rows.items()}
        self.svg, self.events = picture_of(text_of(page)), json.loads(text_of(report)).get('events', [])
        self.groups = {int(group.get('data-i')): group for group in self.svg.iter(SVG + 'g') if group.get('data-i')}
        self.places = [nodes_of(self.film, frame) for frame in range(len(self.film['times']))]
        self.px = self.film['symbol'] / self.film['scale']          # in m

    def items(self, kind):
        """The numbers of the items of a kind."""
        return [i for i, group in sorted(self.groups.items()) if (group.get('class') or '').split()[:1] == [kind]]

    def plates(self):
        """The numbers of all plates by their names: those that are always shown."""
        return {self.groups[i].findtext(SVG + 'title'): i for i in self.items('stop')}

    def middle(self, i):
        """The middle of an item in each frame [m]."""
        return np.array([places[self.film['items'][i - 1]['nodes']].mean(axis=0) for places in self.places])

    def node(self, i, which):
        """A node of an item in each frame [m]."""
        return np.array([places[self.film['items'][i - 1]['nodes'][which]] for places in self.places])

    def joint(self, names):
        """The number of the item that shows a joint."""
        return next(i for i, group in sorted(self.groups.items()) if group.get('data-joint') == names)

    def shown(self, i):
        """Whether an item is shown in each frame."""
        return np.array([letter == '1' for letter in self.film['holds'][self.film['items'][i - 1]['state'] - 1]])


def of_picture(checks, program, data, path, *options):
    done = run(program, data, '--no-write', '--quiet', '--sketch', path, *options)
    checks.equal(done.returncode, 0, f'it is drawn; {done.stderr}')
    return ElementTree.parse(path).getroot()


def classes_in(svg):
    return [(group.get('class') or ' ').split()[:1] for group in svg.iter(SVG + 'g')]


def test_block_meets_its_plate(checks, mech9d, tmp_path):
    film = Film(checks, mech9d, example('bouncing_slider'), tmp_path)
    plates = film.plates()
    checks.equal(list(plates), ['stop 1: low end of q1 at 0 m'], 'one plate, with its name')
    apart = np.linalg.norm(film.middle(film.joint('q1')) - film.middle(plates['stop 1: low end of q1 at 0 m']), axis=1)
    checks.near(apart - (BLOCK + PLATE) * film.px, film.rows['q1'], NEAR, 'the block has the gap to the plate that it has to the stop')
    checks.true(not np.ptp(film.middle(film.items('stop')[0]), axis=0).any(), 'and the plate stands still')


def test_bar_meets_its_plate(checks, mech9d, tmp_path):
    film = Film(checks, mech9d, example('four_bar_stop'), tmp_path)
    plate, joint = film.plates()['stop 1: high end of q4 at 2.4 rad'], film.joint('q4')
    around = film.middle(plate) - film.middle(joint)
    checks.near(np.arctan2(around[:, 1], around[:, 0]), 2.4 + math.atan(BESIDE / FROM_JOINT), 1e-3, 'the plate is beyond the angle of the stop')
    bar, = [i for i in film.items('plate') if 'l3' in film.groups[i].get('class').split()]
    ends = [film.node(bar, n)[-1] for n in range(2)]
    foot, other = sorted(ends, key=lambda end: np.hypot(*(end - film.middle(joint)[-1])[:2]))
    along = (other - foot) / np.linalg.norm(other - foot)
    across = film.middle(plate)[-1] - foot
    checks.near(np.linalg.norm(across - across @ along * along) / film.px, BESIDE, 0.02, 'at rest the bar touches the plate')


def test_stops_in_space(checks, mech9k, tmp_path):
    """On a pair that turns, one on a thread, and one that slides, whose links all move."""
    data = tmp_path / 'space.nml'
    data.write_text(SPATIAL, encoding='utf-8')
    film = Film(checks, mech9k, data, tmp_path)
    plates = film.plates()
    checks.equal(sorted(plates), ['stop 1: high end of q1 at 50 deg', 'stop 1: low end of q1 at -45 deg', 'stop 2: low end of q2 at -360 deg',
                                  'stop 3: high end of q3 at 0.3 m', 'stop 3: low end of q3 at -0.22 m'], 'each end has its plate')
    for name, joint, gap in (('stop 2: low end of q2 at -360 deg', 'q2', 0.2 * (film.rows['q2'] / 360 + 1)),
                             ('stop 3: high end of q3 at 0.3 m', 'q3', 0.3 - film.rows['q3']),
                             ('stop 3: low end of q3 at -0.22 m', 'q3', 0.22 + film.rows['q3'])):
        apart = np.linalg.norm(film.middle(film.joint(joint)) - film.middle(plates[name]), axis=1)
        checks.near(apart - (BLOCK + PLATE) * film.px, gap, NEAR, f'{name}: the gap of the block')
    # the bar of link 2 from the origin to P is across the axis by less than its length; seen along the axis it turns by q1
    axis = np.array([0.3, -0.2, 1]) / math.hypot(0.3, 0.2, 1)
    origin = film.middle(film.joint('q1'))[0]
    label, = [i for i, group in film.groups.items() if group.findtext(SVG + 'text') == 'P']
    for end, value in (('high', 50), ('low', -45)):
        at = film.middle(plates[f'stop 1: {end} end of q1 at {value} deg'])[0] - origin
        for frame in (0, 7, 21):
            bar = film.middle(label)[frame] - origin
            bar = bar - bar @ axis * axis
            between = math.degrees(math.atan2(np.cross(bar, at) @ axis, bar @ at))
            beyond = math.copysign(math.degrees(math.atan(BESIDE / FROM_JOINT)), value)
            checks.near(between, value + beyond - film.rows['q1'][frame], 0.05, f'{end} end: the angle that is left')


def test_rod_has_a_collar_and_a_piston(checks, mech9k, tmp_path):
    data = tmp_path / 'lift.nml'
    data.write_text(text_of(example('hydraulic_lift')) + '&stop coordinate=3, low=0.6, high=1.1 /\n', encoding='utf-8')
    film = Film(checks, mech9k, data, tmp_path)
    plates = film.plates()
    mouth = film.node(film.items('tube')[0], 1)
    for name, gap in (('stop 1: low end of q3 at 0.6 m', film.rows['q3'] - 0.6), ('stop 1: high end of q3 at 1.1 m', 1.1 - film.rows['q3'])):
        apart = np.linalg.norm(film.middle(plates[name]) - mouth, axis=1)
        checks.near(apart - PLATE * film.px, gap, NEAR, f'{name}: its gap to the mouth of the tube')
    tube = film.node(film.items('tube')[0], 0)
    inside = np.einsum('ij,ij->i', film.middle(plates['stop 1: high end of q3 at 1.1 m']) - tube, mouth - tube)
    checks.true(inside.min() > 0, 'the piston never leaves the tube behind', inside.min())


def test_far_stops_are_not_drawn(checks, mech9d, tmp_path):
    """A stop that is far away would make the mechanism small."""
    drawn = {}
    for low in ('-0.8', '-50'):
        svg = of_picture(checks, mech9d, example('bouncing_slider'), tmp_path / 'far.svg', '--set', f'stop(1).low={low}', '--check')
        drawn[low] = classes_in(svg).count(['stop'])
    checks.equal(drawn, {'-0.8': 1, '-50': 0}, 'a near stop is drawn, a far one is not')


@pytest.mark.parametrize('numbers, buffers', (('restitution=0.5', 0), ('stiffness=1e4', 1)), ids=('rigid', 'compliant'))
def test_rigid_and_compliant(checks, mech9d, tmp_path, numbers, buffers):
    data = tmp_path / 'data.nml'
    data.write_text(text_of(example('bouncing_slider')).replace('restitution=0.9', numbers), encoding='utf-8')
    classes = classes_in(of_picture(checks, mech9d, data, tmp_path / 'kind.svg'))
    checks.equal([classes.count([kind]) for kind in ('stop', 'spring', 'hatch', 'pushed')], [1, buffers, 2, 0],
                 'a plate, hatched, and a buffer where it is compliant; no colour in a sketch')


def test_stops_are_coloured_while_they_push(checks, mech9d, tmp_path):
    film = Film(checks, mech9d, example('four_bar_stop'), tmp_path)
    pushed, = film.items('pushed')
    shown, times = film.shown(pushed), film.rows['t']
    checks.true(shown[film.rows['S1'] != 0].all(), 'while it pushes')
    impacts = [event['time'] for event in film.events if event['kind'] == 'impact']
    checks.true(len(impacts) > 3 and all(shown[np.searchsorted(times, time)] for time in impacts), 'and in the frame after each impact')
    some = np.array([any(time <= t < time + 0.06 for time in impacts) for t in times]) | (film.rows['S1'] != 0)
    checks.true(not shown[~some].any(), 'and not otherwise', times[shown & ~some])
    checks.equal(film.groups[pushed].findtext(SVG + 'title'), 'stop 1: high end of q4 at 2.4 rad, pushed', 'it says so')
    joints = {group.get('data-joint') for group in film.groups.values()} - {None}
    checks.equal(joints, {'q1', 'q2', 'q3', 'q4'}, 'plates are no joints')


def test_stuck_pairs_are_marked(checks, mech9d, tmp_path):
    film = Film(checks, mech9d, example('block_on_belt'), tmp_path)
    mark, = film.items('stuck')
    checks.equal(list(film.shown(mark) ^ (film.rows['dq2'] == 0)).count(True), 0, 'the block is marked while it sticks to the belt')
    checks.true(10 < film.shown(mark).sum() < len(film.places) - 10, 'which it does for a part of the time', film.shown(mark).sum())
    checks.near(film.middle(mark), film.middle(film.joint('q2')), NEAR, 'the mark is in the block')
    checks.equal(film.groups[mark].findtext(SVG + 'title'), 'friction 1: q2 sticks', 'and says what it means')


def test_smooth_friction_never_sticks(checks, mech9d, tmp_path):
    data = tmp_path / 'smooth.nml'
    data.write_text(text_of(example('block_on_belt')).replace('static=0.3, dynamic=0.2', "dynamic=0.2, law='smooth', transition=1e-3"), encoding='utf-8')
    checks.equal(Film(checks, mech9d, data, tmp_path).items('stuck'), [], 'no mark')


def test_moving_svg_shows_states(checks, mech9d, tmp_path):
    film = Film(checks, mech9d, example('four_bar_stop'), tmp_path)
    run(mech9d, example('four_bar_stop'), '--no-write', '--quiet', '--animate', tmp_path / 'film.svg')
    svg = ElementTree.parse(tmp_path / 'film.svg').getroot()
    group, = [one for one in svg.iter(SVG + 'g') if one.get('visibility')]
    values = group.find(SVG + 'animate').get('values').split(';')
    checks.equal([value == 'visible' for value in values], film.shown(film.items('pushed')[0]).tolist(), 'the frames are those of the page')
    checks.equal(group.get('visibility'), 'hidden', 'what plays nothing shows the first one')


def test_gif_shows_states(checks, mech9d, tmp_path):
    script, fake = tmp_path / 'script', tmp_path / 'gnuplot'
    fake.write_text(f'#!/bin/sh\n"{shutil.which("cat")}" > "{script}"\n', encoding='utf-8')
    fake.chmod(stat.S_IRWXU)
    subprocess.run([mech9d, example('four_bar_stop'), '--no-write', '--animate', str(tmp_path / 'film.gif'), '--set', 'time.intervals=40'],
                   env=dict(os.environ, PATH=str(tmp_path)), stderr=subprocess.DEVNULL, timeout=60 * PATIENCE)
    frames = text_of(script).split('unset object; unset label\n')[1:]
    red = ['#d0001f' in frame for frame in frames]
    checks.true(not red[0] and red[-1], 'the plate is coloured at the end alone', red)
    plates = [len(re.findall('fc rgb "#d9d9d9"', frame)) for frame in frames]
    checks.equal(set(plates), {1}, 'and is always there')


def test_states_on_a_page(checks, browser, mech9d, tmp_path):
    """The script of a page shows and hides what holds for a time."""
    film = Film(checks, mech9d, example('block_on_belt'), tmp_path)
    mark, = film.items('stuck')
    browser.resize(1280, 860, still=True)
    browser.open(tmp_path / 'film.html')
    seen = browser.value(f'film.times.map((t, i) => (show(i), getComputedStyle(document.querySelector("[data-i=\'{mark}\']")).visibility))')
    checks.equal([one == 'visible' for one in seen], film.shown(mark).tolist(), 'in each frame')
    checks.equal(browser.errors, [], 'nothing on the console')


def test_nothing_without_stops(checks, mech9k, tmp_path):
    film = Film(checks, mech9k, example('fig1'), tmp_path)
    checks.equal((film.items('stop'), film.items('pushed'), film.film['holds']), ([], [], []), 'a mechanism without stops has none')
