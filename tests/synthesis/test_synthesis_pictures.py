"""Pictures of the best design of a search: plots of targets and result, whose numbers are those of a run of the design; drawings and films
with the places of the targets; requests that cannot be met.
"""
import os
import re
import shutil

import numpy as np
import pytest

from mech9_cases import TREE, read_table, run, text_of
from plot_texts import check_apart, texts_of

DONE, USAGE = 0, 2
FOLDER = os.path.join(TREE, 'examples', 'timed_path')
SPATIAL = """&objective kind='path', point='B', file='targets.dat', timing='given' /
&parameter name='height', sets='pair(7).point(3)', low=-0.3, high=0.1 /
&optimum starts=1 /
"""


class Cases:
    def __init__(self, checks, folder, program):
        self.checks, self.folder, self.program = checks, folder, program
        self.text = text_of(os.path.join(FOLDER, 'timed_path.nml')).replace('starts=20', 'starts=2')
        shutil.copy(os.path.join(FOLDER, 'eighteen_points.dat'), folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, text, name='case.nml'):
        with open(self.path(name), 'w', encoding='utf-8') as file:
            file.write(text)
        return self.path(name)

    def search(self, text, *more, why, code=DONE):
        done = run(self.program, self.write(text), '--optimize', *more, folder=self.folder)
        self.checks.true(done.returncode == code, f'{why}: ends with {code}', f'{done.returncode}: {done.stderr}')
        return done

    def table(self, name, *options):
        done = run(self.program, self.path(name), '--table', self.path('run.dat'), '--quiet', *options, folder=self.folder)
        self.checks.true(done.returncode == DONE, f'{name} runs', done.stderr)
        return read_table(text_of(self.path('run.dat')))


@pytest.fixture
def cases(checks, tmp_path, mech9k):
    return Cases(checks, tmp_path, mech9k)


def blocks_of(script):
    """The numbers of each block of data in a script of gnuplot."""
    blocks = {}
    for name, body in re.findall(r'^\$(\w+) << end_of_data\n(.*?)end_of_data$', script, re.M | re.S):
        blocks[name] = np.array([[float(word) for word in line.split()] for line in body.splitlines()])
    return blocks


def test_plot_of_a_path(cases):
    """The plot of a path: its curve, the targets, and the places at their times are those of a run of the best design."""
    check = cases.checks
    done = cases.search(cases.text, '--plot', cases.path('fit.svg') + ':', '--plot', cases.path('again.svg') + ':P', '--out', cases.path('best.nml'), why='path')
    check.true('fit.svg, drawn by ' in done.stderr or 'gnuplot is not here' in done.stderr, 'path: the plot is told', done.stderr)
    check.true(done.stdout == '', 'path: there is no table where plots are asked for', done.stdout)
    script = text_of(cases.path('fit.gp'))
    blocks = blocks_of(script)
    check.equal(blocks_of(text_of(cases.path('again.gp'))).keys(), blocks.keys(), 'path: the objective by its name')
    points = np.loadtxt(os.path.join(FOLDER, 'eighteen_points.dat'))
    check.true(np.array_equal(blocks['targets1'][:, :2], points[:, 1:]), 'path: the targets are those of the file')
    check.true(np.array_equal(blocks['targets1'][:, 4], np.arange(1, 19)), 'path: with their numbers')
    made = cases.table('best.nml', '--set', 'time.intervals=720')
    check.near(blocks['curve1'], np.transpose([made['P.x'], made['P.y']]), 1e-12, 'path: the curve is that of a run of the best design')
    reached = blocks['curve1'][::40][:18]
    check.near(blocks['reached1'][:, :2], reached, 1e-12, 'path: the places at the times of the targets')
    check.near(blocks['gaps1'][:, 2:], reached - points[:, 1:], 1e-12, 'path: the gaps lead there')
    for words in ("set xlabel 'P.x [m]'", "set ylabel 'P.y [m]'", 'set size ratio -1', "title 'best design'", "title 'targets'"):
        check.true(words in script, f'path: {words}')
    if 'gnuplot is not here' not in done.stderr:
        picture = text_of(cases.path('fit.svg'))
        check.true(all(f'>{number}<' in re.sub(r'\s+', '', picture) for number in range(1, 19)), 'path: the picture has all numbers')
        letters = cases.search(cases.text, '--plot', 'term', '--quiet', why='terminal').stdout
        check.true('P and its 18 targets' in letters and '*' in letters, 'path: in the terminal', letters)


