"""Mechanisms in Python: read, built, changed, copied, written, and wrong ones told."""
import copy
import gc
import os
import pickle

import numpy as np
import pytest

from mech9_cases import TREE, text_of

FOUR_BAR = os.path.join(TREE, 'examples', 'library', 'four_bar.nml')


def built(mech9):
    """The four-bar of the library's examples from nothing."""
    m = mech9.Mechanism(title='Four-bar')
    m.add('structure', cq=1)
    m.add('pair', coordinate=1, links=(1, 2), kind='revolute', axis=(0, 0, 1))
    m.add('pair', coordinate=2, links=(2, 3), kind='revolute', axis=(0, 0, 1), point=(0.3, 0, 0), moving_point=(0, 0, 0))
    m.add('pair', coordinate=3, links=(3, 4), kind='revolute', axis=(0, 0, 1), point=(0.8, 0, 0), moving_point=(0, 0, 0))
    m.add('pair', coordinate=4, links=(1, 4), kind='revolute', axis=(0, 0, 1), point=(0.9, 0, 0), moving_point=(0.7, 0, 0))
    m.add('initial', coordinate=2, position=0.5).add('initial', coordinate=3, position=-2)
    m.add('point', name='P', link=3, position=[0.4, 0.2, 0])
    m.add('drive', coordinate=1, kind='polynomial', coefficients=[0.6, 5])
    m.add('time', start=0, end=1.2, intervals=12)
    return m


def test_version(build, mech9):
    assert mech9.__version__ == build.version


def test_from_nothing(mech9, four_bar):
    assert (built(mech9).kinematics().table == four_bar.kinematics().table).all()


def test_words_of_a_new_mechanism(mech9):
    """A crank of 300 mm at 30 degrees: its end is 150 mm up."""
    m = mech9.Mechanism(title='Crank', length_unit='mm', angle_unit='deg').add('structure', cq=1)
    m.add('pair', coordinate=1, links=(1, 2), kind='revolute', axis=(0, 0, 1)).add('drive', coordinate=1, kind='polynomial', coefficients=30)
    r = m.add('point', name='P', link=2, position=(300, 0, 0)).kinematics(end=1, intervals=1)
    assert abs(r['P.y'][0] - 150) < 1e-12 and r.units['P.y'] == 'mm' and "title = 'Crank'" in m.text()
    assert "angle_unit = 'deg'" in mech9.Mechanism(angle_unit='deg').text()
    with pytest.raises(mech9.DataError):
        mech9.Mechanism(length_unit='km').check()


def test_text_makes_the_same_mechanism(mech9, four_bar):
    four_bar['pair(2).point(1)'] = 0.1 + 0.2   # a number that needs all its digits
    again = mech9.read_text(four_bar.text())
    assert again['pair(2).point(1)'] == 0.1 + 0.2
    assert (again.kinematics().table == four_bar.kinematics().table).all()
    assert pickle.loads(pickle.dumps(four_bar)).text() == four_bar.text()


@pytest.mark.parametrize('sent', (lambda one: pickle.loads(pickle.dumps(one)), copy.deepcopy), ids=('pickled', 'copied'))
def test_answers_that_another_process_gets_hold_their_numbers(mech9, four_bar, sent):
    """They share no memory with the library: those that they come from may go."""
    run, q = four_bar.kinematics(), four_bar.positions(np.linspace(0, 1, 4))
    table, report, P = run.table.copy(), run.report, run['P.y'].copy()
    got, positions = sent(run), sent(q)
    f = sent(four_bar.add('quantity', name='top', of='P.y', take='max').function(['pair(2).point(1)'], ['top']))
    del run
    gc.collect()
    again = sent(got)
    del got
    gc.collect()
    assert (again.table == table).all() and (again['P.y'] == P).all() and again.report == report
    assert (positions == q).all() and (positions.code == q.code).all()
    assert f([0.3])[0] == four_bar.kinematics().quantities['top']
    with pytest.raises(mech9.UsageError, match='write them there'):
        again.write('none.h5')


