"""Shapes and numbers that tests read from pictures of mechanisms in SVG."""
import os
import re

import numpy as np

from mech9_cases import TREE

SVG = '{http://www.w3.org/2000/svg}'


def example(name):
    return os.path.join(TREE, 'examples', name, name + '.nml')


def place_in(transform):
    return np.array([float(word) for word in re.match(r'translate\((\S+) (\S+?)\)', transform).groups()])


def corners_of(path):
    return np.array([[float(word) for word in corner.split()] for corner in re.findall(r'[ML]([^MLZ]+)', path)])


def texts_of(svg):
    return [''.join(text.itertext()) for text in svg.iter(SVG + 'text')]
