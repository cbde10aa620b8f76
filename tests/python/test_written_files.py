"""HDF5 files of runs that the package writes: the same as those of the programs, whose content other tests judge."""
import os
import stat
import subprocess
import sys

import numpy as np
import pytest

from mech9_cases import REFERENCE, TREE, run

h5py = pytest.importorskip('h5py', reason='h5py is not installed (Debian: python3-h5py)')
EXAMPLES = os.path.join(TREE, 'examples')
# Facts about the making of a file, which differ where another program makes it: also the time that it took, and the text of the data
# file, which the library writes anew.
OF_THE_MAKER = {'provenance/program', 'provenance/libraries', 'provenance/created', 'provenance/command_line', 'provenance/data',
                'provenance/data_file', 'diagnostics/seconds_solving', 'diagnostics/seconds_writing'}
FOUR_BAR = '''
&mechanism title='Vérin à quatre barres', links=4 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0.8,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', axis=0,0,1, point=0.9,0,0, moving_point=0.7,0,0 /
&initial coordinate=1, position=0.6 /
&initial coordinate=2, position=0.5 /
&initial coordinate=3, position=-2 /
&point name='P', link=3, position=0.4,0.1,0 /
&body link=3, mass=2, centre=0.4,0,0, inertia=0,0.1,0.1,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&parameter name='crank', value=0.3, sets='pair(2).point(1)' /
&quantity name='top', of='P.y', take='max' /
&time end=0.5, intervals=20 /
'''
DRIVE = "&drive coordinate=1, kind='polynomial', coefficients=0.6,2 /"


def gallery():
    """(program, data file) of the examples without user procedures."""
    with open(os.path.join(EXAMPLES, 'list.txt'), encoding='utf-8') as file:
        for line in file:
            if not line.startswith('#') and line.strip():
                name, program, data, procedures = [field.strip() for field in line.split('|')][:4]
                if not procedures:
                    yield pytest.param(program, os.path.join(EXAMPLES, name, data), (), id=name)


SPECIAL = [
    pytest.param('mech9d', os.path.join(REFERENCE, 'dynamics_fivebar.nml'), (), id='events'),
    pytest.param('mech9k', os.path.join(EXAMPLES, 'fig1', 'fig1.nml'), ('reactions=.true.', 'poses=.true.', 'conditioning=.true.'),
                 id='reactions and poses'),
    pytest.param('mech9k', os.path.join(EXAMPLES, 'fig1', 'fig1.nml'), ('compression=4', 'coordinates=2,3', 'derivatives=0'),
                 id='compressed'),
]


def objects(file):
    """All groups and data sets by their paths."""
    found = {'/': file}
    file.visititems(found.__setitem__)
    return found


def form(file, one):
    """Everything about a group or a data set but its values."""
    told = {name: value for name, value in one.attrs.items() if name not in ('DIMENSION_LIST', 'REFERENCE_LIST') and name != 'source'}
    if 'DIMENSION_LIST' in one.attrs:
        told['scales'] = [[file[reference].name for reference in dimension] for dimension in one.attrs['DIMENSION_LIST']]
    if 'REFERENCE_LIST' in one.attrs:
        told['scaled'] = sorted((file[reference].name, int(number)) for reference, number in one.attrs['REFERENCE_LIST'])
    if isinstance(one, h5py.Dataset):
        told['data set'] = (one.dtype.str, h5py.check_string_dtype(one.dtype), one.shape, one.maxshape, one.chunks, one.compression_opts,
                            one.shuffle)
    return repr(told)


def compare(program, library):
    """The files of a program and of the library."""
    with h5py.File(program) as theirs, h5py.File(library) as ours:
        theirs_found, ours_found = objects(theirs), objects(ours)
        assert set(theirs_found) == set(ours_found)
        assert len(ours_found) > 30
        for path, one in theirs_found.items():
            other = ours_found[path]
            assert form(theirs, one) == form(ours, other), path
            if isinstance(one, h5py.Dataset) and path not in OF_THE_MAKER:
                assert np.array_equal(one[()], other[()], equal_nan=one.dtype.kind == 'f'), path


@pytest.mark.parametrize('program, data, output', [*gallery(), *SPECIAL])
def test_files_are_those_of_the_programs(build, mech9, monkeypatch, tmp_path, program, data, output):
    monkeypatch.chdir(os.path.dirname(data))
    settings = ['--set', 'time.intervals=40'] if output == () else []
    for setting in output:
        settings += ['--set', 'output.' + setting]
    done = run(build.program(program), data, '--quiet', '--table', str(tmp_path / 'program.dat'), '--hdf5', str(tmp_path / 'program.h5'),
               *settings)
    assert done.returncode == 0, done.stderr
    m = mech9.read(data)
    for setting in settings[1::2]:
        apply(m, setting)
    results = m.kinematics() if program == 'mech9k' else m.dynamics()
    results.write(tmp_path / 'library.h5')
    compare(tmp_path / 'program.h5', tmp_path / 'library.h5')


def apply(m, setting):
    """Apply a setting of --set."""
    name, value = setting.split('=')
    m[name] = {'.true.': True}.get(value, [int(one) for one in value.split(',')] if ',' in value else value if '.' in value else int(value))


@pytest.fixture(name='case')
def four_bar_in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'a.nml').write_text(FOUR_BAR + DRIVE)
    return tmp_path


