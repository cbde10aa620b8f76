"""Analyses in Python against the programs, and their results as arrays.

Compares the library with the programs, whose numbers other tests judge.
"""
import json
import os
import sys
import threading
import time

import numpy as np
import pytest

from mech9_cases import TREE, read_table, run, table_of, text_of

EXAMPLES = os.path.join(TREE, 'examples')


def gallery():
    """(program, data file) of the examples without user procedures."""
    with open(os.path.join(EXAMPLES, 'list.txt'), encoding='utf-8') as file:
        for line in file:
            if not line.startswith('#') and line.strip():
                name, program, data, procedures = [field.strip() for field in line.split('|')][:4]
                if not procedures:
                    yield pytest.param(program, os.path.join('examples', name, data), id=name)


@pytest.mark.parametrize('program, data', gallery())
def test_runs_are_those_of_the_programs(build, mech9, monkeypatch, tmp_path, program, data):
    path = os.path.join(TREE, data)
    monkeypatch.chdir(os.path.dirname(path))
    m = mech9.read(path)
    results = m.kinematics(intervals=40) if program == 'mech9k' else m.dynamics(intervals=40)
    table = table_of(build.program(program), path, '--set', 'time.intervals=40')
    assert list(results.names) == list(table)
    for name in results.names:
        # the table has 17 digits, which give the same number back
        assert np.array_equal(results[name], table[name], equal_nan=True), name


def test_columns_share_memory(mech9, four_bar):
    results = four_bar.kinematics()
    column = results['q2']
    assert np.shares_memory(column, results.table) and not column.flags.writeable
    del results   # the column keeps the memory
    assert np.isfinite(column).all()
    with pytest.raises(ValueError):
        column[0] = 1.0
    with pytest.raises(KeyError, match='there is no column'):
        four_bar.kinematics()['q9']
    with pytest.raises(KeyError, match='there is no column 0'):
        four_bar.kinematics()[0]


def test_units_and_degrees(mech9, four_bar):
    results = four_bar.kinematics()
    assert results.units['q1'] == 'rad' and results.units['P.vx'] == 'm/s'
    four_bar['mechanism.angle_unit'] = 'deg'
    four_bar['initial(1).position'], four_bar['initial(2).position'] = 30, -115
    four_bar['drive(1).coefficients'] = [np.degrees(0.6), np.degrees(5)]
    degrees = four_bar.kinematics()
    assert degrees.units['q1'] == 'deg'
    assert np.allclose(np.radians(degrees['q2']), results['q2'], rtol=0, atol=1e-12)
    assert np.allclose(np.radians(four_bar.positions([40.0])), mech9.read(four_bar_path()).positions([np.radians(40)]), atol=1e-12)


def four_bar_path():
    return os.path.join(EXAMPLES, 'library', 'four_bar.nml')


def test_tables_of_others(mech9, four_bar):
    pytest.importorskip('pandas')
    pytest.importorskip('xarray')
    results = four_bar.kinematics()
    frame, data = results.to_pandas(), results.to_xarray()
    assert frame.index.name == 't' and (frame['q2'].to_numpy() == results['q2']).all()
    assert data['q2'].attrs['units'] == 'rad' and (data['q2'].to_numpy() == results['q2']).all()


def test_quantities_and_gradients(mech9, four_bar):
    four_bar.add('parameter', name='crank', value=0.3, sets='pair(2).point(1)')
    four_bar.add('quantity', name='top', of='P.y', take='max')
    results = four_bar.kinematics(gradients=True)
    h = 1e-6
    ends = [four_bar.with_(crank=0.3 + d).kinematics().quantities['top'] for d in (h, -h)]
    # a central difference errs by h^2 times a third derivative of the order one, and by round-off over h
    assert abs(results.gradients['top']['crank'] - (ends[0] - ends[1])/(2*h)) < 1e-8
    f = four_bar.function(['crank', 'pair(4).point(1)'], ['top'])
    assert abs(f([0.3, 0.9])[0] - results.quantities['top']) < 1e-14
    assert f.jacobian([0.3, 0.9]).shape == (1, 2)
    assert abs(f.jacobian([0.3, 0.9])[0, 0] - results.gradients['top']['crank']) < 1e-12
    with pytest.raises(mech9.UsageError, match='shape'):
        f([0.3])
    with pytest.raises(mech9.AssemblyError):
        f([0.3, 9.0])


