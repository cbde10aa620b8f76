"""The HDF5 file against the table of the same run, against the data file, and as its readers see it.

What stands in both must agree to the last bit: both are written from the same rows.
"""
import ctypes
import json
import os
import re
import resource
import signal
import subprocess

import numpy as np
import pytest

from mech9_cases import PATIENCE, REFERENCE, read_table, run, text_of

FIG1 = os.path.join(REFERENCE, 'kinematics_fig1.nml')
DYNAMIC_FIG1 = os.path.join(REFERENCE, 'dynamics_fig1.nml')
SLIDER = os.path.join(REFERENCE, 'kinematics_slider_crank.nml')
FIVE_BAR = os.path.join(REFERENCE, 'dynamics_fivebar.nml')
USAGE, DATA, SINGULAR, FILE = 2, 3, 6, 8

try:
    import h5py
except ImportError:
    pytest.skip('h5py is not installed (Debian: python3-h5py): nothing is tested', allow_module_level=True)


class Session:
    """Both programs, in a folder of their own."""

    def __init__(self, checks, folder, mech9k, mech9d):
        self.checks, self.folder, self.mech9k, self.mech9d = checks, folder, mech9k, mech9d

    def path(self, name):
        return os.path.join(self.folder, name)

    def both(self, program, data, *options):
        """Run with --table and --hdf5; gives the table and the path of the HDF5 file."""
        done = run(program, data, '--table', 'run.dat', '--hdf5', 'run.h5', *options, folder=self.folder)
        self.checks.equal(done.returncode, 0, f'{os.path.basename(data)} runs; stderr: {done.stderr}')
        return read_table(text_of(self.path('run.dat'))), self.path('run.h5')


@pytest.fixture
def session(checks, tmp_path, mech9k, mech9d):
    return Session(checks, os.fspath(tmp_path), mech9k, mech9d)


def text(data_set):
    return data_set.asstr()[()]


def is_scale(data_set):
    return h5py.h5ds.is_scale(data_set.id)


def same(checks, values, expected, why):
    checks.true(np.shape(values) == np.shape(expected) and np.array_equal(values, expected), why)


def check_rows(checks, table, file, why):
    """Every column of the table stands in the file, bit for bit."""
    used = {'t'}
    same(checks, file['time'][:], table['t'], f'{why}: time')
    derivatives = sum(name in file for name in ('q', 'dq', 'ddq'))
    for name in ('q', 'dq', 'ddq')[:derivatives]:
        for i, number in enumerate(file['coordinate'][:]):
            same(checks, file[name][:, i], table[f'{name}{number}'], f'{why}: {name}{number}')
            used.add(f'{name}{number}')
    if 'point' in file:
        for i, point in enumerate(text(file['point'])):
            for name, order in (('position', ''), ('velocity', 'v'), ('acceleration', 'a'))[:derivatives]:
                for k, axis in enumerate(text(file['axis'])):
                    column = f'{point}.{order}{axis}'
                    same(checks, file[name][:, i, k], table[column], f'{why}: {column}')
                    used.add(column)
    for column in set(table) - used:
        same(checks, file[column.replace('.', '_')][:], table[column], f'{why}: {column}')


def check_form(checks, file, why):
    """Each quantity has a name in words, a unit, and a scale for each dimension; all grow."""
    rows = file['time'].shape[0]
    checks.true(is_scale(file['time']), f'{why}: time is a dimension scale')
    for name, item in file.items():
        if not isinstance(item, h5py.Dataset):
            continue
        checks.true(isinstance(item.attrs.get('long_name'), str), f'{why}: {name} has a long_name')
        if not is_scale(item):
            checks.true(all(len(dim) == 1 for dim in item.dims), f'{why}: {name} has a scale on each dimension')
            for dim, size in zip(item.dims, item.shape):
                checks.equal(len(dim[0]), size, f'{why}: the scales of {name} have its sizes')
        if item.dtype.kind == 'f':
            checks.true(isinstance(item.attrs.get('units'), str), f'{why}: {name} has units')
            checks.true(item.maxshape[0] is None and item.shape[0] == rows, f'{why}: {name} grows with time')
            checks.true(item.chunks is not None, f'{why}: {name} is chunked')


