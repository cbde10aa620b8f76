"""The programs of examples/library print the numbers that mech9k and mech9d write for the same mechanism, to round-off, and
docs/how-to/library.md shows them as they are.

Compares the program with itself: the numbers of the library and of the programs.
"""
import os

import numpy as np

from mech9_cases import TREE, run, table_of, text_of

FOLDER = os.path.join(TREE, 'examples', 'library')
DATA = os.path.join(FOLDER, 'four_bar.nml')
# Output times are 0.1 i here and 1.2 i/12 there: they differ by one unit in the last place at most, 2e-16 s. At rates below 10 and
# accelerations below 1e3 per s that is 1e-12 at most; a position between steps is closed to 1e-12 besides.
ROUND_OFF = 1e-11
SWINGING = """&initial coordinate=1, position=0.6, velocity=5.0 /
&body link=3, mass=2.0, centre=0.4,0,0, inertia=0,0.1,0.1,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&time start=0, end=1, intervals=10 /
"""


def numbers_of(text):
    return np.array([[float(word) for word in line.split()] for line in text.splitlines()])


def test_from_a_data_file(checks, build, mech9k):
    done = run(build.program('library_from_file'), folder=FOLDER)
    checks.equal(done.returncode, 0, f'it runs; {done.stderr}')
    printed, columns = numbers_of(done.stdout), table_of(mech9k, DATA)
    names = ['t', 'q1', 'q2', 'q3', 'q4', 'P.x', 'P.y', 'P.vx', 'P.vy']
    checks.equal(printed.shape, (13, len(names)), 'a row for each time, a number for each column')
    for name, values in zip(names, printed.T):
        checks.near(values, columns[name], ROUND_OFF, f'from a data file: {name} is that of mech9k')


def test_from_values_in_code(checks, build, mech9d, tmp_path):
    swinging = tmp_path / 'swinging.nml'
    lines = [line for line in text_of(DATA).splitlines(True) if not line.startswith(('&drive', '&time'))]
    swinging.write_text(''.join(lines) + SWINGING, encoding='utf-8')
    done = run(build.program('library_from_values'))
    checks.equal(done.returncode, 0, f'it runs; {done.stderr}')
    printed, columns = numbers_of(done.stdout), table_of(mech9d, swinging)
    names = ['t', 'q1', 'dq1', 'q2', 'dq2', 'q3', 'dq3', 'q4', 'dq4', 'E.kinetic', 'E.potential']
    checks.equal(printed.shape, (11, len(names)), 'a row for each time, a number for each column')
    for name, values in zip(names, printed.T):
        checks.near(values, columns[name], ROUND_OFF, f'from values in code: {name} is that of mech9d')
    checks.near(printed[:, -1] + printed[:, -2], printed[0, -1] + printed[0, -2], 1e-6, 'the energy stays')


def test_other_cranks(checks, build, mech9k):
    done = run(build.program('library_other_cranks'), folder=FOLDER)
    checks.equal(done.returncode, 0, f'it runs; {done.stderr}')
    for line, crank in zip(done.stdout.splitlines(), (0.3, 0.25, 0.2), strict=True):
        highest = table_of(mech9k, DATA, '--set', f'pair(2).point(1)={crank}')['P.y'].max()
        checks.equal(line.split(), ['crank', f'{crank:.2f}', 'm:', 'P.y', 'is', 'at', 'most', f'{highest:.4f}'], f'crank {crank}')


def test_without_its_data_file(checks, build, tmp_path):
    done = run(build.program('library_from_file'), folder=tmp_path)
    checks.equal(done.returncode, 1, 'without its data file the program fails')
    checks.true('four_bar.nml' in done.stderr and not done.stdout, 'and says why', done.stderr)


def test_document_shows_the_programs(checks):
    shown = text_of(os.path.join(TREE, 'docs', 'how-to', 'library.md'))
    checks.true(text_of(os.path.join(FOLDER, 'from_file.f90')) in shown, 'docs/how-to/library.md shows from_file.f90')
    checks.true(text_of(os.path.join(FOLDER, 'other_cranks.f90')) in shown, 'docs/how-to/library.md shows other_cranks.f90')
    lines = [line for line in text_of(os.path.join(FOLDER, 'from_values.f90')).splitlines() if 'design%' in line]
    checks.true(len(lines) > 5 and '\n'.join(lines) in shown, 'docs/how-to/library.md shows the design of from_values.f90')
