"""Failures of numerics reach the user as sentences, with their exit codes; none leaves the programs as a bare kind.

Each kind of failure is provoked here by a data file, or it is named in UNREACHABLE with the reason why no data file leads to
it; tests/wording/test_explanation.f90 then has its sentence.

The closed forms behind the numbers are those of four-bars: a chain of three bars in one line is at its dead point.
"""
import math
import os
import re

import pytest

from failures import kinds
from free_delta import delta
from contact_cases import DRIVEN_POINT, PRESSED_POINT, ROD, SLIDING_POINT, STILL_POINT, SUNK_POINT, TWO_FEET
from friction_cases import FIVE_RUBBING, FOUR_RUBBING, LADDER, RUBBING, WEDGE
from mech9_cases import TREE, run, text_of

DONE, DATA, STRUCTURE, ASSEMBLY, SINGULAR, INTEGRATOR = 0, 3, 4, 5, 6, 7

# kinds that need trial steps with numbers beyond all bounds, at which the builds that are not optimised trap overflow
OVERFLOWING = ('unclosed_step', 'infinite_rate')
# kind: the reason why no data file leads to it
UNREACHABLE = {
    'other_branch': 'a motion then goes on in its present coordinates',
    'unknown_method': 'the reader refuses the name with its place',
    'relative_tolerance': 'the reader refuses the number with its place',
    'absolute_tolerance': 'the reader refuses the number with its place',
    'tolerance_count': 'motions give each variable its tolerance',
    'no_jacobian': 'only systems that have a Jacobian are asked for it',
    'infinite_jacobian': 'motions have no Jacobian of their own',
    'step_memory': 'the memory of an integration is small beside that of the mechanism',
    'step_settings': 'an error of the program itself',
    'few_points': 'the reader of tables refuses the file',
    'points_order': 'the reader of tables refuses the line with its place',
    'drive_jumps': 'drives of the data file are continuous',
    'lost_inertia': 'only steps to positions beyond all sense lose it: tests/simulation/test_simulation.f90',
    'unheld_stop': 'closed stops are independent of each other, and are exchanged for what moves them most',
    'no_friction': 'where frictions have no solution, the paradox is told',
    'contact_paradox': 'sliding contacts lift off or come to rest before: Genot and Brogliato 1999',
    'undecided_friction': 'accelerations have the directions of slip as long as frictions have one solution',
    'lost_angles': 'positions within a step that was made are always found',
    'not_started': 'the programs start each motion',
    'backwards': 'the times of a data file are in order',
    'interrupted': 'a signal leads to it: test_interrupted_run.py',
    'interrupted_starts': 'a signal leads to it: test_interrupted_run.py',
}


# --- mechanisms -----------------------------------------------------------------------------------------------------

def revolute(k, links, point='0,0,0', moving_point='0,0,0', axis='0,0,1'):
    return (f"&pair coordinate={k}, links={links[0]},{links[1]}, kind='revolute', point={point}, moving_point={moving_point}, "
            f'axis={axis} /\n')


def drive(k, coefficients='0'):
    return f"&drive coordinate={k}, kind='polynomial', coefficients={coefficients} /\n"


def initial(k, position, more=''):
    return f'&initial coordinate={k}, position={position!r}{more} /\n'


def structure(*independent):
    return f'&structure cq={",".join(map(str, independent))} /\n'


ROCKER = (1.2, 0.7, 0.9, 0.4)        # ground, crank, coupler, rocker; the crank cannot turn round
FLAT = (1.0, 0.4, 1.0, 0.4)          # a parallelogram, in one line at 0 degrees
# the second axis has turned by 90 degrees: the first and the third one are parallel
BALL_JOINT = ("&mechanism angle_unit='deg' /\n&structure cq=1,2,3 /\n"
              + ''.join(f"&pair coordinate={k}, links={k},{k + 1}, kind='revolute', axis={axis} /\n"
                        f'&initial coordinate={k}, position={90 if k == 2 else 0} /\n'
                        for k, axis in enumerate(('1,0,0', '0,1,0', '0,0,1'), 1))
              + '&body link=4, mass=1, centre=0,0,0.1, inertia=1,1,1,0,0,0 /\n')
BODY = '&body link=2, mass=1, centre=0.1,0,0 /\n'
START = initial(1, 40, ', velocity=10')


def four_bar(bars, *groups, cq=(1,), end=1, offset='0'):
    """In degrees; `offset` is that of the coupler's first pin along the axes."""
    ground, crank, coupler, rocker = bars
    return ("&mechanism links=4, coordinates=4, angle_unit='deg' /\n" + structure(*cq) + revolute(1, (1, 2))
            + revolute(2, (2, 3), f'{crank},0,{offset}') + revolute(3, (3, 4), f'{coupler},0,0', f'{rocker},0,0')
            + revolute(4, (1, 4), f'{ground},0,0') + f'&time start=0, end={end}, intervals=10 /\n' + ''.join(groups))


def dead_point(bars):
    """The crank angle in degrees where the coupler and the rocker are in one line."""
    ground, crank, coupler, rocker = bars
    return math.degrees(math.acos((ground ** 2 + crank ** 2 - (coupler + rocker) ** 2) / (2 * ground * crank)))


def turned(angle):
    """The dependent coordinates of FLAT as a parallelogram at a crank angle in degrees."""
    return initial(2, -angle) + initial(3, angle) + initial(4, angle)


