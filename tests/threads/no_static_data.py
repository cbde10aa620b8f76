"""The floors that compute and read, and the files that make the runs of a study, have no static variables, which threads would
share: reads the symbols of the library. A function result `character(len=:), allocatable` makes one, too, in each of its callers (gfortran 12).

usage: no_static_data.py NM LIBRARY
"""
import os
import re
import subprocess
import sys

FLOORS = 'base numerics spatial structure model sampling user kinematics ode dynamics simulation analyses wording input facade'.split()
# of the floors above, the files that make a run of a study, which several threads do at the same time
OF_RUNS = {'columns.f90': 'output', 'explained_assembly.f90': 'session', 'row_source.f90': 'session', 'force_record.f90': 'session',
           'design_run.f90': 'session', 'run_maker.f90': 'session'}
SOURCES = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'src')
PRINTS_HELP = 'data_help.f90'    # of use to a program's --help only

CONSTANT = re.compile(r'^jumptable\.|^A\.\d|___def_init_|^(print_warning|is_recursive)\.')   # the compiler's own

floor_of = {name.replace('.in', ''): floor for floor in FLOORS
            for _, _, names in os.walk(os.path.join(SOURCES, floor)) for name in names}
floor_of.update(OF_RUNS)
listing = subprocess.run(sys.argv[1:], capture_output=True, text=True, check=True).stdout
member, seen, shared = None, set(), []
for line in listing.splitlines():
    found = re.fullmatch(r'(\S+)\.o:', line)
    if found:
        member = found.group(1)
        continue
    parts = line.split()
    if member not in floor_of or member == PRINTS_HELP or len(parts) < 3:
        continue
    seen.add(member)
    # module constants stand in initialized data with names of their own (D); of b, B, C and d only these are no variables
    if parts[1] in 'bBCd' and not CONSTANT.search(parts[2]):
        shared.append(f'{floor_of[member]}/{member}: {parts[2]}')
if missing := set(OF_RUNS) - seen:
    sys.exit(f'not found in the library: {missing}')
if len(seen) < 50:
    sys.exit(f'only {len(seen)} of the library\'s files were found')
print('\n'.join(shared))
print(f'{len(seen)} files, {len(shared)} static variables')
sys.exit(bool(shared))
