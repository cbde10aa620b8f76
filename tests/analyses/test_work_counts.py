"""Work that is left out, by counts of the work done. Leaving it out changes no result.

Compares the program with itself: results with and without the blocks and derivatives that nothing needs.
"""
import json
import os
import re

import numpy as np
import pytest

from mech9_cases import REFERENCE, TREE, run, table_and_report, table_of, text_of, without_drives
from n_four_bar import data_file

FIVE_BAR = os.path.join(REFERENCE, 'dynamics_fivebar.nml')
LOOSE = ('--set', 'time.end=5', '--set', 'time.intervals=1', '--set', 'solver.relative_tolerance=1e-5')

# a crank-rocker; link 5 joins its coupler to the rocker 6, and link 8 the rocker 6 to the rocker 7: three chains,
# each its own block
SIX_AND_TWO = """
&mechanism links=8, coordinates=10 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.15,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=1,4, kind='revolute', axis=0,0,1, point=0.40,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=4,3, kind='revolute', axis=0,0,1, point=0.30,0,0, moving_point=0.35,0,0 /
&pair coordinate=5, links=3,5, kind='revolute', axis=0,0,1, point=0.20,0.10,0, moving_point=0,0,0 /
&pair coordinate=6, links=1,6, kind='revolute', axis=0,0,1, point=0.62,0.10,0, moving_point=0,0,0 /
&pair coordinate=7, links=6,5, kind='revolute', axis=0,0,1, point=0.30,0,0, moving_point=0.40,0,0 /
&pair coordinate=8, links=6,8, kind='revolute', axis=0,0,1, point=0.15,0,0, moving_point=0,0,0 /
&pair coordinate=9, links=1,7, kind='revolute', axis=0,0,1, point=1.2,0.10,0, moving_point=0,0,0 /
&pair coordinate=10, links=7,8, kind='revolute', axis=0,0,1, point=0.5,0,0, moving_point=0.6,0,0 /
&initial coordinate=2, position=1.0 /
&initial coordinate=3, position=1.8 /
&initial coordinate=4, position=-0.8 /
&initial coordinate=5, position=-0.57 /
&initial coordinate=6, position=1.85 /
&initial coordinate=7, position=-1.42 /
&initial coordinate=8, position=-1.5 /
&initial coordinate=9, position=1.8 /
&initial coordinate=10, position=-1.4 /
&drive coordinate=1, kind='polynomial', coefficients=0,10,1 /
&body link=2, mass=1, centre=0.05,0,0, inertia=0.01,0.01,0.01,0,0,0 /
&body link=4, mass=1, centre=0.15,0,0, inertia=0.01,0.01,0.01,0,0,0 /
&initial coordinate=1, position=0, velocity=10 /
&time start=0, end=0.4, intervals=400 /
{more}
"""
POINT = "&point name='P', link=4, position=0.1,0.2,0 /\n"

# a wedge that lifts a follower: nothing turns. Link 2 slides along x, link 3 along y, and between them the flank at 30 degrees
WEDGE = """
&mechanism links=3, coordinates=3 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0.8660254037844386,0.5,0 /
&pair coordinate=3, links=1,3, kind='prismatic', axis=0,1,0 /
&drive coordinate=1, kind='harmonic', amplitude=0.3, angular_frequency=2 /
&time start=0, end=3, intervals=300 /
"""

# two arms on one another
ARMS = """
&mechanism links=3, coordinates=2 /
&structure cq=1, 2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,1,0, point=1,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0,1 /
&drive coordinate=2, kind='polynomial', coefficients=0,2 /
&time start=0, end=1, intervals=50 /
"""

# on the five-bar's first crank
BESIDE = """
&pair coordinate=6, links=2,6, kind='revolute', axis=0,0,1, point=0.4,0.1,0, moving_point=0,0,0 /
&pair coordinate=7, links=6,7, kind='revolute', axis=0,0,1, point=2.5,0,0, moving_point=0,0,0 /
&pair coordinate=8, links=1,7, kind='revolute', axis=0,0,1, point=-1,-1,0, moving_point=2.0,0,0 /
&initial coordinate=6, position=-0.5 /
&initial coordinate=7, position=2 /
&initial coordinate=8, position=1 /
"""