def open_chain(first, link, n):
    """n revolutes in a row from link 1, with the numbers of pairs and links from `first` and `link` on."""
    return ''.join(revolute(first + i, (1 if i == 0 else link + i - 1, link + i), '0,0,0' if i == 0 else '1,0,0') for i in range(n))


# In mechanisms with more than 500 coordinates the mobility of the whole is not worked out. Long open chains beside a closed one
# bring those messages about that only its own blocks can give.
LONG = 500


BODY_ON_DRIVE = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,1,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&drive coordinate=1, kind='segments', times=0,0.5,3, values=0,1,2, laws='constant-velocity','constant-velocity' /
&initial coordinate=2, position=0.8 /
&body link=3, mass=0.7, centre=0,-0.5,0 /
&time end=1, intervals=1 /
"""
TUMBLING = """&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='revolute', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,1,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0 /
&initial coordinate=2, position=1, velocity=3 /
&initial coordinate=3, position=0, velocity=0.1 /
&body link=4, mass=1, centre=0,0,0.1, inertia=0.002,0.002,0.001,0,0,0 /
&time end=2, intervals=1 /
"""


def falling(stop, *groups, start=initial(1, 1.0), end=1):
    """A slider of 2 kg that falls onto a stop."""
    return ("&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /\n&body link=2, mass=2 /\n"
            f'&gravity acceleration=0,0,-9.81 /\n{start}&stop coordinate=1, {stop} /\n' + ''.join(groups)
            + ('' if any('&time' in group for group in groups) else f'&time end={end}, intervals=10 /\n'))


def sensitive(target, *groups, end=1):
    """A parallelogram whose derivatives by one number are asked for."""
    return four_bar(FLAT, *groups, f"&parameter name='number', sets='{target}' /\n", '&output sensitivities=.true. /\n', end=end)


def by_mass():
    """The request for derivatives by the mass of the last body."""
    return "&parameter name='mass', sets='body.mass' /\n&output sensitivities=.true. /\n"


def large(independent, coordinates, links, closed_chain):
    """A closed chain and a long open chain beside it."""
    independent = [*independent, *range(coordinates + 1, coordinates + LONG + 1)]
    return (structure(*independent) + closed_chain + open_chain(coordinates + 1, links + 1, LONG)
            + ''.join(drive(k) for k in independent if f'&drive coordinate={k},' not in closed_chain))


def rod_with_balls():
    """Two cranks and a rod with ball joints of three revolutes: the rod can spin."""
    axes = ['0,0,1', '1,0,0', '0,1,0', '0,0,1', '1,0,0', '0,1,0', '0,0,1', '1,0,0']
    points = ['0,0,0', *3 * ['0.2,0,0'], *3 * ['0.3,0.5,0.5'], '0.3,0.5,-0.1']
    return ''.join(revolute(k, (k, k + 1) if k < 8 else (1, 8), point, point, axis)
                   for k, (axis, point) in enumerate(zip(axes, points), 1))


def three_cranks(angle, shorter='0.0'):
    """A coupler on three parallel cranks of 0.5 m, or with the third one shorter, in radians. In the first form the third crank
    repeats the equations of the others; in the other one it does so in the upright position only."""
    pairs = (((1, 2), '0,0,0', '0,0,0'), ((2, 5), '0.5,0,0', '0,0,0'), ((1, 3), '1,0,0', '0,0,0'), ((3, 5), '0.5,0,0', '1,0,0'),
             ((1, 4), '2,0,0', '0,0,0'), ((4, 5), f'{0.5 - float(shorter)},0,0', f'2,-{shorter},0'))
    return (''.join(revolute(k, *pair) for k, pair in enumerate(pairs, 1))
            + ''.join(drive(k, repr(angle)) + initial(k + 1, -angle) for k in (1, 3)) + initial(5, angle) + initial(6, -angle))


def levers(n):
    """Uprights in a row and a lever on each but the first, joined by rods to both neighbours: each lever relates the angles of three
    uprights, and no upright can be found without the others."""
    pairs, links = [], 1

    def link():
        nonlocal links
        links += 1
        return links

    def pair(*rest):
        pairs.append(revolute(len(pairs) + 1, *rest))
    uprights = [link() for _ in range(n + 1)]
    for i, upright in enumerate(uprights):
        pair((1, upright), f'{i},0,0')
    for i in range(1, n + 1):
        lever, before, behind = link(), link(), link()
        pair((uprights[i], lever), '0.5,0,0')
        pair((lever, before), '0,0.2,0')
        pair((before, uprights[i - 1]), '1,0,0', '0.3,0,0')
        pair((lever, behind), '0,-0.2,0')
        pair((behind, uprights[i + 1] if i < n else 1), '1,0,0', '0.7,0,0' if i < n else f'{n + 1},0,0')
    return structure(1) + ''.join(pairs) + drive(1)


def bennett(length='1.5', offset='0'):
    """Bennett's linkage, or one with another length or offset of one link, which does not move exactly."""
    example = text_of(os.path.join(TREE, 'examples', 'bennett', 'bennett.nml'))
    return example.replace('dh=1.5, 0.84806207898148101, 0, 0', f'dh={length}, 0.84806207898148101, {offset}, 0', 1)


