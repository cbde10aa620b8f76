"""Programs with user procedures as their users make them: by mech9-link of the build tree, and of a tree that was installed and moved
to another place, by a CMake project that finds the installed package, and by that tree's own mech9-link."""
import os
import re

import pytest

from mech9_cases import TREE, run, text_of

USER_PROCS = os.path.join(TREE, 'user_procs')
# the programs that are made of the samples: further options, sources in user_procs, and the procedures that mech9-link finds in them
SAMPLES = {'trammel': ([], ['trammel/trammel.f90'], 'user_pair'),
           'trammel_values': ([], ['trammel/trammel_values.f90'], 'user_pair_values'),
           'cam_follower': ([], ['cam_follower/cam_follower.f90', 'cam_follower/oldcam.f'], 'user_pair_values'),
           'cycloidal_drive': (['-O2'], ['cycloidal_drive/cycloidal_drive.f90'], 'user_drive'),
           'cycloidal_drive_values': ([], ['cycloidal_drive/cycloidal_drive_values.f90'], 'user_drive_values'),
           'cardan_coupling': ([], ['cardan_coupling/cardan_coupling.f90'], 'user_coupling'),
           'cardan_coupling_values': ([], ['cardan_coupling/cardan_coupling_values.f90'], 'user_coupling_values'),
           'air_drag': ([], ['air_drag/air_drag.f90'], 'user_force')}


def done(*words, **how):
    """Run a command that must succeed."""
    ended = run(*words, timeout=600, **how)
    assert ended.returncode == 0, f'{words} ended with {ended.returncode}:\n{ended.stdout}\n{ended.stderr}'
    return ended


@pytest.fixture(scope='session')
def installed(build, tmp_path_factory):
    """The folder of the installed tree, which was moved to another place."""
    folder = tmp_path_factory.mktemp('installed')
    done(build.settings['CMAKE_COMMAND'], '--install', build.folder, '--prefix', folder / 'first')
    (folder / 'first').rename(folder / 'moved')
    return folder / 'moved'


@pytest.fixture(scope='session')
def made_by_cmake(build, installed, tmp_path_factory):
    """A function that makes a CMake project, which finds the installed package; the folder where it is made."""
    flags = re.search(r'^flags=\((.*)\)$', text_of(build.program('mech9-link')), re.M).group(1)   # as the library was compiled

    def make(project, *options):
        folder = tmp_path_factory.mktemp('project')
        done(build.settings['CMAKE_COMMAND'], '-S', project, '-B', folder, '-G', 'Ninja', f'-DCMAKE_PREFIX_PATH={installed}',
             f"-DCMAKE_Fortran_COMPILER={build.settings['CMAKE_Fortran_COMPILER']}", f'-DCMAKE_Fortran_FLAGS={flags}', *options)
        done(build.settings['CMAKE_COMMAND'], '--build', folder)
        return folder
    return make


@pytest.fixture(scope='session', params=('build tree', 'installed'))
def link(request, build):
    """The path of mech9-link and the folder of the samples that belong to it."""
    if request.param == 'build tree':
        return build.program('mech9-link'), USER_PROCS
    moved = request.getfixturevalue('installed')
    return os.path.join(moved, 'bin', 'mech9-link'), os.path.join(moved, 'share', 'mech9', 'user_procs')


def linked(link, samples, folder):
    """The programs of all samples, by mech9-link."""
    for name, (options, sources, found) in SAMPLES.items():
        said = done(link, '-o', folder / name, *options, *(os.path.join(samples, source) for source in sources))
        assert f'with your {found})' in said.stdout + said.stderr, f'{name}: {said.stdout}\n{said.stderr}'
    return folder


@pytest.fixture(scope='session', params=('samples', 'linked', 'project', 'installed and linked'))
def programs(request, build, tmp_path_factory):
    """A folder with the programs of all samples: by the function in this tree, by its mech9-link, by a CMake project that finds the
    installed package, and by the mech9-link that was installed with it."""
    if request.param == 'samples':
        return build.tests
    if request.param == 'linked':
        return linked(build.program('mech9-link'), USER_PROCS, tmp_path_factory.mktemp('linked'))
    moved = request.getfixturevalue('installed')
    samples = moved / 'share' / 'mech9' / 'user_procs'
    if request.param == 'project':
        project = os.path.join(TREE, 'tests', 'user', 'user_project')
        return request.getfixturevalue('made_by_cmake')(project, f'-DSAMPLES={samples}')
    return linked(moved / 'bin' / 'mech9-link', samples, tmp_path_factory.mktemp('linked'))