def test_rest(mech9):
    path = os.path.join(EXAMPLES, 'pendulum_four_bar', 'pendulum_four_bar.nml')
    m = mech9.read(path)
    modes, linear = m.modes(), m.linear()
    assert linear.second_order.M.shape == (1, 1) and linear.state_space.A.shape == (2, 2)
    root = np.sqrt(linear.second_order.K[0, 0]/linear.second_order.M[0, 0])
    assert abs(root - modes['eigenvalue.im'][0]) < 1e-9*root
    assert linear.state_space.states == ('q4', 'dq4')
    assert np.allclose(np.linalg.eigvals(linear.state_space.A).imag.max(), root, rtol=1e-9)
    rest = m.equilibrium()
    assert np.allclose(linear.q, [rest[f'q{k}'][0] for k in range(1, 5)], atol=1e-12)


def test_structure(mech9, four_bar):
    assemblies = four_bar.assemblies(50)
    assert len(assemblies['q2']) == 2 and (assemblies['q1'] == 0.6).all()
    limits = four_bar.range()
    assert list(limits['coordinate']) == [1] and list(limits['lower']) == [-np.inf] and list(limits['upper']) == [np.inf]


def test_positions(mech9, four_bar):
    results = four_bar.kinematics(intervals=60)
    n = len(results.t)
    order = np.random.default_rng(1).permutation(n)
    q = results['q1'][order]
    columns = [f'q{k}' for k in range(1, 5)]
    positions = four_bar.positions(q)
    assert positions.shape == (n, 4) and (positions.code == 0).all()
    expected = np.column_stack([results[name] for name in columns])[order]
    # both are closed to round-off
    assert np.abs(positions - expected).max() < 1e-12
    rates = four_bar.rates(q, np.full(n, 5.0))
    assert np.abs(rates - np.column_stack([results['d' + name] for name in columns])[order]).max() < 1e-10
    accelerations = four_bar.accelerations(q, np.full(n, 5.0), np.zeros(n))
    assert np.abs(accelerations - np.column_stack([results['dd' + name] for name in columns])[order]).max() < 1e-9


def test_positions_out_of_reach(mech9, four_bar):
    four_bar['pair(2).point(1)'] = 0.7   # not a crank any more
    lower, upper = four_bar.range()['lower'][0], four_bar.range()['upper'][0]
    q = np.array([lower - 0.1, lower + 0.1, 0.6, upper - 0.1, upper + 0.1, np.nan])
    positions = four_bar.positions(q)
    assert list(positions.code) == [6, 0, 0, 0, 6, 3]
    assert np.isnan(positions[[0, 4, 5]]).all() and np.isfinite(positions[1:4]).all()
    assert four_bar.positions([]).shape == (0, 4)
    with pytest.raises(mech9.UsageError, match='shape'):
        four_bar.positions(np.zeros((3, 2)))


def test_positions_of_several_coordinates(mech9):
    m = mech9.read(os.path.join(EXAMPLES, 'stewart_gough', 'stewart_gough.nml'))
    results = m.kinematics(intervals=4)
    independent = [name for name in results.names if name.startswith('q') and name[1:].isdigit()]
    whole = np.column_stack([results[name] for name in independent])
    listed = [int(text) for text in m.text().split('cq =')[1].split('\n')[0].split(',')]
    positions = m.positions(whole[:, [k - 1 for k in listed]])
    assert (positions.code == 0).all() and np.abs(positions - whole).max() < 1e-11


def test_study(mech9, four_bar):
    pytest.importorskip('xarray')
    four_bar.add('parameter', name='crank', value=0.3, sets='pair(2).point(1)', low=0.2, high=1.2, count=5)
    four_bar.add('quantity', name='top', of='P.y', take='max')
    four_bar.add('study', kind='grid')
    study = four_bar.study(threads=2)
    assert list(study['run'].values) == [1, 2, 3, 4, 5] and study['exit_code'].dtype.kind == 'i'
    assert study['exit_code'].values[0] == 0 and study['exit_code'].values[-1] != 0 and np.isnan(study['top'].values[-1])
    assert study['top'].values[0] == four_bar.with_(crank=0.2).kinematics().quantities['top']


