"""One moment of inertia is enough for a link that turns about one direction only, in whatever plane it moves.

The oracle is the same mechanism with whole tensors: n n' I against n n' I + (1 - n n') I/2, whose moment about n is I
too. Only the moment about n enters the equations of such a link, so that both motions are the same.

Compares the program with itself: links with one moment of inertia and with whole tensors.
"""
import numpy as np
import pytest

from mech9_cases import run, table_of

DATA = 3

# a four-bar in the plane of e1 and e2; all its links have mass
FOUR_BAR = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis={n}, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis={n}, point={a} /
&pair coordinate=3, links=3,4, kind='revolute', axis={m}, point={b} /
&pair coordinate=4, links=1,4, kind='revolute', axis={n}, point={c} /
&initial coordinate=1, position=0, velocity=1 /
&body link=2, mass=1, centre={a}, inertia={j2} /
&body link=3, mass=2, centre={b}, inertia={j3} /
&body link=4, mass=1, centre={c}, inertia={j4} /
&gravity acceleration={g} /
&solver relative_tolerance=1e-12, absolute_tolerance=1e-12 /
&time end=1, intervals=10 /
"""

# an arm that turns about z, slides up a column, and turns about x at its end; {last} is the inertia of the last link
ARM = """&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', axis=1,0,0, point=1,0,0 /
&initial coordinate=1, position=0 /
&initial coordinate=2, position=0, velocity=1 /
&initial coordinate=3, position=0, velocity=2 /
&body link=3, mass=1, centre=0.5,0,0, inertia={arm} /
&body link=4, mass=1, centre=1,0.2,0, inertia={last} /
&solver relative_tolerance=1e-12, absolute_tolerance=1e-12 /
&time end=1, intervals=10 /
"""


def numbers(values):
    return ','.join(repr(float(value)) for value in values)


def tensor(n, moment, across):
    """xx, yy, zz, xy, xz, yz of a tensor with a moment about n and another one across it."""
    j = across * np.eye(3) + (moment - across) * np.outer(n, n)
    return numbers([j[0, 0], j[1, 1], j[2, 2], j[0, 1], j[0, 2], j[1, 2]])


def four_bar(n, across):
    e1 = np.cross(n, [0.3, -0.5, 0.8])
    e1 /= np.linalg.norm(e1)
    e2 = np.cross(n, e1)
    at = {name: numbers(x * e1 + y * e2) for name, (x, y) in {'a': (0.3, 0.2), 'b': (1.2, 0.8), 'c': (1.1, 0)}.items()}
    inertias = {f'j{i}': tensor(n, moment, across * moment) for i, moment in ((2, 0.02), (3, 0.3), (4, 0.1))}
    return FOUR_BAR.format(n=numbers(n), m=numbers(-np.asarray(n)), g=numbers(-9.81 * e2), **at, **inertias)


def same_motion(checks, program, folder, single, whole):
    path, tables = folder / 'case.nml', []
    for text in (single, whole):
        path.write_text(text, encoding='utf-8')
        tables.append(table_of(program, path))
    for column in tables[1]:
        if column != 'closure':
            # the same equations; round-off of the tensors changes steps, whose errors of 1e-12 grow a hundredfold
            checks.near(tables[0][column], tables[1][column], 1e-9, column)


@pytest.mark.parametrize('normal', [[0, 0, 1], [1, 0, 0], [0, 0.6, 0.8], [2 / 3, -1 / 3, 2 / 3]], ids=['z', 'x', 'in_yz', 'oblique'])
def test_four_bar_in_any_plane(checks, mech9d, tmp_path, normal):
    normal = np.array(normal, float)
    same_motion(checks, mech9d, tmp_path, four_bar(normal, 0), four_bar(normal, 0.5))


def test_arm(checks, mech9d, tmp_path):
    """A link between that only the slide and the turn about z move."""
    same_motion(checks, mech9d, tmp_path, ARM.format(arm='0,0,0.4,0,0,0', last='0.1,0.1,0.1,0,0,0'),
                ARM.format(arm='0.2,0.2,0.4,0,0,0', last='0.1,0.1,0.1,0,0,0'))


@pytest.mark.parametrize('arm, last, words', [
    ('0,0.4,0,0,0,0', '0.1,0.1,0.1,0,0,0', ['yy exceeds', 'pair 2 lets link 3 turn otherwise']),
    ('0,0,0.4,0,0,0', '0,0,0.1,0,0,0', ['zz exceeds', 'pair 3 lets link 4 turn otherwise', 'give all three moments']),
    ('0,0,0.4,0,0,0', '0.1,0,0,0,0,0', ['xx exceeds', 'pair 2 lets link 4 turn otherwise']),
    # two moments are neither a body's nor one moment
    ('0,0.1,0.4,0,0,0', '0.1,0.1,0.1,0,0,0', ['zz exceeds the sum of the two others'])],
    ids=['of_another_axis', 'of_a_link_behind', 'about_its_own_axis', 'two'])
def test_moments_that_are_not_enough(checks, mech9d, tmp_path, arm, last, words):
    path = tmp_path / 'case.nml'
    path.write_text(ARM.format(arm=arm, last=last), encoding='utf-8')
    done = run(mech9d, path, '--check', folder=tmp_path)
    checks.equal(done.returncode, DATA, f'{words}: exit code')
    for one in words:
        checks.true(one in done.stderr, f'says {one}', done.stderr)