@pytest.mark.parametrize('program', ['mech9k', 'mech9d'])
@pytest.mark.parametrize('output', ['gradients', 'sensitivities', 'reactions', 'drive_forces'])
def test_names_with_accents_and_derivatives(build, mech9, case, program, output):
    """A title beyond ASCII, quantities, their gradients, columns of derivatives; drives that move everything in both programs."""
    done = run(build.program(program), 'a.nml', '--quiet', '--hdf5', 'program.h5', '--set', f'output.{output}=.true.')
    assert done.returncode == 0, done.stderr
    m = mech9.read('a.nml')
    getattr(m, 'kinematics' if program == 'mech9k' else 'dynamics')(**{output: True}).write('größe.h5')
    compare('program.h5', 'größe.h5')
    with h5py.File('größe.h5') as file:
        assert file.attrs['title'] == 'Vérin à quatre barres'
        assert file['provenance/data_file'].asstr()[()] == 'a.nml'
        assert mech9.read_text(file['provenance/data'].asstr()[()]).kinematics()['q3'][-1] == m.kinematics()['q3'][-1]


def test_run_that_stopped(build, mech9, case):
    """The rows before a failure are written, with its exit code, as the program leaves them."""
    # least and greatest length, 0.7 and 0.9 m, are together longer than the others: no link goes round (Grashof)
    done = run(build.program('mech9k'), 'a.nml', '--quiet', '--hdf5', 'program.h5', '--set', 'parameter.value=0.75',
               '--set', 'time.end=5')
    assert done.returncode == 6, done.stderr
    m = mech9.read('a.nml')
    m['crank'] = 0.75
    with pytest.raises(mech9.SingularError) as caught:
        m.kinematics(end=5)
    results = caught.value.results
    assert 1 < len(results.t) < 21
    results.write('library.h5')
    compare('program.h5', 'library.h5')
    with h5py.File('library.h5') as file:
        assert file['diagnostics/exit_code'][()] == 6


def test_many_rows(mech9, case):
    """Rows beyond those that are written together."""
    results = mech9.read('a.nml').kinematics(intervals=300000)
    results.write('long.h5')
    with h5py.File('long.h5') as file:
        assert file['q'].shape == (300001, 4)
        assert np.array_equal(file['q'][:, 2], results['q3']) and np.array_equal(file['time'][:], results.t)


def test_a_file_is_replaced_when_the_new_one_is_whole(mech9, case, monkeypatch):
    results = mech9.read('a.nml').kinematics()
    (case / 'run.h5').write_text('older')
    (case / 'run.h5').chmod(0o640)
    os.symlink('run.h5', 'link.h5')
    results.write('link.h5')
    assert os.path.islink('link.h5') and h5py.is_hdf5('run.h5')
    assert stat.S_IMODE(os.stat('run.h5').st_mode) == 0o640
    assert not os.path.exists('.run.h5.part')
    before = (case / 'run.h5').read_bytes()
    monkeypatch.setattr(h5py.Dataset, 'make_scale', lambda self, name: (_ for _ in ()).throw(OSError('no space left')))
    with pytest.raises(mech9.FileError, match="cannot write to 'run.h5': no space left"):
        results.write('run.h5')
    assert (case / 'run.h5').read_bytes() == before and not os.path.exists('.run.h5.part')


def test_refused_names(mech9, case):
    (case / 'law.dat').write_text('0 0.6\n1 2.6\n2 3\n3 3.5\n')
    text = FOUR_BAR + "&drive coordinate=1, kind='table', file='law.dat' /"
    (case / 'b.nml').write_text(text)
    results = mech9.read('b.nml').kinematics(end=0.2)
    for name, reason in (('b.nml', "'b.nml' would overwrite 'b.nml', which is read"), ('./law.dat', 'would overwrite')):
        with pytest.raises(mech9.UsageError, match=reason):
            results.write(name)
    assert (case / 'b.nml').read_text() == text
    for name in ('', '-', 'a\0b'):
        with pytest.raises(mech9.FileError, match='is not the name of a file'):
            results.write(name)
    with pytest.raises(mech9.FileError, match="cannot write to 'missing/run.h5': No such file or directory$"):
        results.write('missing/run.h5')
    os.mkdir('folder')
    with pytest.raises(mech9.FileError, match="cannot open 'folder' for writing"):
        results.write('folder')
    with h5py.File('open.h5', 'w'):
        with pytest.raises(mech9.FileError, match="cannot open 'open.h5' for writing"):
            results.write('open.h5')
    if os.geteuid():
        (case / 'fixed.h5').touch(0o444)
        with pytest.raises(mech9.FileError, match="cannot open 'fixed.h5' for writing"):
            results.write('fixed.h5')
    with pytest.raises(mech9.UsageError, match='only the results of kinematics and dynamics can be written'):
        mech9.read('b.nml').assemblies(1).write('run.h5')


def test_h5py_is_needed_only_for_files(build, case):
    code = f'''
import sys
sys.path.insert(0, {os.path.join(TREE, 'python')!r})
import mech9
r = mech9.read('a.nml').kinematics()
assert 'h5py' not in sys.modules
sys.modules['h5py'] = None
try:
    r.write('run.h5')
except ImportError:
    print('told')
'''
    library = os.path.join(build.folder, 'lib', 'libmech9.so.0')
    done = subprocess.run([sys.executable, '-c', code], env={**os.environ, 'MECH9_LIBRARY': library}, capture_output=True, text=True)
    assert done.stdout == 'told\n', done.stderr