def test_study_with_a_section(mech9):
    """A truss that snaps through: each run begins where the one before ended, and the points of its section are there."""
    pytest.importorskip('xarray')
    truss = mech9.Mechanism()
    truss.add('structure', cq=1)
    truss.add('pair', coordinate=1, links=(1, 2), kind='prismatic', axis=(0, 1, 0))
    truss.add('initial', coordinate=1, position=0.6)
    truss.add('body', link=2, mass=1)
    truss.add('load', kind='spring', links=(2, 1), second_position=(0.8, 0, 0), stiffness=100, free_length=1)
    truss.add('load', kind='coordinate', coordinate=1, damping=20)
    truss.add('load', kind='coordinate', coordinate=1, force=0)
    truss.add('section', period=1, transient=18)
    truss.add('time', end=20, intervals=1)
    # the force at the fold is 5.139 N
    study = truss.study(carry='both', **{'load(3).force': [0, -5, -5.3, 5, 5.3]})
    signs = np.sign(study['section.q1'].values.reshape(-1, 3)[:, -1])
    assert signs.tolist() == [1, 1, -1, -1, 1, 1, 1, -1, -1, -1]
    assert study['section.run'].values[::3].tolist() == list(range(1, 11))


def test_study_of_lists(mech9, four_bar):
    pytest.importorskip('xarray')
    four_bar.add('parameter', name='crank', value=0.3, sets='pair(2).point(1)')
    four_bar.add('quantity', name='top', of='P.y', take='max')
    study = four_bar.study(crank=[0.2, 0.25, 0.3])
    assert study['crank'].values.tolist() == [0.2, 0.25, 0.3]
    assert study['top'].values[2] == four_bar.kinematics().quantities['top']
    both = four_bar.study(**{'pair(4).point(1)': [0.9, 0.95], 'crank': [0.3, 0.3]})
    assert both['pair(4).point(1)'].values.tolist() == [0.9, 0.95] and both['top'].values[0] == study['top'].values[2]
    with pytest.raises(mech9.UsageError, match='same length'):
        four_bar.study(crank=[0.2], **{'pair(4).point(1)': [0.9, 0.95]})
    with pytest.raises(mech9.DataError):
        four_bar.study(cranck=[0.2])


def test_optimum(mech9):
    path = os.path.join(EXAMPLES, 'five_timed_points', 'five_timed_points.nml')
    if not os.path.exists(path):
        pytest.skip('the example has gone')
    m = mech9.read(path)
    found, again = m.optimize(starts=12, seed=3, threads=2), m.optimize(starts=12, seed=3)
    assert found.value == again.value and found.parameters == again.parameters and found.made == 12
    assert (np.diff(found.optima['value']) >= 0).all()
    assert found.mechanism.check().mobility == 1
    assert found.mechanism[list(found.parameters)[0]] == list(found.parameters.values())[0]
    with pytest.raises(mech9.DataError):
        m.optimize(sedd=1)
    with pytest.raises(mech9.UsageError):
        mech9.read(four_bar_path()).optimize()


def test_simulation(mech9):
    m = mech9.read(os.path.join(EXAMPLES, 'heavy_top', 'heavy_top.nml'))
    results = m.dynamics(intervals=10)
    with m.simulation() as motion:
        for i, t in enumerate(results.t):
            motion.advance(t)
            assert np.allclose(motion.q, [results[f'q{k + 1}'][i] for k in range(len(motion.q))], rtol=0, atol=1e-9)
        assert motion.t == results.t[-1] and motion.closure < 1e-9
        with pytest.raises(mech9.UsageError, match='cannot go back'):
            motion.advance(0.0)
        assert motion.t == results.t[-1]
    with pytest.raises(mech9.UsageError, match='closed'):
        motion.q


