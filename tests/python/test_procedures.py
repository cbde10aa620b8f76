"""User procedures in Python and in Numba: against linked ones in Fortran, built-in kinds, and closed forms."""
import gc
import math
import os
import pickle
import traceback
import warnings

import numpy as np
import pytest

from force_pages import ROUNDED, Arrows
from mech9_cases import TREE, table_of, tolerance_of

WEIGHT = ("&structure cq=1 / &pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,-1 / &body link=2, mass=2 / "
          "&gravity acceleration=0,0,-9.81 / &load kind='user' / &initial coordinate=1, position=0, velocity=0 / "
          "&user parameters=0.1 / &time end=2, intervals=4 / &solver relative_tolerance=1e-10, absolute_tolerance=1e-10 /")
CENTRE = (0.0, 0.0, 0.0)


def data_of(sample):
    return os.path.join(TREE, 'user_procs', sample, sample + '.nml')


def trammel(coordinate, q, parameters):
    (length,) = parameters
    first = [length*math.cos(q), 0, 0]
    return [first, [0, length*math.sin(q), 0], [first[0], 0, -1]]


def trammel_with_derivatives(coordinate, q, parameters):
    (length,) = parameters
    c, s = length*math.cos(q), length*math.sin(q)
    return [trammel(coordinate, q, parameters), [[-s, 0, 0], [0, c, 0], [-s, 0, 0]], [[-c, 0, 0], [0, -s, 0], [-c, 0, 0]]]


def cycloid(coordinate, t, parameters):
    assert coordinate == 4
    rise, duration = parameters
    share = t/duration
    return rise*(share - math.sin(2*math.pi*share)/(2*math.pi))


def cardan(coupling, first, parameters):
    assert coupling == 1
    k = math.cos(parameters[0])
    return first + math.atan2((1 - k)*math.sin(first)*math.cos(first), math.sin(first)**2 + k*math.cos(first)**2)


def drag(t, motion, parameters, loads):
    v = motion.velocity(2, CENTRE)
    loads.add_force(2, CENTRE, -parameters[0]*np.linalg.norm(v)*v)


@pytest.fixture(name='falling')
def falling_weight(mech9):
    """The falling weight, whose drag is to be registered."""
    return mech9.read_text(WEIGHT)


def fall(t):
    """Its way in closed form."""
    final = math.sqrt(2*9.81/0.1)
    return final**2/9.81*np.log(np.cosh(9.81*t/final))


@pytest.mark.parametrize('sample, kind, function', (
    ('trammel', 'pair', trammel), ('trammel', 'pair', trammel_with_derivatives), ('cycloidal_drive', 'drive', cycloid),
    ('cardan_coupling', 'coupling', cardan)))
def test_like_linked_procedures(checks, build, mech9, sample, kind, function):
    linked = table_of(build.program(sample + '_k'), data_of(sample))
    m = mech9.read(data_of(sample))
    assert getattr(m, kind)(function) is function
    r = m.kinematics()
    for column in linked:
        if column != 'closure':
            checks.near(r[column], linked[column], tolerance_of(column), f'{sample}: {column}')


def test_force(checks, falling):
    falling.force(drag)
    r = falling.dynamics()
    checks.near(r['q1'], fall(r.t), 1e-8, 'the weight falls as the closed form says')
    with falling.simulation() as sim:
        sim.advance(2.0)
        checks.near(sim.q[0], fall(2.0), 1e-8, 'so it does step by step')


