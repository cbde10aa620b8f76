"""Classes of what the motions of a study go to: basins of attraction, against motions and states that are compared in numpy."""
import h5py
import numpy as np
import pytest

from mech9_cases import read_table, run

# two wells: a spring of length 1 m whose foot is 0.8 m beside a slide
WELLS = """&mechanism length_unit='mm' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&initial coordinate=1, position=600, velocity=0 /
&body link=2, mass=1 /
&load kind='spring', links=2,1, second_position=800,0,0, stiffness=0.1, free_length=1000 /
&load kind='coordinate', coordinate=1, damping=0.001 /
&time end=40, intervals=1 /
&parameter name='y', sets='initial.position', low=-900, high=900, count=5 /
&parameter name='v', sets='initial.velocity', low=-5000, high=5000, count=6 /
&study kind='grid', classes=.true. /
"""
PENDULUM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0, velocity=0 /
&body link=2, mass=1, centre=0,-1,0 /
&gravity acceleration=0,-1,0 /
&load kind='coordinate', coordinate=1, damping=0.5 /
&load kind='coordinate', coordinate=1, force=1.073, law='harmonic', amplitude=1, angular_frequency=0.6666666666666666, phase=1.5707963267948966 /
&section period=9.42477796076938, transient=565.4, table='points.dat' /
&time end=659.7344572538566, intervals=1 /
&parameter name='rate', sets='initial.velocity', low=-2, high=2, count=8 /
&study kind='grid', classes=.true. /
"""


@pytest.fixture(autouse=True)
def in_folder(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)


def study(program, folder, text, *words, code=0):
    """Standard error of a study that ends with a code."""
    path = folder / 'ends.nml'
    path.write_text(text, encoding='utf-8')
    done = run(program, path, '--study', '--table', folder / 'study.dat', *words)
    assert done.returncode == code, done.stderr
    return done.stderr


def table(path):
    return read_table(path.read_text())


def well_of(y, v):
    """1 or -1: the well in which the slide comes to rest, by the method of Runge and Kutta."""
    def rates(state):
        length = np.hypot(0.8, state[0])
        return np.array([state[1], -100*state[0]*(length - 1)/length - state[1]])

    state, h = np.array([y, v]), 0.005
    for _ in range(4000):
        a = rates(state)
        b = rates(state + h/2*a)
        c = rates(state + h/2*b)
        d = rates(state + h*c)
        state = state + h/6*(a + 2*b + 2*c + d)
    return int(np.sign(state[0]))


def test_wells(checks, mech9d, tmp_path):
    """A slide comes to rest in one of two wells: its class. Numbers follow the order of the runs."""
    said = study(mech9d, tmp_path, WELLS, '--hdf5', 'study.h5', '--plot', 'basins.svg:y:v:class')
    rows = table(tmp_path / 'study.dat')
    wells = [well_of(y/1000, v/1000) for y, v in zip(rows['y'], rows['v'])]
    checks.true({1, -1} == set(wells), 'both wells are met', wells)
    number = {wells[0]: 1.0, -wells[0]: 2.0}
    checks.equal(list(rows['class']), [number[well] for well in wells], 'the classes')
    checks.true('class: 1 to 2' in said, 'what is told', said)
    checks.true((tmp_path / 'basins.svg').stat().st_size > 0, 'a picture')
    with h5py.File('study.h5', 'r') as file:
        checks.equal(list(file['quantities/class'][()]), list(rows['class']), 'the classes in the HDF5 file')
    study(mech9d, tmp_path, WELLS, '--threads', '2')
    checks.equal(list(table(tmp_path / 'study.dat')['class']), list(rows['class']), 'the same by two threads')


def test_cycles(checks, mech9d, tmp_path):
    """Periodic motions are one class where their points are the same in any order, in turns that do not count."""
    study(mech9d, tmp_path, PENDULUM)
    rows, points = table(tmp_path / 'study.dat'), table(tmp_path / 'points.dat')
    ends = []
    for number in rows['run']:
        of_run = points['run'] == number
        # two last points on the circle of the angle, with the rate
        q, dq = points['q1'][of_run][-2:], points['dq1'][of_run][-2:]
        ends.append(np.column_stack([np.cos(q), np.sin(q), dq]))
    known, expected = [], []
    for end in ends:
        for k, other in enumerate(known):
            if min(np.abs(end - other).max(), np.abs(end - other[::-1]).max()) < 0.02:
                expected.append(k + 1.0)
                break
        else:
            known.append(end)
            expected.append(float(len(known)))
    checks.true(np.abs(ends[0][0] - ends[0][1]).max() > 0.02, 'the motions have two periods', ends[0])
    checks.true(1 < len(known) < len(ends), 'there are several classes, and several runs in one', expected)
    checks.equal(list(rows['class']), expected, 'the classes')


def test_motions_without_a_class(checks, mech9d, tmp_path):
    """A motion that neither rests nor repeats has the class 0, and a run that fails has none."""
    text = WELLS.replace('damping=0.001', 'damping=0').replace('count=6', 'count=2')
    study(mech9d, tmp_path, text)
    checks.equal(set(table(tmp_path / 'study.dat')['class']), {0.0}, 'motions without losses go on')
    text = WELLS.replace('count=5', 'count=2').replace('count=6', 'count=2') + "&stop coordinate=1, low=-800 /\n"
    study(mech9d, tmp_path, text)
    rows = table(tmp_path / 'study.dat')
    checks.equal([code > 0 for code in rows['exit_code']], [True, True, False, False], 'starts behind the stop fail')
    checks.equal([bool(np.isnan(number)) for number in rows['class']], [True, True, False, False], 'and have no class')


@pytest.mark.parametrize('words, changes, code, said', (
    (('--part', '1/2'), {}, 2, 'numbers them in all its runs'),
    (('--continue', 'study.h5'), {}, 2, 'numbers them in all its runs'),
    ((), {"name='y'": "name='class'"}, 3, "a column 'class' already"),
), ids=('part', 'continued', 'name'))
def test_bad_requests(checks, mech9d, tmp_path, words, changes, code, said):
    text = WELLS
    for old, new in changes.items():
        text = text.replace(old, new)
    found = study(mech9d, tmp_path, text, *words, code=code)
    checks.true(said in found, said, found)
