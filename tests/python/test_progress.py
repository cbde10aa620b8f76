"""Progress of long calls: a function learns the share that is done, and may stop the call by an exception."""
import _thread
import os
import threading
import time

import numpy as np
import pytest

from mech9_cases import TREE

SWING = os.path.join(TREE, 'examples', 'double_pendulum', 'double_pendulum.nml')


@pytest.fixture(name='long_runs')
def runs_that_take_some_seconds(mech9, four_bar):
    """(what, a function that makes the call with words)."""
    studied = four_bar.copy()
    studied.add('quantity', name='top', of='P.y', take='max')
    return {
        'kinematics': lambda **words: four_bar.kinematics(intervals=300000, **words),
        'dynamics': lambda **words: mech9.read(SWING).dynamics(end=1800, intervals=1800, **words),
        'study': lambda **words: studied.study(**{'pair(2).point(1)': np.linspace(0.25, 0.35, 1500)}, **words),
    }


@pytest.mark.parametrize('what', ['kinematics', 'dynamics', 'study'])
def test_shares_grow_to_one(long_runs, what):
    shares, threads = [], set()

    def note(done):
        shares.append(done)
        threads.add(threading.get_ident())
    plain = long_runs[what]()
    told = long_runs[what](progress=note)
    assert shares[-1] == 1.0 and shares == sorted(shares)
    assert len(shares) > 3 and 0 < shares[1] < 1, shares
    assert len(threads) == 1
    for name in (plain.names if hasattr(plain, 'names') else plain.data_vars):
        assert np.array_equal(np.asarray(plain[name]), np.asarray(told[name]), equal_nan=True), name


class Stop(Exception):
    """Raised by a function for progress."""


@pytest.mark.parametrize('what', ['kinematics', 'dynamics', 'study'])
@pytest.mark.parametrize('reason', [Stop('enough'), KeyboardInterrupt(), SystemExit(3)])
@pytest.mark.parametrize('in_main_thread', [True, False])
def test_exception_stops_the_call(long_runs, what, reason, in_main_thread):
    def stop(done):
        raise reason
    caught = []

    def work():
        try:
            long_runs[what](progress=stop)
        except BaseException as one:
            caught.append(one)
    began = time.monotonic()
    if in_main_thread:
        work()
    else:
        thread = threading.Thread(target=work)
        thread.start()
        thread.join()
    assert caught == [reason]
    assert time.monotonic() - began < 2
    assert caught[0].results is not None and len(caught[0].results.table) >= 0


def test_short_calls_are_told_their_end(four_bar):
    shares = []
    r = four_bar.kinematics(progress=shares.append)
    assert shares == [1.0] and len(r.t) == 13
    with pytest.raises(Stop):
        four_bar.kinematics(progress=lambda done: (_ for _ in ()).throw(Stop()))


def test_failures_have_no_end(mech9, four_bar):
    shares = []
    with pytest.raises(mech9.SingularError):
        four_bar.with_(**{'pair(2).point(1)': 0.75}).kinematics(progress=shares.append)
    assert 1.0 not in shares


def test_wrong_functions(mech9, four_bar):
    with pytest.raises(mech9.UsageError, match='progress is a function'):
        four_bar.kinematics(progress=3)
    with pytest.raises(TypeError):
        four_bar.kinematics(progress=lambda: None)


def test_search(mech9):
    m = mech9.read(os.path.join(TREE, 'examples', 'straight_line', 'straight_line.nml'))
    shares = []
    best = m.optimize(starts=20, seed=1, progress=shares.append)
    assert shares[-1] == 1.0 and shares == sorted(shares)
    assert best.value == m.optimize(starts=20, seed=1).value
    with pytest.raises(Stop) as caught:
        m.optimize(starts=100000, progress=lambda done: (_ for _ in ()).throw(Stop()))
    assert caught.value.results is None or len(caught.value.results.table) >= 0


def test_threads_of_a_study(long_runs):
    """The function is called in one thread, however many make the runs."""
    threads = set()
    long_runs['study'](threads=2, progress=lambda done: threads.add(threading.get_ident()))
    assert len(threads) == 1


@pytest.mark.parametrize('what', ['assemblies', 'range'])
def test_answers_about_positions_are_interrupted(mech9, monkeypatch, what):
    """The search itself ends, and goes on nowhere."""
    from mech9 import _library
    monkeypatch.setattr(_library, 'MOST_SECONDS', 20.0)   # a build with checks takes longer between two questions
    m = mech9.read(os.path.join(TREE, 'examples', 'delta_robot', 'delta_robot.nml'))
    work = {'assemblies': lambda: m.assemblies(10**6), 'range': m.range}[what]
    timer = threading.Timer(0.1, _thread.interrupt_main)
    timer.start()
    with pytest.raises(KeyboardInterrupt) as caught:
        work()
    assert not _library._forgotten
    if what == 'assemblies':
        assert len(caught.value.results.table) >= 1 and caught.value.results.names[0] == 'q1'
    assert len(m.assemblies(5).table) >= 1