def test_all_that_forces_read_and_add(checks, mech9):
    """A spring, a damper and a torque as a procedure, beside the built-in kinds."""
    groups = ("&structure c(1,:)=0,1,0, c(2,:)=1,0,2, c(3,:)=0,2,0, cq=1,2 / &pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 / "
              "&pair coordinate=2, links=2,3, kind='revolute', point=0.5,0,0, axis=0,1,0 / &time end=1, intervals=10 / "
              "&body link=2, mass=1, centre=0.3,0,0, inertia=0.1,0.1,0.1,0,0,0 / &body link=3, mass=2, centre=0.2,0.1,0, "
              "inertia=0.2,0.2,0.2,0,0,0 / &solver relative_tolerance=1e-10, absolute_tolerance=1e-10 / &initial coordinate=1, position=0.2, velocity=1 / &initial coordinate=2, position=0.1, velocity=-2 / ")
    built = mech9.read_text(groups + "&load kind='spring', links=1,3, position=1,1,1, second_position=0.4,0,0.1, stiffness=20, "
                            "free_length=0.3, damping=0.5 / &load kind='coordinate', coordinate=2, stiffness=3, damping=0.2, rest=0.1 / "
                            "&load kind='torque', link=3, torque=1,2,3, frame='link' /").dynamics()
    own = mech9.read_text(groups + "&load kind='user' /")
    spins = []

    @own.force
    def forces(t, motion, parameters, loads):
        a, b = np.ones(3), (0.4, 0.0, 0.1)
        way = motion.position(3, b) - motion.position(1, a)
        length = np.linalg.norm(way)
        pull = (20*(length - 0.3) + 0.5*(motion.velocity(3, b) @ way)/length)*way/length
        loads.add_force(1, a, pull)
        loads.add_force(3, b, -pull)
        loads.add_generalized(2, -3*(motion.q(2) - 0.1) - 0.2*motion.dq(2))
        loads.add_torque(3, motion.turned(3, (1, 2, 3)))
        spins.append(motion.angular_velocity(2) - (0, 0, motion.dq(1)))
        assert len(parameters) == 0

    r = own.dynamics()
    for column in ('q1', 'q2', 'ddq1', 'ddq2'):
        # the tolerances of both motions are 1e-10
        checks.near(r[column], built[column], 1e-9, f'{column} as under built-in loads', scale=10.0)
    checks.near(np.array(spins), 0.0, 1e-15, 'the first link turns with its coordinate', scale=10.0)


def test_failing_procedures(mech9, falling):
    @falling.force
    def late(t, motion, parameters, loads):
        if t > 0.5:
            raise RuntimeError('no forces any more')
    with pytest.raises(mech9.DataError) as caught:
        falling.dynamics()
    assert isinstance(caught.value.__cause__, RuntimeError) and 'late' in ''.join(traceback.format_exception(caught.value.__cause__))
    assert 'says that it has no forces at t = 0.5' in caught.value.message and caught.value.line == 1
    assert caught.value.results.t.tolist() == [0.0]   # the step beyond fails before the output at 0.5

    falling.force(lambda t, motion, parameters, loads: loads.add_torque(7, CENTRE))
    with pytest.raises(mech9.DataError, match='calls add_torque with link 7') as caught:
        falling.dynamics()
    assert caught.value.__cause__ is None
    for wrong, told in ((lambda t, motion, parameters, loads: loads.add_force(2, (0, 0), CENTRE), 'have three numbers'),
                        (lambda t, motion, parameters, loads: np.ones(3), 'returns nothing'),
                        (lambda t, motion, parameters, loads: motion.q(1.0), 'have whole numbers')):
        falling.force(wrong)
        with pytest.raises(mech9.DataError, match=told) as caught:
            falling.dynamics()
        assert isinstance(caught.value.__cause__, mech9.UsageError)
    falling.force(lambda t, motion, parameters, loads: loads.add_generalized(2**32 + 1, 5.0))
    with pytest.raises(mech9.DataError, match='calls add_generalized with coordinate 0'):
        falling.dynamics()

    m = mech9.read(data_of('trammel'))
    m.pair(lambda coordinate, q, parameters: np.zeros((2, 3)))
    with pytest.raises(mech9.DataError, match='user procedure of pair 1') as caught:
        m.kinematics()
    assert 'of the shape (3, 3)' in str(caught.value.__cause__)
    for answer, told in ((None, 'returned None'), ('1.5', 'must return real numbers'), (1j, 'must return real numbers')):
        m.pair(lambda coordinate, q, parameters: answer)
        with pytest.raises(mech9.DataError, match=told):
            m.kinematics()
    m.pair(lambda coordinate, q, parameters: np.zeros((3, 3)))
    with pytest.raises(mech9.DataError, match='on one line'):
        m.kinematics()
    with pytest.raises(mech9.UsageError, match='a procedure is a function'):
        m.pair(3.0)
    with pytest.raises(mech9.DataError, match='none is linked'):
        mech9.read(data_of('trammel')).kinematics()


