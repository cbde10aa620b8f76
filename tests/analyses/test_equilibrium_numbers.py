"""Positions of equilibrium and modes of vibration of random mechanisms do not depend on the numbers of links and coordinates, on the
independent coordinates, nor on the rotation of the whole; small motions about them follow their modes.

Compares the program with itself in part: all but the motions.
"""
import os

import numpy as np
import pytest

import families
from data_file import write
from force_files import family_groups, rotated, rotation, with_coordinates, with_links
from mech9_cases import read_table, run

FAMILIES = {'seven pairs of all kinds': families.seven('RRPRHRR'), 'a rod between ball joints': families.rssr,
            'three cylindrical joints': families.rccc, 'two spatial loops': families.two_spatial_loops(1),
            'a five-bar': families.five_bar((1, 5)), 'Bennett': families.bennett, 'Sarrus': families.sarrus,
            'Bricard, of a plane': families.bricard_of_a_plane, 'cranks too many': families.parallel_cranks(3)}
# Forces of round-off leave a position uncertain by some hundred times that where springs are soft, and matrices change with it.
SAME = 1e-8


class Case:
    """Runs the program on data files in a folder of its own."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def __call__(self, groups, *options):
        """Table of a run, or None where it fails with a message; an exception where a signal ends it."""
        with open(os.path.join(self.folder, 'case.nml'), 'w', encoding='utf-8') as file:
            file.write(write(groups))
        done = run(self.program, 'case.nml', '--quiet', '--table', '-', *options, folder=self.folder)
        if done.returncode < 0:
            raise RuntimeError(f'{write(groups)}\nended by signal {-done.returncode}:\n{done.stderr}')
        return read_table(done.stdout) if done.returncode == 0 else None


def resting(case, family, rng):
    """(groups that start at an equilibrium where the mechanism vibrates, its position, its modes)."""
    for _ in range(40):
        groups = [(group, items) for group, items in family_groups(family, rng) if group not in ('drive', 'time')]
        cq = next(items['cq'] for group, items in groups if group == 'structure')
        found = case(groups + [('initial', {'coordinate': [k], 'position': [0.0]}) for k in cq], '--equilibrium')
        if found is None or not found['stable'][0] > 0 or max(abs(found[f'q{k}'][0]) for k in cq) > 2:
            continue
        count = next(items['coordinates'][0] for group, items in groups if group == 'mechanism')
        place = [float(found[f'q{k + 1}'][0]) for k in range(count)]
        groups += [('initial', {'coordinate': [k + 1], 'position': [place[k]]}) for k in range(count)]
        modes = case(groups, '--modes')
        roots = None if modes is None else roots_of(modes)
        # a mechanism that rests at a limit of an independent coordinate has other ones there; near a limit, a small motion of that
        # coordinate is a large one of others
        if roots is not None and len(roots) == len(cq) and min(abs(roots)) > 0.5 and max(abs(roots)) < 50 and (
                len(cq) > 1 or weights_of(modes, count)[cq[0] - 1] > 0.2):
            return groups, place, modes
    raise RuntimeError('no member of the family vibrates')


def roots_of(modes):
    return modes['eigenvalue.re'] + 1j * modes['eigenvalue.im']


def weights_of(modes, count):
    """How far each coordinate moves in the first mode, of which the largest number is 1."""
    return abs(np.array([modes[f'q{k}.re'][0] + 1j * modes[f'q{k}.im'][0] for k in range(1, count + 1)]))


def compare(checks, case, place, modes, groups, numbers, why):
    """`numbers` are those of the coordinates in the other file, in the order of the first."""
    found, other = case(groups, '--equilibrium'), case(groups, '--modes')
    if not checks.true(found is not None and other is not None, f'{why}: an equilibrium with modes'):
        return
    checks.near([found[f'q{k}'][0] for k in numbers], place, SAME, f'{why}: the same equilibrium', scale=1.0)
    roots, expected = roots_of(other), roots_of(modes)
    if not checks.equal(len(roots), len(expected), f'{why}: as many modes'):
        return
    checks.near([roots.real, roots.imag], [expected.real, expected.imag], SAME, f'{why}: the same eigenvalues', scale=abs(expected).max())
    shapes = [np.array([table[f'q{k}.re'] + 1j * table[f'q{k}.im'] for k in order])
              for table, order in ((other, numbers), (modes, range(1, len(numbers) + 1)))]
    for mode in range(len(roots)):
        one, two = (shape[:, mode] for shape in shapes)
        # whichever of two equal numbers is the largest
        one = one * two[np.argmax(abs(two))] / one[np.argmax(abs(two))]
        checks.near([one.real, one.imag], [two.real, two.imag], 100 * SAME, f'{why}: the shape of mode {mode + 1}', scale=1.0)


def small_motion(checks, case, groups, place, modes, why):
    """Released from rest beside the equilibrium, a motion is a sum of modes: its coordinates follow the linear equations, whose
    solutions of one freedom are known."""
    root, k = roots_of(modes)[0], next(items['cq'][0] for group, items in groups if group == 'structure')
    size = 1e-5
    start = [(group, {**items, **({'position': [place[k - 1] + size], 'velocity': [0.0]} if items.get('coordinate') == [k] else {})})
             if group == 'initial' else (group, items) for group, items in groups]
    motion = case(start + [('time', {'start': [0], 'end': [float(6 / abs(root))], 'intervals': [60]}),
                           ('solver', {'relative_tolerance': [1e-12], 'absolute_tolerance': [1e-16]})])
    t, s, w = motion['t'], root.real, root.imag
    expected = size * np.exp(s * t) * (np.cos(w * t) - s / w * np.sin(w * t))
    # terms of second order are `size` times a curvature of some tens
    checks.near((motion[f'q{k}'] - place[k - 1]) / size, expected / size, 1e-2, f'{why}: a small motion follows the mode')


@pytest.mark.parametrize('name', FAMILIES)
def test_equilibrium_in_other_numbers(checks, mech9d, tmp_path, name):
    """In other numbers of links and coordinates, turned as a whole, by other independent coordinates; and a small motion."""
    case, family = Case(mech9d, tmp_path), FAMILIES[name]
    # each family has a generator of its own, so that it can be run alone
    rng = np.random.default_rng((3, list(FAMILIES).index(name)))
    groups, place, modes = resting(case, family, rng)
    count, links = len(place), max(max(items['links']) for group, items in groups if group == 'pair')
    cq = next(items['cq'] for group, items in groups if group == 'structure')
    new = [int(k) + 1 for k in rng.permutation(count)]
    new_links = [1, *(int(k) + 2 for k in rng.permutation(links - 1))]
    compare(checks, case, place, modes, with_coordinates(with_links(groups, new_links), new), new, f'{name} in other numbers')
    same = list(range(1, count + 1))
    compare(checks, case, place, modes, rotated(groups, rotation(rng)), same, f'{name}, turned')
    if len(cq) > 1:
        return
    small_motion(checks, case, groups, place, modes, name)
    weights = weights_of(modes, count)
    for k in [k for k in same if k not in cq and weights[k - 1] > 0.2][:3]:
        others = [(group, {'cq': [k]} if group == 'structure' else items) for group, items in groups]
        compare(checks, case, place, modes, others, same, f'{name} by coordinate {k}')