def test_fig1(session, build):
    checks = session.checks
    table, path = session.both(session.mech9k, FIG1)
    with h5py.File(path, 'r') as file, open(FIG1, encoding='utf-8') as data:
        check_rows(checks, table, file, 'Fig. 1')
        check_form(checks, file, 'Fig. 1')
        checks.equal(file['q'].attrs['units'], 'rad', 'the unit of angles')
        checks.equal(file['ddq'].attrs['units'], 'rad/s^2', 'the unit of their accelerations')
        checks.equal(file['velocity'].attrs['units'], 'm/s', 'the unit of velocities')
        where = file['provenance']
        checks.equal(text(where['data']), data.read(), 'the data file stands in it as it is')
        checks.equal(text(where['program']), 'mech9k', 'the program')
        checks.equal(text(where['version']), build.version, 'its version')
        checks.equal(text(where['data_file']), FIG1, 'the name of the data file')
        checks.equal(text(where['command_line']), f'mech9k {FIG1} --table run.dat --hdf5 run.h5', 'the command line')
        for library in ('HDF5 1.', 'SUNDIALS ', 'LAPACK 3.'):
            checks.true(library in text(where['libraries']), f'the version of {library}', text(where['libraries']))
        checks.true('GCC' in text(where['compiler']), 'the compiler', text(where['compiler']))
        structure = file['structure']
        # the paper's own Fig. 1, nrw with its fifth number mended
        checks.equal(list(structure['nrg']), [1, 2, 3, 4, 1, 1, 6, 5, 3], 'nrg of the paper')
        checks.equal(list(structure['nws']), [0, 5, 4, 7, 6, 0, 1, 2, 3], 'nws of the paper')
        checks.equal(list(structure['rdw']), [1, 1, 0, 0, 0, 1, 0, 0, 0], 'rdw of the paper')
        checks.equal(list(structure['nrw']), [0, 0, 0, 0, 1, 1, 1, 1, 2], 'nrw of the paper')
        c = [[0, 5, 0, 6, 0, 1], [5, 0, 4, 0, 0, 0], [0, 4, 0, 7, 3, 0], [6, 0, 7, 0, 0, 0], [0, 0, 3, 0, 0, 2],
             [1, 0, 0, 0, 2, 0]]
        same(checks, structure['c'][:], np.array(c), 'the coincidence matrix of the paper')
        checks.equal(list(structure['independent']), [0, 0, 0, 0, 1, 0, 0], 'the independent coordinate')
        for k, links in enumerate(structure['links'][:]):
            checks.equal(c[links[0] - 1][links[1] - 1], k + 1, f'the links of pair {k + 1}')
        found = file['diagnostics']
        checks.equal(found['positions'][()], len(table['t']), 'the number of positions')
        checks.equal(found['largest_closure'][()], np.max(table['closure']), 'the largest closure')
        checks.equal(found['largest_closure'].attrs['units'], 'm', 'and its unit')
        checks.equal(found['exit_code'][()], 0, 'the exit code')


def test_units(session):
    """Coordinates of two kinds, angles in degrees."""
    checks = session.checks
    table, path = session.both(session.mech9k, SLIDER, '--set', "mechanism.angle_unit='deg'")
    with h5py.File(path, 'r') as file:
        check_rows(checks, table, file, 'slider-crank')
        check_form(checks, file, 'slider-crank')
        units, kinds = list(text(file['coordinate_unit'])), list(text(file['coordinate_kind']))
        checks.equal(units, ['m' if kind == 'prismatic' else 'deg' for kind in kinds], 'each coordinate has its unit')
        checks.true('prismatic' in kinds and 'revolute' in kinds, 'there are two kinds')
        checks.equal(set(file['q'].attrs['units'].split(' or ')), {'deg', 'm'}, 'the units of all of them')


@pytest.mark.parametrize('derivatives, absent', ((0, ('dq', 'velocity', 'ddq', 'acceleration')), (1, ('ddq', 'acceleration')), (2, ())))
@pytest.mark.parametrize('data, wanted, kinds, units', ((FIG1, '5,2', ['revolute', 'revolute'], ['rad', 'rad']),
                                                        (SLIDER, '4,2', ['revolute', 'prismatic'], ['deg', 'm'])), ids=('fig1', 'slider_crank'))