@pytest.mark.parametrize('reason', (KeyboardInterrupt, SystemExit))
def test_interrupted_procedure(falling, reason):
    """The exceptions that end a program are seen, whatever calls the procedure."""
    @falling.force
    def stopped(t, motion, parameters, loads):
        if t > 0.5:
            raise reason
    falling.add('quantity', name='way', of='q1', take='end')
    with falling.simulation() as sim, falling.simulations(2) as many:
        for call in (lambda: sim.advance(1.0), lambda: many.advance(1.0), falling.dynamics,
                     lambda: falling.study(**{'user.parameters(1)': [0.1, 0.2]})):
            with pytest.raises(reason):
                call()


def test_ctrl_c_in_a_procedure(checks, falling):
    """It comes once, amid the procedure; afterwards the motion goes on, and no force was added twice."""
    comes = [True]

    @falling.force
    def force(t, motion, parameters, loads):
        drag(t, motion, parameters, loads)
        if t > 0.5 and comes:
            comes.clear()
            raise KeyboardInterrupt
    with falling.simulation() as sim:
        with pytest.raises(KeyboardInterrupt):
            sim.advance(2.0)
        sim.advance(2.0)
        interrupted = sim.state()
    with falling.simulation() as sim:
        sim.advance(2.0)
        checks.equal(interrupted.tolist(), sim.state().tolist(), 'the motion goes on as if there had been none')


def test_calls_on_the_simulation_that_calls(mech9, falling):
    """A procedure must not change the motion that calls it."""
    refused, begun = [], []

    @falling.force
    def force(t, motion, parameters, loads):
        for sim in begun:
            for call in (lambda: sim.advance(5.0), lambda: sim.set('load(1).force', 1.0), lambda: sim.set_state(np.zeros(3)), sim.mass_matrix):
                try:
                    call()
                except mech9.UsageError as reason:
                    refused.append(str(reason))
    with falling.simulation() as sim:
        begun.append(sim)
        sim.advance(0.1)
        assert len(refused) >= 4 and all('a call changes this simulation' in reason for reason in refused)
        assert abs(sim.q[0] - 0.5*9.81*0.1**2) < 1e-9


@pytest.mark.parametrize('frequency', (25.1, 31.4, 16*math.pi, 50.0, 100.0, 1000.0))
@pytest.mark.parametrize('phase', (0.0, 0.7))
def test_fast_drives_without_derivatives(checks, mech9, frequency, phase):
    """Differences are as good as the derivatives, also where the period is a step of the stencil, or the curve is odd."""
    m = mech9.read_text("&structure cq=1 / &pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 / &drive coordinate=1, kind='user' / "
                        "&time end=1, intervals=20 /")
    m.drive(lambda coordinate, t, parameters: math.sin(frequency*t + phase))
    r = m.kinematics()
    angle = frequency*r.t + phase
    # the round-off of the values in differences over a sixteenth of a period: 1e-16 16^2, ten times that for sums
    checks.near(r['dq1']/frequency, np.cos(angle), 1e-10, 'rates')
    checks.near(r['ddq1']/frequency**2, -np.sin(angle), 1e-8, 'accelerations')


@pytest.mark.parametrize('function', (
    lambda t: 0.0 if t < 0.5 else 1.0, lambda t: float(int(3*t)), lambda t: abs(t - 0.5), lambda t: t*t if t >= 0 else 0.0,
    lambda t: float(np.interp(t, [0, 0.5, 1], [0, 1, 0])), lambda t: math.sin(1e6*t)))
def test_drives_that_are_not_smooth(mech9, function):
    """No derivatives are invented."""
    m = mech9.read_text("&structure cq=1 / &pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 / &drive coordinate=1, kind='user' / "
                        "&time end=1, intervals=20 /")
    m.drive(lambda coordinate, t, parameters: function(t))
    with pytest.raises(mech9.DataError, match='is not smooth at t = '):
        m.kinematics()


def test_pairs_and_couplings_that_are_not_smooth(mech9):
    pair = mech9.read(data_of('trammel'))
    pair.pair(lambda coordinate, q, parameters: np.array(trammel(coordinate, q, parameters)) + abs(q - 0.3))   # the kink is at the start
    with pytest.raises(mech9.DataError, match='is not smooth at q = 0.3'):
        pair.kinematics()
    coupling = mech9.read(data_of('cardan_coupling'))
    coupling.coupling(lambda coupling, first, parameters: abs(first - 0.3))
    with pytest.raises(mech9.DataError, match='is not smooth where its first coordinate is'):
        coupling.kinematics()


