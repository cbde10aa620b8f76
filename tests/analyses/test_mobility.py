"""The mobility that --check reports, the errors of a wrong choice of independent coordinates, and --branches."""
import os
import re

import numpy as np
import pytest

from mech9_cases import REFERENCE, TREE, run, text_of

DONE, USAGE, DATA, STRUCTURE, ASSEMBLY, SINGULAR = 0, 2, 3, 4, 5, 6

# a crank-rocker in degrees, driven at its crank; the other coordinates are guessed
FOUR_BAR = """
&mechanism links=4, coordinates=4, angle_unit='deg' /
&structure cq={cq} /
&pair coordinate=1, links=1,2, kind='revolute', point=0,0,0, axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.4,0,0, axis=0,0,1, moving_point=0,0,0, moving_axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point=1.1,0,0, axis=0,0,1, moving_point=0.9,0,0, moving_axis=0,0,1 /
&pair coordinate=4, links=1,4, kind='revolute', point=1.2,0,0, axis=0,0,1, moving_point=0,0,0, moving_axis=0,0,1 /
{initial}
{drives}
"""

# a rod with a spherical joint at each end, three revolutes each, between two cranks about crossed axes
ROD = """
&mechanism links=8, coordinates=8 /
&structure cq=1, {spin} /
&pair coordinate=1, links=1,2, kind='revolute', point=0,0,0, axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.3,0,0, axis=1,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.3,0,0, axis=0,1,0 /
&pair coordinate=4, links=4,5, kind='revolute', point=0.3,0,0, axis=0,0,1 /
&pair coordinate=5, links=5,6, kind='revolute', point=1.1,0.5,0.7, axis=1,0,0 /
&pair coordinate=6, links=6,7, kind='revolute', point=1.1,0.5,0.7, axis=0,1,0 /
&pair coordinate=7, links=7,8, kind='revolute', point=1.1,0.5,0.7, axis=0,0,1 /
&pair coordinate=8, links=1,8, kind='revolute', point=1.1,0.1,0.6, axis=1,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0.1 /
&drive coordinate={spin}, kind='polynomial', coefficients=0.2 /
"""

# four-bar in one line: both branches meet there; on link 4 an open chain
FLAT = """
&mechanism links=5, coordinates=5 /
&structure cq={cq} /
&pair coordinate=1, links=1,2, kind='revolute', point=0,0,0, axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=1,0,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point=3,0,0, axis=0,0,1 /
&pair coordinate=4, links=4,1, kind='revolute', point=2,0,0, axis=0,0,1 /
&pair coordinate=5, links=4,5, kind='revolute', point=3,1,0, axis=0,0,1 /
{drives}
"""

# Three parallel cranks of one length on a coupler: the third one repeats what the first two say. A dyad drives the
# coupler, so that all three chains are solved together.
THREE_CRANKS = """
&mechanism links=7, coordinates=9 /
&structure cq=1 /
&pair coordinate=1, links=1,6, kind='revolute', point=2,0,0, axis=0,0,1 /
&pair coordinate=2, links=6,5, kind='revolute', point=2.2,0.9,0, axis=0,0,1 /
&pair coordinate=3, links=5,3, kind='revolute', point=1.6,1.2,0, axis=0,0,1 /
&pair coordinate=4, links=2,3, kind='revolute', point=0.3,0.5,0, axis=0,0,1 /
&pair coordinate=5, links=1,2, kind='revolute', point=0,0,0, axis=0,0,1 /
&pair coordinate=6, links=1,4, kind='revolute', point=1,0,0, axis=0,0,1 /
&pair coordinate=7, links=4,3, kind='revolute', point=1.3,0.5,0, axis=0,0,1 /
&pair coordinate=8, links=1,7, kind='revolute', point=0.6,0.4,0, axis=0,0,1 /
&pair coordinate=9, links=7,3, kind='revolute', point=0.9,0.9,0, axis=0,0,1 /
&drive coordinate=1, kind='polynomial', coefficients=0 /
"""

# a slider-crank of any size
SLIDER_CRANK = """
&mechanism links=4, coordinates=4 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', point=0,0,0, axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0,{size:.1e},0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point={size:.1e},0,0, axis=0,0,1 /
&pair coordinate=4, links=1,4, kind='prismatic', point={size:.1e},0,0, axis=1,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0 /
"""


class Cases:
    def __init__(self, mech9k, folder, checks):
        self.mech9k, self.folder, self.checks = mech9k, folder, checks

    def ends(self, program, code, text, *options):
        path = os.path.join(self.folder, 'case.nml')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        done = run(program, path, *options, folder=self.folder)
        self.checks.true(done.returncode == code, f'{options}: exit code {code}',
                         f'it was {done.returncode}\n{done.stdout}{done.stderr}')
        return done

    def says(self, text, *parts):
        for part in parts:
            self.checks.true(part in text, f'says "{part}"', text)


@pytest.fixture
def s(checks, mech9k, tmp_path):
    return Cases(mech9k, tmp_path, checks)


