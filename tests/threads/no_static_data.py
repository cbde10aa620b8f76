"""The floors that compute and read have no static variables, which threads would share: reads the symbols of the
library. A function result `character(len=:), allocatable` makes one, too, in each of its callers (gfortran 12).

usage: no_static_data.py NM LIBRARY
"""
import os
import re
import subprocess
import sys

FLOORS = 'base numerics spatial structure model user kinematics ode dynamics simulation wording input facade'.split()
SOURCES = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'src')
PRINTS_HELP = 'data_help.f90'    # of use to a program's --help only

CONSTANT = re.compile(r'^jumptable\.|^A\.\d|___def_init_|^(print_warning|is_recursive)\.')   # the compiler's own

floor_of = {name.replace('.in', ''): floor for floor in FLOORS
            for _, _, names in os.walk(os.path.join(SOURCES, floor)) for name in names}
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
if len(seen) < 50:
    sys.exit(f'only {len(seen)} of the library\'s files were found')
print('\n'.join(shared))
print(f'{len(seen)} files, {len(shared)} static variables')
sys.exit(bool(shared))