def test_motion_outlives_no_call(mech9, falling):
    kept = []
    falling.force(lambda t, motion, parameters, loads: kept.append((motion, loads)))
    falling.dynamics()
    motion, loads = kept[0]
    for call in (lambda: motion.q(1), lambda: motion.position(2, CENTRE), lambda: loads.add_torque(2, CENTRE)):
        with pytest.raises(mech9.UsageError, match='within the call alone'):
            call()


def test_functions_live_as_long_as_needed(checks, mech9, falling):
    """No name but the library's own refers to these functions."""
    falling.force(lambda t, motion, parameters, loads: drag(t, motion, parameters, loads))
    sim, copy, run = falling.simulation(), falling.copy(), falling.dynamics()
    changed = falling.with_(**{'user.parameters(1)': 0.2})
    falling.force(drag)
    sent = pickle.loads(pickle.dumps(falling))
    del falling
    gc.collect()
    sim.advance(2.0)
    sim.close()
    checks.near([sim_q[-1] for sim_q in (copy.dynamics()['q1'], sent.dynamics()['q1'])], fall(2.0), 1e-8, 'copies keep the function')
    checks.true(changed.dynamics()['q1'][-1] < fall(2.0) - 0.1, 'another number brakes more')
    checks.true('<svg' in run.sketch()._repr_html_(), 'so does a run that is drawn')


def test_studies_and_functions(checks, falling):
    falling.force(drag)
    falling.add('quantity', name='way', of='q1', take='end')
    f = falling.function(['user.parameters(1)'], ['way'])
    h = 1e-5
    # differences of fourth order in steps of a ten-thousandth of the number: 1e-8
    slope = (8*(f([0.1 + h]) - f([0.1 - h])) - f([0.1 + 2*h]) + f([0.1 - 2*h]))/(12*h)
    checks.near(f.jacobian([0.1])[0], slope, 1e-6, 'the derivative by a number of &user', scale=10.0)
    one, two = (falling.study(threads=n, **{'user.parameters(1)': [0.05, 0.1, 0.2, 0.4]}) for n in (1, 2))
    checks.equal(np.asarray(two['way']).tolist(), np.asarray(one['way']).tolist(), 'threads give the same bits')
    checks.near(float(np.asarray(one['way'])[1]), fall(2.0), 1e-8, 'the second run')


def test_compiled_procedures(checks, mech9, falling):
    numba = pytest.importorskip('numba')
    from mech9 import numba as ours

    @falling.force
    @numba.cfunc(ours.FORCE)
    def compiled(t, motion, n, parameters, loads, data):
        centre = np.zeros(3)
        v = ours.velocity(motion, 2, centre)
        ours.add_force(loads, motion, 2, centre, -parameters[0]*np.sqrt(v @ v)*v)
        return 0

    r = falling.dynamics()
    checks.near(r['q1'], fall(r.t), 1e-8, 'a compiled force')
    del compiled
    gc.collect()
    checks.near(falling.dynamics()['q1'], r['q1'], 0.0, 'lives as long as its mechanism')

    # arrays of any kind are taken; a wrong number of numbers ends the run
    for i, (vector, is_right) in enumerate((((0, 0, 5), True), (np.array([0, 0, 5]), True), (np.zeros((3, 2)) + [[0], [0], [5]], True),
                                            (np.zeros(2), False))):
        pushed = mech9.read_text(WEIGHT)
        part = vector[:, 1] if i == 2 else vector

        @pushed.force
        @numba.cfunc(ours.FORCE)
        def push(t, motion, n, parameters, loads, data):
            ours.add_force(loads, motion, 2, (0.0, 0.0, 0.0), part)
            return 0
        if is_right:
            checks.near(pushed.dynamics()['q1'][-1], (9.81 - 2.5)*2, 1e-8, f'force {i}')
        else:
            with pytest.raises(mech9.IntegrationError, match='not finite'):
                pushed.dynamics()

    m = mech9.read(data_of('cycloidal_drive'))

    @m.drive
    @numba.cfunc(ours.DRIVE)
    def drive(coordinate, t, n, parameters, values, data):
        share, turn = t/parameters[1], 2*math.pi
        values[0] = parameters[0]*(share - math.sin(turn*share)/turn)
        values[1] = parameters[0]/parameters[1]*(1 - math.cos(turn*share))
        values[2] = parameters[0]/parameters[1]**2*turn*math.sin(turn*share)
        return 0

    m2 = mech9.read(data_of('cycloidal_drive'))
    m2.drive(cycloid)
    checks.near(m.kinematics()['ddq1'], m2.kinematics()['ddq1'], 1e-9, 'a compiled drive with derivatives', scale=10.0)