def four_bar(cq='1', initial='', drives="&drive coordinate=1, kind='polynomial', coefficients=40 /"):
    return FOUR_BAR.format(cq=cq, initial=initial, drives=drives)


def flat(*cq):
    still = "&drive coordinate={}, kind='polynomial', coefficients=0 /\n"
    return FLAT.format(cq=', '.join(map(str, cq)), drives=''.join(map(still.format, cq)))


REPORTS = {
    'kinematics_fig1': ['mobility by the count: 1 = 7 coordinates - 6', 'mobility by the rank: 1 = 7 coordinates - rank 6',
                        'block 1: closed chain 1, 3 equations, rank 3', 'block 2: closed chain 2, 3 equations, rank 3',
                        'could be independent instead of 5: 1, 2, 3, 4, 6, 7'],
    # driven in its second chain, both are one block
    'kinematics_fig1_driven_at_q1': ['block 1: closed chains 1, 2 together, 6 equations, rank 6'],
    # Bennett: the count says that it cannot even be assembled
    'kinematics_bennett': ['mobility by the count: -2 =', 'mobility by the rank: 1 = 4 coordinates - rank 3',
                           'closed chain 1: 3 of its 6 equations redundant', 'could be independent instead of 1: 2, 3, 4'],
    # its rod stays parallel to the plane of the crank, the axes normal to it alone turn
    'kinematics_spatial_slider_crank': ['cannot move, hence not be independent: 2, 3, 5']}


@pytest.mark.parametrize('name', REPORTS)
def test_mobility_of_references(s, name):
    done = run(s.mech9k, os.path.join(REFERENCE, name + '.nml'), '--check')
    s.checks.equal(done.returncode, DONE, f'{name} --check')
    s.says(done.stdout, *REPORTS[name])
    s.checks.true('singular position' not in done.stdout, f'{name}: nothing singular at its start', done.stdout)


def test_mobility_in_a_singular_position(s):
    """The run would not start there, hence the check refuses it too, and says what it knows."""
    done = s.ends(s.mech9k, SINGULAR, flat(1, 5), '--check')
    s.says(done.stdout, 'rank 3; at the start only 2: a singular position', 'independent in any case: 5',
           'on no closed chain: 5', 'could be independent instead of 1: 2, 3, 4')


def test_idle_rod(s):
    done = s.ends(s.mech9k, DONE, ROD.format(spin=2), '--check')
    s.says(done.stdout, 'mobility by the rank: 2', 'idle: coordinates 2, 3, 4, 5, 6, 7 can move while links 2 and 8 stand still')


def test_redundant_crank(s):
    done = s.ends(s.mech9k, DONE, THREE_CRANKS, '--check')
    s.says(done.stdout, 'mobility by the count: 0 = 9 coordinates - 9', 'mobility by the rank: 1 = 9 coordinates - rank 8',
           'block 1: closed chains 1, 2, 3 together, 9 equations, rank 8', 'closed chain 2: 1 of its 3 equations redundant')
    s.checks.equal(done.stdout.count('redundant'), 1, 'the third crank alone is one too many')


@pytest.mark.parametrize('size', [1e-12, 1.0, 1e12])
def test_mobility_in_any_size(s, size):
    """A mechanism that moves does so in any size."""
    done = s.ends(s.mech9k, DONE, SLIDER_CRANK.format(size=size), '--check')
    s.says(done.stdout, 'mobility by the rank: 1', 'could be independent instead of 1: 2, 3, 4')


STILL = "&drive coordinate={}, kind='polynomial', coefficients=0 /\n"


def test_too_many_independent_coordinates(s):
    done = s.ends(s.mech9k, STRUCTURE, four_bar('1, 2', drives=STILL.format(1) + STILL.format(2)), '--check')
    s.says(done.stderr, 'the mobility is 1', '2 coordinates are independent', 'take 1 of the coordinates 1, 2 off',
           'cq = 1 would serve; instead of 1 also 2, 3, 4')


def test_wrong_choices_beside_an_open_chain(s):
    done = s.ends(s.mech9k, STRUCTURE, flat(1), '--check')
    s.says(done.stderr, 'the mobility is 2', 'coordinate 5 must be independent, too (cq)', 'cq = 1, 5 would serve')
    done = s.ends(s.mech9k, STRUCTURE, flat(1, 4, 5))
    s.says(done.stderr, 'the mobility is 2', 'take 1 of the coordinates 1, 4 off')
    done = s.ends(s.mech9k, STRUCTURE, flat(1, 4))
    s.says(done.stderr, 'coordinate 5 must be independent, too', 'take 1 of the coordinates 1, 4 off')


def test_wrong_choice_of_a_rod(s):
    """The rod has two freedoms, but only one of them can move the cranks."""
    done = s.ends(s.mech9k, STRUCTURE, ROD.format(spin=8), '--check')
    s.says(done.stderr, 'the mobility is 2', 'take 1 of the coordinates 1, 8 off',
           '1 more of the coordinates 2, 3, 4, 5, 6, 7 must be independent')


