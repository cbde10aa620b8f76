"""Names of links, pairs, points, parameters and numbers that Tab completes in a conversation at a terminal."""
import os

import pytest

from four_bars import NAMED_BARS
from mech9_cases import text_of
from pseudo_terminal import Terminal, needs_terminal

BARS = NAMED_BARS + """&point name='coupler_point', link=3, position=0.5,0.1,0 /
&parameter name='diagonal', value=1 /
&parameter name='half', formula='diagonal/2', sets='pair(3).point(2)' /
&drive coordinate='A', kind='polynomial', coefficients=0.4, 10 /
&time end=0.2, intervals=8 /
"""
RIGHT = 'right: '
# steps: what is expected, and what is typed then
TALKS = {
    'links in a correction': (((RIGHT, 'point 1 link = roc\t\r'),), "link='rocker'"),
    'links at a question': (((RIGHT, 'point 1 link\r'), ('link [3]: ', 'cr\t\r')), "link='crank'"),
    'pairs within quotes': (((RIGHT, "initial 1 position = 1.1\r"), (RIGHT, "structure cq = 'D\t\r"),), "cq='D'"),
    'columns': (((RIGHT, 'add quantity\r'), ('name', 'swing\r'), ('of', 'D.d\t'), ('D.ddq', 'q\r'), ('take', 'max\r')), "of='D.dq'"),
    'columns of points': (((RIGHT, 'add quantity\r'), ('name', 'way\r'), ('of', 'cou\tax\r'), ('take', 'max\r')),
                          "of='coupler_point.ax'"),
    'numbers of parameters': (((RIGHT, 'parameter 2 sets\r'), ('sets', 'pair(C).po\t1)\r')), "sets='pair(C).point(1)'"),
    'parameters in formulas': (((RIGHT, 'parameter 2 formula = sqrt(dia\t\x7f)\r'),), "formula='sqrt(diagonal)'")}
# the question behind the last step, where it is not for another answer: the coordinate that is independent then needs a drive
NEXT = {'pairs within quotes': 'kind [polynomial]: '}


@needs_terminal
@pytest.mark.parametrize('why', TALKS)
def test_completed_names(checks, build, mech9k, tmp_path, why):
    if build.settings.get('MECH9_LINE_EDITING') != 'ON' or build.settings.get('MECH9_LIBEDIT', 'NOTFOUND').endswith('NOTFOUND'):
        pytest.skip('the programs are built without libedit, so that lines cannot be edited')
    steps, expected = TALKS[why]
    with open(os.path.join(tmp_path, 'bars.nml'), 'w', encoding='utf-8') as file:
        file.write(BARS)
    with Terminal([mech9k, '--edit', 'bars.nml'], folder=tmp_path) as terminal:
        for prompt, keys in steps:
            checks.true(terminal.expect(prompt), f'{why}: asks {prompt!r}', terminal.seen)
            terminal.type(keys)
        checks.true(terminal.expect(NEXT.get(why, RIGHT)), f'{why}: goes on', terminal.seen)
        terminal.type('quit\r')
        terminal.ends()
    checks.true(expected in text_of(os.path.join(tmp_path, 'bars.draft.nml')), f'{why}: {expected}', terminal.seen)
