"""Derivatives by parameters that move no link of a closed chain: they exist, and are zero.

The direction `zero` of a pair from which its coordinate is counted moves `moving_zero` along, unless that is given. Both turn by the
same angle then: the pair's frame turns between its links, and no link and no coordinate does.
"""
import re

import pytest

from mech9_cases import run, table_of

# four-bars whose pairs are parallel, or meet in one point, in directions that no axis has: their closing frames leave out equations
AXIS = '0.5214690752420352,0.20972360202363263,-0.8270949246129187'
ZEROS = ('0.028,0.547,-0.736', '-0.292,-0.782,-0.257', '-1.843,-1.54,-1.552', '-1.112,-0.378,2.043')
POINTS = ('1.4154399429009412,0.7823786163330492,-0.13015464440125002', '0.5059791372662557,1.0784980653373129,-0.6284680006362144',
          '0.9973778334242916,1.888289172207419,-0.11331367094475553', '1.9505688754376322,0.9981360058950831,0.2619437675665244')
AXES = ('0.52,0.21,-0.83', '0.1,0.95,0.3', '-0.7,0.2,0.6', '0.3,-0.5,0.9')
LINKS = ('1,2', '2,3', '3,4', '1,4')
WHEEL = """&pair coordinate=5, links=1,5, kind='revolute', axis=-0.514,-1.648,0.167, zero=-0.072,-0.945,-0.098, point=0.109,-1.227,-0.683 /
&coupling kind='gear', coordinates=3,5, ratio=1.0121208308087115, phase=0 /
"""
REST = """&structure cq=1 /
&drive coordinate=1, kind='harmonic', amplitude=0.1, angular_frequency=6.283185307179586 /
&body link=3, mass=1, inertia=1,1,1,0,0,0 /
&time end=1, intervals=8 /
"""
# A parameter that changes constants by round-off alone is differentiated with any of the steps, down to 4e-8 of its value: 1e-16 over
# that is 2.5e-9. The smallest derivative that is not zero would be about one.
ROUND_OFF = 1e-8


def four_bar(axes, points):
    return ''.join(f"&pair coordinate={k + 1}, links={LINKS[k]}, kind='revolute', axis={axes[k]}, zero={ZEROS[k]}, point={points[k]} /\n"
                   for k in range(4))


FAMILIES = {'parallel': four_bar((AXIS,) * 4, POINTS), 'parallel beside a gear': four_bar((AXIS,) * 4, POINTS) + WHEEL,
            'in one point': four_bar(AXES, (POINTS[0],) * 4), 'in one point beside a gear': four_bar(AXES, (POINTS[0],) * 4) + WHEEL}


@pytest.mark.parametrize('family', FAMILIES)
@pytest.mark.parametrize('forces', [False, True], ids=['motion', 'forces'])
def test_the_direction_of_zero_moves_no_link(checks, mech9k, tmp_path, family, forces):
    path = tmp_path / 'case.nml'
    output = f"&output sensitivities=.true., reactions={'.true.' if forces else '.false.'} /\n"
    # each pair has three components; those of one pair are parameters together
    for pair in range(1, 5):
        parameters = ''.join(f"&parameter name='zero{i}', sets='pair({pair}).zero({i})' /\n" for i in (1, 2, 3))
        path.write_text(parameters + FAMILIES[family] + REST + output, encoding='utf-8')
        table = table_of(mech9k, path)
        checks.equal(len(table['t']), 9, 'all rows are there')
        names = [name for name in table if re.fullmatch(r'd\(d*q\d\)/d\(zero\d\)', name)]
        checks.true(len(names) >= 36, 'the derivatives of all coordinates are there', names)
        for name in names:
            # accelerations have the square of the frequency
            checks.near(table[name], 0 * table['t'], ROUND_OFF * (40 if 'ddq' in name else 1), f'pair {pair}: {name}', scale=1)
        if forces:
            size = max(abs(table[f'R{pair}.f{axis}']).max() for axis in 'xyz')
            for axis in 'xyz':
                for i in (1, 2, 3):
                    values = table[f'd(R{pair}.f{axis})/d(zero{i})']
                    values = values[values == values]    # forces that equilibrium does not determine may have none
                    if len(values):
                        checks.near(values, 0 * values, 100 * ROUND_OFF, f'force in pair {pair} by zero{i}', scale=size)


def test_a_direction_that_opens_a_chain_is_refused(checks, mech9k, tmp_path):
    path = tmp_path / 'case.nml'
    for name in 'pair(2).axis(1)', 'pair(3).axis(3)':
        path.write_text(f"&parameter name='tilt', sets='{name}' /\n" + FAMILIES['parallel'] + REST + "&output sensitivities=.true. /\n",
                        encoding='utf-8')
        done = run(mech9k, path, '--no-write', folder=tmp_path)
        checks.equal(done.returncode, 3, f'{name}: the axes are not parallel any more')
        checks.true('would not stay closed' in done.stderr, f'{name}: the message names the chain', done.stderr)


def test_a_parameter_that_is_zero_but_for_round_off(checks, mech9k, tmp_path):
    # 6e-17 is what a cosine of a right angle leaves; a step in proportion to it would be lost beside the other numbers
    text = """&parameter name='p', value={}, sets='pair(2).point(2)' /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0.1,0.2,1, point=0.3,0.1,0.2, moving_point=0.3,0.1,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0.3,1, point=0.3,0,0.1, moving_point=0.1,0.2,0.4 /
&drive coordinate=1, kind='polynomial', coefficients=0.2, 1 /
&drive coordinate=2, kind='polynomial', coefficients=0.2, 1 /
&point name='P', link=3, position=1,2,3 /
&output sensitivities=.true. /
&time end=1, intervals=4 /
"""
    tables = []
    for value in '0', '6.123e-17':
        path = tmp_path / 'case.nml'
        path.write_text(text.format(value), encoding='utf-8')
        tables.append(table_of(mech9k, path))
    for axis in 'xyz':
        name = f'd(P.{axis})/d(p)'
        checks.near(tables[1][name], tables[0][name], 1e-13, name, scale=1)
    # the point moves with link 2, in which the parameter is a length
    checks.near(sum(tables[1][f'd(P.{axis})/d(p)']**2 for axis in 'xyz'), 1, 1e-13, 'the point moves as far as the axis')