def test_the_value_of_a_parameter_without_one_is_its_number(mech9, four_bar):
    four_bar.add('parameter', name='crank', sets='pair(2).point(1)', low=0.2, high=0.4)
    four_bar.add('parameter', name='twice', sets='pair(3).point(1)', low=0.7, high=0.9)
    assert four_bar['crank'] == 0.3 and four_bar["parameter('twice').value"] == 0.8 and four_bar['parameter(2).value'] == 0.8
    four_bar.add('quantity', name='top', of='P.y', take='max')
    runs = four_bar.study(crank=[0.25, 0.3])
    assert (np.asarray(runs['twice']) == 0.8).all()
    with pytest.raises(mech9.DataError, match='write it first'):
        four_bar['parameter(1).count']


def test_copies_are_independent(mech9, four_bar):
    other = four_bar.with_(**{'pair(2).point(1)': 0.25})
    for same in four_bar.copy(), copy.copy(four_bar), copy.deepcopy(four_bar):
        same['pair(2).point(1)'] = 0.2
    assert (four_bar['pair(2).point(1)'], other['pair(2).point(1)']) == (0.3, 0.25)


def test_numbers_and_other_values(mech9, four_bar):
    four_bar['time.intervals'] = 7
    four_bar['output.coordinates'] = [1, 3]
    four_bar['output.reactions'] = True
    four_bar['mechanism.title'] = "The 'best' four-bar"
    run = four_bar.kinematics()
    assert len(run.t) == 8 and 'q2' not in run and 'R3.fx' in run
    assert "The ''best'' four-bar" in four_bar.text()


def test_words_of_a_run_do_not_stay(mech9, four_bar):
    assert len(four_bar.kinematics(end=0.5, intervals=3).t) == 4
    assert len(four_bar.kinematics().t) == 13
    with pytest.raises(mech9.UsageError, match="no word 'inervals'"):
        four_bar.kinematics(inervals=3)


def test_parameters(mech9, four_bar):
    four_bar.add('parameter', name='crank', value=0.3, sets='pair(2).point(1)')
    assert four_bar.parameters == ('crank',) and four_bar['crank'] == 0.3
    changed = four_bar.with_(crank=0.28)
    assert changed['crank'] == 0.28 and four_bar['crank'] == 0.3
    assert (changed.kinematics()['q2'] != four_bar.kinematics()['q2']).any()
    with pytest.raises(mech9.DataError, match='no parameter'):
        four_bar.with_(cranck=0.28)
    with pytest.raises(KeyError):
        four_bar['rocker']


def test_parameters_win(mech9, four_bar):
    """A parameter sets its number, whichever of both comes first, and nothing else does."""
    m = built(mech9).add('parameter', name='crank', value=0.25, sets='pair(2).point(1)')
    with pytest.raises(mech9.UsageError, match="parameter 'crank' sets"):
        m['pair(2).point(1)'] = 0.3
    with pytest.raises(mech9.UsageError, match="parameter 'crank' sets"):
        m['pair(2).point'] = (0.3, 0, 0)
    first = mech9.Mechanism().add('parameter', name='crank', value=0.25, sets='pair(2).point(1)')
    for group in m.copy().remove('parameter').text().split('&')[1:]:
        call_group(first, group)
    assert (first.kinematics().table == m.kinematics().table).all()
    assert (mech9.read_text(m.text()).kinematics().table == m.kinematics().table).all()


def call_group(mechanism, text):
    """Add a group that is written as text() writes it."""
    name, *lines = text.strip().rstrip('/').strip().split('\n')
    words = {}
    for line in lines:
        word, value = line.split('=', 1)
        values = [one.strip() for one in value.split(',')]
        read = [one.strip("'") if one.startswith("'") else float(one) if '.' in one or 'e' in one else int(one) for one in values]
        words[word.strip()] = read[0] if len(read) == 1 else read
    mechanism.add(name, **words)