def cart(mech9):
    """2 kg on a rail, pushed by a force that is zero at first."""
    m = mech9.Mechanism(title='cart')
    m.add('structure', cq=1).add('pair', coordinate=1, links=(1, 2), kind='prismatic', axis=(1, 0, 0))
    m.add('body', link=2, mass=2.0).add('load', kind='force', link=2, force=(0, 0, 0))
    return m.add('initial', coordinate=1, position=1.0)


def test_control(mech9):
    with cart(mech9).simulation() as sim:
        x, v, h = 1.0, 0.0, 0.01
        for _ in range(100):
            force = -4.0*sim.q[0] - sim.dq[0]
            sim.set('load(1).force(1)', force)
            assert abs(sim.ddq[0] - force/2.0) < 1e-14
            sim.advance(sim.t + h)
            # the force stands still within a step, so that the motion is a parabola
            x, v = x + h*v + h*h*force/4.0, v + h*force/2.0
            assert abs(sim.q[0] - x) < 1e-9 and abs(sim.dq[0] - v) < 1e-9
        for wrong, kind in (('load(2).force(1)', mech9.DataError), ('pair(1).axis(1)', mech9.UsageError), ('', mech9.UsageError)):
            with pytest.raises(kind):
                sim.set(wrong, 1.0)
        assert sim.q[0] == pytest.approx(x, abs=1e-9)
    with mech9.read(four_bar_path()).simulation() as driven, pytest.raises(mech9.UsageError, match='drives determine'):
        driven.set('load(1).force(1)', 1.0)


def test_many_at_once(mech9):
    with cart(mech9).simulations(5) as many:
        forces = np.linspace(-2.0, 2.0, 5)
        many.set('load(1).force(1)', forces)
        many.advance(0.5)
        assert many.q.shape == (5, 1) and np.abs(many.q[:, 0] - (1.0 + forces*0.25/4.0)).max() < 1e-9
        assert np.abs(many.ddq[:, 0] - forces/2.0).max() < 1e-14 and (many.code == 0).all() and len(many) == 5
        with pytest.raises(mech9.UsageError):
            many.advance(0.1)
    with pytest.raises(mech9.UsageError, match='from 1 on'):
        cart(mech9).simulations(0)


def test_many_that_fail(mech9, four_bar):
    four_bar['pair(2).point(1)'] = 0.7
    with four_bar.simulations(2, driven=True) as many:
        many.advance(2.0)
        assert (many.code == 6).all() and np.isnan(many.q).all()


def test_states_and_equations(mech9):
    folder = os.path.join(EXAMPLES, 'motor_crank')
    m = mech9.read(os.path.join(folder, 'motor_crank.nml'))
    with m.simulation() as first, m.simulation() as other:
        first.advance(0.5)
        state = first.state()
        other.set_state(state)
        assert other.t == 0.5 and np.abs(other.q - first.q).max() < 1e-14
        first.advance(1.0)
        other.advance(1.0)
        # both hold the tolerances of the data file, 1e-8 and better
        assert np.abs(other.q - first.q).max() < 1e-7
        mass, free = first.mass_matrix(), [k - 1 for k in first.free]
        assert np.abs(mass @ first.ddq[free] + first.bias()).max() < 1e-12
        with pytest.raises(mech9.UsageError, match='no state'):
            first.set_state(state[:-1])
        with pytest.raises(mech9.UsageError, match='no state'):
            first.set_state(np.full(len(state), np.nan))
    with mech9.read(os.path.join(EXAMPLES, 'double_pendulum', 'double_pendulum.nml')).simulation(accuracy=0.0) as sim:
        sim.advance(0.3)
        mass = sim.mass_matrix()
        assert mass.shape == (2, 2) and np.allclose(mass, mass.T) and (np.linalg.eigvalsh(mass) > 0).all()
        kinetic = 0.5*sim.dq @ mass @ sim.dq
        assert kinetic == pytest.approx(sim.energies[0], rel=1e-12)


