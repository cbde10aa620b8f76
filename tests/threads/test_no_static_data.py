"""The floors that compute and read have no static variables, which threads would share: reads the symbols of the library. A function
result `character(len=:), allocatable` makes one, too, in each of its callers (gfortran 12)."""
import os
import re

import pytest

from mech9_cases import TREE, run

FLOORS = 'base numerics spatial structure model sampling user kinematics ode dynamics simulation analyses wording runs studies input output/layout facade'.split()
SOURCES = os.path.join(TREE, 'src')
RUN_ONCE = ('data_help.f90', 'auto_files.f90', 'made_code.f90')    # a program's --help, and programs of mech9-link, use them alone

# The compiler's own; and constants of MPI, common blocks that SUNDIALS 7 of Debian hands on with its communicator.
CONSTANT = re.compile(r'^jumptable\.|^A\.\d|___def_init_|^(print_warning|is_recursive)\.|^mpi_fortran_\w+_$')


def test_no_static_variables(checks, build):
    if build.kind != 'Debug':
        pytest.skip('optimising across files hides the symbols, and the sanitizers add their own')
    floor_of = {name.replace('.in', ''): floor for floor in FLOORS
                for _, _, names in os.walk(os.path.join(SOURCES, floor)) for name in names}
    done = run(build.settings['CMAKE_NM'], os.path.join(build.folder, 'libmech9.a'))
    checks.equal(done.returncode, 0, f'the symbols are listed; {done.stderr}')
    member, seen = None, set()
    for line in done.stdout.splitlines():
        found = re.fullmatch(r'(\S+)\.o:', line)
        if found:
            member = found.group(1)
            continue
        parts = line.split()
        if member not in floor_of or member in RUN_ONCE or len(parts) < 3:
            continue
        seen.add(member)
        # module constants stand in initialized data with names of their own (D); of b, B, C and d only these are no variables
        shared = parts[1] in 'bBCd' and not CONSTANT.search(parts[2])
        checks.true(not shared, f'{floor_of[member]}/{member} has no static variable', parts[2])
    checks.true(len(seen) >= 50, 'the files of the library were found', len(seen))
