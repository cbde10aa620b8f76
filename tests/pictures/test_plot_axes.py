"""Axes of plots: numbers and labels do not overlap, angles are marked at parts of a turn, tall paths fill their page in true shape.

Places of texts and marks are those of the SVG that gnuplot draws. A crank that turns once has marks at 0, 90 .. 360 degrees.
"""
import os
import re
import xml.etree.ElementTree as xml

import numpy as np
import pytest

from mech9_cases import TREE, run
from plot_texts import SVG, check_apart, texts_of

FIG1 = os.path.join(TREE, 'examples', 'fig1', 'fig1.nml')
PRESS = """&mechanism title='press', angle_unit='{unit}' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=0,1,0, point=0.02,0,0, moving_point=0,0,0 /
&initial coordinate=4, position=1 /
&point name='B', link=4 /
&point name='M', link=3, position=0.9,0.01,0 /
&drive coordinate=1, kind='polynomial', coefficients=0, {turn} /
&time end=1, intervals=90 /
"""


def drawn(checks, program, data, folder, *plots):
    options = [word for i, plot in enumerate(plots) for word in ('--plot', f'p{i}.svg:{plot}')]
    done = run(program, data, '--quiet', *options, folder=folder)
    checks.equal(done.returncode, 0, f'the plots are drawn; {done.stderr}')
    return [texts_of(folder / f'p{i}.svg') for i in range(len(plots))]


@pytest.fixture
def gnuplot(checks):
    if not checks.has('gnuplot', 'gnuplot-nox'):
        pytest.skip(checks.missing[-1])


@pytest.fixture(params=('deg', 'rad'))
def press(request, tmp_path):
    data = tmp_path / 'press.nml'
    turn = 360 if request.param == 'deg' else 2 * np.pi
    data.write_text(PRESS.format(unit=request.param, turn=repr(float(turn))), encoding='utf-8')
    return request.param, data


def marks(texts, upwards):
    """The numbers of an axis with their places along it, in px to the right or up."""
    values = {}
    for text in texts:
        if re.fullmatch(r'-?[\d.]+(e-?\d+)?', text.words) and not text.turned:
            values.setdefault(round(text.at[0 if upwards else 1]), []).append((float(text.words), text.at))
    rows = [row for row in values.values() if len(row) > 2]
    axis = min(rows, key=lambda row: row[0][1][0]) if upwards else max(rows, key=lambda row: row[0][1][1])
    return np.array([[value, -at[1] if upwards else at[0]] for value, at in axis])


def test_no_text_overlaps(checks, gnuplot, mech9k, press, tmp_path):
    unit, data = press
    plots = ('B.x:B.y', 'M.x:M.y', 'B.y:B.x', 'q1,q2,dq1,dq2,ddq1,ddq2,B.y,B.vy,B.ay', 'q1:B.y,M.y,dq2', 'M.x:M.y,q1:q2,q3',
             'closure,ddq2', 'q1:closure', 'M.ax:M.ay')
    for plot, texts in zip(plots, drawn(checks, mech9k, data, tmp_path, *plots)):
        checks.true(len(texts) > 8, f'{unit} {plot}: numbers and labels', len(texts))
        check_apart(checks, texts, f'{unit} {plot}')


def test_marks_of_angles(checks, gnuplot, mech9k, press, tmp_path):
    unit, data = press
    over, upwards, small = drawn(checks, mech9k, data, tmp_path, 'q1:B.y', 'q1', 'q3')
    if unit == 'deg':
        for name, texts, up in (('to the right', over, False), ('upwards', upwards, True)):
            angles = marks(texts, up)[:, 0]
            checks.equal((angles.min(), angles.max()), (0.0, 360.0), f'{name}: a turn from end to end')
            checks.true(90.0 in angles and not any(angles % 45), f'{name}: parts of a turn', angles)
        checks.true(not any(value == 360.0 for value in marks(small, True)[:, 0]), 'a small angle has other marks')
    else:
        for name, texts in (('to the right', over), ('upwards', upwards)):
            words = {text.words for text in texts}
            checks.true({'0', 'π/2', 'π', '3π/2', '2π'} <= words, f'{name}: parts of pi', words)
        checks.true(not any('π' in text.words for text in small), 'a small angle has other marks')


def test_tall_paths(checks, gnuplot, mech9k, press, tmp_path):
    """A slim path has a page of usual proportions, fills its height, and keeps its shape, alone and beside other panels."""
    unit, data = press
    plots = ('M.x:M.y', 'B.x:B.y', 'B.y:B.x', 'M.x:M.y,q1:q2')
    for i, (plot, texts) in enumerate(zip(plots, drawn(checks, mech9k, data, tmp_path, *plots))):
        root = xml.parse(tmp_path / f'p{i}.svg').getroot()
        width, height = map(float, root.get('viewBox').split()[2:])
        checks.true(0.5 < width / height < 3, f'{plot}: proportions of the page', (width, height))
        if i > 2:
            texts = [text for text in texts if text.at[1] < height * 0.69]      # those of the upper panel
        right, up = marks(texts, False), marks(texts, True)
        scales = [np.polyfit(axis[:, 0], axis[:, 1], 1)[0] for axis in (right, up)]
        checks.near(scales[0], scales[1], 1e-3 * abs(scales[1]), f'{plot}: one scale for both axes')
        path = [group for group in root.iter(SVG + 'g') if (group.get('id') or '').startswith('gnuplot_plot_1')][0]
        corners = np.array(re.findall(r'([-\d.]+),([-\d.]+)', ' '.join(line.get('d') for line in path.iter(SVG + 'path'))), float)
        extent = np.ptp(corners, axis=0)
        checks.true(max(extent) > 0.6 * (width if i == 2 else height) or i > 2, f'{plot}: it fills the page', (extent, width, height))
        if i > 2:
            checks.true(extent[1] > 400, f'{plot}: it is tall beside others', extent)


def test_both_over_one_column(checks, gnuplot, mech9k, tmp_path):
    """`x:y1,y2` draws both over x, in panels of their own where the units differ."""
    one, two = drawn(checks, mech9k, FIG1, tmp_path, 'q5:q3,q4', 'q5:q3,P.x')
    words = [text.words for text in one]
    checks.true('q5 [rad]' in words and 'q5:q3' in words and 'q5:q4' in words, 'both over q5', words)
    checks.equal([text.words for text in two].count('q5 [rad]'), 2, 'two panels over q5')
