"""Labels and titles of drawn mechanisms: what is written covers nothing that it should not, and stands on the page.
"""
import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from mech9_cases import run, text_of
from svg_pictures import SVG, example, place_in, texts_of

# an excavator: three cylinders, and a joint at which two pairs meet
EXCAVATOR = """&mechanism title='excavator', links=12, coordinates=15 /
&structure cq=9,12,15 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,-1,0, point=0,0,1.5 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,-1,0, point=4.6,0,2.6 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,-1,0, point=5.6,0,1.2 /
&pair coordinate=4, links=3,5, kind='revolute', axis=0,-1,0, point=5.75,0,0.4 /
&pair coordinate=5, links=4,6, kind='revolute', axis=0,-1,0, point=6.2,0,1.3 /
&pair coordinate=6, links=6,5, kind='revolute', axis=0,-1,0, point=6.35,0,0.5 /
&pair coordinate=7, links=1,7, kind='revolute', axis=0,-1,0, point=0.6,0,1 /
&pair coordinate=8, links=2,8, kind='revolute', axis=0,-1,0, point=1.8,0,2.9 /
&pair coordinate=9, links=7,8, kind='prismatic', axis=1.2,0,1.9, point=0.6,0,1 /
&pair coordinate=10, links=2,9, kind='revolute', axis=0,-1,0, point=2.4,0,3.4 /
&pair coordinate=11, links=3,10, kind='revolute', axis=0,-1,0, point=4.4,0,3.4 /
&pair coordinate=12, links=9,10, kind='prismatic', axis=2,0,0, point=2.4,0,3.4 /
&pair coordinate=13, links=3,11, kind='revolute', axis=0,-1,0, point=4.7,0,3.1 /
&pair coordinate=14, links=4,12, kind='revolute', axis=0,-1,0, point=6.2,0,1.3 /
&pair coordinate=15, links=11,12, kind='prismatic', axis=1.5,0,-1.8, point=4.7,0,3.1 /
&point name='tooth', link=5, position=5.4,0,-0.6 /
&drive coordinate=9, kind='polynomial', coefficients=0,0.25 /
&drive coordinate=12, kind='polynomial', coefficients=0,-0.2 /
&drive coordinate=15, kind='polynomial', coefficients=0,0.2 /
"""

# of the fonts that the style names no letter of these labels is narrower or lower: for boxes that surely are covered
LETTERS = {'name': (12, 'start'), 'coordinate': (10, 'end'), 'input': (10, 'end'), 'number': (11, 'middle')}


def labels_of(svg):
    """Each label: its words, its kind, the corners of a box that it fills, and its middle."""
    found = []
    for group in svg.iter(SVG + 'g'):
        text = group.find(SVG + 'text')
        kind = (text.get('class') or '').split()[0] if text is not None and text.get('class') else ''
        if kind not in LETTERS or not group.get('transform'):
            continue
        size, anchor = LETTERS[kind]
        x, y = place_in(group.get('transform'))
        width, height = 0.55 * size * len(text.text), 0.6 * size
        left = {'start': x, 'middle': x - width / 2, 'end': x - width}[anchor]
        top = y - height / 2 if kind == 'number' else y - height
        found.append((text.text, kind, np.array([left, top]), np.array([left + width, top + height])))
    return found


MECHANISMS = {'mech9k': ('excavator', 'fig1', 'watt_parallel_motion', 'jansen_leg', 'peaucellier', 'whitworth', 'slider_crank',
                         'palletising_arm', 'class_three_group', 'geneva'),
              'mech9d': ('flyball_governor', 'andrews', 'bricard', 'pendulum_four_bar', 'double_pendulum')}


@pytest.mark.parametrize('program, why', [(program, name) for program, names in MECHANISMS.items() for name in names])
def test_labels_cover_nothing(checks, build, tmp_path, program, why):
    """No label covers a pin, a mass centre, a point or another label; a coordinate has the colour of the independent ones only if it
    is one."""
    path, data = tmp_path / 'labels.svg', example(why)
    if why == 'excavator':
        data = tmp_path / 'excavator.nml'
        data.write_text(EXCAVATOR, encoding='utf-8')
    done = run(build.program(program), data, '--no-write', '--quiet', '--sketch', path)
    if not checks.equal(done.returncode, 0, f'{why}: drawn'):
        return
    svg = ElementTree.parse(path).getroot()
    labels = labels_of(svg)
    marks = [(group.get('class').split()[0], place_in(group.get('transform'))) for group in svg.iter(SVG + 'g')
             if (group.get('class') or '').split()[:1] in (['ring'], ['ball'], ['centre'], ['dot'])]
    page = np.array([float(svg.get('width')), float(svg.get('height'))])
    for i, (words, kind, low, high) in enumerate(labels):
        for mark, place in marks:
            covered = np.all(place > low) and np.all(place < high)
            checks.true(not covered, f'{why}: {words} does not lie on a {mark}', (low, high, place))
        for other, _, a, b in labels[:i]:
            checks.true(np.any(low >= b) or np.any(a >= high), f'{why}: {words} does not lie on {other}', (low, a))
        checks.true(np.all(low > 0) and np.all(high < page), f'{why}: {words} is on the page')
    numbers = re.search(r'\bcq *= *([\d, ]*\d)', text_of(data)).group(1).replace(' ', '').split(',')
    independent = {f'q{number}' for number in numbers}
    shown = {words for words, kind, _, _ in labels if kind == 'input'}
    checks.equal(shown, independent, f'{why}: independent coordinates, and no others, have their colour')


# titles with the mean width of their letters in DejaVu Sans, as a part of their size
LONG_TITLES = {'words': ('a crank drives two rockers by one coupler, ' * 4, 0.505), 'one word': ('x' * 2000, 0.592),
               'wide letters': ('WIDE LETTERS ' * 9, 0.6)}


@pytest.mark.parametrize('kind', LONG_TITLES)
def test_long_title(checks, mech9k, tmp_path, kind):
    """A title that is too long for a line is drawn in up to three; what has no room is named whole all the same."""
    (title, letter), path = LONG_TITLES[kind], tmp_path / 'title.svg'
    done = run(mech9k, example('fig1'), '--check', '--quiet', '--sketch', path, '--set',
               f"mechanism.title='{title}'")
    checks.equal(done.returncode, 0, 'any length of a title will do')
    svg = ElementTree.parse(path).getroot()
    lines = [text for text in texts_of(svg) if len(text) > 20]
    checks.true(2 <= len(lines) <= 3, 'a long title in lines', lines)
    widest = letter * 11 * max(map(len, lines))
    checks.true(14 + widest <= float(svg.get('width')), 'and none leaves the picture', lines)
    checks.equal(svg.findtext(SVG + 'title'), title.strip(), 'the whole title is the name of the picture')