# crank and rod of one length, driven at the slide: where it stands on the axis of the crank, the crank can turn freely
EQUAL_CRANK = (structure(4) + revolute(1, (1, 2)) + revolute(2, (2, 3), '1,0,0') + revolute(3, (3, 4), '1,0,0')
               + "&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0 /\n" + initial(1, math.pi / 2) + initial(2, math.pi)
               + initial(3, -1.5 * math.pi) + '&time start=0, end=1, intervals=10 /\n')
# a block on a line across and in a slot of the crank: where both are parallel it is nowhere
SLOT = """&mechanism angle_unit='deg' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=1,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1 /
&pair coordinate=4, links=1,4, kind='prismatic', point=0,0.3,0, moving_point=0,0,0, axis=1,0,0 /
&initial coordinate=2, position=0.35 /
&initial coordinate=3, position=-60 /
&initial coordinate=4, position=0.17 /
&drive coordinate=1, kind='polynomial', coefficients=60, 50 /
&time start=0, end=3, intervals=30 /
"""
SLIDES = structure(1) + drive(1) + ''.join(
    f"&pair coordinate={k}, links={links}, kind='prismatic', axis={axis} /\n"
    for k, links, axis in ((1, '1,2', '1,0,0'), (2, '2,3', '0,1,0'), (3, '3,4', '0,0,1'), (4, '1,4', '1,1,1')))