# positions are closed to some 1e-15 of the lengths; the chains' conditioning is about 0.1, each derivative brings it and
# a driving rate of ten once more
POSITION, VELOCITY, ACCELERATION = 1e-13, 1e-11, 1e-9


class Case:
    def __init__(self, checks, folder, kinematics, dynamics):
        self.checks = checks
        self.folder = folder
        self.kinematics = kinematics
        self.dynamics = dynamics

    def file(self, text, **parts):
        path = os.path.join(self.folder, 'case.nml')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text.format(**parts) if parts else text)
        return path

    def same(self, less, more, tolerances, why):
        """All that one table has, the other has too."""
        for name, values in less.items():
            if name in ('t', 'closure'):
                continue
            tolerance = tolerances[2 if name.startswith('dd') or '.a' in name else
                                   1 if name.startswith('d') or '.v' in name else 0]
            self.checks.near(values, more[name], tolerance, f'{why}: {name}')


@pytest.fixture
def case(checks, mech9k, mech9d, tmp_path):
    return Case(checks, tmp_path, mech9k, mech9d)


def test_blocks_that_nothing_needs(case):
    """Blocks on which nothing that is recorded depends are not solved."""
    checks = case.checks
    path = case.file(SIX_AND_TWO, more='')
    table, whole = table_and_report(case.kinematics, path)
    checks.equal(len(whole['blocks']), 3, 'three blocks')
    for wanted, blocks in ('4', 1), ('7,2', 2), ('9', 3):
        less, report = table_and_report(case.kinematics, path, '--set', f'output.coordinates={wanted}')
        checks.equal(len(report['blocks']), blocks, f'blocks for coordinates {wanted}')
        for count in 'rate_solutions', 'acceleration_solutions':
            checks.equal(report[count]*3, whole[count]*blocks, f'{count} for coordinates {wanted}')
        checks.true(report['frames_placed'] < whole['frames_placed'] or blocks == 3, f'frames for coordinates {wanted}')
        checks.true(report['factorizations'] < whole['factorizations'] or blocks == 3, f'factors for coordinates {wanted}')
        names = ['t'] + [order + 'q' + k for order in ('', 'd', 'dd') for k in sorted(wanted.split(','))] + ['closure']
        checks.equal(list(less), names, f'columns for coordinates {wanted}')
        case.same(less, table, (POSITION, VELOCITY, ACCELERATION), f'coordinates {wanted}')


def test_point_is_a_reason_to_solve(case):
    """So is a point of the last chain; the plan names the chains that are left out."""
    checks = case.checks
    path = case.file(SIX_AND_TWO, more="&point name='P', link=8, position=0,0,0 /")
    report = table_and_report(case.kinematics, path, '--set', 'output.coordinates=4')[1]
    checks.equal(len(report['blocks']), 3, 'blocks for a point of link 8')
    plan = run(case.kinematics, case.file(SIX_AND_TWO, more='&output coordinates=4 /'), '--plan').stdout
    checks.equal(plan.count('left out: no result or load depends on it'), 2, 'the plan says so')


def renumbered(text, numbers):
    """The same mechanism with other numbers of its coordinates."""
    return re.sub(r'coordinate=(\d+)', lambda found: f'coordinate={numbers.get(int(found[1]), int(found[1]))}', text)


def test_chains_that_end_on_earlier_links(case):
    """Chains that begin at link 1 and end on a link of an earlier chain need that chain, too."""
    checks = case.checks
    table = table_of(case.kinematics, case.file(SIX_AND_TWO, more=''))
    numbers = {5: 6, 6: 5, 8: 9, 9: 8}
    path = case.file(renumbered(SIX_AND_TWO.format(more=''), numbers))
    plan = run(case.kinematics, path, '--plan').stdout
    for ending in 'closes on link 3', 'closes on link 6':
        checks.true(ending in plan, f'a chain {ending}', plan)
    for old, blocks in (6, 2), (9, 3):
        new = numbers[old]
        less, report = table_and_report(case.kinematics, path, '--set', f'output.coordinates={new}')
        checks.equal(len(report['blocks']), blocks, f'blocks for coordinate {new}, other numbers')
        # another direction through the chain turns no coordinate
        case.same({f'q{old}': less[f'q{new}'], f'dq{old}': less[f'dq{new}'], f'ddq{old}': less[f'ddq{new}']}, table,
                  (POSITION, VELOCITY, ACCELERATION), f'coordinate {new}, other numbers')


