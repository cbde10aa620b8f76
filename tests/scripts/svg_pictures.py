"""Shapes and numbers that tests read from pictures and films of mechanisms."""
import json
import os
import re
import xml.etree.ElementTree as ElementTree

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


def film_of(html):
    """The constant that the script of a page begins with."""
    text = re.search(r'const film = (\{.*?\n\});?\n', html, re.S).group(1)
    text = re.sub(r'(\w+):', r'"\1":', text)
    return json.loads(re.sub(r',\s*([\]}])', r'\1', text))


def picture_of(text):
    """The picture in a page, or the picture that a file is."""
    ending = '</svg>\n</figure>' if '<figure>' in text else '</svg>\n'
    start = re.search(r'<svg [^>]*class="mech9"', text).start()
    return ElementTree.fromstring(text[start:text.rindex(ending) + len('</svg>')])


def turned(q, v):
    """The square of the length of a quaternion is a factor, 1 but for arrows round an axis."""
    w, u = q[0], np.array(q[1:])
    return (w * w - u @ u) * v + 2 * (u @ v) * u + 2 * w * np.cross(u, v)


def nodes_of(film, frame):
    """All nodes in a frame, in m from the middle of the picture."""
    places = np.array(film['points'], float).reshape(-1, 3)
    poses = np.array(film['poses'][frame], float).reshape(-1, 7)
    for i, link in enumerate(film['links']):
        if link:
            pose = poses[link - 1]
            places[i] = turned(pose[3:] / 1e5, places[i]) + pose[:3]
    return places * film['unit']
