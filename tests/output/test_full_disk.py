"""A disk that becomes full at any moment leaves no hidden part of a file, and no file of a search that cannot be continued.

The disks are file systems in memory of a given size, in a name space of their own; where these cannot be made, the test is left out.
"""
import os
import re
import shutil
import subprocess

import pytest

from mech9_cases import TREE

FILE, DONE = 8, 0
SIZES = [*range(8, 72, 8), *range(72, 128, 4), 160, 200, 4000]      # kB; the last one is enough for all
EXAMPLES = os.path.join(TREE, 'examples')
SEARCH = '--optimize --out best.nml --hdf5 r.h5 --set optimum.starts=4'
AGAIN = SEARCH.replace('--hdf5', '--continue')
# each run makes files of several kinds
RUNS = {
    'a run': ('fig1.nml --hdf5 r.h5 --table t.dat --report r.json --animate p.svg', ['fig1/fig1.nml']),
    'a study': ('study.nml --study --hdf5 r.h5 --table t.dat', ['../tests/threads/study.nml']),
    'a search': (f'five_timed_points.nml {SEARCH} --table t.dat',
                 ['five_timed_points/five_timed_points.nml', 'five_timed_points/five_points.dat'])}


def has_disks():
    if not shutil.which('unshare'):
        return False
    return subprocess.run(['unshare', '-rm', 'sh', '-c', 'mount -t tmpfs t /mnt'], capture_output=True, check=False).returncode == 0


def on_disk(kilobytes, files, commands):
    """The output of shell commands in a folder with the files, on a disk of this size."""
    script = f'mount -t tmpfs -o size={kilobytes}k t /mnt && cp {" ".join(files)} /mnt && cd /mnt && {commands}'
    return subprocess.run(['unshare', '-rm', 'sh', '-c', script], capture_output=True, text=True, check=False, timeout=600).stdout


@pytest.mark.parametrize('kind', RUNS)
def test_no_part_stays(checks, mech9k, kind):
    if not has_disks():
        checks.left_out('no file systems in memory can be made here (unshare -rm)')
        return
    words, names = RUNS[kind]
    files = [os.path.join(EXAMPLES, name) for name in names]
    codes = set()
    for size in SIZES:
        said = on_disk(size, files, f'{mech9k} {words} 2>&1; echo code $?; ls -A')
        code = int(re.search(r'^code (\d+)$', said, re.M).group(1))
        codes.add(code)
        checks.true(code in (FILE, DONE), f'{kind}, {size} kB: a known end', said)
        checks.true('.part' not in said.split('\ncode ')[1], f'{kind}, {size} kB: no part of a file stays', said)
        checks.true(code == DONE or 'No space left on device' in said, f'{kind}, {size} kB: the reason', said)
    checks.equal(codes, {FILE, DONE}, f'{kind}: disks that are too small, and one that is not')


def test_a_search_can_be_continued(checks, mech9k):
    if not has_disks():
        checks.left_out('no file systems in memory can be made here (unshare -rm)')
        return
    files = [os.path.join(EXAMPLES, name) for name in RUNS['a search'][1]]
    whole = on_disk(4000, files, f'{mech9k} five_timed_points.nml {SEARCH} --quiet; cat best.nml')
    best = re.findall(r'^&p.*$', whole, re.M)
    checks.true(len(best) > 4, 'a design', whole)
    kept = 0
    for size in SIZES:
        said = on_disk(size, files, f'{mech9k} five_timed_points.nml {SEARCH} --quiet; test -e r.h5 && echo kept; mount -o remount,size=4000k /mnt; '
                                    f'test -e r.h5 && {mech9k} five_timed_points.nml {AGAIN} --quiet 2>&1; echo code $?; cat best.nml')
        if 'kept\n' not in said:
            continue
        kept += 1
        checks.true('code 0\n' in said, f'{size} kB: the search is continued', said)
        checks.equal(re.findall(r'^&p.*$', said, re.M), best, f'{size} kB: the same best design')
    checks.true(kept > 3, 'files of searches that a full disk left', kept)
