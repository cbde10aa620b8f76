"""Stops in Python: groups from nothing, events, a simulation through impacts to rest, many of them, and a study."""
import numpy as np
import pytest

G = 9.81


@pytest.fixture
def ball(mech9):
    """A slider that falls on a stop."""
    m = mech9.Mechanism(title='ball')
    m.add('structure', cq=1)
    m.add('pair', coordinate=1, links=(1, 2), kind='prismatic', axis=(0, 0, 1))
    m.add('body', link=2, mass=2.0)
    m.add('gravity', acceleration=(0, 0, -G))
    m.add('initial', coordinate=1, position=1.0)
    m.add('stop', coordinate=1, low=0.0, restitution=0.9)
    return m


def test_events_of_a_run(checks, ball):
    run = ball.dynamics(end=10, intervals=100)
    first = run.events[0]
    checks.equal((first['kind'], first['group'], first['number']), ('impact', 'stop', 1), 'the first event')
    checks.near([first['time'], first['impulse']], [np.sqrt(2 / G), 2 * 1.9 * np.sqrt(2 * G)], 1e-12, 'its time and impulse')
    checks.equal(run.events[-1]['kind'], 'close', 'the last one')
    checks.near(run.events[-1]['time'], 8.578949178728887, 1e-10, 'its time')
    checks.true(run.events[-1]['impulse'] is None and run.coordinate_changes == [], 'it has no impulse')
    checks.near(run['S1'][-1], 2 * G, 1e-12, 'the force at rest')


def test_a_simulation_comes_to_rest(checks, ball):
    """The same motion in pieces; at rest M ddq + bias = 0 holds with the force of the stop."""
    whole = ball.dynamics(end=10, intervals=100)
    with ball.simulation() as sim:
        for i, t in enumerate(whole.t[1:], 1):
            sim.advance(t)
            # tolerance: pieces make other steps, whose errors are those of the integration
            checks.near(sim.q[0], whole['q1'][i], 1e-8, f'position at {t}', scale=1.0)
            checks.near(sim.mass_matrix(), [[2.0]], 1e-14, f'mass matrix at {t}')
            checks.near(sim.mass_matrix() @ sim.ddq + sim.bias(), 0.0, 1e-12, f'equation of motion at {t}')
        checks.equal((sim.q[0], sim.dq[0], sim.ddq[0]), (0.0, 0.0, 0.0), 'it rests on the stop')
        rest = sim.state()
        sim.set_state(rest)
        sim.advance(11.0)
        checks.equal(sim.q[0], 0.0, 'it stays there when its state is set again')


def test_many_simulations(checks, ball):
    many = ball.simulations(5)
    many.advance(2.0)
    alone = ball.dynamics(end=2, intervals=1)
    checks.near(many.q, alone['q1'][-1], 1e-8, 'all of them bounce')


def test_a_study_of_the_restitution(checks, ball):
    ball.add('quantity', name='last', take='end', of='q1')
    try:
        s = ball.study(**{'stop(1).restitution': [0.0, 0.5, 0.8]})
    except ImportError:
        pytest.skip('xarray is not installed')
    checks.equal(s.sizes['run'], 3, 'three runs')


def test_events_are_marked_in_plots(checks, ball):
    pytest.importorskip('matplotlib', reason='matplotlib is not installed: plots are not tested')
    ball['stop(1).restitution'] = 0.5
    run = ball.dynamics(end=3, intervals=100)
    lines = {line.get_label(): line for line in run.plot('q1').axes[0].lines}
    for kind in ('impact', 'close'):
        times = [event['time'] for event in run.events if event['kind'] == kind]
        checks.equal(list(lines[kind].get_xdata()), times, f'{kind}: a symbol at each')
    checks.true('open' not in lines, 'no other kinds')
    checks.equal([line.get_label() in ('impact', 'close') for line in run.plot('q1', 'S1').axes[0].lines], [False], 'a path has no marks')
