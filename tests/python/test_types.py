"""The package has types that mypy accepts, and users' code is checked against them."""
import os

import pytest

from mech9_cases import TREE

@pytest.fixture(name='api')
def mypy_that_knows_numpy():
    pytest.importorskip('mypy', reason='mypy is not installed (pip install mypy)')
    from mypy import api, version
    if tuple(int(part) for part in version.__version__.split('.')[:2]) < (1, 8):
        pytest.skip(f'mypy {version.__version__} does not know the types of NumPy; 1.8 does')
    return api


def test_package(api, monkeypatch, tmp_path):
    monkeypatch.chdir(os.path.join(TREE, 'python'))
    told, errors, code = api.run(['--cache-dir', str(tmp_path), 'mech9'])
    assert code == 0, told + errors


def test_use(api, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv('MYPYPATH', os.path.join(TREE, 'python'))
    (tmp_path / 'use.py').write_text('''
import mech9
m = mech9.read('four_bar.nml')
r: mech9.Results = m.kinematics(end=2)
r['q1'].max()
@m.force
def drag(t: float, motion: mech9.Motion, parameters: object, loads: mech9.Loads) -> None:
    loads.add_force(2, (0, 0, 0), -motion.velocity(2, (0, 0, 0)))
wrong: int = m.text()
m.kinematic()
''')
    told, _, code = api.run(['--strict', '--cache-dir', str(tmp_path), 'use.py'])
    assert code == 1 and 'use.py:9: error' in told and 'use.py:10: error' in told and 'Found 2 errors' in told, told