@pytest.mark.parametrize('name', ['kinematics', 'dynamics'])
def test_pictures_show_all_links(case, name):
    """Poses and pictures show all links, whatever coordinates are recorded."""
    checks = case.checks
    film = os.path.join(case.folder, 'film.html')
    less = ('--set', 'output.coordinates=4', '--set', 'output.derivatives=0')
    program, text = (case.kinematics, SIX_AND_TWO) if name == 'kinematics' else (case.dynamics, without_drives(SIX_AND_TWO))
    films = []
    for settings in (), less:
        done = run(program, case.file(text, more=''), '--quiet', '--table', os.devnull, '--animate', film, *settings)
        checks.equal(done.returncode, 0, f'a film; stderr: {done.stderr}')
        # all but the values of the columns, which are those that are recorded
        films.append(re.sub(r'^names: .*?^values: .*?^\],$', '', text_of(film), flags=re.S | re.M))
    checks.true(len(films[0]) > 10000 and films[0] == films[1], f'{name}: the same film')


def test_derivatives_that_are_not_recorded(case):
    """Accelerations that are not recorded are not found, and rates of points neither."""
    checks = case.checks
    path = case.file(SIX_AND_TWO, more=POINT)
    table, whole = table_and_report(case.kinematics, path)
    checks.equal(whole['acceleration_solutions'], 3*whole['positions'], 'accelerations of all blocks at all positions')
    for derivatives, orders in (0, ['']), (1, ['', 'd']):
        less, report = table_and_report(case.kinematics, path, '--set', f'output.derivatives={derivatives}')
        checks.equal(report['acceleration_solutions'], 3, 'accelerations of all blocks at the start')
        # velocities of ten frames at each position, and accelerations at most at the start
        checks.true(report['frames_moved'] <= 10*report['positions'] + 10, 'velocities of frames', report['frames_moved'])
        checks.true(report['frames_moved'] < whole['frames_moved'], 'frames are moved less', report['frames_moved'])
        checks.true(report['newton_iterations'] < 1.3*whole['newton_iterations'], 'rates alone predict nearly as well',
                    [report['newton_iterations'], whole['newton_iterations']])
        names = ['t'] + [f'{order}q{k}' for order in orders for k in range(1, 11)]
        names += ['P.' + order + axis for order in ('', 'v')[:derivatives + 1] for axis in 'xyz'] + ['closure']
        checks.equal(list(less), names, f'columns with {derivatives} derivatives')
        case.same(less, table, (POSITION, VELOCITY, ACCELERATION), f'{derivatives} derivatives')


def test_frames_of_the_last_chain(case):
    """Accelerations of frames that only their own chain needs are not spread a second time."""
    checks = case.checks
    with_point = table_and_report(case.kinematics, case.file(SIX_AND_TWO, more="&point name='P', link=8, position=0,0,0 /"))
    without = table_and_report(case.kinematics, case.file(SIX_AND_TWO, more=''))
    checks.true(without[1]['frames_moved'] < with_point[1]['frames_moved'], 'frames of the last chain')
    checks.equal(without[1]['acceleration_solutions'], with_point[1]['acceleration_solutions'], 'the same equations')
    case.same(without[0], with_point[0], (POSITION, VELOCITY, ACCELERATION), 'with and without a point')