def test_wrong_choice_is_told_before_drives(s):
    """The choice is told before the drives that it leaves out."""
    done = s.ends(s.mech9k, STRUCTURE, four_bar('1, 2', drives=STILL.format(1)), '--check')
    s.says(done.stderr, 'the mobility is 1', 'take 1 of the coordinates 1, 2 off', 'coordinate 2 has no drive')
    s.checks.true(done.stderr.index('mobility') < done.stderr.index('no drive'), 'the choice before the drives', done.stderr)


def test_right_choice_without_its_drive(s):
    """It is a matter of the data alone."""
    done = s.ends(s.mech9k, DATA, four_bar('2', drives=STILL.format(1)), '--check')
    s.says(done.stderr, 'coordinate 2 has no drive')
    s.checks.true('mobility' not in done.stderr, 'nothing to say against the choice', done.stderr)


def test_structure_is_told_whatever_the_choice(s):
    done = s.ends(s.mech9k, DONE, flat(1, 4), '--structure')
    s.says(done.stdout, 'nrg = 1')


def test_branches(s):
    done = s.ends(s.mech9k, DONE, four_bar(), '--branches')
    s.says(done.stdout, '! 2 assemblies found from 100 starts')
    s.checks.equal(done.stdout, s.ends(s.mech9k, DONE, four_bar(), '--branches').stdout, 'the same starts each time')
    s.says(s.ends(s.mech9k, DONE, four_bar(), '--branches', '--starts', '30').stdout, 'from 30 starts')
    found = [np.array([float(value) for value in re.findall(r'position=(\S+)', part)])
             for part in re.split(r'! assembly .*\n', done.stdout)[1:]]
    s.checks.equal([len(values) for values in found], [3, 3], 'coordinates 2, 3, 4 of two assemblies')
    # the rocker by the law of cosines: lengths 0.4, 1.1, 0.9, frame 1.2, crank at 40 degrees
    crank = np.radians(40.0)
    tip = np.array([0.4 * np.cos(crank) - 1.2, 0.4 * np.sin(crank)])
    diagonal = np.hypot(*tip)
    opening = np.arccos((0.9 ** 2 + diagonal ** 2 - 1.1 ** 2) / (2.0 * 0.9 * diagonal))
    rockers = np.degrees(np.arctan2(tip[1], tip[0]) + np.array([-opening, opening]))
    rockers = (rockers + 180.0) % 360.0 - 180.0
    # angles of some radians are closed to 1e-15 over a conditioning of 0.1
    s.checks.near(sorted(values[2] for values in found), sorted(rockers), 1e-12, 'the two rockers, in degrees')
    # the groups of one assembly lead to it
    for part, values in zip(re.split(r'! assembly .*\n', done.stdout)[1:], found):
        again = s.ends(s.mech9k, DONE, four_bar(initial=part), '--check')
        numbers = [float(value) for value in re.findall(r'^ +q[234] +(\S+)', again.stdout, re.M)]
        s.checks.near(numbers, values, 1e-12, 'an assembly as the guess leads to itself')


@pytest.mark.parametrize('wrong', ['0', '-3', 'many', '99999999999999'])
def test_wrong_numbers_of_starts(s, wrong):
    s.ends(s.mech9k, USAGE, four_bar(), '--branches', '--starts=' + wrong)


# the crank and rocker of examples/rsur, with joints of several freedoms
RSUR = """
&mechanism links=4, coordinates=7 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinates=2,3,4, links=2,3, kind='spherical', point=0.2,0,0 /
&pair coordinates=5,6, links=3,4, kind='universal', axis=0.5,0,-0.1, moving_axis=0,1,0, point=0.3,0.5,0.5 /
&pair coordinate=7, links=1,4, kind='revolute', axis=1,0,0, point=0.3,0.5,-0.1 /
&drive coordinate=1, kind='polynomial', coefficients=0, 6.283185307179586 /
"""


@pytest.mark.parametrize('data, links', [
    (RSUR, '3'), (text_of(os.path.join(TREE, 'examples', 'rsur', 'rsur.nml')), '3, 4, 5, 6')], ids=['joints', 'example'])
def test_postures_are_no_assemblies(s, data, links):
    """Settings of joints and turns of rods make no assemblies: the rocker has two angles."""
    done = s.ends(s.mech9k, DONE, data, '--branches')
    s.says(done.stdout, '! 2 assemblies found from 100 starts')
    s.says(done.stdout, f'their settings are not counted: {links}\n')


def test_chain_that_stays_open(s):
    done = s.ends(s.mech9k, ASSEMBLY, four_bar().replace('point=1.2,0,0', 'point=4,0,0'))
    s.says(done.stderr, 'closed chain 1', 'stays open by')
    # the least gap is at most what the links lack to reach so far
    gap = float(re.search(r'stays open by (\S+) m', done.stderr).group(1))
    tip = np.hypot(0.4 * np.cos(np.radians(40.0)) - 4.0, 0.4 * np.sin(np.radians(40.0)))
    s.checks.true(0.1 < gap <= 1.001 * (tip - 2.0), 'the gap is what the links lack', f'{gap}, {tip - 2.0}')
