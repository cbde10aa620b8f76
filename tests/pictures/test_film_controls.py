"""The controls of a page that plays a film, in a real browser: by mouse, keys and fingers, on a screen and on a telephone.

Where things stand is asked of the browser; what they must show stands in the table of the same run.
"""
import glob
import os
import re
import struct
import time

import numpy as np
import pytest

from mech9_cases import PATIENCE, TREE, read_table, run, text_of

FILMS = {'fig1': 'mech9k', 'bricard': 'mech9d', 'andrews': 'mech9d'}

FRAME = 'Number(document.getElementById("frame").value)'
SHIFT = 8
# the place of the joint with a coordinate in the window
JOINT = '''(() => {{ const box = document.querySelector('[data-joint="{}"]').getBoundingClientRect();
           return [box.x + box.width/2, box.y + box.height/2]; }})()'''
LISTED = '''[...document.querySelectorAll("#list div")].map(row => [...row.children].map(cell => cell.textContent))'''
BOX = 'document.querySelector("svg.mech9").getBoundingClientRect().toJSON()'
# half a px: places in the picture have two decimals, in the window some px each
PX = 0.5


class Page:
    """A page that stands still, and what is asked of it often."""

    def __init__(self, checks, browser, path, **device):
        self.browser, self.checks = browser, checks
        browser.resize(**{'width': 1280, 'height': 860, 'still': True, **device})
        browser.open(path)

    def press(self, *keys, modifiers=0):
        for key in keys:
            self.browser.key(key, modifiers=modifiers)

    def click(self, name):
        self.browser.value(f'document.getElementById("{name}").click()')

    def joint(self, name):
        return np.array(self.browser.value(JOINT.format(name)))

    def frame(self):
        return self.browser.value(FRAME)

    def centre(self):
        box = self.browser.value(BOX)
        return np.array([box['x'] + box['width'] / 2, box['y'] + box['height'] / 2])

    def drag(self, start, way, modifiers=0, button='left'):
        x, y = start
        self.browser.mouse('mousePressed', x, y, button=button, clickCount=1, modifiers=modifiers)
        buttons = 4 if button == 'middle' else 1
        for part in (0.5, 1.0):
            self.browser.mouse('mouseMoved', x + part * way[0], y + part * way[1], button=button, buttons=buttons,
                               modifiers=modifiers)
        self.browser.mouse('mouseReleased', x + way[0], y + way[1], button=button, modifiers=modifiers)

    def close(self, a, b, why, within=PX):
        self.checks.true(np.abs(np.asarray(a) - b).max() < within, why, f'{a} and {b}')

    def is_quiet(self):
        """The page has said no error, and asked for nothing."""
        self.checks.equal(self.browser.errors, [], 'nothing on the console')
        self.checks.true(all(one.startswith(('file:', 'data:', 'blob:')) for one in self.browser.requests), 'nothing from elsewhere',
                         self.browser.requests)


@pytest.fixture(scope='module')
def films(build, tmp_path_factory):
    """The page and the table of each mechanism, by its name."""
    folder, made = tmp_path_factory.mktemp('films'), {}
    for name, program in FILMS.items():
        made[name] = page, table = folder / f'{name}.html', folder / f'{name}.dat'
        done = run(build.program(program), os.path.join(TREE, 'examples', name, name + '.nml'), '--quiet', '--table', table, '--animate', page)
        assert done.returncode == 0, f'{name}: the page is made; {done.stderr}'
    return made


@pytest.fixture
def page(checks, browser, films):
    """The page of Fig. 1."""
    return Page(checks, browser, films['fig1'][0])


def test_steps_by_keys_and_buttons(checks, page):
    """Steps forth and back, from either end to the other."""
    checks.equal(page.frame(), 0, 'without wish for motion it stands at its first frame')
    for keys, expected in ((['ArrowRight'] * 3, 3), (['ArrowLeft'], 2), (['End'], 100), (['ArrowRight'], 0), (['ArrowLeft'], 100),
                           (['Home'], 0)):
        page.press(*keys)
        checks.equal(page.frame(), expected, f'the frame after {keys[0]}')
    for name, expected in (('forward', 1), ('forward', 2), ('back', 1)):
        page.click(name)
        checks.equal(page.frame(), expected, f'the frame after the button {name}')
    # each frame can be stopped at, and played on from: rounding leads to no other
    same = page.browser.value('film.times.every((t, i) => (show(i), Math.floor(phase*film.times.length) == i))')
    checks.true(same, 'playing goes on from the frame that is shown')
    page.press('Home', ' ')
    checks.equal(page.browser.value('document.getElementById("play").getAttribute("aria-label")'), 'Pause', 'the space bar plays')
    page.press(' ')
    checks.equal(page.browser.value('document.getElementById("play").getAttribute("aria-label")'), 'Play', 'and stops')
    page.is_quiet()


