"""A page that plays a film, in a real browser: it plays at every load, at the speed that it says.

Chromium shows the page. What it shows is asked for between two frames of the browser, with the browser's time of that
frame, so that no load of the machine matters: frames that are late must show what is due then.
"""
import os

import pytest

from mech9_cases import TREE, run

# a motion of 1 s in 101 frames, which plays in 3 s
FRAMES, LENGTH = 101, 3.0

# the next frame of the browser: its time [ms], and the number of the frame of the film that the page has drawn for it
LOOK = 'new Promise(done => requestAnimationFrame(now => done([now, Number(document.getElementById("frame").value)])))'
WAIT = 'new Promise(done => setTimeout(done, {}))'

# Frames of the browser as the test wants them: `frames(ms...)` gives them at these times.
BY_HAND = '''
  let asked = [], number = 0;
  window.requestAnimationFrame = callback => { asked.push([++number, callback]); return number; };
  window.cancelAnimationFrame = which => { asked = asked.filter(one => one[0] != which); };
  window.frames_at = (...times) => times.map(time => {
    const now = asked;
    asked = [];
    for (const one of now) one[1](time);
    return Number(document.getElementById("frame").value);
  });
'''


@pytest.fixture(scope='module')
def page(build, tmp_path_factory):
    path = tmp_path_factory.mktemp('film') / 'film.html'
    done = run(build.program('mech9k'), os.path.join(TREE, 'examples/fig1/fig1.nml'), '--no-write', '--quiet', '--animate', path)
    assert done.returncode == 0, f'the page is made; {done.stderr}'
    return path


@pytest.mark.parametrize('load', range(20))
def test_film_goes_on_with_the_time_at_each_load(checks, browser, page, load):
    """Twenty loads, some at other speeds."""
    speed = (1, 0.25, 0.5, 1, 2, 4)[load % 6]
    why = f'load {load + 1} at speed {speed}'
    browser.open(page)
    browser.value(f'void (document.getElementById("speed").value = "{speed}")')
    time, frame = browser.value(LOOK)
    turns, judged = 0.0, 0
    while judged < 3:
        browser.value(WAIT.format(80))
        later, shown = browser.value(LOOK)
        if later - time < 1000:          # longer, and the page may have taken it for a pause
            due = FRAMES * speed * (later - time) / 1000 / LENGTH
            turns, judged = turns + due, judged + 1
            # both frames are whole numbers, rounded down
            off = (shown - frame - due + FRAMES / 2) % FRAMES - FRAMES / 2
            checks.true(abs(off) <= 1.001, f'{why}: the frame that is due',
                        f'{frame} was followed by {shown} after {later - time} ms')
        time, frame = later, shown
    checks.true(turns > 0.3, f'{why}: time has passed', turns)
    checks.equal(browser.errors, [], f'{why}: nothing on the console')
    checks.true(all(one.startswith('file:') for one in browser.requests), f'{why}: nothing from elsewhere', browser.requests)


@pytest.mark.parametrize('offset', (-1e6, -40, 0, 5000))
def test_frames_at_any_time(checks, browser, page, offset):
    """Frames from before the start, late ones, a tab that was away for an hour."""
    step = 1000 * LENGTH / FRAMES            # ms of a frame of the film
    browser.open(page, before=BY_HAND)
    start = browser.value('performance.now()') + offset
    asked = [start, start + 2.5 * step, start + 10.5 * step, start + 3600e3, start + 3600e3 + 5.0 * step]
    shown = browser.value(f'frames_at({", ".join(map(str, asked))})')
    checks.equal(shown, [0, 2, 10, 10, 15], f'a first frame {offset} ms after the start')
    # a pause of any length is none; a frame that was asked for before it plays nothing
    button = 'document.getElementById("play").click()'
    shown = browser.value(f'{button}, frames_at({asked[-1] + 9 * step})')
    checks.equal(shown, [15], 'a pause')
    shown = browser.value(f'{button}, {button}, {button}, frames_at({asked[-1] + 700e3}, {asked[-1] + 700e3 + 4 * step})')
    checks.equal(shown, [15, 19], 'and on after it')
    times = [asked[-1] + 800e3 + i * 7.0 * step for i in range(40)]
    shown = browser.value(f'frames_at({", ".join(map(str, times))})')
    checks.true(all(0 <= frame < FRAMES for frame in shown), 'round and round', shown)
    checks.true(all((b - a) % FRAMES in (6, 7, 8) for a, b in zip(shown[1:], shown[2:])), 'evenly', shown)
    checks.equal(browser.errors, [], 'nothing on the console')