def test_plot_of_a_function(cases):
    """The plot of a function: its curve, and the differences at the targets, in the unit of the results."""
    check = cases.checks
    angles = np.linspace(10.0, 170.0, 9)
    np.savetxt(cases.path('targets.dat'), np.transpose([angles, 60.0 + 0.2*angles]))
    text = cases.text.replace("kind='path', point='P', file='eighteen_points.dat', timing='given'",
                              "kind='function', of='q4', over='q1', file='targets.dat'")
    cases.search(text, '--plot', cases.path('fit.svg') + ':q4', '--out', cases.path('best.nml'), '--table', cases.path('designs.dat'), why='function')
    blocks = blocks_of(text_of(cases.path('fit.gp')))
    check.near(blocks['targets1'][:, 0], angles, 1e-13, 'function: the variable')
    check.near(blocks['targets1'][:, 1], 60.0 + 0.2*angles, 1e-13, 'function: its values')
    made = cases.table('best.nml', '--set', 'time.intervals=720')
    check.near(blocks['curve1'], np.transpose([made['q1'], made['q4']]), 1e-12, 'function: the curve is that of a run')
    check.near(blocks['targets2'][:, 1], blocks['reached1'][:, 1] - blocks['targets1'][:, 1], 1e-12, 'function: the differences')
    if shutil.which('gnuplot'):
        texts = texts_of(cases.path('fit.svg'))
        check_apart(check, texts, 'function')
        check.true({'best design', 'targets', 'best design less target'} <= {text.words for text in texts}, 'function: legends')
    value = np.sum(np.radians(blocks['targets2'][:, 1])**2)
    check.near(value/read_table(text_of(cases.path('designs.dat')))['value'][0], 1, 1e-7, 'function: their squares are the value')


def test_numbers_of_many_poses(cases):
    """Fifty poses close to each other: the numbers that are written do not cover each other, and the first and the last one are there."""
    check = cases.checks
    part = np.linspace(0, 1, 50)
    np.savetxt(cases.path('poses.dat'), np.transpose([2.2*part, 2 + 0.9*np.sin(1.7*part), 20 - 45*part]))
    text = text_of(os.path.join(TREE, 'examples', 'three_poses', 'three_poses.nml')).replace('starts=20', 'starts=1')
    done = cases.search(text, '--plot', cases.path('fit.svg') + ':', why='poses')
    shown = blocks_of(text_of(cases.path('fit.gp')))['numbers1'][:, 2]
    check.true(shown[0] == 1 and shown[-1] == 50 and 10 < len(shown) < 40, 'poses: first and last one', shown)
    if 'gnuplot is not here' in done.stderr:
        return
    # numbers are written in a font of 10 px, whose digits are at most 7 px wide
    places = [(float(x), float(y), number) for x, y, number in
              re.findall(r'translate\(([-\d.]+),([-\d.]+)\)"[^>]*font-size="10.00"[^>]*>\s*<text>\s*(\d+)</text>', text_of(cases.path('fit.svg')))]
    check.equal([float(number) for _, _, number in places], list(shown), 'poses: the numbers of the picture')
    covered = [(a, b) for i, a in enumerate(places) for b in places[:i]
               if abs(a[0] - b[0]) < 3.5*(len(a[2]) + len(b[2])) and abs(a[1] - b[1]) < 10]
    check.equal(covered, [], 'poses: no number covers another one')


def test_plots_of_a_path_in_space(cases):
    """A path in space has three planes."""
    text = text_of(os.path.join(TREE, 'examples', 'rsur', 'rsur.nml')).replace('axis=1,0,0, point=0.3', 'axis=1,0,0.01, point=0.3')
    cases.write(text, 'rsur.nml')
    made = cases.table('rsur.nml')
    rows = np.transpose([made['t'], made['B.x'], made['B.y'], made['B.z']])[::10]
    np.savetxt(cases.path('targets.dat'), rows, fmt='%.17g')
    cases.search(text + SPATIAL, '--plot', cases.path('space.svg') + ':', '--animate', cases.path('space.html'), why='spatial')
    blocks = blocks_of(text_of(cases.path('space.gp')))
    for number, axes in ((1, [1, 2]), (2, [1, 3]), (3, [2, 3])):
        cases.checks.near(blocks[f'targets{number}'][:, :2], rows[:, axes], 1e-14, f'spatial: targets in plane {number}')
        cases.checks.near(blocks[f'reached{number}'][:, :2], rows[:, axes], 1e-8, f'spatial: met in plane {number}')