def test_parts(session, data, wanted, kinds, units, derivatives, absent):
    """Some coordinates, in whatever order they are given, and fewer derivatives."""
    checks = session.checks
    unit = ['--set', "mechanism.angle_unit='deg'"] if 'deg' in units else []
    whole, path = session.both(session.mech9k, data, *unit)
    why = f'coordinates {wanted}, {derivatives} derivatives'
    table, path = session.both(session.mech9k, data, *unit, '--set', f'output.coordinates={wanted}',
                               '--set', f'output.derivatives={derivatives}')
    with h5py.File(path, 'r') as file:
        check_rows(checks, table, file, why)
        check_form(checks, file, why)
        checks.equal(file['coordinate'][:].tolist(), sorted(int(k) for k in wanted.split(',')), f'{why}: which')
        checks.equal(list(text(file['coordinate_kind'])), kinds, f'{why}: their kinds')
        checks.equal(list(text(file['coordinate_unit'])), units, f'{why}: their units')
        checks.equal([name for name in absent if name in file], [], f'{why}: no others')
        for k in file['coordinate'][:]:
            # chains are closed to round-off, in either run
            checks.near(table[f'q{k}'], whole[f'q{k}'], 1e-12, f'{why}: q{k} is that of the whole run')


def scales_elsewhere(file):
    """Dimensions whose scale is missing, or stands neither in the group of its data set nor in one above it. By the rules
    of netCDF, which xarray and ncdump keep, such a dimension does not exist."""
    found = []

    def look(name, item):
        if not isinstance(item, h5py.Dataset) or is_scale(item):
            return
        for number, dim in enumerate(item.dims):
            scales = [scale.name for scale in dim.values()]
            if len(scales) != 1 or not item.name.startswith(scales[0][:scales[0].rindex('/') + 1]):
                found.append(f'{name}, dimension {number}: {scales}')

    file.visititems(look)
    return found


@pytest.mark.parametrize('program, data', (('mech9k', FIG1), ('mech9d', DYNAMIC_FIG1)), ids=('mech9k', 'mech9d'))
def test_scales(session, build, program, data):
    """Every data set of every group has its scales where readers of netCDF look for them."""
    checks, program = session.checks, build.program(program)
    path = session.both(program, data, '--set', 'output.poses=.true.')[1]
    with h5py.File(path, 'r') as file:
        checks.equal(scales_elsewhere(file), [], f'{os.path.basename(program)}: scales where netCDF looks for them')
        check_form(checks, file, f'{os.path.basename(program)} with poses')


def test_poses_of_all(session):
    """Poses are those of all links, whatever coordinates are recorded."""
    data = session.path('no_points.nml')
    with open(data, 'w', encoding='utf-8') as file:
        file.write(re.sub(r'&point[^/]*/', '', text_of(FIG1)))
    found = []
    for settings in [], ['--set', 'output.coordinates=6', '--set', 'output.derivatives=0']:
        path = session.both(session.mech9k, data, '--set', 'output.poses=.true.', *settings)[1]
        with h5py.File(path, 'r') as file:
            found.append((file['rotation'][:], file['origin'][:]))
    session.checks.true(np.all(np.ptp(found[0][0], axis=0).max(axis=(1, 2))[1:] > 0.1), 'all links but the frame turn')
    for whole, part in zip(*found):
        # chains are closed to round-off, in either run
        session.checks.near(part, whole, 1e-12, 'the poses of all links')


def test_dynamics(session):
    checks = session.checks
    table, path = session.both(session.mech9d, DYNAMIC_FIG1)
    with h5py.File(path, 'r') as file:
        check_rows(checks, table, file, 'Fig. 1 in motion')
        check_form(checks, file, 'Fig. 1 in motion')
        same(checks, file['E_kinetic'][:] + file['E_potential'][:], file['E_total'][:], 'the energies add up')
        a, dq = file['dynamics/coefficients'][:], file['dq'][0, file['dynamics/p'][:] - 1]
        # both sum some dozens of products of order ten
        checks.near(0.5 * dq @ a @ dq, file['E_kinetic'][0], 1e-13, 'the coefficients of motion give the kinetic energy')
        found, change = file['diagnostics'], file['E_total'][:] - file['E_total'][0]
        checks.equal(found['energy_at_start'][()], file['E_total'][0], 'the energy at the start')
        checks.equal(found['largest_energy_change'][()], np.max(np.abs(change)), 'its largest change')
        checks.true(np.max(np.abs(change)) > np.max(change), 'the damper takes more than is ever gained')
        checks.equal(file['coordinate_changes/time'].shape[0], 0, 'no change of coordinates')
        checks.true(file['diagnostics/steps'][()] > 0 and text(file['diagnostics/method']) != '', 'how it was integrated')