def test_failed_motions_stay_where_they_are(mech9):
    with cart(mech9).simulation() as sim:
        sim.set('load(1).force(1)', 1.0)
        sim.advance(1.0)
        with pytest.raises(mech9.IntegrationError):
            sim.advance(1e300)
        # the force of 1 N moves 2 kg by t^2/4
        assert sim.q[0] == pytest.approx(1.0 + sim.t**2/4.0, rel=1e-6) and sim.t >= 1.0
        with pytest.raises(mech9.UsageError, match='cannot go on'):
            sim.advance(sim.t + 1.0)
        sim.set_state([0.0, 1.0, 0.0])
        sim.advance(1.0)
        assert sim.q[0] == pytest.approx(1.25, abs=1e-9)
    m = mech9.read(four_bar_path()).with_(**{'pair(2).point(1)': 0.65})
    with m.simulation(driven=True) as sim:
        with pytest.raises(mech9.SingularError):
            sim.advance(1.2)
        # the drive of the data file: 0.6 + 5 t
        assert sim.q[0] == pytest.approx(0.6 + 5.0*sim.t, abs=1e-12) and sim.t > 0.0


def test_states_that_are_none(mech9):
    with cart(mech9).simulation() as sim:
        sim.advance(0.5)
        for wrong in ([0.0, 1e300, 0.0], [0.0, np.inf, 0.0], [], [1.0]):
            with pytest.raises(mech9.UsageError, match='no state'):
                sim.set_state(wrong)
        assert sim.t == 0.5 and sim.q[0] == 1.0
        import copy
        with pytest.raises(mech9.UsageError, match='cannot be copied'):
            copy.copy(sim)


def test_numbers_of_calls(mech9, four_bar):
    for wrong in (None, 1.5, 'many', -1, 2**31, float('nan')):
        with pytest.raises(mech9.UsageError, match='whole number'):
            four_bar.assemblies(wrong)
        with pytest.raises(mech9.UsageError, match='whole number'):
            four_bar.positions([0.0], threads=wrong)
    with pytest.raises(mech9.DataError, match='at most'):
        four_bar.kinematics(intervals=2**31 - 1)
    f = four_bar.function(['pair(2).point(1)'], ['nope'])
    with pytest.raises(mech9.DataError, match='no quantity'):
        f([0.3])
    assert (four_bar.rates([0.6, 0.6], [np.nan, 1.0]).code == [3, 0]).all()


def test_cams(checks, build, mech9, tmp_path):
    path = os.path.join(EXAMPLES, 'dwell_cam', 'dwell_cam.nml')
    done = run(build.program('mech9k'), path, '--cam', f"1:{tmp_path / 'cam.dat'}", '--report', str(tmp_path / 'report.json'), folder=tmp_path)
    checks.equal(done.returncode, 0, done.stderr)
    theirs, told = read_table(text_of(str(tmp_path / 'cam.dat'))), json.loads(text_of(str(tmp_path / 'report.json')))['cams'][0]
    m = mech9.read(path)
    profile = m.cam()
    checks.equal(list(profile.names), list(theirs), 'the columns of the program')
    for name in theirs:
        checks.near(profile[name], theirs[name], 0.0, f'{name} of the profile')
    checks.equal(profile.report, told, 'the entry of the report')
    shaft = told['coordinate']
    copy = tmp_path / 'named.nml'
    copy.write_text(text_of(path).replace(f'&pair coordinate={shaft},', f"&pair coordinate={shaft}, name='shaft',", 1), encoding='utf-8')
    checks.near(mech9.read(copy).cam()['shaft.q'], profile[f'q{shaft}'], 0.0, 'a column by the name of its pair')
    with pytest.raises(mech9.UsageError, match='there is no cam 3; this mechanism has 2 cams'):
        m.cam(3)


def test_pictures(mech9, four_bar, tmp_path):
    drawing = four_bar.sketch()
    for name in ('drawing.svg', 'drawing', 'Drawing.SVG', 'drawing.v2'):
        drawing.save(tmp_path / name)
        assert (tmp_path / name).read_bytes() == drawing.content
    with pytest.raises(mech9.UsageError, match='of the kind svg; give a name that ends with .svg, not with .png'):
        drawing.save(tmp_path / 'drawing.png')
    assert not (tmp_path / 'drawing.png').exists()
    assert drawing.text.startswith('<?xml') and four_bar._repr_html_().startswith('<svg')
    results = four_bar.kinematics(intervals=5)
    assert results.animate().text.lstrip().lower().startswith('<!doctype html')
    assert results.animate('gif').content[:3] == b'GIF'
    with pytest.raises(mech9.UsageError, match='must end in'):
        results.animate('mp3')
    with pytest.raises(mech9.UsageError):
        four_bar.sketch(view='upside')
    four_bar['pair(4).point(1)'] = 9.0
    assert 'cannot be assembled' in four_bar._repr_html_()