def test_sketch_and_film_show_the_best_design(cases):
    """Sketch and film show the best design, with the targets where they are."""
    check = cases.checks
    files = [cases.path(name) for name in ('best.svg', 'best.html', 'film.svg')]
    done = cases.search(cases.text, '--sketch', files[0], '--animate', files[1], '--out', cases.path('best.nml'), why='drawings')
    check.true('sketch: ' in done.stderr and 'animation: ' in done.stderr, 'drawings are told', done.stderr)
    cases.search(cases.text, '--animate', files[2], '--quiet', why='film')
    sketch = text_of(files[0])
    names = re.findall(r'<text class="name">(.*?)</text>', sketch)
    check.equal(sorted(names), sorted(['P'] + [str(i) for i in range(1, 19)]), 'sketch: names of the point and the targets')
    # 1 m in the picture, from its scale; then targets 1 and 9 are as far from each other as in the file
    dots = [tuple(float(x) for x in place) for place in
            re.findall(r'<g class="dot[^"]*"[^>]*transform="translate\(([-\d.]+) ([-\d.]+)\)', sketch)]
    points = np.loadtxt(os.path.join(FOLDER, 'eighteen_points.dat'))[:, 1:]
    check.true(len(dots) == 19, 'sketch: a dot for each', len(dots))
    places = np.array(dots[-18:]) if len(dots) == 19 else np.zeros((18, 2))
    scale = np.ptp(places[:, 0])/np.ptp(points[:, 0])
    shifted = places/scale*[1, -1]
    check.near(shifted - shifted.mean(axis=0), points - points.mean(axis=0), 1e-3, 'sketch: the dots are the targets, to a hundredth of a px')
    own = run(cases.program, cases.path('best.nml'), '--sketch', cases.path('own.svg'), '--quiet', '--no-write')
    check.true(own.returncode == DONE and '>q1<' in sketch, 'sketch: of the mechanism', own.stderr)
    for film in files[1:]:
        check.true(os.path.getsize(film) > 10000 and '18' in text_of(film), f'film: {os.path.basename(film)}')


def test_drawings_show_poses(cases):
    """Each pose is an arrow from its place along the x axis of the link, and the link has the same arrow."""
    check = cases.checks
    folder = os.path.join(TREE, 'examples', 'three_poses')
    text = text_of(os.path.join(folder, 'three_poses.nml')).replace('starts=20', 'starts=2')
    poses = np.array([line.split()[:3] for line in text_of(os.path.join(folder, 'poses.dat')).splitlines()
                      if line.strip() and line.lstrip()[0] not in '#!'], float)
    np.savetxt(cases.path('poses.dat'), poses)
    cases.search(text, '--sketch', cases.path('best.svg'), '--animate', cases.path('best.html'), why='poses')
    sketch = text_of(cases.path('best.svg'))
    found = re.findall(r'<g class="target" data-i="\d+"><title>pose (\d+) of link 3</title><path d="([^"]*)"', sketch)
    check.equal([int(number) for number, _ in found], [1, 2, 3], 'poses: each is drawn, and named under the pointer')
    lines = np.array([[[float(x) for x in corner.split()] for corner in re.findall('[ML]([^ML]+)', path)] for _, path in found])
    places, tips, across = lines[:, 0]*[1, -1], lines[:, 1]*[1, -1], lines[:, 7]*[1, -1]
    way, side = tips - places, across - places
    angles = np.degrees(np.arctan2(way[:, 1], way[:, 0]))
    check.near((angles - poses[:, 2] + 180) % 360, [180]*3, 2e-3, 'poses: their angles')
    check.near(way[:, 0]*side[:, 1] - way[:, 1]*side[:, 0], np.hypot(*way.T)*np.hypot(*side.T), 1e-2, 'poses: y is on the left of x')
    scale = np.ptp(places[:, 0])/np.ptp(poses[:, 0])
    check.near((places - places[0])/scale, poses[:, :2] - poses[0, :2], 1e-2, 'poses: their places')
    own = re.findall(r'<g class="bracket l\d+" data-i="\d+"><path d="([^"]*)"', sketch)
    check.equal([len(re.findall('[ML]', path)) for path in own], [8], 'poses: the link has such an arrow')


@pytest.mark.parametrize('words, options', (
    ("none is about 'Q'; there are P", ('--plot', 'fit.svg:Q')),
    ("none is about 'P.x:P.y'; there are P", ('--plot', 'P.x:P.y')),
    ("'film.mpg' is no name of a moving picture", ('--animate', 'film.mpg')),
    ("'x' is no view", ('--sketch', 'a.svg', '--view', 'x')),
    ('leave --verbose out', ('--verbose',))), ids=('unknown point', 'columns', 'name of a film', 'view', 'verbose'))
def test_refused(cases, words, options):
    done = cases.search(cases.text, *options, why=words, code=USAGE)
    cases.checks.true(words in done.stderr and 'starts: ' not in done.stderr, f'mistakes: {words}', done.stderr)