def test_constant_jacobian(case):
    """A Jacobian that never changes is factorized once."""
    checks = case.checks
    table, report = table_and_report(case.kinematics, case.file(WEDGE))
    checks.true(report['factorizations'] <= 2, 'factorized at the start only', report['factorizations'])
    checks.equal(report['positions'], 301, 'positions')
    x = 0.3*np.sin(2*table['t'])
    # q1 + q2 cos 30 = 0, q2 sin 30 = q3
    checks.near(table['q2'], -x/np.cos(np.pi/6), POSITION, 'the slide on the flank')
    checks.near(table['q3'], -x*np.tan(np.pi/6), POSITION, 'the follower')
    checks.near(table['ddq3'], 4*x*np.tan(np.pi/6), ACCELERATION, 'its acceleration')
    checks.true('its Jacobian is constant' in run(case.kinematics, case.file(WEDGE), '--plan').stdout, 'the plan says so')
    turning = table_and_report(case.kinematics, case.file(SIX_AND_TWO, more=''))[1]
    checks.true(turning['factorizations'] > turning['positions'], 'one that changes is factorized at each position')


def test_constant_poses(case):
    """They are part of one step for each pair: with every pair of the first chain placed by four constant vectors of its own choosing
    there are as many frames as before."""
    checks = case.checks
    turning = table_and_report(case.kinematics, case.file(SIX_AND_TWO, more=''))[1]
    shifted = SIX_AND_TWO.replace("links=1,2, kind='revolute', axis=0,0,1 /", "links=1,2, kind='revolute', axis=0,0,1, "
                                  "point=0,0,0.3, moving_point=0,0,0.3, zero=0,1,0, moving_zero=0,1,0 /")
    moved, count = table_and_report(case.kinematics, case.file(shifted, more=''))
    checks.true(shifted != SIX_AND_TWO, 'other constants')
    # a few of some thousand iterations depend on round-off
    checks.near(count['frames_placed']/turning['frames_placed'], 1, 0.01, 'constant poses take no frames')
    case.same(moved, table_of(case.kinematics, case.file(SIX_AND_TWO, more='')), (POSITION, VELOCITY, ACCELERATION),
              'constant poses')


@pytest.mark.parametrize('name', ['slider_crank', 'fig1', 'rsur', 'jansen_leg', 'whitworth'])
def test_predictions_of_positions_alone(case, name):
    """Positions alone are predicted as well as with accelerations: no more iterations of Newton's method but at the start."""
    path = os.path.join(TREE, 'examples', name, f'{name}.nml')
    for intervals in 60, 100, 1000:
        whole, less = (table_and_report(case.kinematics, path, '--set', f'time.intervals={intervals}', '--set',
                                        f'output.derivatives={d}')[1]['newton_iterations'] for d in (2, 0))
        # at the start accelerations are known at one position, from the second one on at two
        case.checks.true(less <= 1.05*whole + 10, f'{name}, {intervals} positions', [less, whole])


def test_open_chain_needs_no_equations(case):
    """An open chain needs no equations, and no frames where none of its points is recorded."""
    report = table_and_report(case.kinematics, case.file(ARMS + "&point name='P', link=3, position=1,0,0 /"))[1]
    for count in 'newton_iterations', 'factorizations':
        case.checks.equal(report[count], 0, f'{count} of an open chain')
    # two frames at each position, placed once; those of the start are there already
    case.checks.equal(report['frames_placed'], 2*(report['positions'] - 1), 'its frames')
    report = table_and_report(case.kinematics, case.file(ARMS))[1]
    case.checks.equal(report['frames_placed'], 0, 'no frames for coordinates that the drives give')


