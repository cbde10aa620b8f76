"""docs/how-to/clusters.md: its script for Dask, and pieces of a study that workers write."""
import os
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest

from mech9_cases import PATIENCE, TREE, text_of

CODE = re.findall(r'```python\n(.*?)```', text_of(os.path.join(TREE, 'docs', 'how-to', 'clusters.md')), re.S)


def in_folder(checks, mech9, folder, code):
    """Run code as a file, since workers read it, too; returns its lines."""
    pytest.importorskip('distributed', reason='Dask is not installed (Debian: python3-distributed)')
    for name in ('library/four_bar.nml', 'timed_path/timed_path.nml', 'timed_path/eighteen_points.dat'):
        shutil.copy(os.path.join(TREE, 'examples', name), folder)
    with open(folder / 'many.py', 'w', encoding='utf-8') as file:
        file.write(code)
    environment = dict(os.environ, PYTHONPATH=os.path.join(TREE, 'python'))
    done = subprocess.run([sys.executable, 'many.py'], cwd=folder, env=environment, text=True, capture_output=True, timeout=60*PATIENCE)
    checks.equal(done.returncode, 0, done.stderr)
    return done.stdout.splitlines()


def test_script_of_the_page(checks, mech9, tmp_path):
    """The runs of two processes have the bits of one; the searches find the best design that is published for this problem."""
    lines = in_folder(checks, mech9, tmp_path, CODE[0].replace('threads_per_worker=1', 'threads_per_worker=1, dashboard_address=None'))
    m = mech9.read(os.path.join(TREE, 'examples', 'library', 'four_bar.nml'))
    m.add('quantity', name='top', of='P.y', take='max')
    alone = m.study(**{'pair(2).point(1)': np.linspace(0.25, 0.35, 1001)})
    checks.equal(lines[0].split(), ['1001', repr(float(alone['top'].max()))], 'the runs are those of one process')
    # the least value that examples/timed_path has, in its own tests
    checks.true(abs(float(lines[1]) - 0.0090288846) < 1e-9, 'the best design is found', lines)


def test_pieces_in_files(checks, mech9, tmp_path):
    """The files of all workers hold the whole study."""
    code = f"""import numpy as np
import xarray
import mech9
from dask.distributed import Client, LocalCluster

def main():
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        m = mech9.read('four_bar.nml')
        m.add('quantity', name='top', of='P.y', take='max').add('parameter', name='crank', sets='pair(2).point(1)')
        cranks = np.linspace(0.25, 0.35, 1000)
{re.sub('(?m)^(?=.)', '        ', CODE[1].replace('1000', '10'))}
        print(bool((np.sort(runs['crank'].values) == cranks).all()), bool((runs['top'].values == m.study(crank=cranks)['top'].values).all()))

if __name__ == '__main__':
    main()
"""
    checks.equal(in_folder(checks, mech9, tmp_path, code), ['True True'], 'the pieces are the whole study')