def test_interruption(mech9, monkeypatch):
    import _thread
    m = mech9.read(os.path.join(EXAMPLES, 'heavy_top', 'heavy_top.nml'))
    timer = threading.Timer(0.5, _thread.interrupt_main)
    timer.start()
    with pytest.raises(KeyboardInterrupt) as caught:
        m.dynamics(end=1e6, intervals=1000000)
    timer.join()
    assert 0 < len(caught.value.results.t) < 1000000


def test_failures_keep_results(mech9, four_bar):
    four_bar['pair(2).point(1)'] = 0.7
    with pytest.raises(mech9.SingularError) as caught:
        four_bar.kinematics(end=2, intervals=200)
    assert caught.value.code == 6 and 0 < len(caught.value.results.t) < 201


def test_other_libraries_in_the_process(build, mech9, tmp_path):
    """h5py, with its own HDF5, works before and after, in both orders."""
    pytest.importorskip('h5py')
    package = os.path.join(TREE, 'python')
    work = f'''
m = mech9.read({four_bar_path()!r})
r = m.kinematics()
with h5py.File('run.h5', 'w') as file:
    file['table'] = r.table
with h5py.File('run.h5') as file:
    assert (file['table'][()] == r.table).all()
print('done')
'''
    for order in ('import mech9, h5py', 'import h5py, mech9'):
        script = tmp_path / 'both.py'
        script.write_text(f'import sys\nsys.path.insert(0, {package!r})\n{order}\n{work}')
        done = run(sys.executable, '-B', script, folder=tmp_path)
        assert done.stdout == 'done\n', done.stderr


def test_linear_along_a_motion(checks, build, mech9, tmp_path):
    """The matrices of --linear --at, at one time, at several, and at all outputs."""
    import h5py
    path = os.path.join(TREE, 'examples', 'double_pendulum', 'double_pendulum.nml')
    m = mech9.read(path)
    done = run(build.program('mech9d'), path, '--quiet', '--linear', str(tmp_path / 'a.h5'), '--at', '0,0.5,1.5')
    checks.equal(done.returncode, 0, done.stderr)
    along = m.linear(at=[0, 0.5, 1.5])
    checks.equal(along.free, ('q1', 'q2'), 'free coordinates')
    with h5py.File(tmp_path / 'a.h5') as file:
        for ours, theirs in ((along.t, 'time'), (along.q, 'q'), (along.dq, 'dq'), (along.ddq, 'ddq'), (along.second_order.M, 'second_order/M'),
                             (along.second_order.C, 'second_order/C'), (along.second_order.K, 'second_order/K'),
                             (along.state_space.A, 'state_space/A'), (along.state_space.B, 'state_space/B'),
                             (along.state_space.C, 'state_space/C'), (along.state_space.D, 'state_space/D')):
            checks.equal(ours.shape, file[theirs].shape, theirs)
            checks.true(np.array_equal(ours, file[theirs][()]), f'{theirs}: the same numbers')
    alone = m.linear(at=0.0)
    checks.true(alone.t == 0 and np.array_equal(alone.state_space.A, along.state_space.A[0]) and np.array_equal(alone.q, along.q[0]), 'one time')
    checks.equal(alone.state_space.states, ('q1', 'q2', 'dq1', 'dq2'), 'states')
    checks.near(m.linear(at='outputs').t, np.linspace(0, 5, 201), 1e-15, 'all outputs')
    checks.near(m.linear(at=np.array([0.5])).state_space.A, along.state_space.A[1:2], 1e-9, 'one time in a list')
    for wrong in ('often', [], [[0.1]], float('nan'), [0.2, 0.1], 9.0):
        with pytest.raises(mech9.UsageError):
            m.linear(at=wrong)
    with pytest.raises(mech9.DataError):
        mech9.read(os.path.join(TREE, 'examples', 'block_on_belt', 'block_on_belt.nml')).linear(at=0.0)


