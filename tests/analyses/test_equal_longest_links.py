"""Derivatives of reactions that equilibrium determines, where two links are the longest and equally long.

Moments are divided by the largest length of a link for the least norm of reactions that equilibrium does not determine. Where two links
are equally long, this length has no derivative, and such reactions have none. All others do not depend on it: a link that is longer
than both changes nothing, also beside a singular position, in which round-off is large.

Compares the program with itself: one parallelogram without and with a longer link beside it.
"""
import math

import numpy as np

from mech9_cases import table_of

PARALLELOGRAM = """
&mechanism links=5, coordinates=5 /
&structure cq=1, 5 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point={a[0]!r},{a[1]!r},0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point={b[0]!r},{b[1]!r},0 /
&pair coordinate=4, links=1,4, kind='revolute', axis=0,0,1, point={base!r},0,0 /
&pair coordinate=5, links=1,5, kind='revolute', axis=0,0,1, point={far!r},0,0 /
&body link=2, mass=1, centre=0.3,0.1,0.05, inertia=0.1,0.1,0.1,0,0,0 /
&body link=3, mass=2, centre=1,1,0.1, inertia=0.1,0.2,0.3,0,0,0 /
&body link=4, mass=1.5, centre=2,1,0.2, inertia=0.1,0.2,0.3,0,0,0 /
&gravity acceleration=0,-9.81,1 /
&drive coordinate=1, kind='polynomial', coefficients=0, 0.6283185307179586 /
&drive coordinate=5, kind='polynomial', coefficients=0 /
&time start=0, end={end!r}, intervals=20 /
&parameter name='base', sets='pair(4).point(1)' /
&parameter name='crank', sets='pair(2).point(1)' /
&output reactions=.true., reaction_pairs=1,2,3,4, drive_forces=.true., sensitivities=.true. /
"""
PHASE = 0.3     # angle of the crank at home


def columns(program, folder, crank, base, beside, far):
    """The table of a run whose row 10 is as far beside the flat position as `beside` says, in parts of the time."""
    a = crank * math.cos(PHASE), crank * math.sin(PHASE)
    path = folder / 'case.nml'
    path.write_text(PARALLELOGRAM.format(a=a, b=(a[0] + base, a[1]), base=base, far=far,
                                         end=2 * (math.pi - PHASE) / 0.6283185307179586 * (1 + beside)), encoding='utf-8')
    return table_of(program, path)


def in_plane(table):
    return [name for name in table if name.startswith(('d(R', 'd(F1')) and ('.fx' in name or '.fy' in name or 'F1' in name)]


def test_in_plane_reactions_have_derivatives(checks, mech9k, tmp_path):
    for crank, base, nearest in (1.5, 1.0, 1e-6), (0.5, 2.0, 2e-6), (1.0, 3.0, 1e-5):
        for beside in 0.1, 1e-3, 1e-5, nearest:
            equal = columns(mech9k, tmp_path, crank, base, beside, 0.5 * base)
            longer = columns(mech9k, tmp_path, crank, base, beside, 10.0)
            names = in_plane(equal)
            checks.equal(len(names), 2 * (2 * 4 + 1), 'forces of four pairs and of the drive, by two parameters')
            # some hundred units of round-off, which grow beside the flat position, once for the positions and once for the forces
            angle = PHASE + longer['q1']
            tolerance = np.minimum(1e-6, 4e-14 / np.sin(angle)**2 + 1e-12)
            largest = np.max([np.abs(longer[name]) for name in names], axis=0)
            for name in names:
                why = f'{crank}, {base}, {beside}: {name}'
                checks.true(bool(np.isfinite(equal[name]).all()), f'{why} exists in all rows')
                error = np.abs(equal[name] - longer[name]) / (tolerance * largest)
                checks.true(bool(np.nanmax(error) <= 1), f'{why}: a longer link changes nothing', str(error))


def test_reactions_that_depend_on_the_length_have_none(checks, mech9k, tmp_path):
    for beside in 0.1, 1e-6:
        equal = columns(mech9k, tmp_path, 1.5, 1.0, beside, 0.5)
        longer = columns(mech9k, tmp_path, 1.5, 1.0, beside, 10.0)
        for name in 'd(R1.fz)/d(crank)', 'd(R2.fz)/d(crank)', 'd(R4.fz)/d(base)':
            checks.true(bool(np.isnan(equal[name]).all()), f'{beside}: {name} is not known')
            checks.true(bool(np.isfinite(longer[name]).all()), f'{beside}: {name} is known beside a longer link')
