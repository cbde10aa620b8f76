"""examples/run in a project that was moved with its build folder: it says so and configures anew. A stand-in for cmake refuses, as
cmake does, a cache that was made for another place."""
import os
import shutil

import pytest

from mech9_cases import TREE, run

CMAKE = r"""#!/usr/bin/env bash
if [ "$1" = --preset ]; then
  cache=build/release/CMakeCache.txt
  [ ! -f $cache ] || grep -q "^CMAKE_HOME_DIRECTORY:INTERNAL=$PWD\$" $cache || { echo "made for another place"; exit 1; }
  echo "CMAKE_HOME_DIRECTORY:INTERNAL=$PWD" >$cache
fi
"""
MECH9K = r"""#!/usr/bin/env bash
while [ $# -gt 0 ]; do
  if [ "$1" = --table ]; then printf '# title\nt q1\n0 0\n' >"$2"; fi
  shift
done
"""


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A project with stand-ins for cmake and mech9k, whose build folder was made in another place."""
    folder = tmp_path.resolve() / 'project'
    for part in ('examples', 'cmake', 'build/release/CMakeFiles', 'build/release/bin', '../tools'):
        (folder / part).mkdir(parents=True)
    for name in ('run', 'list.txt'):
        shutil.copy(os.path.join(TREE, 'examples', name), folder / 'examples')
    (folder / 'cmake' / 'packages.sh').write_text('need_packages() { :; }\n', encoding='utf-8')
    for path, text in ((folder / '../tools/cmake', CMAKE), (folder / 'build/release/bin/mech9k', MECH9K)):
        path.write_text(text, encoding='utf-8')
        path.chmod(0o755)
    (folder / 'build/release/CMakeCache.txt').write_text('CMAKE_HOME_DIRECTORY:INTERNAL=/elsewhere/project\n', encoding='utf-8')
    monkeypatch.setenv('PATH', f"{tmp_path / 'tools'}:{os.environ['PATH']}")
    monkeypatch.delenv('MECH9_BIN', raising=False)
    return folder


def test_moved_build_folder_is_configured_anew(checks, project):
    done = run(project / 'examples' / 'run', 'fig1')
    said = done.stdout + done.stderr
    checks.equal(done.returncode, 0, f'the moved build folder is noticed: {said}')
    checks.true('build/release was made for the project in /elsewhere/project' in said, 'that is said', said)
    done = run(project / 'examples' / 'run', 'fig1')
    said = done.stdout + done.stderr
    checks.equal(done.returncode, 0, f'the second time: {said}')
    checks.true('was made for' not in said, 'a build folder in its place is not configured anew', said)