def test_events(session):
    """Changes of coordinates as the report has them, of a five-bar that whirls through singular positions."""
    checks = session.checks
    table, path = session.both(session.mech9d, FIVE_BAR, '--set', 'time.end=5', '--report', 'run.json')
    with open(session.path('run.json'), encoding='utf-8') as report:
        events = json.load(report)['coordinate_changes']
    sets = {tuple(event['independent']) for event in events}
    if not checks.true(len(sets) > 1, 'it changes to different coordinates', events):
        return
    with h5py.File(path, 'r') as file:
        check_rows(checks, table, file, 'a five-bar')
        checks.equal(file['coordinate_changes/time'][:].tolist(), [event['t'] for event in events], 'when coordinates changed')
        checks.equal(file['coordinate_changes/independent'][:].tolist(), [event['independent'] for event in events], 'and to which')
        checks.true(np.all(np.diff(file['coordinate_changes/time'][:]) >= 0), 'in their order')
        checks.true(not np.any(file['coordinate_changes/replaced'][:]), 'all coordinates are integrated themselves')


def test_replaced_angles(session):
    """Angles that others replace near gimbal lock: a top on a ball joint that comes near to it."""
    checks = session.checks
    with open(session.path('ball.nml'), 'w', encoding='utf-8') as file:
        file.write("&mechanism /\n&structure cq=1,2,3 /\n&gravity acceleration=0,0,-9.81 /\n&time end=2, intervals=200 /\n"
                   '&initial coordinate=1, position=0.4, velocity=3 /\n&initial coordinate=2, position=0.3, velocity=8 /\n'
                   '&initial coordinate=3, position=0.2, velocity=7 /\n'
                   '&body link=4, mass=1, centre=0,0,0.1, inertia=0.002,0.002,0.001,0,0,0 /\n')
        for k, axis in enumerate(('1,0,0', '0,1,0', '0,0,1'), 1):
            file.write(f"&pair coordinate={k}, links={k},{k + 1}, kind='revolute', axis={axis} /\n")
    table, path = session.both(session.mech9d, 'ball.nml', '--report', 'run.json')
    with open(session.path('run.json'), encoding='utf-8') as report:
        events = json.load(report)['coordinate_changes']
    checks.true(len(events) > 1 and events[0]['replaced'] == [1, 2, 3] and events[1]['replaced'] == [], 'forth and back', events)
    with h5py.File(path, 'r') as file:
        check_rows(checks, table, file, 'past gimbal lock')
        replaced = [[int(k in event['replaced']) for k in (1, 2, 3)] for event in events]
        checks.equal(file['coordinate_changes/replaced'][:].tolist(), replaced, 'which angles are replaced')


def test_dead_point(session):
    """The results up to a dead point are kept, and so is the exit code."""
    checks = session.checks
    data = os.path.join(REFERENCE, 'kinematics_fig1_driven_at_q1.nml')
    done = run(session.mech9k, data, '--table', 'run.dat', '--hdf5', 'run.h5', '--set', 'time.end=30', '--set',
               'time.intervals=3000', folder=session.folder)
    checks.equal(done.returncode, SINGULAR, f'it ends at a dead point; stderr: {done.stderr}')
    with open(session.path('run.dat'), encoding='utf-8') as text_of_table, h5py.File(session.path('run.h5'), 'r') as file:
        check_rows(checks, read_table(text_of_table.read()), file, 'up to a dead point')
        checks.equal(file['diagnostics/exit_code'][()], SINGULAR, 'the exit code')


def test_compression(session):
    checks = session.checks
    many = ('--set', 'time.intervals=20000')
    table, path = session.both(session.mech9k, FIG1, *many)
    plain = os.path.getsize(path)
    table, path = session.both(session.mech9k, FIG1, *many, '--set', 'output.compression=4')
    with h5py.File(path, 'r') as file:
        check_rows(checks, table, file, 'compressed')
        checks.equal(file['q'].compression_opts, 4, 'compressed as asked for')
    checks.true(os.path.getsize(path) < plain, 'a compressed file is smaller', f'{os.path.getsize(path)} of {plain}')


