"""Summaries and plots of studies: quantiles and moments are those of the table, shares of variance those of linear propagation where
the quantity is linear, all of them the same for parts of one; the numbers in the scripts of plots are those of the table, and gnuplot
draws them; requests that cannot be drawn. Shares by derivatives are those of the linear propagation of errors.
"""
import json
import os
import re
import xml.etree.ElementTree as xml

import numpy as np
import pytest

from mech9_cases import read_table, run, text_of

DONE, USAGE = 0, 2
# Two slides in a row: the place of the last link is the sum of the two, and its height is a parameter.
SLIDES = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=1,0,0, point=0.5,0,0, moving_point=0,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0.3, 0.1 /
&drive coordinate=2, kind='polynomial', coefficients=0.2, 0.3 /
&point name='B', link=3, position=0,0.7,0 /
&time end=1, intervals=10 /
&quantity name='place', of='B.x', take='end' /
&quantity name='height', of='B.y', take='end' /
&quantity name='level', of='B.z', take='end' /
&parameter name='far', sets='pair(2).point(1)', spread=0.02 /
&parameter name='start', sets='drive(1).coefficients(1)', spread=0.06, distribution='uniform' /
&parameter name='speed', sets='drive(2).coefficients(2)', low=0.2, high=0.5 /
&parameter name='high', sets='point(1).position(2)', low=0.6, high=0.8 /
"""
# A stone that falls: its height at the end is start + rate - pull/2, its rate there the rate less the pull.
STONE = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&initial coordinate=1, position=3, velocity=4 /
&body link=2, mass=2 /
&gravity acceleration=0,-9.81,0 /
&time end=1, intervals=10 /
&parameter name='start', sets='initial.position', spread=0.3 /
&parameter name='rate', sets='initial.velocity', low=3, high=7 /
&parameter name='pull', sets='gravity.acceleration(2)', spread=0.5, distribution='uniform' /
&parameter name='mass', sets='body.mass', spread=0.1 /
&quantity name='height', of='q1', take='end' /
&quantity name='speed', of='dq1', take='end' /
&quantity name='gap', of='closure', take='max' /
&study kind='latin', runs=100 /
"""
# With a crank of 0.6 m and a rod of 0.5 m, the means, the slider comes to a dead point; other cranks turn.
FOLDING = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0.5,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, zero=0,1,0, moving_point=0,0,0 /
&initial coordinate=4, position=1 /
&drive coordinate=1, kind='polynomial', coefficients=0.4, 7 /
&time end=1, intervals=20 /
&quantity name='stroke', of='q4', take='range' /
&parameter name='crank', sets='pair(2).point(1)', low=0.2, high=1 /
&study kind='random', runs=20 /
"""
RUNS = 400


class Cases:
    def __init__(self, checks, folder, program):
        self.checks, self.folder, self.program = checks, folder, program

    def write(self, text, name='case.nml'):
        path = os.path.join(self.folder, name)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return path

    def study(self, text, *more):
        """Table, report and words of a study."""
        done = run(self.program, self.write(text), '--study', '--table', 'study.dat', '--report', 'study.json', *more, folder=self.folder)
        self.checks.true(done.returncode == DONE, f'{more}: the study goes through', done.stderr)
        return (read_table(text_of(os.path.join(self.folder, 'study.dat'))),
                json.loads(text_of(os.path.join(self.folder, 'study.json'))), done.stderr)

    def blocks(self, script):
        """The blocks of data of a script, by name."""
        found = {}
        for name, lines in re.findall(r'^(\$\w+) << end_of_data\n(.*?)^end_of_data$', text_of(os.path.join(self.folder, script)), re.M | re.S):
            found[name] = np.array([line.split() for line in lines.splitlines()], float)
        return found


@pytest.fixture
def cases(checks, tmp_path, mech9k):
    return Cases(checks, tmp_path, mech9k)


@pytest.fixture
def cases_of_pictures(cases):
    """Cases where gnuplot draws the pictures; without it, they are left out."""
    if not cases.checks.has('gnuplot', 'gnuplot-nox'):
        pytest.skip(cases.checks.missing[0])
    return cases


def told_quantiles(one):
    return np.array([level['value'] for level in one['quantiles']])


# place = far + start + 0.3 + speed + 0.2: its shares are the variances of the parameters over their sum.
VARIANCES = np.array([0.02**2, 0.06**2 / 3, 0.3**2 / 12, 0])


@pytest.mark.parametrize('kind', ('random', 'latin', 'sobol'))
def test_summary_of_drawn_values(cases, kind):
    text = SLIDES + f"&study kind='{kind}', runs={RUNS}, seed=3 /\n"
    rows, told, printed = cases.study(text)
    check = cases.checks
    place, height, level = told['quantities']
    check.near(told_quantiles(place), np.quantile(rows['place'], [0.05, 0.5, 0.95]), 1e-14, f'{kind}: quantiles')
    check.near([place['deviation'], place['mean_error']], np.std(rows['place'], ddof=1) * np.array([1, RUNS**-0.5]), 1e-12, f'{kind}: deviation')
    check.equal([one['parameter'] for one in place['first_order_shares']], ['far', 'start', 'speed', 'high'], f'{kind}: parameters')
    check.near([one['share'] for one in place['first_order_shares']], VARIANCES / sum(VARIANCES), 1e-10, f'{kind}: shares')
    check.near(place['share_of_rest'], 0, 1e-10, f'{kind}: the rest of the variance')
    check.equal([one['parameter'] for one in place['linear_shares']], ['far', 'start', 'speed', 'high'], f'{kind}: parameters of linear shares')
    check.near([one['share'] for one in place['linear_shares']], VARIANCES / sum(VARIANCES), 1e-12, f'{kind}: linear shares')
    check.near([one['derivative'] for one in place['linear_shares']], [1, 1, 1, 0], 1e-12, f'{kind}: derivatives')
    check.near(place['linear_deviation'], np.sqrt(sum(VARIANCES)), 1e-12, f'{kind}: linear deviation')
    check.true('place: shares by its derivatives: far 0.0' in printed, f'{kind}: linear shares in words', printed)
    check.near([one['share'] for one in height['first_order_shares']], [0, 0, 0, 1], 1e-10, f'{kind}: shares of one cause')
    check.true('first_order_shares' not in level, f'{kind}: what does not vary has no shares', level)
    for name, one in (('place', place), ('level', level)):
        lines = re.findall(rf'^{name}: (.*)$', printed, re.M)
        check.true(lines[2].startswith(f'quantiles 5 % {one["quantiles"][0]["value"]:.6g} m') if name == 'place' else 'shares' not in ''.join(lines),
                   f'{kind}: {name} in words', lines)


def test_summary_of_ten_runs(cases):
    check = cases.checks
    ten, told, _ = cases.study(SLIDES + "&study kind='random', runs=10 /\n")
    check.near(told_quantiles(told['quantities'][0]), np.quantile(ten['place'], [0.05, 0.5, 0.95]), 1e-14, 'ten runs: quantiles')
    check.true('error' not in told['quantities'][0]['quantiles'][0] and 'first_order_shares' not in told['quantities'][0],
               'ten runs: what they do not tell', told)


def test_one_run_tells_nothing_of_the_scatter(cases):
    _, told, printed = cases.study(SLIDES + "&study kind='random', runs=1 /\n")
    cases.checks.true('deviation' not in told['quantities'][0] and 'standard error' not in printed, 'one run tells nothing of the scatter', printed)


def test_a_list_does_not_scatter(cases):
    cases.write('0.5 0.3 0.3 0.7\n0.6 0.3 0.3 0.7\n', 'designs.dat')
    _, told, printed = cases.study(SLIDES + "&study kind='list', file='designs.dat' /\n")
    cases.checks.true('deviation' not in told['quantities'][0] and 'quantiles' not in printed, 'a list does not scatter', told)


def test_shares_by_derivatives_of_a_free_motion(checks, tmp_path, mech9d):
    """One of the quantities has no derivatives."""
    _, told, printed = Cases(checks, tmp_path, mech9d).study(STONE)
    height, speed, gap = told['quantities']
    for one, by in ((height, [1, 1, 0.5, 0]), (speed, [0, 1, 1, 0])):
        parts = (np.array(by) * [0.3, 4 / 12**0.5, 0.5 / 3**0.5, 0.1])**2
        checks.near([share['derivative'] for share in one['linear_shares']], by, 1e-6, f"derivatives of {one['name']}")
        checks.near([share['share'] for share in one['linear_shares']], parts / sum(parts), 1e-6, f"linear shares of {one['name']}")
        checks.near(one['linear_deviation'], np.sqrt(sum(parts)), 1e-6, f"linear deviation of {one['name']}")
    checks.true('linear_shares' not in gap and 'gap: no shares by derivatives, because it has none by the parameters' in printed,
               'a quantity without derivatives', printed)


def test_a_mechanism_without_derivatives_at_the_means(cases):
    """There, crank and rod are equally long: this linkage passes a change point."""
    _, told, printed = cases.study(FOLDING)
    cases.checks.true('note: no shares by derivatives: ' in printed and 'linear_shares' not in told['quantities'][0] and 'mean' in told['quantities'][0],
               'a run that fails at the means', printed)


def test_a_grid_has_no_shares_by_derivatives(cases):
    _, told, printed = cases.study(SLIDES.replace(', low=0.2, high=0.5', ', low=0.2, high=0.5, count=2').replace(', low=0.6, high=0.8', ', low=0.6, high=0.8, count=2')
                                   .replace('spread=0.02', 'low=0.4, high=0.6, count=2').replace("spread=0.06, distribution='uniform'", 'low=0.2, high=0.3, count=2')
                                   + "&study kind='grid' /\n")
    cases.checks.true('linear_shares' not in told['quantities'][0] and 'derivatives' not in printed, 'a grid has no shares by derivatives', printed)


@pytest.mark.parametrize('size', (1e-90, 1.0, 1e98))
def test_extreme_numbers(cases, size):
    """Numbers whose fourth powers are no numbers of the machine scatter as those of common size do."""
    check = cases.checks
    slide = SLIDES.split('&drive coordinate=2')[0].replace('cq=1,2', 'cq=1').split('&pair coordinate=2')[0]
    text = (slide + f"&drive coordinate=1, kind='polynomial', coefficients={3 * size}, {size} /\n&time end=1, intervals=4 /\n"
            f"&parameter name='start', sets='drive.coefficients(1)', spread={0.5 * size} /\n"
            f"&parameter name='speed', sets='drive.coefficients(2)', spread={0.2 * size}, distribution='uniform' /\n"
            "&quantity name='place', of='q1', take='end' /\n&study kind='random', runs=200 /\n")
    rows, told, _ = cases.study(text)
    place = told['quantities'][0]
    values = rows['place'] / size
    check.near([place['mean'] / size, place['deviation'] / size], [values.mean(), values.std(ddof=1)], 1e-12, f'{size}: mean and deviation')
    check.true(0 < place['deviation_error'] < 0.1 * place['deviation'], f'{size}: error of the deviation', place['deviation_error'])
    variances = np.array([0.25, 0.04 / 3])
    for name in ('first_order_shares', 'linear_shares'):
        check.near([one['share'] for one in place[name]], variances / sum(variances), 1e-9, f'{size}: {name}')
    check.near(place['linear_deviation'] / size, np.sqrt(sum(variances)), 1e-9, f'{size}: linear deviation')


def numbers_apart(picture):
    """The least gap between neighbouring numbers below the axes of a picture, in widths of a letter; texts are centred there."""
    gap, rows = np.inf, {}
    for x, y, text in re.findall(r'translate\(([-\d.]+),([-\d.]+)\)"[^>]*text-anchor="middle">\s*<text>([-+.\de]+)</text>', picture):
        rows.setdefault(y, []).append((float(x), len(text)))
    for row in rows.values():
        row.sort()
        gap = min([gap, *((there - here) / 9 - (wide + other) / 2 for (here, wide), (there, other) in zip(row, row[1:]))])
    return gap, sum(map(len, rows.values()))


@pytest.mark.parametrize('value, spread', ((0.018, 5e-5), (12345.678, 0.01), (-0.5, 0.1), (1e-9, 1e-10), (3e7, 1e6), (0.5, 1e-9)))
def test_numbers_below_narrow_axes(cases_of_pictures, value, spread):
    """Numbers of many digits do not run into each other below narrow plots: here 0.0179 to 0.0181, and 12345.65 to 12345.71."""
    cases = cases_of_pictures
    text = SLIDES.replace("point(1)', spread=0.02", f"point(1)', value={value!r}, spread={spread!r}") + "&study kind='random', runs=200 /\n"
    for request in ('far,place,speed:place,far:speed:place', 'far:speed:place,far:place', 'far', 'far:speed:place', ','.join(['far'] * 7)):
        cases.study(text, '--plot', f'narrow.svg:{request}')
        gap, count = numbers_apart(text_of(os.path.join(cases.folder, 'narrow.svg')))
        cases.checks.true(gap > 0.5 and count >= 2, f'{request}, {value}: numbers below axes stand apart', f'gap {gap:.2f}, {count} numbers')


def is_drawn(cases, *scripts):
    """gnuplot draws the scripts and has nothing to say."""
    for script in scripts:
        done = run('gnuplot', script, folder=cases.folder)
        cases.checks.true(done.returncode == 0 and done.stderr == '', f'{script}: gnuplot has nothing to say', done.stderr)


def test_plots_of_drawn_values(cases_of_pictures):
    """Histograms, effects and maps against those of numpy."""
    cases, check = cases_of_pictures, cases_of_pictures.checks
    rows, _, printed = cases.study(SLIDES + f"&study kind='random', runs={RUNS} /\n", '--plot', 'place,speed:place,far:speed:place',
                                   '--plot', 'one.svg:height')
    check.true(all(os.path.exists(os.path.join(cases.folder, name)) for name in ('study.svg', 'study.gp', 'one.svg', 'one.gp'))
               and 'plot: study.svg, drawn by study.gp' in printed, 'the pictures are there', printed)
    words = {' '.join(''.join(element.itertext()).split()) for element in xml.parse(os.path.join(cases.folder, 'study.svg')).getroot().iter()}
    check.true({'place [m]', 'runs', 'speed', 'far'} <= words, 'the picture names its axes', words)
    blocks = cases.blocks('study.gp')
    bars = blocks['$figure1']
    edges = np.append(bars[:, 0] - bars[:, 2] / 2, bars[-1, 0] + bars[-1, 2] / 2)
    check.near(edges[[0, -1]], [rows['place'].min(), rows['place'].max()], 1e-12, 'the histogram reaches from the least to the greatest number')
    inner = np.searchsorted(edges[1:-1], rows['place'], side='left')
    check.true(np.array_equal(bars[:, 1], np.bincount(inner, minlength=len(bars))) and bars[:, 1].sum() == RUNS, 'the bars count the runs', bars)
    order = np.argsort(rows['speed'])
    groups = np.array_split(order, 20)
    check.near(blocks['$figure2'], [[rows['speed'][one].mean(), rows['place'][one].mean(), rows['place'][one].std(ddof=1)] for one in groups], 1e-12,
               'means over a parameter')
    check.near(blocks['$figure2_runs'], np.column_stack([rows['speed'], rows['place']]), 1e-15, 'the runs behind them')
    for x0, x1, y0, y1, mean in blocks['$figure3']:
        inside = (rows['far'] > x0 - 1e-12) & (rows['far'] <= x1) & (rows['speed'] > y0 - 1e-12) & (rows['speed'] <= y1)
        check.near(mean, rows['place'][inside].mean(), 1e-12, 'the mean in a cell of a map')
    is_drawn(cases, 'study.gp', 'one.gp')


def test_plots_of_a_grid(cases_of_pictures):
    cases, check = cases_of_pictures, cases_of_pictures.checks
    grid = re.sub(r"spread=0.02", "low=0.4, high=0.6, count=3", re.sub(r"spread=0.06, distribution='uniform'", "low=0.1, high=0.3, count=2", SLIDES))
    grid = grid.replace('high=0.5 /', 'high=0.5, count=4 /').replace('high=0.8 /', 'high=0.8, count=2 /')
    rows, _, _ = cases.study(grid + "&study kind='grid' /\n", '--plot', 'grid.svg:far:speed:place,far:place,start')
    blocks = cases.blocks('grid.gp')
    check.equal(len(blocks['$figure1']), 12, 'a grid has a cell for each pair of values')
    for x0, x1, y0, y1, mean in blocks['$figure1']:
        inside = np.isclose(rows['far'], (x0 + x1) / 2) & np.isclose(rows['speed'], (y0 + y1) / 2)
        check.true(inside.sum() == 4, 'a cell holds the runs of its values', inside.sum())
        check.near(mean, rows['place'][inside].mean(), 1e-12, 'the mean of a cell of a grid')
    check.near(blocks['$figure2'][:, 0], [0.4, 0.5, 0.6], 1e-12, 'the values of a grid stand one by one')
    check.equal(list(blocks['$figure3'][:, 1]), [24, 24], 'a bar for each value of a grid')
    is_drawn(cases, 'grid.gp')


def test_plots_in_the_terminal(cases_of_pictures):
    """No table is written there."""
    cases, check = cases_of_pictures, cases_of_pictures.checks
    path = cases.write(SLIDES + "&study kind='random', runs=40 /\n")
    done = run(cases.program, path, '--study', '--plot', 'term:place,far:place', '--quiet', folder=cases.folder)
    check.true(done.returncode == DONE and 'place [m]' in done.stdout and '# ' not in done.stdout and 'runs' in done.stdout, 'plots in letters', done.stdout)
    done = run(cases.program, path, '--study', '--plot', 'term', folder=cases.folder)
    check.true(done.returncode == DONE and 'height [m]' in done.stdout, 'without names all quantities are drawn', done.stdout)


FOUR_RUNS = "&study kind='random', runs=4 /\n"


@pytest.mark.parametrize('request_of_plots, message', (
    ('plase', "no column of the results is named 'plase'; did you mean 'place'?"),
    ('run', "no column of the results is named 'run'"),
    ('far:speed:start:place', "here are more: ':place'"),
    ('far,', 'a name of a column is missing'),
    ('far speed', "a comma is missing before 'speed'"),
    ('term:far:speed:place', 'a terminal cannot show a map'),
    (','.join(['far'] * 13), 'at most 12 plots')), ids=('plase', 'run', 'too many', 'missing', 'comma', 'terminal', 'thirteen'))
def test_plots_that_are_refused(cases, request_of_plots, message):
    kept = cases.write('kept', 'kept.dat')
    done = run(cases.program, cases.write(SLIDES + FOUR_RUNS), '--study', '--table', kept, '--plot', request_of_plots, folder=cases.folder)
    cases.checks.true(done.returncode == USAGE and message in done.stderr, f'{request_of_plots}: {message}', f'{done.returncode}: {done.stderr}')
    cases.checks.true(text_of(kept) == 'kept', f'{request_of_plots}: nothing is written over')


def test_nothing_to_draw(cases):
    without = re.sub(r'&quantity.*\n', '', SLIDES) + FOUR_RUNS
    done = run(cases.program, cases.write(without), '--study', '--plot', 'term', folder=cases.folder)
    cases.checks.true(done.returncode == USAGE and 'this study has no quantities' in done.stderr, 'nothing to draw', done.stderr)


def test_a_picture_over_the_table(cases):
    path = cases.write(SLIDES + FOUR_RUNS)
    done = run(cases.program, path, '--study', '--plot', 'case.svg:far', '--table', 'case.svg', folder=cases.folder)
    cases.checks.true(done.returncode == USAGE and "cannot both be 'case.svg'" in done.stderr, 'a picture over the table', done.stderr)
