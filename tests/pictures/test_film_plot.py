"""The plot beside a film, in a real browser: its curves are the columns of the table of the run, and its marks go with the film."""
import numpy as np
import pytest

from mech9_cases import read_table, run, text_of
from svg_pictures import example

# places in the plot have one decimal [px]
PX = 0.11
# for each curve: its points, those of its mark, and two marks of each axis with their places
CURVES = '''[...document.querySelectorAll("#plot .line")].map(line => [...line.getAttribute("d").matchAll(/[ML]([^ML ]+) ([^ML]+)/g)]
            .map(one => [Number(one[1]), Number(one[2])]))'''
DOTS = '''[...document.querySelectorAll("#plot circle")].map(dot => [Number(dot.getAttribute("cx")), Number(dot.getAttribute("cy"))])'''
TEXTS = '''[...document.querySelectorAll("#plot text")].map(text => text.textContent.trim())'''
BOXES = '''[...document.querySelectorAll("#plot text")].filter(text => text.textContent.trim()).map(text =>
           {{ const box = text.getBoundingClientRect(); return [text.textContent, box.x, box.y, box.right, box.bottom]; }})'''


def ask(browser, columns):
    browser.value(f'''(() => {{ const field = document.getElementById("columns"); field.value = "{columns}";
                      field.dispatchEvent(new Event("input")); }})()''')


@pytest.fixture(scope='module')
def made(build, tmp_path_factory):
    """Page and table of a slider-crank in degrees."""
    folder = tmp_path_factory.mktemp('film')
    data = folder / 'crank.nml'
    text = text_of(example('slider_crank')).replace("coordinates = 4\n/", "coordinates = 4, angle_unit='deg'\n/", 1)
    data.write_text(text.replace('coefficients=0.4, 10.0', 'coefficients=0, 572.95779513082321'), encoding='utf-8')
    done = run(build.program('mech9k'), data, '--quiet', '--table', folder / 'film.dat', '--plot', f'{folder}/a.svg:M.x:M.y,q1:q2',
               '--animate', folder / 'film.html', '--animate', folder / 'other.html')
    assert done.returncode == 0, done.stderr
    return folder, read_table(text_of(folder / 'film.dat'))


@pytest.fixture
def page(browser, made):
    browser.resize(width=1300, height=900, still=True)
    browser.open(made[0] / 'film.html')
    return browser


def check_curve(checks, points, x, y, why):
    """The points are an affine image of the columns, y upwards."""
    points = np.array(points)
    if not checks.equal(len(points), len(x), f'{why}: a point for each frame'):
        return
    for place, values, name in ((points[:, 0], x, 'to the right'), (-points[:, 1], y, 'upwards')):
        slope, start = np.polyfit(values, place, 1)
        checks.true(slope > 0 and np.abs(slope * values + start - place).max() < 2 * PX, f'{why}: {name}')


def test_curves_and_marks(checks, page, made):
    rows = made[1]
    checks.equal(page.value('document.getElementById("columns").value'), 'M.x:M.y,q1:q2', 'at first what --plot names')
    for request, pairs in (('M.x:M.y,q1:q2', [('M.x', 'M.y'), ('q1', 'q2')]), ('q1,q2,B.x', [('t', 'q1'), ('t', 'q2'), ('t', 'B.x')]),
                           ('q1:B.x, M.x,dq2', [('q1', 'B.x'), ('q1', 'M.x'), ('q1', 'dq2')]), ('B.x:t', [('B.x', 't')])):
        ask(page, request)
        curves = page.value(CURVES)
        checks.equal(len(curves), len(pairs), f'{request}: so many curves')
        for points, (x, y) in zip(curves, pairs):
            check_curve(checks, points, rows[x], rows[y], f'{request}: {y} over {x}')
        for frame in (0, 17, 44, 90):
            page.value(f'show({frame})')
            marks = page.value(DOTS)
            checks.true(np.abs(np.array(marks) - [points[frame] for points in curves]).max() < PX, f'{request}: marks of frame {frame}')
        boxes = page.value(BOXES)
        for i, (one, *a) in enumerate(boxes):
            for other, *b in boxes[:i]:
                checks.true(not (a[0] < b[2] and b[0] < a[2] and a[1] < b[3] - 1 and b[1] < a[3] - 1), f'{request}: texts stand apart',
                            (one, other))
    ask(page, 'q1')
    texts = page.value(TEXTS)
    checks.true({'0', '90', '180', '270', '360', 't [s]', 'q1 [deg]'} <= set(texts), 'parts of a turn', texts)
    checks.equal((page.errors, [one for one in page.requests if not one.startswith('file:')]), ([], []), 'nothing on the console')


