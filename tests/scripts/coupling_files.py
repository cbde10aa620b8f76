"""Data files with couplings, their tables and their messages, for several tests."""
import os
import tempfile

from mech9_cases import read_table, run, text_of

TIGHT = '&solver relative_tolerance=1e-11, absolute_tolerance=1e-12 /\n'
# Errors of steps at 1e-11 add up over some hundred steps of motions that do not enlarge them: 100 tolerances.
NEAR = 1e-9

TWO_WHEELS = """&mechanism angle_unit='{unit}' /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='{second}', point=0.3,0.1,0, axis={axis} /
&coupling coordinates=1,2, {words} /
&initial coordinate=1, position={first} /
&initial coordinate=2, position={other} /
&drive coordinate=1, kind='polynomial', coefficients={first},2,0.5 /
&time end=1, intervals=5 /
"""


def table(program, text, *options):
    """The table of a run of a data file with this text; an exception with the messages where the run fails."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'case.nml')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        done = run(program, path, '--table', os.path.join(folder, 'table'), *options, folder=folder)
        if done.returncode != 0:
            raise RuntimeError(f'{text}\nended with {done.returncode}:\n{done.stderr}')
        return read_table(text_of(os.path.join(folder, 'table')))


def output(program, text, *options):
    """The finished run of a data file with this text."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'case.nml')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return run(program, path, *options, folder=folder)