# 1 kg on a spring, 1 m from its rest
SPRING = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&initial coordinate=1, position=1 /
&body link=2, mass=1 /
&load kind='coordinate', coordinate=1, stiffness={}, damping={} /
&time start={}, end={}, intervals=1 /
"""
TABLE = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&drive coordinate=1, kind='table', file='table.dat' /
&time start=-1, end=1, intervals=2 /
"""
LONG_ROD = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1e16,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, zero=0,1,0, moving_point=0,0,0 /
&initial coordinate=4, position=1e16 /
&drive coordinate=1, kind='polynomial', coefficients=0.4, 10 /
&time end=0.7, intervals=10 /
"""
GEARS = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='revolute', point=1,0,0, axis=0,0,1 /
&drive coordinate=1, kind='polynomial', coefficients=0,1 /
&coupling kind='gear', coordinates=1,2, ratio=2 /
"""
TABLE_COUPLING = GEARS.replace("kind='gear', coordinates=1,2, ratio=2", "kind='table', coordinates=1,2, file='curve.dat'")
PATH = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='path', file='curve.dat' /
&drive coordinate=1, kind='polynomial', coefficients=1, 5 /
"""


# --- failures -------------------------------------------------------------------------------------------------------

def settings(**values):
    return [word for name, value in values.items() for word in ('--set', f'solver.{name}={value}')]


def driven_cases():
    """(kind, data file, options, exit code, words) for mech9k."""
    limit = dead_point(ROCKER)
    chain = 'closed chain 1 (coordinates 2, 3, 4)'
    starts = f'the mechanism starts in a singular position of {chain}, '
    return [
        ('self_locking', WEDGE, (), SINGULAR,
         ['coordinate 3 cannot be driven in the negative direction at t = 0 s: the mechanism locks itself by the friction of coordinate 2, '
          'whose coefficient is 0.6; from 0.5 on no force moves it this way. Lower the coefficient, or drive another coordinate']),
        ('friction_sensitivity', RUBBING.replace('&initial coordinate=1, position=0, velocity=1 /\n', drive(1, '0, 1'))
         + "&parameter name='mu', sets='friction(1).dynamic' /\n&output sensitivities=.true., drive_forces=.true. /\n", (), DATA,
         ['derivatives by the parameters are not computed with friction, as of friction 1. Leave out the friction, the parameters, or '
          'sensitivities and gradients']),
        ('stop_passed', falling('low=0.5', start=drive(1, '1, -1')), (), SINGULAR,
         ['coordinate 1 passes the end of stop 1 at 0.5 m at t = 0.5 s: at t = 0.', ' m beyond. Change the drives, or move the stop']),
        ('open_chain', four_bar(ROCKER, drive(1, '120')), (), ASSEMBLY,
         ['the mechanism cannot be assembled: closed chain 1 (it closes on link 4 through coordinate 3) stays open by ',
          ' m at best; check its dimensions and the independent coordinates, or give better guesses with &initial']),
        ('nearly_closed_chain', four_bar((1.0, 0.75, 1.0, 0.4), drive(1, '60'), offset='1e-6'), (), ASSEMBLY,
         ['case.nml:4:1: the points of its pairs leave the closed chain of pairs 1, 2, 3, 4 open by 1e-6 m along its parallel axes',
          'stays open by 1e-6 m at best; so small a gap comes from directions or points given with too few digits',
          'or allow for their error with &mechanism data_tolerance=1e-6\n']),
        ('wrong_choice', four_bar(ROCKER, drive(1, '40'), drive(2), cq=(1, 2)), (), STRUCTURE,
         ['the mobility is 1 (4 coordinates, rank 3), and 2 coordinates are independent; take 1 of the coordinates 1, 2 off the '
          'independent ones (cq); cq = 1 would serve; instead of 1 also 2, 3, 4']),
        ('undetermined_coordinates', structure(*range(1, LONG + 1)) + open_chain(1, 2, LONG + 1)
         + ''.join(drive(k) for k in range(1, LONG + 1)), (), STRUCTURE,
         [f'the independent coordinates cannot determine the others: 1 more must be independent (cq); {LONG + 1} would serve']),
        ('undetermined_block', large((1, 8), 8, 8, rod_with_balls()), (), STRUCTURE,
         ['closed chain 1 cannot determine all dependent coordinates from the independent ones near the start: it is singular '
          'there; take other independent coordinates (cq), or other guesses (&initial)']),
        ('contradictory_inputs', large((1, 3), 6, 5, three_cranks(1.0)), (), STRUCTURE,
         ['the independent coordinates cannot all move freely: closed chain 1 would not stay closed; take one of its coordinates '
          'off the independent ones (cq)']),
        ('locked_chain', large((1,), 6, 5, three_cranks(math.pi / 2, '0.1').replace(drive(3, repr(math.pi / 2)), '')), (), STRUCTURE,
         ['closed chain 2 does not move: 1 of its equations follows from the others at the start only; after a displacement of ',
          ' m; check the points and directions of its pairs, or use pairs with more freedom']),
        ('nearly_moving_chain', bennett(length='1.500001'), ('--set', 'mechanism.data_tolerance=5e-7'), STRUCTURE,
         ['closed chain 1 does not move: 3 of its equations follow from the others at the start only; after a displacement of ',
          'its dimensions are about 5e-7 (rad, or parts of the size) from those of an overconstrained mechanism that moves: give '
          'points and directions with more digits, or allow for their error with &mechanism data_tolerance=1e-6, or use pairs']),
        ('open_position', bennett(offset='1e-6'), ('--set', 'mechanism.data_tolerance=5e-7'), SINGULAR,
         ['the closed chains are open by ', ' m is allowed (5e-7 of the mechanism\'s size): its dimensions let it move near the '
          'start only; give points and directions with more digits, or a larger &mechanism data_tolerance']),
        # the crank of 0.3 m turns, and the slide would move by the round-off of 1e16 m
        ('lost_link', LONG_ROD, (), SINGULAR,
         [' m at t = ', ' s, by the round-off of lengths of 1e16 m, and 3e-5 m is allowed beside link 2, whose pairs are 0.3 m apart: '
          'its motion is lost in this round-off; give lengths that differ less']),
        ('large_block', levers(503), (), STRUCTURE,
         ['3018 coordinates could only be solved for together, and at most 3000 can be; take independent coordinates (cq) nearer '
          'to link 1']),
        ('dead_point', four_bar(ROCKER, drive(1, '40, 100'), end=3), (), SINGULAR,
         [f'the motion cannot go on beyond t = {digits((limit - 40) / 100)}',
          f' s: {chain} reaches a dead point at q1 = {digits(limit)}', ' and cannot follow farther']),
        # flat after half a second: no finite force turns the second crank, on which the coupler leans
        ('unbalanced', four_bar(FLAT, drive(1, '-30, 60'), turned(-30), BODY.replace('link=2', 'link=3'), '&gravity acceleration=0,-9.81,0 /\n',
                                '&output reactions=.true. /\n'), (), SINGULAR,
         ['the closed chains of coordinates 1, 2, 3, 4 are in a singular position at t = 0.5 s, in which no finite forces in their '
          'pairs balance the links; choose times that leave it out, or record neither reactions nor drive_forces']),
        # it comes to its dead point with a rate and an acceleration of 0
        ('lost_branch', four_bar(ROCKER, drive(1, f'{limit - 60!r}, 180, -180, 60'), end=2), (), SINGULAR,
         ['the motion cannot go on beyond t = 0.999', f'{chain} reaches a singular position at q1 = 81.7867',
          ', where it is not certain how the motion goes on']),
        ('escape', SLOT, (), SINGULAR,
         ['the motion cannot go on beyond t = 2.4', f'{chain} cannot follow up to q1 = 180, where coordinate ',
          ' grows beyond all bounds']),
        ('start_at_dead_point', four_bar(ROCKER, drive(1, f'{limit!r}, -1')), (), SINGULAR,
         [f'{starts}a dead point, where rates are not finite; start a little beside it']),
        ('start_on_branches', four_bar(FLAT, drive(1, '0, 240')), (), SINGULAR,
         [f'{starts}where two branches meet: ', ' (deg/s, m/s); start a little beside it, on the one that is meant']),
        ('start_unclear', four_bar(FLAT, drive(1)), (), SINGULAR,
         [f'{starts}where it is not certain how it goes on; start a little beside it']),
        # from rest at the dead point into the angles that cannot be
        ('start_locked', four_bar(ROCKER, drive(1, f'{limit!r}, 0, 10')), (), SINGULAR,
         [f'{starts}which it cannot leave as it is driven; drive it another way, or start a little beside it']),
        ('start_not_left', EQUAL_CRANK + drive(4, '0, 1, 1e6'), (), SINGULAR,
         ['the mechanism starts in a singular position and cannot be followed off it with certainty; start a little beside it']),
        ('no_spline', TABLE, {'table.dat': '-1 0\n0 1\n1e-17 1\n1 4\n'}, DATA,
         ['case.nml:3:41: no smooth curve runs through these points: some are too close together; leave those out']),
        ('sharp_curve', PATH, {'curve.dat': '0 0\n1 0\n2 0\n3 0\n2 0\n1 0\n'}, DATA,
         ['curve.dat:4:1: the smooth curve through these points turns back on itself after point 4; put the points there closer '
          'together, round a corner, or leave out a point that goes back']),
        ('off_curve', PATH, {'curve.dat': '0 0\n1 0\n2 0\n3 0\n'}, SINGULAR,
         ['case.nml:2:1: coordinate 1 comes to an end of its curve at t = ', ' s: it would go on to 3', ' m, and the curve leads from 0 '
          'to 3 m. Start elsewhere on the curve, end the motion earlier, or give points of a longer curve']),
        # why a mechanism is not planar
        ('chain_dimensions', text_of(os.path.join(TREE, 'examples', 'double_hooke', 'double_hooke.nml')), ('--plan',), DONE,
         ['spatial arithmetic: the motions of closed chain 1 have 6 dimensions, not 3\n']),
        ('nothing_turns', SLIDES, ('--plan',), DONE, ['spatial arithmetic: no pair turns\n']),
        ('pair_off_plane', four_bar(FLAT, turned(60), drive(1, '60'), drive(5), revolute(5, (2, 5), axis='1,0,0'), cq=(1, 5)).replace(
            'links=4, coordinates=4', 'links=5, coordinates=5'), ('--plan',), DONE,
         ["spatial arithmetic: pair 5 neither turns about the plane's normal nor slides across it\n"]),
        ('no_fixed_axis', "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /\n" + PATH.replace('cq=1', 'cq=1,2')
         + "&drive coordinate=2, kind='polynomial', coefficients=1 /\n", {'--plan': '', 'curve.dat': '0 0\n1 0\n2 0\n9 0\n'},
         DONE, ['spatial arithmetic: pair 1 has no fixed axis\n']),
        ('chain_off_plane', four_bar(FLAT, turned(60), drive(1, '60'), offset='1e-11'), ('--plan',), DONE,
         ['spatial arithmetic: closed chain 1 does not close in a plane\n']),
        ('coupled', GEARS, ('--plan',), DONE, ['spatial arithmetic: coordinates are coupled\n']),
        ('open_coupling', GEARS + "&coupling kind='gear', coordinates=1,2, ratio=2, phase=1 /\n", (), ASSEMBLY,
         ['cannot be assembled: couplings 1 (line 5) and 2 (line 6) contradict each other', ':6:1:']),
        ('off_table', TABLE_COUPLING, {'curve.dat': '0 0\n0.1 0\n0.2 0.1\n0.3 0.2\n'}, SINGULAR,
         ['case.nml:5:1: coordinate 1 comes to an end of the table of coupling 1 at t = ', ' s: it would go on to 0.3',
          'rad, and the table leads from 0 to 0.3 rad. Start elsewhere in the table']),
        ('no_neighbours', sensitive('mechanism.data_tolerance', turned(60), drive(1, '60')), (), DATA,
         ["derivatives by the parameter 'number' do not exist: its value cannot be changed a little in both directions"]),
        ('unknown_derivative', sensitive('time.end', turned(60), drive(1, '60')), (), DATA,
         ["derivatives by the parameter 'number' are not computed: it sets a time"]),
        ('singular_sensitivity', sensitive('drive.coefficients(1)', turned(-20), drive(1, '-20,20'), end=2), (), SINGULAR,
         ['derivatives by the parameters do not exist at t = 1 s, in a singular position of closed chain 1']),
        ('opening_parameter', sensitive('pair(2).axis(1)', turned(60), drive(1, '60')), (), DATA,
         ["derivatives by the parameter 'number' do not exist: closed chain 1 would not stay closed"]),
        ('shared_force', GEARS + "&coupling kind='gear', coordinates=1,2, ratio=2 /\n&body link=3, mass=1, centre=0.1,0,0 /\n"
         "&parameter name='mass', sets='body.mass' /\n&output sensitivities=.true., reactions=.true. /\n", (), DATA,
         ['derivatives of forces in the pairs are not computed, because equilibrium does not determine the force of coupling']),
    ]


def free_cases():
    """The same for mech9d."""
    chain = 'closed chain 1 (coordinates 2, 3, 4)'
    stops = 'the integration cannot go on from t = '
    swings = four_bar(ROCKER, START, BODY)
    limit = dead_point(ROCKER)
    return [
        ('no_inertia', four_bar(ROCKER, START), (), DATA,
         ['independent coordinate 1 has no inertia: no link with mass moves with it (apart from those that the independent '
          'coordinates before it move already); give a &body']),
        ('jump_sensitivity', BODY_ON_DRIVE + "&parameter name='when', sets='drive.times(2)' /\n&output sensitivities=.true. /\n", (), SINGULAR,
         ["derivatives by the parameter 'when' are not computed beyond t = 0.5 s: it sets this time, at which the rates of drives jump. "
          'Give drives without jumps of their rates, end the run before, leave out the parameter, or sensitivities and gradients']),
        # the push comes to an end at each period, whose length the parameter sets
        ('jumping_force', BODY_ON_DRIVE + "&load kind='force', link=3, force=1,0,0, law='segments', "
         "times=0,0.1,0.3, values=0,0,1, laws='dwell','harmonic', period=0.3 /\n&parameter name='begin', sets='load.times(2)' /\n"
         "&output sensitivities=.true. /\n", (), DATA,
         ["derivatives by the parameter 'begin' are not computed: it sets numbers of a law by which the force of a load or of a motor "
          'jumps. Give a law whose value does not jump (and for the setpoint of a controller its rate), leave out the parameter']),
        ('angles_sensitivity', TUMBLING + by_mass(), (), SINGULAR,
         ['derivatives by the parameters are not computed at t = ', 'in other angles of a ball joint or of a rod']),
        # the load keeps the angles as they are
        ('gimbal_lock', BALL_JOINT + "&load kind='coordinate', coordinate=1, damping=1 /\n", (), SINGULAR,
         ['the motion comes to gimbal lock at t = 0 s: there coordinates 1, 3 can move together without moving any mass, so that '
          'the forces do not determine their accelerations. Turn about the axes in another order, or give the links between them '
          'inertia']),
        ('loaded_lock', delta(2e-5, more="&load kind='coordinate', coordinate=6, stiffness=0.01 /\n"), (), SINGULAR,
         ['the ball joint of coordinates 4, 5, 6 comes to gimbal lock at t = 0.28', ' s: its first and its third axis are parallel there. '
          'A load on coordinate 6 determines no torque in this position. Let it act between links, or turn about the axes in another '
          'order']),
        ('singular_passing', delta(2e-5, vertical=True).replace('position=0', 'position=-20'), (), SINGULAR,
         ['closed chains 1, 2, 3, 4, 5 together (coordinates 4, ', ') come to a singular position at t = 0.14', ' s, in which some links '
          'can move in several ways, so that it is not certain how the motion goes on. End before this time, begin beside it, or '
          'change the dimensions']),
        ('moving_setpoint', '&mechanism links=2, coordinates=1 /\n' + structure(1) + revolute(1, (1, 2)) + BODY + initial(1, 0.5)
         + "&motor coordinate=1, kind='pid', proportional=3, integral=2, law='polynomial', coefficients=0,0.5, over='q1' /\n",
         ('--equilibrium', '--no-write'), DATA, ['the setpoint of motor 1 follows q1, and with an integral part it has no position of rest']),
        ('no_equilibrium', '&mechanism links=2, coordinates=1 /\n' + structure(1) + revolute(1, (1, 2)) + BODY + initial(1, 0.5)
         + "&load kind='coordinate', coordinate=1, force=3 /\n", ('--equilibrium', '--no-write'), ASSEMBLY,
         ['no position of equilibrium was found from the initial position; where the search ended, the loads still push with '
          '(N m, N): 3 on coordinate 1 at ']),
        ('no_initial_position', four_bar(ROCKER, BODY), (), DATA,
         ['case.nml:3:1: the independent coordinate 1 of this pair has no initial position; give &initial coordinate=1, '
          'position=..., velocity=... /']),
        ('singular_start_block', four_bar(FLAT, initial(1, 0, ', velocity=10'), BODY), (), SINGULAR,
         [f'{chain} is in a singular position for these independent coordinates; choose other independent coordinates, or start a '
          'little beside it']),
        # with mass on the crank alone it turns evenly: flat after 0.5 s
        ('singular_block', four_bar(FLAT, initial(1, 60, ', velocity=240'), turned(60), BODY), (), SINGULAR,
         [f'{stops}0.49999', f': {chain} is in a singular position for these independent coordinates; others may pass it (cq), '
          'unless branches meet there']),
        # a pendulum on a crank that is driven to its dead point
        ('driven_dead_point', four_bar(ROCKER, drive(1, '40, 60'), revolute(5, (2, 5)), initial(5, 10), '&body link=5, mass=1, '
                                       'centre=0.1,0,0 /\n', cq=(1, 5)).replace('links=4, coordinates=4', 'links=5, coordinates=5'),
         ('--set', 'time.end=3'), SINGULAR,
         [f'the motion cannot go on beyond t = {(limit - 40) / 60:.8g}'[:-2], f': {chain} reaches a dead point at q1 = {limit:.8g}'[:-2],
          ' and cannot follow farther']),
        ('unclosed_step', swings, ('--set', 'time.end=1e90', *settings(relative_tolerance=0.9, absolute_tolerance='1e90')), SINGULAR,
         [f'{stops}0 s: at t = ', 'closed chain 1 cannot be closed near the position at t = ', ' s; lower the tolerances']),
        ('accurate_step', swings, settings(relative_tolerance='1e-30', absolute_tolerance='1e-30'), INTEGRATOR,
         [f'{stops}0 s: the tolerances ask for more digits than the numbers have. Raise relative_tolerance or absolute_tolerance']),
        ('many_steps', SPRING.format(1e6, 0, 0, 1), settings(maximum_steps=30), INTEGRATOR,
         [stops, ' s: 30 steps were not enough to come to t = 1 s, and they are now ', ' s long. The motion is stiff (try method '
          "'bdf'), or the tolerances are too small, or maximum_steps is"]),
        ('short_step', SPRING.format(1e6, 0, 1e15, 1e15 + 1), (), INTEGRATOR,
         [f'{stops}1e15 s: the steps have become too short for time to advance. The motion becomes infinitely fast there, or comes '
          'to a position that it cannot pass; or times are so large that they should begin at 0']),
        # the spring changes the motion faster than any step can follow
        ('inaccurate_step', SPRING.format(1e100, 0, 0, 1), (), INTEGRATOR,
         [f'{stops}0 s: however short the step, its error stays too large. Look for a force that jumps or grows without limit there; '
          'or raise the tolerances']),
        ('unsolved_step', SPRING.format(1e80, 1e80, 0, 1), settings(method="'bdf'"), INTEGRATOR,
         [f'{stops}0 s: the equations of an implicit step cannot be solved. Look for a force that jumps there; or try another '
          'method']),
        ('accuracy', swings, settings(accuracy='1e-17'), INTEGRATOR,
         ['the motion is not as accurate as was asked for at t = 0 s: with the least tolerances of auto, 1e-14, its error is about ',
          ', and 1e-17 is allowed (in units of the file). Round-off makes such an error in many steps, or where the motion enlarges it: it may be '
          'chaotic. End before this time, or ask for a larger accuracy']),
        ('stop_start', falling('low=1.25'), (), DATA,
         ['the motion starts beyond the end of stop 1: coordinate 1 is 1 m, 0.25 m beyond 1.25 m. Start elsewhere, or move the stop']),
        # the carriage comes to its stop at 0.5 s, with the free slider beside it
        ('stop_violated', "&structure cq=1,2 /\n&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /\n&pair coordinate=2, "
         "links=2,3, kind='prismatic', axis=0,1,0 /\n&body link=2, mass=1 /\n&body link=3, mass=2 /\n" + drive(1, '1, -1')
         + initial(2, 0.0, ', velocity=1') + '&stop coordinate=1, low=0.5 /\n&time end=1, intervals=10 /\n', (), SINGULAR,
         ['the drives force coordinate 1 beyond the end of stop 1 at 0.5 m from t = 0.5 s on, with the rate -1 m/s. Change the drives, '
          'move the stop, or make it compliant by stiffness=']),
        # a heavy top leaves its stop in gimbal lock, where its first and third turn are one
        ('singular_contact', "&structure cq=1,2,3 /\n&pair coordinate=1, links=1,2, kind='revolute', axis=1,0,0 /\n&pair coordinate=2, "
         "links=2,3, kind='revolute', axis=0,1,0 /\n&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1 /\n"
         + initial(1, 0.0) + initial(2, 1.0, ', velocity=3') + initial(3, 0.0, ', velocity=0.1') +
         '&body link=4, mass=1, centre=0,0,0.1, inertia=0.002,0.002,0.001,0,0,0 /\n&gravity acceleration=0,0,-9.81 /\n'
         '&solver relative_tolerance=1e-9, absolute_tolerance=1e-9 /\n&stop coordinate=1, low=-1, high=1.2, restitution=0.6 /\n'
         '&time end=2, intervals=400 /\n', (), SINGULAR,
         ['the motion cannot go on from a stop at t = 0.768', ' s: no mass moves with coordinate 3 there, apart from those that other '
          'independent coordinates move. Start elsewhere, or make the stop compliant by stiffness=']),
        ('event_sensitivity', falling('low=0', "&parameter name='h', sets='initial(1).position' /\n&output sensitivities=.true. /\n",
                                      start=initial(1, 0.0)), (), SINGULAR,
         ['derivatives by the parameters do not exist at t = 0 s: the motion begins on stop 1, and parameters move it away or behind. '
          'End the run before, or leave out sensitivities and gradients']),
        # at t = 1e6 s numbers are 1e-10 s apart, in which it would hit five times
        ('many_events', falling('low=-1e-11, high=1e-11, restitution=1', '&time start=1e6, end=1000001, intervals=1 /\n',
                                start=initial(1, 0.0, ', velocity=1')), ('--set', 'gravity.acceleration=0,0,0'), INTEGRATOR,
         ['the motion makes no progress beyond t = 1000000 s: it has had ', ' events at stops, frictions and contacts. Give a smaller '
          "restitution, a compliant stop or contact by stiffness=, or friction by law='smooth'"]),
        ('shared_contact', TWO_FEET, (), DATA,
         ['derivatives by the parameters are not computed at t = 0 s, where equilibrium does not determine the forces of closed contacts, '
          'among them contact 1. Leave out reactions and drive forces if contacts have no friction, or give fewer contacts']),
        ('contact_start', SUNK_POINT, (), DATA,
         ['the links of contact 1 are 0.25 m within each other at the start. Start elsewhere, or move the surface']),
        ('contact_behind', SLIDING_POINT.replace('velocity=0', 'velocity=1').replace(
            "&contact point='P' /", "&contact point='P', kind='path', file='path.dat', side='left', axis=0,1,0, zero=0,0,1 /"),
         {'path.dat': '1.5 0.1\n3 0.1\n'}, SINGULAR,
         ['the ball of contact 1 comes behind its path at t = ', ' s, round one of its ends: it is 0.1 m within the surface. Make the path '
          'longer, or close it']),
        ('contact_still', STILL_POINT, (), DATA,
         ['the links of contact 1 never move against each other: the pairs between them stand still. Name another link or point, or leave '
          'the contact out']),
        ('contact_violated', PRESSED_POINT, (), SINGULAR,
         ['the drives press the links of contact 1 into each other from t = 0.5 s on; the gap has the rate -1 m/s. Change the drives, or '
          'make the contact compliant by stiffness=']),
        ('undecided_contact', ROD, (), SINGULAR,
         ['the motion ends at t = 0 s: the forces of rigid contacts with friction have ', ' there, among them contact 1 (the paradox of '
          'Painleve). Lower friction=, or make the contact compliant by stiffness=']),
        ('contact_passed', DRIVEN_POINT, (), SINGULAR,
         ['the links of contact 1 move into each other at t = 0.5 s: at t = ', ' s they would be ', ' m within each other. Change the '
          'drives, or move the surface']),
        ('shared_bearing', FOUR_RUBBING, (), DATA,
         ['the friction of coordinate 1 depends on the component fz of the wrench of its pair, which equilibrium does not determine and '
          'which is not zero at t = 0 s. Leave this friction out, or give the joint more freedoms (--check names the components)']),
        ('shared_sticking', FIVE_RUBBING, (), SINGULAR,
         ['the motion ends at t = 0 s: the pair of coordinate 2 sticks together with coordinates 1, 5, and nothing decides how they share '
          "their forces. Leave out the friction of one of them, or give law='smooth'"]),
        # mu sin 2a = 1.4 is more than 4/3
        ('paradox', LADDER, (), SINGULAR,
         ['the friction of coordinate 1 has no solution from t = 0 s on (the paradox of Painleve): its coefficient is 1.4, and from '
          '1.3333333 on rigid bodies with dry friction cannot slip this way. Lower the coefficient, or end the motion before']),
        # it grows as exp(1000 t), up to 1e308 at 0.71 s
        ('infinite_rate', SPRING.format(-1e6, 0, 0, 10), (), INTEGRATOR,
         [stops, ': the motion of coordinate 1 is not finite: this motion, or a force, grows beyond all bounds. Look for a spring, a '
          'damper or a force of your own that drives instead of holding back']),
    ]


def digits(value):
    """The first eight decimals, as they begin a longer number."""
    return f'{math.floor(value * 1e8) / 1e8:.8f}'


def is_told(checks, folder, program, kind, text, options, code, words):
    """Run a case, with further files or options, and compare its exit code and what was printed."""
    files = {'case.nml': text, **(options if isinstance(options, dict) else {})}
    options = [name for name in options if name.startswith('--')] if isinstance(options, dict) else options
    files = {name: content for name, content in files.items() if not name.startswith('--')}
    for name, content in files.items():
        with open(os.path.join(folder, name), 'w', encoding='utf-8') as file:
            file.write(content)
    done = run(program, 'case.nml', '--quiet', '--no-write', *options, folder=folder)
    said = done.stderr if code else done.stdout
    checks.equal(done.returncode, code, f'{kind}: exit code; {done.stderr}')
    for part in words:
        checks.true(part in said, f'{kind}: said: {part}', said)
    checks.true('failure of kind' not in said, f'{kind}: in words', said)


DRIVEN, FREE = driven_cases(), free_cases()


@pytest.mark.parametrize('kind, text, options, code, words', DRIVEN, ids=[case[0] for case in DRIVEN])
def test_failures_of_mech9k(checks, tmp_path, mech9k, kind, text, options, code, words):
    is_told(checks, tmp_path, mech9k, kind, text, options, code, words)


@pytest.mark.parametrize('kind, text, options, code, words', FREE, ids=[case[0] for case in FREE])
def test_failures_of_mech9d(checks, tmp_path, build, mech9d, kind, text, options, code, words):
    if kind in OVERFLOWING and not build.optimised:
        pytest.skip('this build traps overflow')
    is_told(checks, tmp_path, mech9d, kind, text, options, code, words)


def test_wild_steps(checks, tmp_path, build, mech9d):
    """Tolerances with which any step is good lead to absurd positions. Round-off decides how such a motion ends, but it ends with a
    code and a sentence that are known; among many motions, one comes too near to a singular position."""
    if not build.optimised:
        pytest.skip('this build traps overflow')
    ends = {SINGULAR: ('a singular position for these independent coordinates is too near; others may pass it (cq), or smaller '
                       'tolerances', 'closed chain 1 cannot be closed near the position at t = ',
                       'is in a singular position for these independent coordinates; others may pass it (cq)',
                       'comes to a singular position at t = '),
            INTEGRATOR: ('is not finite: this motion, or a force, grows beyond all bounds', 'has no inertia in the position there, ',
                         'the steps have become too short for time to advance', 'however short the step, its error stays too large')}
    too_near = 0
    with open(tmp_path / 'case.nml', 'w', encoding='utf-8') as file:
        file.write(four_bar(ROCKER, START, BODY))
    for i in range(30):
        done = run(mech9d, 'case.nml', '--quiet', '--no-write', '--set', 'time.end=1e40', '--set',
                   f'initial.velocity={0.1 + 0.3 * i!r}', *settings(relative_tolerance=0.9, absolute_tolerance='1e60'), folder=tmp_path)
        known = [part for part in ends.get(done.returncode, ()) if part in done.stderr]
        checks.true(known and 'the integration cannot go on from t = ' in done.stderr, f'wild steps {i}: the end is a known one',
                    f'{done.returncode}: {done.stderr}')
        too_near += known[:1] == list(ends[SINGULAR][:1])
    checks.true(too_near > 0, 'wild steps: one motion comes too near to a singular position')


def test_each_kind_is_provoked_once_or_cannot_be():
    """A kind that no data file leads to has a reason."""
    names = [name[len('failure_'):] for name, _, _ in kinds()]
    assert sorted(['singular_step', *(case[0] for case in DRIVEN + FREE), *UNREACHABLE]) == sorted(names)


@pytest.mark.parametrize('kind', UNREACHABLE)
def test_sentence_is_tested(kind):
    """A kind that is not provoked here has its sentence in the test of the wording."""
    sentences = text_of(os.path.join(TREE, 'tests', 'wording', 'test_explanation.f90'))
    assert re.search(rf'(call raise\(err, \w+,|kind =) failure_{kind}\b', sentences)