def test_values_are_those_of_the_table(checks, films, page):
    """The columns at the shown time, as the table has them, six digits of the largest; and the clock."""
    rows = read_table(text_of(films['fig1'][1]))
    for frame in (0, 41, 100):
        page.browser.value(f'show({frame})')
        listed = page.browser.value(LISTED)
        checks.equal([row[0] for row in listed], [name for name in rows if name != 't'], f'frame {frame}: all columns')
        for name, text, _ in listed:
            largest = np.abs(rows[name]).max()
            checks.true(abs(float(text) - rows[name][frame]) <= 1.1e-5 * largest, f'frame {frame}: the value of {name}',
                        f'{text} instead of {rows[name][frame]}')
        shown = page.browser.value('[document.getElementById("now").textContent, document.querySelector("#time").textContent]')
        checks.equal(shown, [f'{rows["t"][frame]:.2f} s', f't = {rows["t"][frame]:.2f} s'], f'frame {frame}: the clock')
    units = {name: unit for name, _, unit in page.browser.value(LISTED)}
    checks.equal((units['q1'], units['dq1'], units['P.ax'], units['closure']), ('rad', 'rad/s', 'm/s^2', 'm'), 'units')
    wanted = 'const field = document.getElementById("filter"); field.value = "{}"; field.dispatchEvent(new Event("input"));'
    for words, expected in (('q7 p.v', ['q7', 'dq7', 'ddq7', 'P.vx', 'P.vy', 'P.vz']), ('none', [])):
        page.browser.value(f'(() => {{ {wanted.format(words)} }})()')
        checks.equal([row[0] for row in page.browser.value(LISTED)], expected, f'the columns for "{words}"')
    page.browser.value(f'(() => {{ {wanted.format("")} }})()')
    page.is_quiet()


def test_zoom_keeps_the_point_under_the_mouse(checks, browser, page):
    """The bar of the scale tells the same length at each zoom."""
    page.press('Home', '0')
    at, other = page.joint('q4'), page.joint('q6')
    bar = 'document.querySelector("#scale path").getBoundingClientRect().width'
    metres = 'parseFloat(document.querySelector("#scale text").textContent)'
    scale = browser.value(f'{bar}/{metres}')
    for delta in (-100, -250, 400, 150):
        before = np.hypot(*(page.joint('q6') - page.joint('q4')))
        browser.mouse('mouseWheel', at[0], at[1], deltaX=0, deltaY=delta)
        for _ in range(50 * PATIENCE):       # the browser sends wheels on with its next frame
            after = np.hypot(*(page.joint('q6') - page.joint('q4')))
            if after != before:
                break
            time.sleep(0.02)
        page.close(page.joint('q4'), at, f'the wheel by {delta}: the place under the mouse stays')
        checks.true((after > before) == (delta < 0), f'the wheel by {delta}: nearer or farther', (before, after))
        zoom = after / np.hypot(*(other - at))
        # of the bar a px or two of its line may count
        checks.true(abs(browser.value(f'{bar}/{metres}') / (zoom * scale) - 1) < 0.05, 'the scale tells so')
    page.press('0')
    page.close(page.joint('q6'), other, 'the view of the beginning is back')
    page.press('+', '+', '-')
    checks.true(abs(np.hypot(*(page.joint('q6') - page.joint('q4'))) / np.hypot(*(other - at)) - 1.25) < 0.01, 'keys zoom')
    size = 'document.querySelector(".number").getBoundingClientRect().height'
    large = browser.value(size)
    page.press('0')
    checks.true(abs(browser.value(size) - large) < 1.5, 'labels keep their size')
    browser.value('for (let i = 0; i < 60; i++) zoomAt(1.25)')
    checks.equal(browser.value('zoom'), 20, 'not nearer than this')
    page.is_quiet()