def test_messages_of_added_groups(mech9):
    with pytest.raises(mech9.DataError) as caught:
        built(mech9)['pair(2).point(1)'] = 'x'
    assert len(caught.value.findings) == 1 and "'x'" in str(caught.value) and '--set adds' not in str(caught.value)
    with pytest.raises(mech9.DataError, match='no finite number'):
        built(mech9)['pair(2).point(1)'] = float('nan')
    with pytest.raises(mech9.DataError) as caught:
        built(mech9)['structure.cq'] = 1.5
    assert '1.5' in str(caught.value)


def test_missing_groups_come(mech9, four_bar):
    four_bar['solver.relative_tolerance'] = 1e-9
    assert four_bar['solver.relative_tolerance'] == 1e-9


@pytest.mark.parametrize('name', ['pair(9).point(1)', 'pair(2).pont(1)', 'pair(2).point(4)', 'nothing.at_all', '', '.', 'pair(2).'])
def test_unknown_numbers(mech9, four_bar, name):
    with pytest.raises(mech9.DataError) as caught:
        four_bar[name]
    assert caught.value.code == 3 and isinstance(caught.value, KeyError)
    with pytest.raises(mech9.DataError):
        four_bar[name] = 1.0
    assert four_bar.text() == mech9.read(FOUR_BAR).text()


@pytest.mark.parametrize('value', [float('nan'), float('inf'), object(), None, [], {}])
def test_values_that_are_none(mech9, four_bar, value):
    with pytest.raises((mech9.UsageError, mech9.DataError)):
        four_bar['pair(2).point'] = value
    with pytest.raises((mech9.UsageError, mech9.DataError)):
        four_bar.add('point', name='Q', link=3, position=value)


def test_places_of_errors(mech9, tmp_path):
    path = tmp_path / 'wrong.nml'
    path.write_text("&structure cq=1 /\n&pair coordinate=1, linkz=1,2, kind='revolute' /\n")
    with pytest.raises(mech9.DataError) as caught:
        mech9.read(path)
    failure = caught.value
    assert failure.code == 3 and len(failure.findings) == 2
    assert (failure.file, failure.line, failure.column) == (str(path), 2, 1)
    assert "did you mean 'links'?" in failure.findings[1].message and failure.findings[1].column == 21
    assert f"{path}:2:21: unknown name 'linkz' in &pair" in str(failure)


def test_added_groups_have_no_line(mech9, four_bar):
    before = four_bar.text()
    with pytest.raises(mech9.DataError) as caught:
        four_bar.add('point', name='Q', linkk=3)
    assert caught.value.line is None and caught.value.file is None
    assert four_bar.text() == before


def test_structure_is_judged_later(mech9, four_bar):
    four_bar['pair(4).point(1)'] = 9.0
    with pytest.raises(mech9.AssemblyError, match='cannot be assembled') as caught:
        four_bar.kinematics()
    assert caught.value.code == 5 and caught.value.file == FOUR_BAR and caught.value.line > 1


@pytest.mark.parametrize('path, code', [('missing.nml', 8), ('.', 8)])
def test_files_that_cannot_be_read(mech9, tmp_path, path, code):
    with pytest.raises(mech9.FileError) as caught:
        mech9.read(tmp_path / path)
    assert caught.value.code == code


def test_check(mech9, four_bar):
    check = four_bar.check()
    assert (check.mobility, check.redundant) == (1, 0)
    assert 'mobility by the rank: 1' in check.text and 'assembled at the start' in str(check)


def test_empty_mechanism(mech9):
    with pytest.raises(mech9.Error) as caught:
        mech9.Mechanism().check()
    assert caught.value.code in (3, 4)


def test_memory_stays(mech9):
    import resource
    for _ in range(200):
        mech9.read(FOUR_BAR).kinematics(intervals=50)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(1000):
        m = mech9.read(FOUR_BAR)
        m.with_(**{'pair(2).point(1)': 0.25}).kinematics(intervals=50)
        with pytest.raises(mech9.Error):
            m['nothing(1).x']
    # a run has 10 kB; 1000 of them that stayed would be ten times as much
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 1000
