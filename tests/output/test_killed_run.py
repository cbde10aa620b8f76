"""A run killed outright, at any moment, leaves an HDF5 file that opens and holds right rows.

Compares the program with itself in part: the last row of a run that was killed and that row of a whole run.

The run is of Fig. 1, driven through millions of positions. Each file is held against the rows of a run that
was not killed, at the times that both have: positions of two runs differ by the round-off of one closed chain.
"""
import os
import random
import signal
import subprocess
import time

import numpy as np
import pytest

from mech9_cases import POSITION, REFERENCE, run

FIG1 = os.path.join(REFERENCE, 'kinematics_fig1.nml')
# a run that nobody waits for; rows are made known to the file every second, the first ones at once
INTERVALS, LONGEST = 50_000_000, 2.6
SIZE = 5.6    # of the mechanism [m]

try:
    import h5py
except ImportError:
    pytest.skip('h5py is not installed (Debian: python3-h5py): nothing is tested', allow_module_level=True)


def killed_after(program, folder, seconds):
    """The file that a run leaves when it is killed after so many seconds; None where it has not begun."""
    path = os.path.join(folder, 'killed.h5')
    if os.path.exists(path):
        os.remove(path)
    process = subprocess.Popen([program, FIG1, '--hdf5', path, '--quiet', '--set', "output.table=''",
                                '--set', f'time.intervals={INTERVALS}'], cwd=folder)
    time.sleep(seconds)
    process.send_signal(signal.SIGKILL)
    process.wait()
    return path if os.path.exists(path) else None


def check_file(checks, path, seconds):
    """The file opens; its rows go on without a gap from the start; gives how many there are."""
    why = f'killed after {seconds:.3f} s'
    try:
        with h5py.File(path, 'r') as file:
            rows = {name: item.shape[0] for name, item in file.items()
                    if isinstance(item, h5py.Dataset) and item.maxshape[:1] == (None,)}
            checks.true(len(set(rows.values())) == 1, f'{why}: all quantities have as many rows', rows)
            n = rows['time']
            times = file['time'][:]
            start, end = 0.0, 1.0
            if n:
                checks.near(times, start + (end - start) * np.arange(n) / INTERVALS, 1e-15, f'{why}: times')
            for name in rows:
                checks.true(np.all(np.isfinite(file[name][-1000:])), f'{why}: the last rows of {name} are there')
            checks.true(n == 0 or np.all(file['closure'][:] <= 1e-13 * SIZE), f'{why}: every row is of closed chains')
            checks.true(file['provenance/data'].shape == (), f'{why}: provenance')
            checks.equal(file['diagnostics/exit_code'][()], -1, f'{why}: no exit code')
            return n, file['q'][-1] if n else None
    except OSError as error:
        checks.true(False, f'{why}: the file opens and can be read', error)
        return 0, None


def test_killed_at_any_moment(checks, mech9k, tmp_path):
    random.seed(20)
    most = 0
    for i in range(4):
        seconds = LONGEST if i == 0 else random.uniform(0.3, LONGEST)
        path = killed_after(mech9k, tmp_path, seconds)
        if not path:
            continue
        n, q = check_file(checks, path, seconds)
        most = max(most, n)
        if n:
            t = (n - 1) / INTERVALS
            done = run(mech9k, FIG1, '--hdf5', 'whole.h5', '--quiet', '--set', "output.table=''",
                       '--set', f'time.end={t!r}', '--set', 'time.intervals=100', folder=tmp_path)
            checks.equal(done.returncode, 0, f'the run up to there; stderr: {done.stderr}')
            with h5py.File(tmp_path / 'whole.h5', 'r') as whole:
                checks.near(q, whole['q'][-1], POSITION, f'killed after {seconds:.3f} s: the last row')
    checks.true(most > 1000, 'many rows were there when a run was killed', most)