@pytest.mark.parametrize('mechanism', FILMS)
def test_drag_moves_a_planar_mechanism_and_turns_a_spatial_one(checks, browser, films, mechanism):
    """With shift or the middle button it is the other way."""
    planar, page = mechanism != 'bricard', Page(checks, browser, films[mechanism][0])
    name = page.browser.value('document.querySelector("[data-joint]").dataset.joint')
    page.press('0')
    start, view = page.joint(name), page.browser.value('film.view')
    for modifiers, button in ((0, 'left'), (SHIFT, 'left'), (0, 'middle')):
        moves = planar == (modifiers == 0 and button == 'left')
        page.drag(page.centre(), (60, -40), modifiers, button)
        why = f'{"planar" if planar else "spatial"}, button {button}, modifiers {modifiers}'
        if moves:
            page.close(page.joint(name), start + [60, -40], f'{why}: it follows the mouse')
            page.checks.equal(page.browser.value('view'), view, f'{why}: as it is')
        else:
            turned = np.array(page.browser.value('view')).reshape(3, 3)
            page.checks.true(np.abs(turned @ turned.T - np.eye(3)).max() < 1e-6, f'{why}: a rotation')
            page.checks.true(np.abs(turned.ravel() - view).max() > 0.1, f'{why}: it is turned')
        page.press('0')
        page.close(page.joint(name), start, f'{why}: and back')
    page.press('ArrowRight', modifiers=SHIFT)
    changed = page.browser.value('view') != view if not planar else np.abs(page.joint(name) - start).max() > 5
    page.checks.true(changed, 'shift and an arrow do what the mouse does')
    page.is_quiet()


def png_size(path):
    """Width and height of a PNG, and its bytes."""
    with open(path, 'rb') as file:
        data = file.read()
    if data[:8] != b'\x89PNG\r\n\x1a\n':
        raise ValueError(f'{path} is no PNG')
    return struct.unpack('>II', data[16:24]), data


def test_image_of_the_present_frame(checks, browser, page):
    """A file with the time in its name, three times as large; of another frame another picture."""
    os.makedirs(browser.downloads, exist_ok=True)
    browser.call('Browser.setDownloadBehavior', behavior='allow', downloadPath=browser.downloads)
    size = browser.value('[svg.viewBox.baseVal.width, svg.viewBox.baseVal.height]')
    images = []
    for frame, zoom in ((0, 1), (50, 1), (50, 2)):
        browser.value(f'void (resetView(), show({frame}), zoomAt({zoom}), document.getElementById("image").click())')
        found = []
        until = time.monotonic() + 30 * PATIENCE
        while not found and time.monotonic() < until:
            time.sleep(0.05)
            browser.value('0')
            found = [path for path in glob.glob(browser.downloads + '/*.png')]
        if not checks.true(bool(found), f'frame {frame}: an image is saved'):
            return
        time.sleep(0.1)
        wide, data = png_size(found[0])
        checks.equal(os.path.basename(found[0]), f'Fig_1_two_closed_chains_one_degree_of_freedom_{frame / 100:.2f}s.png', 'its name')
        checks.true(abs(wide[0] - 3 * size[0]) <= 1 and abs(wide[1] - 3 * size[1]) <= 1, 'its size', wide)
        checks.true(len(data) > 20000, 'it is not empty', len(data))
        images.append(data)
        os.remove(found[0])
    checks.equal(len(set(images)), 3, 'each shows what was seen')
    page.is_quiet()


def test_controls_have_names(page):
    """Every control has a name for who hears it, and names of links can be switched off."""
    for domain in ('DOM', 'Accessibility'):
        page.browser.call(domain + '.enable')
    roles = ('button', 'slider', 'combobox', 'checkbox', 'searchbox', 'image')
    found = {}
    for node in page.browser.call('Accessibility.getFullAXTree')['nodes']:
        role = node.get('role', {}).get('value')
        if role in roles and not node.get('ignored'):
            found.setdefault(role, []).append(node.get('name', {}).get('value', ''))
    page.checks.true(all(all(names) for names in found.values()), 'all controls have names', found)
    page.checks.equal({role: len(found.get(role, [])) for role in roles[1:5]},
                      {'slider': 1, 'combobox': 3, 'checkbox': 1, 'searchbox': 1}, 'these controls')
    page.checks.true(len(found.get('button', [])) >= 7, 'and these buttons', found)
    shown = 'getComputedStyle(document.querySelector(".number")).display'
    page.click('names')
    page.checks.equal(page.browser.value(shown), 'none', 'no names of links')
    page.click('names')
    page.checks.true(page.browser.value(shown) != 'none', 'and again')
    page.is_quiet()