def test_parts_of_a_free_motion(case):
    """Links without mass have no terms; chains that nothing depends on, and energies, are left out."""
    checks = case.checks
    free = without_drives(SIX_AND_TWO)
    exact = '&solver relative_tolerance=1e-12, absolute_tolerance=1e-12 /\n'
    path = case.file(free, more=exact)
    table, whole = table_and_report(case.dynamics, path)
    checks.equal(whole['links_with_inertia'], 2, 'two bodies')
    # link 1 does not move; links 3, 5 to 8 carry nothing, but 3 and 6 the chains behind them
    checks.equal(whole['frames_carried'], 4, 'frames of links 2, 3, 4 and 6')
    less, report = table_and_report(case.dynamics, path, '--set', 'output.coordinates=3', '--set', 'output.derivatives=1')
    checks.equal(report['links_with_inertia'], 2, 'the same bodies')
    checks.true(report['frames_carried'] < whole['frames_carried'], 'no frame carries a chain')
    checks.true(report['frames_placed'] < 0.5*whole['frames_placed'], 'frames of one chain of three')
    checks.true(report['factorizations'] < 0.5*whole['factorizations'], 'Jacobians of one chain of three')
    checks.equal(list(less), ['t', 'q3', 'dq3', 'E.kinetic', 'E.potential', 'E.total', 'closure'], 'columns')
    # tolerances of 1e-12 a step, some hundred steps
    case.same(less, table, (1e-9, 1e-9, 1e-9), 'one chain of three')
    quiet = table_of(case.dynamics, path, '--set', 'output.energies=.false.')
    checks.equal([name for name in quiet if name.startswith('E')], [], 'no energies')
    case.same(quiet, table, (0, 0, 0), 'without energies')
    heavy = table_and_report(case.dynamics, case.file(free, more=exact + '&body link=3, mass=0 /\n'))
    checks.equal(heavy[1]['links_with_inertia'], 2, 'a body without mass is none')
    case.same(heavy[0], table, (0, 0, 0), 'a body without mass')
    idle = "&load kind='force', link=1, force=1,2,3 /\n&load kind='coordinate', coordinate=10 /\n"
    unloaded = table_and_report(case.dynamics, case.file(free, more=exact + idle))
    checks.equal(unloaded[1]['acting_loads'], 0, 'loads that move nothing')
    case.same(unloaded[0], table, (0, 0, 0), 'loads that move nothing')
    pushed = table_and_report(case.dynamics, case.file(free, more=exact + idle + "&load kind='torque', link=2, torque=0,0,1 /"))
    checks.equal(pushed[1]['acting_loads'], 1, 'and one that does')
    checks.true(abs(pushed[0]['q3'][-1] - table['q3'][-1]) > 0.01, 'it does')
    plan = run(case.dynamics, case.file(free, more=idle), '--plan').stdout
    checks.true('zero, or on link 1 alone, left out: loads 1, 2' in plan, 'the plan says so', plan)
    loaded = case.file(free, more="&output coordinates=3 /\n&load kind='coordinate', coordinate=10, damping=0.1 /\n")
    checks.true('left out: no result' not in run(case.dynamics, loaded, '--plan').stdout, 'a load is a reason to solve')
    spring = exact + "&load kind='spring', links=1,8, position=0,1,0, second_position=0.1,0,0, stiffness=100, free_length=0.1 /\n"
    path = case.file(free, more=spring)
    sprung, less = table_of(case.dynamics, path), table_of(case.dynamics, path, '--set', 'output.coordinates=1')
    checks.true(np.max(np.abs(sprung['q1'] - table['q1'])) > 1e-3, 'a spring on a link of the last chain')
    case.same(less, sprung, (1e-9, 1e-9, 1e-9), 'what a spring holds is followed')


def test_counts_over_changes_of_coordinates(case):
    """Counts go on where other coordinates become the independent ones."""
    checks = case.checks
    report = table_and_report(case.dynamics, FIVE_BAR, '--set', 'time.end=5')[1]
    checks.true(len(report['coordinate_changes']) > 3, 'it changes coordinates', report['coordinate_changes'])
    checks.true(report['factorizations'] >= report['evaluations'], 'its block is factorized in each evaluation',
                [report['factorizations'], report['evaluations']])
    # five coordinates make five frames, those of one loop
    checks.true(report['frames_placed'] >= 5*report['steps'], 'and closed after each step',
                [report['frames_placed'], report['steps']])


