"""Names of links and pairs, and parameters that are formulas, in the package."""
import sys
import types

import numpy as np
import pytest

GROUPS = """&mechanism /
&link number=2, name='crank' /
&structure cq='A' /
&pair coordinate=1, name='A', links=1,'crank', kind='revolute', axis=0,0,1 /
&pair coordinate=2, name='B', links='crank',3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0.8,0,0 /
&pair coordinate=4, name='D', links=1,4, kind='revolute', axis=0,0,1, point=0.9,0,0, moving_point=0,0,0 /
&initial coordinate='D', position=1.2 /
&drive coordinate='A', kind='polynomial', coefficients=0.4, 10 /
&point name='P', link='crank', position=0.1,0,0 /
&parameter name='f', formula='sqrt(a^2 + b^2) - 0.2', sets='pair(B).point(1)' /
&parameter name='a', value=0.3 /
&parameter name='b', value=0.4 /
&quantity name='swing', of='D.q', take='end' /
"""


def test_numbers_by_names(checks, mech9):
    m = mech9.read_text(GROUPS)
    checks.near(m['pair(B).point(1)'], 0.3, 1e-14, 'a number by the name of its pair')
    checks.true(m.parameters == ('a', 'b'), 'formulas are no parameters')
    checks.true(m['a'] == 0.3 and m['b'] == 0.4 and m['parameter(b).value'] == 0.4, 'parameters behind a formula')
    m['a'] = 0.35
    m['pair(D).point(1)'] = 0.95
    checks.near(m['pair(B).point(1)'], np.hypot(0.35, 0.4) - 0.2, 1e-14, 'the formula follows')
    checks.true(m['pair(4).point(1)'] == 0.95, 'a number set by a name')
    with pytest.raises(mech9.UsageError, match="the formula of parameter 'f' sets"):
        m['pair(B).point(1)'] = 0.2
    with pytest.raises(mech9.DataError, match="no &pair of the name 'E'"):
        m['pair(E).point(1)']
    again = mech9.read_text(m.text())
    checks.true(again['pair(B).point(1)'] == m['pair(B).point(1)'] and "'crank'" in m.text() and 'sqrt(a^2 + b^2) - 0.2' in m.text(),
                'the text keeps names and formulas')


def test_columns_by_names(checks, mech9):
    r = mech9.read_text(GROUPS).kinematics(end=0.1, intervals=4, reactions=True, drive_forces=True)
    for named, number in (('D.q', 'q4'), ('B.ddq', 'ddq2'), ('A.drive', 'F1'), ('B.fx', 'R2.fx'), ('P.x', 'P.x')):
        checks.true(np.array_equal(r[named], r[number]), f'{named} is {number}')
    for wrong in ('E.q', 'crank.q', 'D.x', '.q', 'D.'):
        with pytest.raises(KeyError):
            r[wrong]


def test_plots_by_names(checks, mech9, monkeypatch):
    """A column that has the name of its pair is drawn with its unit. A stand-in for matplotlib keeps what it is asked to draw."""
    asked = []

    class Axes:
        """Axes that keep the labels."""
        def plot(self, *values, label=''):
            asked.append(label)

        def __getattr__(self, name):
            return lambda *values, **words: asked.extend(values if name.endswith('label') else [])

    figure = types.SimpleNamespace(Figure=lambda: types.SimpleNamespace(add_subplot=Axes))
    monkeypatch.setitem(sys.modules, 'matplotlib', types.SimpleNamespace(figure=figure))
    monkeypatch.setitem(sys.modules, 'matplotlib.figure', figure)
    r = mech9.read_text(GROUPS).kinematics(end=0.1, intervals=4)
    r.plot('D.q')
    r.plot('A.q', 'D.dq')
    checks.equal(asked, ['D.q [rad]', 't [s]', '', 'A.q [rad]', 'D.dq [rad/s]'], 'labels')


def test_groups_may_come_before_their_names(checks, mech9):
    m = mech9.Mechanism(title='by groups')
    m.add('pair', coordinate=1, name='A', links=(1, 'crank'), kind='revolute', axis=(0, 0, 1))
    m.add('link', number=2, name='crank')
    m.add('drive', coordinate='A', kind='polynomial', coefficients=(0, 1))
    m.add('structure', cq='A')
    checks.near(m.kinematics(end=0.5, intervals=2)['A.q'][-1], 0.5, 1e-15, 'a mechanism from groups')
    m.add('point', name='P', link='rank', position=(1, 0, 0))
    with pytest.raises(mech9.DataError, match="no link with the name 'rank'; did you mean 'crank'"):
        m.check()


def test_functions_and_studies_follow_formulas(checks, mech9):
    m = mech9.read_text(GROUPS)
    f = m.function(['a', 'b'], ['swing'])
    j = f.jacobian(np.array([0.3, 0.4]))
    checks.near(j[0, 0] * 0.8, j[0, 1] * 0.6, 1e-12, 'the derivatives are in the ratio of those of the formula')
    h = 2.0**-10
    slope = (f(np.array([0.3 + h, 0.4])) - f(np.array([0.3 - h, 0.4])))[0] / (2 * h)
    checks.near(j[0, 0], slope, 1e-5, 'the derivative by a is a slope')


def test_answers_by_names(checks, mech9):
    """Assemblies, equilibria and ranges know the names of pairs; a range tells what limits it."""
    m = mech9.read_text(GROUPS.replace("&drive coordinate='A', kind='polynomial', coefficients=0.4, 10 /", """
&initial coordinate='A', position=0.4, velocity=0 /
&gravity acceleration=0,-9.81,0 /
&body link=3, mass=1, centre=0.5,0,0, inertia=0,0,0.1,0,0,0 /""").replace('value=0.3', 'value=0.9'))
    modes = m.modes()
    checks.true(np.array_equal(modes['D.q.re'], modes['q4.re']), 'a column of modes')
    for rows in (m.assemblies(), m.equilibrium()):
        checks.true(np.array_equal(rows['D.q'], rows['q4']), 'a column by the name of its pair')
    ranges = m.range()
    checks.equal(ranges.report['coordinate_names'], ['A', 'B', '', 'D'], 'names by numbers')
    told, = ranges.report['ranges']
    checks.equal((told['coordinate'], told['name'], told['unit']), (1, 'A', ranges.units['lower']), 'the coordinate by number and name, and its unit')
    checks.equal(ranges.units['upper'], m.assemblies().units['q1'], 'the unit of the file')
    checks.true('2 (B), 3, 4 (D)' in told['limited_by'], f'the limit by names: {told}')
