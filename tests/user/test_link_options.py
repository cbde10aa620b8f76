"""Programs of other projects are linked without optimisation across files, unless they ask for it.

The exported target of a release configuration is read by a small project, whose rules for linking tell the options. Nothing is compiled.
"""
import os
import re
import shutil
import subprocess

import pytest

from mech9_cases import TREE

PROJECT = """cmake_minimum_required(VERSION 3.22)
project(user LANGUAGES C)
add_library(LAPACK::LAPACK INTERFACE IMPORTED)
include("{targets}")
foreach(name plain asked by_property)
  add_executable(${{name}} main.c)
  target_link_libraries(${{name}} PRIVATE mech9::mech9)
endforeach()
set_target_properties(asked PROPERTIES MECH9_LTO ON)
target_link_options(asked PRIVATE -flto)
set_target_properties(by_property PROPERTIES INTERPROCEDURAL_OPTIMIZATION ON)
"""


def configure(folder, build, *options):
    done = subprocess.run(['cmake', '-G', 'Ninja', '-S', folder, '-B', build, *options], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize('lto', ['ON', 'OFF'])
def test_programs_of_other_projects(checks, tmp_path, lto):
    build, user = tmp_path / 'build', tmp_path / 'user'
    configure(TREE, build, '-DCMAKE_BUILD_TYPE=Release', f'-DMECH9_LTO={lto}', '-DMECH9_MPI=OFF', '-DMECH9_BUILD_TESTS=OFF')
    exported = next((build / 'CMakeFiles' / 'Export').rglob('mech9Targets.cmake'))
    package = user / 'lib' / 'cmake' / 'mech9'
    package.mkdir(parents=True)
    for path in exported.parent.glob('*.cmake'):
        shutil.copy(path, package)
    # the target checks that its files are there
    os.makedirs(user / 'include' / 'mech9')
    (user / 'lib' / 'libmech9.a').write_bytes(b'!<arch>\n')
    (user / 'main.c').write_text('int main(void) { return 0; }\n', encoding='utf-8')
    (user / 'CMakeLists.txt').write_text(PROJECT.format(targets=package / 'mech9Targets.cmake'), encoding='utf-8')
    configure(user, tmp_path / 'out')
    options = {}
    for name in ('plain', 'asked', 'by_property'):
        done = subprocess.run(['ninja', '-C', tmp_path / 'out', '-t', 'commands', name], capture_output=True, text=True, check=True)
        link = done.stdout.splitlines()[-1]
        options[name] = re.findall(r'-f(?:no-)?lto\S*', link)
    checks.equal(options['plain'], ['-fno-lto'] if lto == 'ON' else [], f'MECH9_LTO={lto}: a program that asks nothing')
    checks.equal(options['asked'], ['-flto'], f'MECH9_LTO={lto}: one that asks')
    checks.true('-fno-lto' not in options['by_property'] and options['by_property'], f'MECH9_LTO={lto}: one that asks by its property', options)