def test_exceptions_in_studies_are_shown(mech9, falling):
    """A study goes on with other runs; a warning tells what a procedure raised, and where."""
    def fail(t, motion, parameters, loads):
        if parameters[0] > 0.15:
            raise ZeroDivisionError('too much drag')
    falling.force(fail)
    falling.remove('user').add('user', parameters=0.1)
    falling.add('quantity', name='depth', of='q1', take='max')
    with pytest.warns(RuntimeWarning, match=r'2 runs have failed; the procedure for groups of force raised ZeroDivisionError: too much '
                                            r'drag \(.*test_procedures.py, line \d+\)'):
        s = falling.study(**{'user.parameters': [0.1, 0.2, 0.3]})
    codes = s['exit_code'] if isinstance(s, mech9.Results) else s['exit_code'].values
    assert list(codes) == [0, 3, 3]
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        falling.study(**{'user.parameters': [0.1, 0.05]})


def test_exceptions_in_simulations_are_shown(mech9, falling):
    broken = []

    def fail(t, motion, parameters, loads):
        if broken:
            raise ZeroDivisionError('late')
    falling.force(fail)
    with falling.simulations(3) as many:
        with warnings.catch_warnings():
            warnings.simplefilter('error')
            many.advance(0.4)
        assert many.code.tolist() == [0, 0, 0] and many.t.tolist() == [0.4, 0.4, 0.4]
        broken.append(True)
        with pytest.warns(RuntimeWarning, match='3 motions have failed; the procedure for groups of force raised ZeroDivisionError: late'):
            many.advance(1.0)
        assert (many.code == 3).all() and np.isnan(many.q).all() and (many.t < 1).all()
        with warnings.catch_warnings():
            warnings.simplefilter('error')
            many.advance(2.0)
        with pytest.raises(mech9.Error, match='cannot go on'):
            many[0].advance(2.0)
        with pytest.raises(ValueError):
            many.code[0] = 0
        with pytest.raises(AttributeError):
            many.code = [0, 0, 0]
    with pytest.raises(mech9.UsageError):
        many.t


@pytest.mark.parametrize('turns', (True, False))
def test_arrow_of_a_stop(checks, mech9, turns):
    """A stop on a user's coordinate, three of which make one radian or one metre: its arrow is the torque, or the force, that holds the link."""
    m = mech9.read_text("&structure cq=1 / &pair coordinate=1, links=1,2, kind='user' / &body link=2, mass=2, centre=0.4,0,0 / "
                        "&gravity acceleration=0,-9.81,0 / &stop coordinate=1, low=0.3 / &initial coordinate=1, position=0.3 / "
                        "&output force_arrows=.true. / &time end=0.1, intervals=2 /")
    about = np.array([0.1, 0.2, 0])

    @m.pair
    def arm(coordinate, q, parameters):
        c, s = (math.cos(q/3), math.sin(q/3)) if turns else (1, 0)
        origin = about + [0, 0 if turns else q/3, 0]
        return [origin, origin + [c, s, 0], origin + [-s, c, 0]]
    arrows = Arrows(m.animate(dynamics=True).text)
    true = np.array([0, 0, 2*9.81*0.4*math.cos(0.1)] if turns else [0, 2*9.81, 0])
    titles = [title for title in arrows.ways if title.startswith('stop')]
    checks.equal(titles, [f"stop 1: {'torque' if turns else 'force'} in pair 1"], 'one arrow')
    largest = max(size for name, size in arrows.told.items() if arrows.is_torque(name) == turns)
    checks.true(np.abs(arrows.ways[titles[0]] - true).max() < ROUNDED*largest, 'its direction and size', [arrows.ways[titles[0]][0], true])
    checks.near(arrows.told[titles[0]], np.linalg.norm(true), 1e-3, 'its size is told')