def test_wrong_names_and_clicks(checks, page, made):
    ask(page, 'q1,B.x')
    curves = page.value(CURVES)
    for wrong, words in (('q9', "no column is named 'q9'"), ('q1,', "no column is named ''"), ('q1 q2', "a comma is missing before 'q2'")):
        ask(page, wrong)
        checks.equal(page.value('document.getElementById("plot-note").textContent'), words, f'{wrong!r} is told')
        checks.equal(page.value(CURVES), curves, f'{wrong!r}: the plot stays')
    ask(page, 'q1,B.x')
    checks.equal(page.value('document.getElementById("plot-note").textContent'), '', 'and nothing is told')
    # a click on a curve over the time shows that time
    place = page.value(f'''(() => {{ const plot = document.getElementById("plot"), at = new DOMPoint({curves[0][33][0]}, {curves[0][33][1]});
                           const to = at.matrixTransform(plot.getScreenCTM()); return [to.x, to.y]; }})()''')
    page.mouse('mousePressed', *place, button='left', buttons=1, clickCount=1)
    page.mouse('mouseReleased', *place, button='left', clickCount=1)
    checks.equal(page.value('Number(document.getElementById("frame").value)'), 33, 'the frame under the mouse')
    # keys that are typed here move nothing
    page.value('document.getElementById("columns").focus()')
    page.key('s')
    checks.equal(page.value('Number(document.getElementById("frame").value)'), 33, 'letters are for the field')
    checks.equal(page.errors, [], 'nothing on the console')


def test_films_without_columns_or_frames(checks, browser, build, tmp_path):
    """A mode has no columns, a start no motion: neither has a plot."""
    done = run(build.program('mech9d'), example('pendulum'), '--quiet', '--modes', '--mode', '1', '--animate', 'mode.html', folder=tmp_path)
    checks.equal(done.returncode, 0, f'the film of a mode; {done.stderr}')
    browser.open(tmp_path / 'mode.html')
    checks.equal(browser.value('document.getElementById("curves").hidden'), True, 'no plot')
    checks.equal(browser.errors, [], 'nothing on the console')
    done = run(build.program('mech9k'), example('fig1'), '--quiet', '--no-write', '--animate', 'fig1.html', folder=tmp_path)
    browser.open(tmp_path / 'fig1.html')
    checks.equal(browser.value('document.getElementById("columns").value'), 'q1,q2,q3', 'some coordinates where --plot names none')
    checks.equal((browser.value('document.querySelectorAll("#plot .line").length'), browser.errors), (3, []), 'a curve for each')


def test_units_and_names_of_the_file(checks, browser, build, tmp_path):
    """The scale of the page is in the unit of length of the file, and columns of --plot may have names of pairs."""
    text = text_of(example('slider_crank')).replace("coordinates = 4\n/", "coordinates = 4, length_unit='mm'\n/", 1)
    for number in ('0.3', '0.1', '1.2', '0.05'):
        text = text.replace(f'point={number},', f'point={1000 * float(number):g},').replace(f'position={number} ', f'position={1000 * float(number):g} ')
    text = text.replace('point=1,0,0', 'point=1000,0,0').replace('point=0,0.1,0', 'point=0,100,0').replace(
        'position=0.5,0.05,0', 'position=500,50,0').replace("coordinate=4, links=1,4,", "coordinate=4, links=1,4, name='slide',")
    (tmp_path / 'mm.nml').write_text(text, encoding='utf-8')
    done = run(build.program('mech9k'), 'mm.nml', '--quiet', '--table', 'mm.dat', '--plot', 'a.svg:slide.q,B.x', '--animate', 'mm.html',
               folder=tmp_path)
    checks.equal(done.returncode, 0, done.stderr)
    rows = read_table(text_of(tmp_path / 'mm.dat'))
    checks.true(1000 < rows['q4'].max() < 1400, 'the slide is at more than a metre', rows['q4'].max())
    browser.resize(width=1300, height=900, still=True)
    browser.open(tmp_path / 'mm.html')
    checks.equal(browser.value('document.getElementById("columns").value'), 'slide.q,B.x', 'the column of the pair')
    words = browser.value('document.querySelector("#scale text").textContent').split()
    bar = browser.value('Number(document.querySelector("#scale path").getAttribute("d").match(/h([^v]+)v/)[1])')
    checks.equal(words[1], 'mm', 'the unit of the scale')
    # two pairs of the picture, whose distance is the radius of the crank
    places = [browser.value(f"""(() => {{ const m = document.querySelector('[data-joint="{name}"]').transform.baseVal[0].matrix;
                               return [m.e, m.f]; }})()""") for name in ('q1', 'q2')]
    checks.near(np.hypot(*np.subtract(*places)) / bar * float(words[0]), 300, 2e-3, 'the radius of the crank by the scale')
    checks.equal(browser.errors, [], 'nothing on the console')


def test_names_of_pairs(checks, browser, build, tmp_path):
    """Columns have the names of pairs, in the plot and in the list of values; a request may have their numbers, too."""
    data = tmp_path / 'named.nml'
    data.write_text(text_of(example('slider_crank')).replace('&pair coordinate=1,', "&pair coordinate=1, name='shaft',", 1), encoding='utf-8')
    done = run(build.program('mech9k'), data, '--quiet', '--table', tmp_path / 'film.dat', '--animate', tmp_path / 'film.html')
    if not checks.equal(done.returncode, 0, done.stderr):
        return
    browser.resize(width=1300, height=900, still=True)
    browser.open(tmp_path / 'film.html')
    checks.true(browser.value('document.getElementById("columns").value').startswith('shaft.q,'), 'at first', None)
    checks.true('shaft.dq' in browser.value('document.getElementById("list").textContent'), 'in the list', None)
    for request in ('shaft.q:shaft.dq', 'q1:dq1'):
        ask(browser, request)
        checks.true({'shaft.q [rad]', 'shaft.dq [rad/s]'} & set(browser.value(TEXTS)), f'{request}: labels', browser.value(TEXTS))