def test_refused_steps_are_counted(case):
    """Long steps come to singular positions, and are refused there."""
    checks = case.checks
    text = run(case.dynamics, FIVE_BAR, '--table', os.devnull, '--report', os.path.join(case.folder, 'r.json'), *LOOSE).stderr
    with open(os.path.join(case.folder, 'r.json'), encoding='utf-8') as file:
        loose = json.load(file)
    checks.true(loose['refusals'] > 0, 'steps that are refused are counted', loose['refusals'])
    again = loose['error_test_failures'] + loose['convergence_failures'] + loose['refusals']
    checks.true(f"{loose['steps']} steps, {again} made again" in text, 'and in words, with the others', text)


def test_conditioning_jumps_at_changes(case):
    """It jumps up where other coordinates are taken, between two rows."""
    checks = case.checks
    table, report_of_second = table_and_report(case.dynamics, FIVE_BAR, '--set', 'time.end=1', '--set', 'time.intervals=4000',
                                               '--set', 'output.conditioning=.true.')
    jumps = np.flatnonzero(table['conditioning'][1:] > 2*table['conditioning'][:-1])
    times = np.array([event['t'] for event in report_of_second['coordinate_changes']])
    if checks.equal(len(jumps), len(times), 'the conditioning jumps at each change'):
        checks.true(np.all(table['t'][jumps] <= times + 1e-12) and np.all(times < table['t'][jumps + 1]),
                    'changes are told when they happen', [list(table['t'][jumps]), list(times)])


def test_work_for_each_window(case):
    """The work for each of N windows side by side does not depend on N, through the flat position, where other independent
    coordinates are looked for."""
    checks = case.checks
    few, many = (table_and_report(case.dynamics, case.file(data_file(n, 2.0)))[1] for n in (8, 40))
    for count in 'steps', 'evaluations':
        checks.near(many[count], few[count], 0.02*few[count], f'{count} of 8 and 40 windows')
    # frames and loops are counted for a window; links that all windows share, and a step more or less, are a few per cent
    for count in 'frames_placed', 'factorizations':
        checks.near(many[count]/40, few[count]/8, 0.05*few[count]/8, f'{count} for each of 8 and 40 windows')


def test_chain_beside_a_five_bar(case):
    """Two links without mass beside the five-bar, with the frame a chain, change nothing, recorded or not: that they were
    not followed for a while must not hinder a change of coordinates."""
    with open(FIVE_BAR, encoding='utf-8') as file:
        text = re.sub(r' *c\(\d,:\).*\n', '', file.read())
    text = text.replace('links = 5', 'links = 7').replace('coordinates = 5', 'coordinates = 8') + BESIDE
    path = case.file(text + '&solver relative_tolerance=1e-11, absolute_tolerance=1e-11 /\n')
    settings = ('--set', 'time.end=5')
    whole, report = table_and_report(case.dynamics, path, *settings)
    less, report_of_less = table_and_report(case.dynamics, path, *settings, '--set', 'output.coordinates=1,2,3,4,5')
    case.checks.true(len(report['coordinate_changes']) > 3 and len(report_of_less['coordinate_changes']) > 3, 'it changes coordinates')
    # the same steps; alone it takes others, and in 5 s this whirling motion makes errors of 1e-11 some 1e6 times larger
    case.same(less, whole, (1e-4, 1e-3, 1e-1), 'a chain beside a five-bar')
    alone = table_of(case.dynamics, FIVE_BAR, *settings, '--set', 'solver.relative_tolerance=1e-11',
                     '--set', 'solver.absolute_tolerance=1e-11')
    case.same({name: alone[name] for name in alone if not name.startswith('E')}, whole, (1e-4, 1e-3, 1e-1), 'a five-bar alone')


@pytest.mark.parametrize('setting, words', [
    ('coordinates=11', 'there is no coordinate 11; they are 1 to 10'), ('coordinates=3,3', 'coordinate 3 is there already'),
    ('derivatives=3', '0 (positions), 1'), ('derivatives=-1', 'derivatives')])
def test_columns_that_are_refused(case, setting, words):
    """Requests for columns that cannot be recorded are refused."""
    path = case.file(SIX_AND_TWO, more='')
    done = run(case.kinematics, path, '--set', f'output.{setting}')
    case.checks.true(done.returncode in (2, 3) and words in done.stderr, f'output.{setting} is refused', done.stderr)