def test_reports(checks, build, mech9, four_bar):
    """The report of a run is that of the program, but for what differs from run to run."""
    from mech9_cases import report_of
    m, path = four_bar, os.path.join(TREE, 'examples', 'library', 'four_bar.nml')
    theirs, ours = report_of(build.program('mech9k'), path), m.kinematics().report
    for name in theirs.keys() | ours.keys():
        if name not in ('table', 'seconds_solving', 'seconds_writing'):
            checks.equal(ours.get(name), theirs.get(name), f'{name} in the report')
    checks.true(0 < ours['seconds_solving'] < 60 and m.kinematics().events == [], 'a driven run has no events')

    free = os.path.join(TREE, 'examples', 'pendulum_four_bar', 'pendulum_four_bar.nml')
    theirs, run = report_of(build.program('mech9d'), free), mech9.read(free).dynamics()
    for name in ('outputs', 'steps', 'evaluations', 'coefficients', 'coordinate_changes', 'exit_code', 'largest_energy_change'):
        checks.equal(run.report[name], theirs[name], f'{name} in the report of a free motion')

    checks.true(len(run.coordinate_changes) > 0 and run.coordinate_changes == theirs['coordinate_changes'], 'changes of coordinates are those of the report')
    told = report_of(build.program('mech9d'), free, '--set', 'time.at=0.0')
    instant = mech9.read(free).dynamics(at=0.0).report
    for name in ('mass_matrix', 'bias', 'point_jacobians', 'dependent_jacobian', 'generalized_forces'):
        checks.equal(instant[name], told[name], f'{name} of one instant')
    stuck = m.with_(**{'pair(2).point(1)': 0.65})
    with pytest.raises(mech9.Error) as caught:
        stuck.kinematics()
    report = caught.value.results.report
    checks.equal((report['exit_code'], len(report['errors'])), (caught.value.code, 1), 'a failure is in the report')
    checks.equal(m.assemblies().report, {}, 'other analyses have none')


def test_pauses_change_nothing(mech9, monkeypatch):
    """A motion that is stopped again and again, to see whether there was a Ctrl-C, goes on with the same bits. Only the main thread's is."""
    from mech9 import _library
    calls = []
    advance = _library.lib.simulation_advance
    monkeypatch.setattr(_library.lib, 'simulation_advance', lambda *arguments: calls.append(None) or advance(*arguments))
    monkeypatch.setattr(_library._watch, '_interval', 0.0005)
    time.sleep(0.2)   # the thread that watches may still sleep as long as before
    for name, is_driven, end in (('library/four_bar.nml', True, 3000.0), ('heavy_top/heavy_top.nml', False, 30.0)):
        m = mech9.read(os.path.join(EXAMPLES, name))
        states, counts = [], []

        def move():
            calls.clear()
            with m.simulation(driven=is_driven, end=end) as sim:
                sim.advance(end)
                states.append(np.concatenate(([sim.t], sim.q, sim.dq, sim.ddq)))
            counts.append(len(calls))
        move()
        thread = threading.Thread(target=move)
        thread.start()
        thread.join()
        assert counts[0] > 3 and counts[1] == 1, f'{name}: paused, and not paused: {counts}'
        assert np.array_equal(states[0], states[1]), name


@pytest.mark.parametrize('many', (False, True), ids=('one motion', 'many motions'))
def test_interrupted_simulation(mech9, many):
    import _thread
    m = mech9.read(os.path.join(EXAMPLES, 'heavy_top', 'heavy_top.nml'))
    with m.simulations(3, end=1e6) if many else m.simulation(end=1e6) as sim:
        timer = threading.Timer(0.5, _thread.interrupt_main)
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            sim.advance(1e6)
        timer.join()
        one = sim[0] if many else sim
        reached = one.t
        assert 0 < reached < 1e6
        one.advance(reached + 0.5)
        assert one.t == reached + 0.5


