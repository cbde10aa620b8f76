"""Texts in plots of gnuplot, with the boxes that they fill."""
import itertools
import re
import xml.etree.ElementTree as xml

import numpy as np

SVG = '{http://www.w3.org/2000/svg}'
# width of a letter of DejaVu Sans as a part of its size, at most on average, and height of a line
LETTER, LINE = 0.62, 0.8


class Text:
    """A text of a picture with the box that it fills."""

    def __init__(self, words, at, anchor, size, turned):
        self.words, self.at, self.turned = words, at, turned
        width = LETTER * size * len(words)
        left = {'start': 0.0, 'middle': -0.5, 'end': -1.0}[anchor] * width
        box = np.array([[left, -LINE * size], [left + width, 0.0]])
        self.box = box + at if not turned else np.array([[-LINE * size, -0.5 * width], [0.0, 0.5 * width]]) + at

    def overlaps(self, other):
        return all(self.box[0] < other.box[1]) and all(other.box[0] < self.box[1])


def texts_of(path):
    """All texts of an SVG."""
    found = []
    for group in xml.parse(path).getroot().iter(SVG + 'g'):
        words = [' '.join(''.join(text.itertext()).split()) for text in group.findall(SVG + 'text')]
        place = re.match(r'translate\(([-\d.]+),([-\d.]+)\)( rotate)?', group.get('transform', ''))
        if words and words[0] and place:
            found.append(Text(words[0], np.array([float(place.group(1)), float(place.group(2))]), group.get('text-anchor'),
                              float(group.get('font-size')), bool(place.group(3))))
    return found


def check_apart(checks, texts, why):
    """No text covers another one."""
    for one, other in itertools.combinations(texts, 2):
        checks.true(not one.overlaps(other), f'{why}: texts stand apart', (one.words, other.words))