def test_telephone(checks, browser, films):
    """Nothing is wider than the window; texts can be read; two fingers zoom and move, one turns."""
    page = Page(checks, browser, films['fig1'][0], width=390, height=844, mobile=True)
    browser.call('Emulation.setTouchEmulationEnabled', enabled=True, maxTouchPoints=2)
    checks.true(browser.value('document.documentElement.scrollWidth <= innerWidth'), 'nothing to scroll to the side')
    least = browser.value('Math.min(...[...svg.querySelectorAll("text:not(.title)")].filter(text => text.textContent)'
                          '.map(text => text.getBoundingClientRect().height))')
    checks.true(least > 9, 'letters are large enough', least)
    high = browser.value('Math.min(...[...document.querySelectorAll("button,select")].map(one => one.offsetHeight))')
    checks.true(high >= 44, 'buttons are large enough for a finger', high)
    at, view = page.joint('q6'), browser.value('film.view')
    x, y = page.centre()
    browser.touch('touchStart', (x - 30, y), (x + 30, y))
    browser.touch('touchMove', (x - 45, y), (x + 45, y))
    browser.touch('touchMove', (x - 60, y + 20), (x + 60, y + 20))
    browser.touch('touchEnd')
    page.close(page.joint('q6'), np.array([x, y + 20]) + 2 * (at - [x, y]), 'fingers twice as far apart, 20 px farther down', 2)
    checks.equal(browser.value('view'), view, 'two fingers turn nothing')
    page.click('home')
    browser.touch('touchStart', (x, y))
    browser.touch('touchMove', (x + 40, y))
    browser.touch('touchEnd')
    page.close(page.joint('q6'), at + [40, 0], 'one finger moves what is planar', 2)
    browser.call('Emulation.setTouchEmulationEnabled', enabled=False)
    page.is_quiet()


def test_dark_where_the_dark_is_wanted(checks, browser, films):
    page = Page(checks, browser, films['fig1'][0], dark=True)
    dark = browser.value('getComputedStyle(document.body).backgroundColor')
    checks.true(max(int(part) for part in dark[4:-1].split(',')) < 64, 'dark where the dark is wanted', dark)
    page.is_quiet()


def test_title_full_of_signs(checks, browser, mech9k, tmp_path):
    """It is a title in the page and in the name of an image, and nothing in it is run."""
    title, path = '</title></script><script>alert(1)</script> & "x" `y` $z', tmp_path / 'title.html'
    done = run(mech9k, os.path.join(TREE, 'examples/fig1/fig1.nml'), '--quiet', '--no-write', '--animate', path,
               '--set', f"mechanism.title='{title}'")
    checks.equal(done.returncode, 0, f'any title: the page is made; {done.stderr}')
    page = Page(checks, browser, path)
    checks.equal(browser.value('[document.title, document.querySelector("h1").textContent]'), [title] * 2, 'it stands as it is')
    page.press('ArrowRight')
    checks.equal((page.frame(), browser.errors), (1, []), 'and the page works')


# every item as the file has it, before the script draws it anew: places of marks and labels, corners of lines
WRITTEN = """
  new MutationObserver((found, watch) => {
    const last = document.querySelector('svg.mech9 #axes');
    if (last && !window.written) { window.written = window.items_now(); watch.disconnect(); }
  }).observe(document, {childList: true, subtree: true});
  window.items_now = () => Object.fromEntries([...document.querySelectorAll('#scene > g')].map(g => [g.dataset.i,
    g.hasAttribute('transform') ? g.getAttribute('transform') : g.firstElementChild.getAttribute('d')]));
"""


@pytest.mark.parametrize('name', FILMS)
def test_script_draws_the_first_frame_as_the_program_does(checks, browser, films, name):
    browser.resize(1280, 860, still=True)
    browser.open(films[name][0], before=WRITTEN)
    written, drawn = browser.value('window.written'), browser.value('window.items_now()')
    if not checks.true(bool(written) and set(written) == set(drawn), f'{name}: an element for each item'):
        return
    worst = 0.0
    for number, words in written.items():
        both = [re.findall(r'-?[\d.]+', text) for text in (words, drawn[number])]
        if 'translate' in words:
            both = [numbers[:2] for numbers in both]
        if checks.equal(len(both[0]), len(both[1]), f'{name}: item {number} has as many corners'):
            worst = max([worst] + [abs(float(a) - float(b)) for a, b in zip(*both)])
    # steps of 1e-5 of the width, quaternions of 1e-5, and two decimals; across a short spring its direction counts more
    checks.true(worst < 0.1, f'{name}: the page is drawn as the program draws', f'{worst} px apart')