@pytest.mark.parametrize('group, name, values', (
    ("&load kind='force', link=2, force=1,0,0, position=0,0.1,0 /", 'load(1).force(1)', (1.5, 2.0, 0.0, 3.0, 2.5, 1e300)),
    ("&load kind='torque', link=2, torque=0,0,1 /", 'load.torque(3)', (1.5, 2.0, 0.0, 3.0)),
    ("&load kind='coordinate', coordinate=1, force=2, stiffness=3, rest=20 /", 'load(1).rest', (0.0, 10.0, 30.0, 40.0)),
    ("&load kind='coordinate', coordinate=1, force=2, stiffness=3, rest=20 /", 'load(1).force', (0.5, -0.5, 0.7)),
    ("&load kind='coordinate', coordinate=1, stiffness=3 /", 'load(1).stiffness', (4.0, 5.0, -1.0)),
    ("&load kind='spring', links=1,2, position=1,0,0, second_position=0,1,0, stiffness=2 /", 'load(1).position(2)', (0.2, 0.3, 0.4)),
    ("&load kind='force', link=2, force=1,0,0, law='harmonic', amplitude=2, angular_frequency=3 /", 'load(1).amplitude', (3.0, 4.0)),
    ("&motor kind='dc', coordinate=1, voltage=2, resistance=1, constant=0.1 /", 'motor(1).voltage', (3.0, 4.0, -5.0))))
def test_many_changes_while_a_motion_runs(checks, mech9, group, name, values):
    """The second change of a number may go to the load at once; the mechanism is read anew for each in the other motion."""
    m = mech9.read_text("&mechanism angle_unit='deg' / &structure cq=1 / &pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 / "
                        "&body link=2, mass=1, centre=0.2,0,0, inertia=0,0,0.1,0,0,0 / &initial coordinate=1, position=10, velocity=50 / " + group)
    with m.simulation() as sim:
        for value in values:
            state = sim.state()
            with m.simulation() as other:
                failures = []
                for motion in (other, sim):
                    try:
                        motion.set(name, value)
                        failures.append(None)
                    except mech9.Error as failure:
                        failures.append((failure.code, failure.message))
                checks.equal(failures[1], failures[0], f'{name} = {value}: both take it, or refuse it')
                if abs(value) > 1e100 or failures[0]:
                    continue
                other.set_state(state)
                sim.set_state(state)
                for motion in (other, sim):
                    motion.advance(state[0] + 0.05)
                checks.equal(sim.state().tolist(), other.state().tolist(), f'{name} = {value}: the same motion')


def test_changes_in_any_order(checks, mech9):
    """Many numbers of several loads, in random order and with values at which loads come and go: the motion of a mechanism that has these
    numbers from its start."""
    m = mech9.read_text("&mechanism angle_unit='deg' / &structure cq=1 / &pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 / "
                        "&body link=2, mass=1, centre=0.2,0,0, inertia=0,0,0.1,0,0,0 / &initial coordinate=1, position=10, velocity=50 / "
                        "&load kind='force', link=2, force=1,0,0 / &load kind='coordinate', coordinate=1, stiffness=3 / "
                        "&load kind='spring', links=1,2, position=1,0,0, second_position=0,1,0, stiffness=2 / "
                        "&load kind='force', link=2, force=0,1,0, law='harmonic', amplitude=2, angular_frequency=3 / "
                        "&motor kind='dc', coordinate=1, voltage=2, resistance=1, constant=0.1 /")
    names = ('load(1).force(1)', 'load(1).force(2)', 'load(1).position(2)', 'load(2).rest', 'load(2).force', 'load(2).damping',
             'load(3).second_position(1)', 'load(3).free_length', 'load(4).amplitude', 'load(4).force(2)', 'motor(1).voltage')
    random = np.random.default_rng(5)
    with m.simulation() as sim:
        for _ in range(80):
            name, value = names[random.integers(len(names))], float(random.choice([0.0, 1.0, 0.5, 20.0, random.uniform(0, 3)]))
            sim.set(name, value)
            m[name] = value
            with m.simulation() as other:
                state = sim.state()
                for motion in (sim, other):
                    motion.set_state(state)
                    motion.advance(state[0] + 0.01)
                checks.equal(sim.state().tolist(), other.state().tolist(), f'{name} = {value}: the same motion')
