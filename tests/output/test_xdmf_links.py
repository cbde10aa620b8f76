"""Poses of links in the HDF5 file, and the XDMF file that shows them, against what pairs and points must satisfy."""
import os
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from mech9_cases import POSITION, REFERENCE, run

try:
    import h5py
except ImportError:
    pytest.skip('h5py is not installed (Debian: python3-h5py): nothing is tested', allow_module_level=True)

CASES = (('mech9k', 'kinematics_fig1'), ('mech9k', 'kinematics_spatial_slider_crank'), ('mech9k', 'kinematics_bennett'),
         ('mech9d', 'dynamics_fivebar'))
TITLE = '<A & "B">'


def hdf5_of(program, name, folder):
    """Run a case with poses; the path of its HDF5 file, beside which its XDMF file stands."""
    path = folder / f'{name}.h5'
    done = run(program, os.path.join(REFERENCE, f'{name}.nml'), '--hdf5', path, '--table', 'run.dat',
               '--set', 'output.poses=.true.', '--set', f"mechanism.title='{TITLE}'", folder=folder)
    assert done.returncode == 0, f'{name} runs; stderr: {done.stderr}'
    return path


@pytest.mark.parametrize('program, why', CASES)
def test_poses(checks, build, tmp_path, program, why):
    """Rotations are rotations; both links of a pair that turns hold its point; points ride on their links."""
    path = hdf5_of(build.program(program), why, tmp_path)
    with h5py.File(path, 'r') as file:
        a, u, vertex = file['rotation'][:], file['origin'][:], file['vertex'][:]
        rows, links = a.shape[:2]
        # a rotation is a product of those of the pairs before it: some hundred units of round-off for the longest chain
        checks.near(np.einsum('tlij,tlkj->tlik', a, a), np.broadcast_to(np.eye(3), a.shape), 1e-13,
                    f'{why}: A A^T = 1')
        checks.near(np.linalg.det(a), 1.0, 1e-13, f'{why}: right-handed')
        checks.true(np.array_equal(a[:, 0], np.broadcast_to(np.eye(3), (rows, 3, 3))) and not u[:, 0].any(),
                    f'{why}: link 1 is the frame')
        kinds = file['coordinate_kind'].asstr()[:]
        for k, kind in enumerate(kinds):
            apart = vertex[:, 2 * k] - vertex[:, 2 * k + 1]
            if kind == 'revolute':
                checks.near(apart, 0.0, POSITION, f'{why}: pair {k + 1} holds its links together')
        for i in range(len(file['point']) if 'point' in file else 0):
            checks.near(vertex[:, 2 * len(kinds) + i], file['position'][:, i], POSITION,
                        f'{why}: point {i + 1} is a vertex')
        owner = file['shape/vertex_link'][:]
        checks.true(np.array_equal(owner[:2 * len(kinds)].reshape(-1, 2), file['structure/links'][:]),
                    f'{why}: the two vertices of a pair belong to its links')
        for link in range(1, links + 1):
            mine = vertex[:, owner == link]
            fixed = np.einsum('tji,tvj->tvi', a[:, link - 1], mine - u[:, link - 1][:, None])
            checks.near(fixed, fixed[:1], POSITION, f'{why}: vertices rest in link {link}')
        for line, link in zip(file['shape/line'][:], file['shape/line_link'][:]):
            checks.true(list(owner[line]) == [link, link], f'{why}: a line joins vertices of one link')


def read_item(folder, item):
    """The numbers that a DataItem refers to; their shape must be what it says."""
    name, data_set = item.text.split(':')
    with h5py.File(os.path.join(folder, name), 'r') as file:
        values = file[data_set][()]
    return values, tuple(int(word) for word in item.get('Dimensions').split()) == values.shape


@pytest.mark.parametrize('program, why', CASES)
def test_xdmf(checks, build, tmp_path, program, why):
    path = hdf5_of(build.program(program), why, tmp_path)
    with h5py.File(path, 'r') as file:
        rows = len(file['time'])
    root = ElementTree.parse(path.with_suffix('.xdmf')).getroot()
    checks.equal(root.tag, 'Xdmf', f'{why}: an XDMF document')
    collection = root.find('Domain/Grid')
    checks.equal(collection.get('GridType'), 'Collection', f'{why}: a grid for each')
    checks.equal(collection.get('CollectionType'), 'Temporal', f'{why}: time')
    checks.equal(collection.get('Name'), TITLE, f'{why}: the title')
    grids = collection.findall('Grid')
    checks.equal(len(grids), rows, f'{why}: a grid for each output')
    for row in sorted({0, rows // 2, rows - 1}):
        grid = grids[row]
        slab = grid.find('Geometry/DataItem')
        where, numbers = slab.findall('DataItem')
        values, fits = read_item(tmp_path, numbers)
        checks.true(fits, f'{why}: the sizes of the vertices')
        start, stride, count = np.array(where.text.split(), int).reshape(3, 3)
        checks.equal((list(start), list(stride)), ([row, 0, 0], [1, 1, 1]), f'{why}: the slab of output {row}')
        checks.equal(tuple(count), (1,) + values.shape[1:], f'{why}: its size')
        topology = grid.find('Topology')
        lines, fits = read_item(tmp_path, topology.find('DataItem'))
        checks.true(fits and int(topology.get('NumberOfElements')) == len(lines), f'{why}: the number of lines')
        checks.true(lines.min() >= 0 and lines.max() < values.shape[1], f'{why}: lines join vertices that there are')
        links, fits = read_item(tmp_path, grid.find('Attribute/DataItem'))
        checks.true(fits and len(links) == len(lines), f'{why}: each line has its link')
        with h5py.File(tmp_path / numbers.text.split(':')[0], 'r') as file:
            time = float(grid.find('Time').get('Value'))
            checks.near(time, file['time'][row], 1e-15, f'{why}: the time of output {row}')