def test_xarray(session):
    """xarray reads what was written."""
    try:
        import xarray
        import h5netcdf  # noqa: F401
    except ImportError as missing:
        session.checks.left_out(f'{missing.name} is not installed (Debian: python3-xarray, python3-h5netcdf)')
        return
    checks = session.checks
    table, path = session.both(session.mech9k, FIG1)
    with xarray.open_dataset(path, engine='h5netcdf') as data:
        same(checks, data['q'].sel(coordinate=5).values, table['q5'], 'xarray: a coordinate by its number')
        same(checks, data['position'].sel(point='P', axis='y').values, table['P.y'], 'xarray: a point by its name')
        same(checks, data['q'].coords['time'].values, table['t'], 'xarray: time belongs to it')
        checks.equal(data['closure'].attrs['units'], 'm', 'xarray: units')
    table, path = session.both(session.mech9d, DYNAMIC_FIG1, '--set', 'output.poses=.true.')
    with xarray.open_dataset(path, engine='h5netcdf') as data:
        same(checks, data['q'].sel(coordinate=5).values, table['q5'], 'xarray: a file with poses')
        checks.equal(data['vertex'].dims, ('time', 'vertex_number', 'axis'), 'xarray: the dimensions of the vertices')
    with h5py.File(path, 'r') as file:
        groups = [name for name, item in file.items() if isinstance(item, h5py.Group)]
    for group in groups:
        with xarray.open_dataset(path, engine='h5netcdf', group=group) as data:
            checks.true(len(data.variables) > 0, f'xarray: the group {group}')


def test_h5dump(session):
    """h5dump reads what was written."""
    checks = session.checks
    if not checks.has('h5dump', 'hdf5-tools'):
        return
    table, path = session.both(session.mech9d, DYNAMIC_FIG1, '--set', 'output.poses=.true.')
    done = run('h5dump', '-d', '/time', '-y', '-w', '0', '-m', '%.17g', path)
    numbers = [float(word) for word in done.stdout.split('DATA {')[1].split('}')[0].replace(',', ' ').split()]
    same(checks, numbers, table['t'], 'h5dump: time')
    done = run('h5dump', '-H', path)
    checks.equal(done.returncode, 0, 'h5dump: all of it')


def without_privileges():
    """Let permissions bind root, too, in the program that is started next."""
    drop_from_bounding_set, override, read_search = 24, 1, 2
    if os.geteuid() == 0:
        for capability in (override, read_search):
            if ctypes.CDLL(None).prctl(drop_from_bounding_set, capability, 0, 0, 0) != 0:
                raise OSError('the privilege of root to write everywhere cannot be given up')


def test_failures(session):
    """Failures are told in one line with the path and the reason, and end with the code for files."""
    checks = session.checks

    def fails(why, code, path, *words, options=(), before=None):
        command = [session.mech9k, FIG1, '--hdf5', path, '--quiet', '--set', "output.table=''", *options]
        done = subprocess.run(command, cwd=session.folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              timeout=120 * PATIENCE, preexec_fn=before)
        checks.equal(done.returncode, code, f'{why}: exit code; stderr: {done.stderr}')
        for word in words:
            checks.true(word in done.stderr, f'{why}: says {word}', done.stderr)
        checks.true('HDF5-DIAG' not in done.stderr and 'acktrace' not in done.stderr, f'{why}: nothing else', done.stderr)
        checks.equal(len(done.stderr.strip().splitlines()), 1, f'{why}: in one line: {done.stderr}')

    fails('a folder', FILE, session.folder, session.folder, 'directory')
    fails('no such folder', FILE, 'nowhere/x.h5', 'nowhere/x.h5', 'No such file or directory')
    fails('no name', FILE, '-', "'-'")
    if checks.has_full_disk():
        fails('a full disk', FILE, '/dev/full', '/dev/full', 'No space left')
    os.mkdir(session.path('closed'), 0o500)
    fails('no permission', FILE, 'closed/x.h5', 'closed/x.h5', 'Permission denied', before=without_privileges)

    def small_files():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (400000, 400000))

    fails('a disk that fills up on the way', FILE, 'x.h5', 'x.h5', 'File too large',
          options=('--set', 'time.intervals=100000'), before=small_files)
    fails('table and HDF5 in one file', USAGE, 'x', 'cannot both', options=('--table', 'x'))
    fails('nothing written', USAGE, 'x.h5', 'contradicts', options=('--no-write',))
    done = run(session.mech9k, FIG1, '--hdf5', 'x.h5', '--set', 'output.compression=10', folder=session.folder)
    checks.true(done.returncode == DATA and '0 (none) to 9' in done.stderr, 'more compression than there is', done.stderr)


def test_data_file_names_it(session):
    checks = session.checks
    done = run(session.mech9k, FIG1, '--set', "output.hdf5='named.h5'", '--set', "output.table=''", folder=session.folder)
    checks.true(done.returncode == 0 and os.path.exists(session.path('named.h5')), '&output hdf5= names the file', done.stderr)
    checks.equal(done.stdout, '', 'with a file of results, none go to standard output')
    checks.true('named.h5' in done.stderr, 'the file is told', done.stderr)
