"""Failures of numerics reach the user as sentences, with their exit codes; none leaves the programs as a bare kind.

usage: failure_messages.py MECH9K MECH9D

The closed forms behind the numbers are those of four-bars: a chain of three bars in one line is at its dead point.
"""
import math
import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from mech9_cases import TREE, Checks, run

DATA, STRUCTURE, ASSEMBLY, SINGULAR, INTEGRATOR = 3, 4, 5, 6, 7

FOUR_BAR = """&mechanism links=4, coordinates=4, angle_unit='deg' /
&structure cq={cq} /
&pair coordinate=1, links=1,2, kind='revolute', point=0,0,0, axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point={bars[1]},0,0, moving_point=0,0,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point={bars[2]},0,0, moving_point={bars[3]},0,0, axis=0,0,1 /
&pair coordinate=4, links=1,4, kind='revolute', point={bars[0]},0,0, moving_point=0,0,0, axis=0,0,1 /
&time start=0, end={end}, intervals=10 /
"""
DRIVE = "&drive coordinate={}, kind='polynomial', coefficients={} /\n"
INITIAL = '&initial coordinate=1, position={}, velocity=10 /\n'
BODY = '&body link=2, mass=1, centre=0.1,0,0 /\n'
ROCKER = (1.2, 0.7, 0.9, 0.4)        # ground, crank, coupler, rocker; the crank cannot turn round
FLAT = (1.0, 0.4, 1.0, 0.4)          # a parallelogram, in one line at 0 degrees
TABLE = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&drive coordinate=1, kind='table', file='short.dat' /
&time start=0, end=1, intervals=3 /
"""


def four_bar(bars, *groups, cq='1', end=1):
    return FOUR_BAR.format(bars=bars, cq=cq, end=end) + ''.join(groups)


def dead_point(bars):
    """The crank angle in degrees where coupler and rocker are in one line."""
    ground, crank, coupler, rocker = bars
    return math.degrees(math.acos((ground ** 2 + crank ** 2 - (coupler + rocker) ** 2) / (2 * ground * crank)))


def digits(value):
    """The first eight decimals, as they begin a longer number."""
    return f'{math.floor(value * 1e8) / 1e8:.8f}'


def main():
    mech9k, mech9d = (os.path.abspath(path) for path in sys.argv[1:3])
    checks = Checks()
    limit = dead_point(ROCKER)
    chain = 'closed chain 1 (coordinates 2, 3, 4)'
    starts = f'the mechanism starts in a singular position of {chain}, '
    cases = [
        (mech9k, four_bar(ROCKER, DRIVE.format(1, '120')), (), ASSEMBLY,
         ['the mechanism cannot be assembled: closed chain 1 (it closes on link 4 through coordinate 3) stays open by ',
          ' m at best; check its dimensions and the independent coordinates, or give better guesses with &initial']),
        (mech9k, four_bar(ROCKER, DRIVE.format(1, '40'), DRIVE.format(2, '0'), cq='1,2'), (), STRUCTURE,
         ['the mobility is 1 (4 coordinates, rank 3), and 2 coordinates are independent; take 1 of the coordinates 1, 2 off the '
          'independent ones (cq); cq = 1 would serve; instead of 1 also 2, 3, 4']),
        (mech9k, four_bar(ROCKER, DRIVE.format(1, '40, 100'), end=3), (), SINGULAR,
         [f'the motion cannot go on beyond t = {digits((limit - 40) / 100)}',
          f' s: {chain} reaches a dead point at q1 = {digits(limit)}',
          ' and cannot follow farther']),
        (mech9k, four_bar(ROCKER, DRIVE.format(1, f'{limit!r}, -1')), (), SINGULAR,
         [f'{starts}a dead point, where rates are not finite; start a little beside it']),
        (mech9k, four_bar(FLAT, DRIVE.format(1, '0, 240')), (), SINGULAR,
         [f'{starts}where two branches meet: ', ' (deg/s, m/s); start a little beside it, on the one that is meant']),
        (mech9k, four_bar(FLAT, DRIVE.format(1, '0')), (), SINGULAR,
         [f'{starts}where it is not certain how it goes on; start a little beside it']),
        (mech9d, four_bar(ROCKER, INITIAL.format(40)), (), DATA,
         ['independent coordinate 1 has no inertia: no link with mass moves with it (apart from those that the independent '
          'coordinates before it move already); give a &body']),
        (mech9d, four_bar(ROCKER, BODY), (), DATA,
         ['case.nml:3:1: the independent coordinate 1 of this pair has no initial position; give &initial coordinate=1, '
          'position=..., velocity=... /']),
        (mech9d, four_bar(FLAT, INITIAL.format(0), BODY), (), SINGULAR,
         [f'{chain} is in a singular position for these independent coordinates; choose other independent coordinates, or start a '
          'little beside it']),
        (mech9d, four_bar(ROCKER, INITIAL.format(40), BODY),
         ('--set', 'solver.relative_tolerance=1e-30', '--set', 'solver.absolute_tolerance=1e-30'), INTEGRATOR,
         ['the integration cannot go on from t = 0 s: the tolerances ask for more digits than the numbers have. Raise '
          'relative_tolerance or absolute_tolerance']),
    ]
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, 'short.dat'), 'w', encoding='utf-8') as file:
            file.write('0 0\n1 1\n2 3\n')
        path = os.path.join(folder, 'case.nml')
        for program, text, options, code, words in cases + [(mech9k, TABLE, (), DATA, ['a smooth curve needs at least 4 points'])]:
            with open(path, 'w', encoding='utf-8') as file:
                file.write(text)
            done = run(program, path, '--quiet', '--no-write', *options, folder=folder)
            checks.equal(done.returncode, code, f'{words[0]}: exit code')
            for part in words:
                checks.true(part in done.stderr, f'said: {part}', done.stderr)
            checks.true('failure of kind' not in done.stderr, 'in words', done.stderr)
    hooke = os.path.join(TREE, 'examples', 'double_hooke', 'double_hooke.nml')
    done = run(mech9k, hooke, '--plan')
    checks.true('spatial arithmetic: the motions of closed chain 1 have 6 dimensions, not 3\n' in done.stdout, 'why it is not planar',
                done.stdout)
    checks.finish()


if __name__ == '__main__':
    main()
