"""Arrows of forces in the page of a film, with their sizes, and their balance."""
import re

import numpy as np

from mech9_cases import run, text_of
from svg_pictures import SVG, film_of, nodes_of, picture_of

STYLES = ('force', 'moment', 'load', 'weight', 'touching')
# arrows are rounded to a hundred-thousandth of the width, about 2000 parts of the longest one
ROUNDED = 2e-3


class Arrows:
    """The arrows of a page by their titles: kind, place of the foot and vector in each frame [m, N, N m]."""

    def __init__(self, text, force_unit=1.0, torque_unit=1.0):
        self.film, svg = film_of(text), picture_of(text)
        places = [nodes_of(self.film, frame) for frame in range(len(self.film['times']))]
        self.feet, self.ways, self.told, self.shapes, self.heads = {}, {}, {}, {}, {}
        for group in svg.iter(SVG + 'g'):
            kind = group.get('class') or ''
            if kind not in STYLES:
                continue
            title, size = re.fullmatch(r'(.*?),(?: at most)? (\S+) .*', group.findtext(SVG + 'title')).groups()
            nodes = self.film['items'][int(group.get('data-i')) - 1]['nodes']
            at = np.array([place[nodes] for place in places])
            self.shapes[title] = {6: 'straight', 10: 'double'}.get(len(nodes), 'ring')
            if self.shapes[title] == 'ring':
                # 45 to 315 degrees in steps of 15
                middle, up = 0.5 * (at[:, 3] + at[:, 15]), 0.5 * (at[:, 3] - at[:, 15])
                right = middle - at[:, 9]
                radius = np.linalg.norm(right, axis=1)
                self.feet[title], self.ways[title] = middle, 2 * np.cross(right, up) / np.maximum(radius, 1e-12)[:, None]
            else:
                self.feet[title], self.ways[title] = at[:, 0], at[:, 1] - at[:, 0]
                # tip, and middle of the ends of the barbs, of one head or two
                self.heads[title] = [(at[:, tip], 0.5 * (at[:, left] + at[:, right]))
                                     for tip, left, right in ((1, 3, 5), (6, 7, 9))[:1 + (len(nodes) == 10)]]
            self.told[title] = float(size) * (torque_unit if self.is_torque(title) else force_unit)
        for turning in (False, True):
            names = [name for name in self.ways if self.is_torque(name) == turning]
            longest = {name: np.linalg.norm(self.ways[name], axis=1).max() for name in names}
            for name in names:
                self.ways[name] = self.ways[name] * max(self.told[other] for other in names) / max(longest.values())

    @staticmethod
    def is_torque(title):
        return 'moment' in title or 'torque' in title

    def balance(self, on_link):
        """Sums of forces, and of moments about the middle of the picture, of (title, sign), and the largest of their terms."""
        forces, moments = [], []
        for title, sign in on_link:
            if title not in self.ways:
                continue
            if self.is_torque(title):
                moments.append(sign * self.ways[title])
            else:
                forces.append(sign * self.ways[title])
                moments.append(sign * np.cross(self.feet[title], self.ways[title]))
        return sum(forces), np.abs(forces).max(), sum(moments), np.abs(moments).max()


def page_of(checks, program, folder, text, *options):
    """The text of the page of a run."""
    (folder / 'case.nml').write_text(text, encoding='utf-8')
    written = [] if '--optimize' in options else ['--no-write']
    done = run(program, folder / 'case.nml', '--quiet', *written, '--animate', 'film.html', *options, folder=folder)
    checks.equal(done.returncode, 0, done.stderr)
    return text_of(folder / 'film.html')


def check_balance(checks, arrows, links):
    for link, acting in links.items():
        force, most_force, moment, most_moment = arrows.balance(acting)
        checks.true(np.abs(force).max() < ROUNDED * most_force, f'forces on {link} are in balance', np.abs(force).max() / most_force)
        checks.true(np.abs(moment).max() < ROUNDED * most_moment, f'moments on {link} are in balance', np.abs(moment).max() / most_moment)
