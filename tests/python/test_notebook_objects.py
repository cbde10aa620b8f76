"""Objects that a notebook shows, in a browser: mechanisms, results and films are drawn, and the console stays empty."""
import os

import pytest

from mech9_cases import TREE


@pytest.fixture(name='shown')
def page_with_an_object(browser, tmp_path):
    """A function that opens a page with an object as a notebook shows it."""
    def show(thing):
        path = tmp_path / 'page.html'
        path.write_text(f'<!doctype html><meta charset="utf-8"><body><div id="output">{thing._repr_html_()}</div></body>', encoding='utf-8')
        browser.open(str(path))
        return browser
    return show


def test_drawing(checks, shown, four_bar):
    for name, thing in (('mechanism', four_bar), ('drawing', four_bar.sketch()), ('drawing of a run', four_bar.kinematics().sketch())):
        page = shown(thing)
        checks.true(page.value("document.querySelectorAll('#output svg path, #output svg line, #output svg circle').length") > 5, f'{name}: it has lines')
        checks.true(page.value("document.querySelector('#output svg').getBoundingClientRect().height") > 50, f'{name}: it is visible')
        checks.equal((page.errors, page.requests[1:]), ([], []), f'{name}: the console is empty, and nothing is loaded')


def test_table(checks, shown, four_bar):
    r = four_bar.kinematics(intervals=200)
    page = shown(r)
    checks.true(2 < page.value("document.querySelectorAll('#output tr').length") <= 202, 'a table with rows')
    checks.true('q1' in page.value("document.querySelector('#output').innerText"), 'it names its columns')
    checks.equal((page.errors, page.requests[1:]), ([], []), 'the console is empty, and nothing is loaded')


@pytest.mark.parametrize('kind', ('html', 'gif', 'svg', 'mp4'))
def test_film(checks, shown, four_bar, kind):
    if kind == 'mp4' and not checks.has('ffmpeg', 'ffmpeg'):
        pytest.skip(checks.missing[-1])
    page = shown(four_bar.kinematics().animate(kind))
    element = {'html': 'iframe', 'gif': 'img', 'svg': 'svg', 'mp4': 'video'}[kind]
    checks.true(page.value(f"document.querySelector('#output {element}').getBoundingClientRect().height") > 100, f'{kind}: the film is visible')
    if kind == 'gif':
        checks.true(page.value("document.querySelector('#output img').naturalWidth") > 100, 'gif: the picture is whole')
    checks.equal(page.errors, [], f'{kind}: the console is empty')
    checks.true(all(address.startswith(('data:', 'about:', 'file:')) for address in page.requests), f'{kind}: nothing is loaded', page.requests)


def test_mechanism_that_cannot_be_drawn(checks, shown, four_bar):
    four_bar['pair(4).point(1)'] = 9.0
    page = shown(four_bar)
    checks.true('cannot be assembled' in page.value("document.querySelector('#output').innerText"), 'the reason is shown')
    checks.equal(page.errors, [], 'the console is empty')


def test_objects_beside_each_other(checks, browser, tmp_path, four_bar, mech9):
    """A notebook shows several drawings in one page: their styles and names must not disturb each other."""
    other = mech9.read(os.path.join(TREE, 'examples', 'fig1', 'fig1.nml'))
    parts = [thing._repr_html_() for thing in (four_bar, other, four_bar.kinematics(), other.animate(kind='svg'))]
    path = tmp_path / 'page.html'
    path.write_text('<!doctype html><meta charset="utf-8">' + ''.join(f'<div class="output">{part}</div>' for part in parts), encoding='utf-8')
    browser.open(str(path))
    names = browser.value("[...document.querySelectorAll('[id]')].map(e => e.id)")
    checks.equal(len(names), len(set(names)), f'no two elements have one id: {sorted(name for name in names if names.count(name) > 1)[:5]}')
    checks.equal(browser.errors, [], 'the console is empty')
