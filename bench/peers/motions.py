"""Whole motions by other programs, where they are installed: wall time against the error at the end, in the form of bench_precision.

usage: motions.py MECH9D FOLDER PROBLEM full|quick
    MECH9D     the program mech9d, which closes the chains at the start
    FOLDER     for data files
    PROBLEM    a motion of bench_precision
Prints a row for each program and setting: its name, the step [s] or the tolerance, the largest difference of coordinates or of a point's
position [rad, m] from tests/reference, seconds, and how many steps or evaluations were made. Lines `setting` tell version and settings of
each program; lines `missing` name programs that are not installed; a line `failed` tells why one has no rows. All programs get the
links, pairs, bodies and loads of one data file, and the closed position and rates of its start.
"""
import importlib
import math
import os
import re
import signal
import statistics
import subprocess
import sys
import time

from mechanism import Mechanism, first_row

TREE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# data file, reference, columns of the results in the order of the reference's columns after the time, time of the end [s]
PROBLEMS = {
    'andrews': ('examples/andrews/andrews.nml', 'a03_andrews_ivp.csv', 'q1 q2 q3 q4 q5 q6 q7', 0.03),
    'governor': ('examples/flyball_governor/flyball_governor.nml', 'a05_flyball.csv', 'q2', 10.0),
    'two_windows': ('examples/n_four_bar/n_four_bar_2.nml', 'a02_nfourbar_N2.csv', 'B0.x B0.y', 10.0),
    'forty_windows': ('examples/n_four_bar/n_four_bar_40.nml', 'a02_nfourbar_N40.csv', 'B0.x B0.y', 10.0),
    'bricard': ('examples/bricard/bricard.nml', 'a04_bricard.csv', 'P3.x P3.y P3.z', 9.0),
    'legs': ('bench/data/legs_fall.nml', 'legs_fall.csv', 'left_toe.x left_toe.y left_toe.z right_toe.x right_toe.y right_toe.z', 0.5),
}
PROGRAMS = ('exudyn_motion', 'mujoco_motion', 'drake_motion', 'pinocchio_motion', 'simbody_motion')
# the list of a program ends when its runs have taken this time together, since finer settings would take longer still [s]
PATIENCE = 10.0
# all runs of a program together are ended after this time, a fifth of it in quick runs [s]
LONGEST = 90.0
LONG_ENOUGH = 0.05


def reference(name, end):
    """The row of a reference at the time of the end, after its time."""
    with open(os.path.join(TREE, 'tests', 'reference', name), encoding='utf-8') as file:
        rows = [line.split(',') for line in file if line[0] in '0123456789']
    row = min((list(map(float, row)) for row in rows), key=lambda row: abs(row[0] - end))
    assert abs(row[0] - end) < 1e-9, f'{name} has no time {end}'
    return row[1:]


def measure(program, mechanism, problem, exact, end, quick):
    """Rows of a program over its settings, from coarse to fine, and a line that tells the settings without a motion."""
    columns = PROBLEMS[problem][2].split()
    spent, failures = 0.0, {}
    for setting in program.settings(mechanism, problem, end)[:2 if quick else None]:
        # a version that knows other names must not end the run
        try:
            times, work, places = repeat(program, mechanism, problem, end, setting, quick)
        except Exception as failure:
            failures.setdefault((str(failure) or type(failure).__name__).strip().splitlines()[0], []).append(f'{setting:.1e}')
            continue
        values = mechanism.values(columns, places)
        error = max(difference(mechanism, column, value, true) for column, value, true in zip(columns, values, exact))
        print(f'{program.NAME} {setting:.3e} {error:.3e} {statistics.median(times):.5e} {work} {work}', flush=True)
        spent += sum(times)
        if spent > PATIENCE:
            break
    for reason, settings in failures.items():
        print('failed', f'{program.NAME} with', f'{", ".join(settings)}: {reason}')


def repeat(program, mechanism, problem, end, setting, quick):
    """Times of a motion that is repeated, how many steps or evaluations it takes, and the places of the links at its end."""
    times = []
    while True:
        run = program.prepare(mechanism, problem, end, setting)
        begin = time.perf_counter()
        work = run.go()
        # a program that runs in a process of its own tells the time of its integration
        times.append(getattr(run, 'seconds', time.perf_counter() - begin))
        if quick or len(times) == 9 or sum(times) > LONG_ENOUGH:
            return times, work, run.places()


def difference(mechanism, column, value, true):
    """The distance of two numbers, of angles less whole turns."""
    turning = any(column == f'q{pair.coordinate}' and pair.turns for pair in mechanism.pairs)
    return abs(math.remainder(value - true, math.tau) if turning else value - true)


def main():
    """All programs, each in a process of its own: one that breaks down must not end the others."""
    *words, mode = sys.argv[1:]
    for module in PROGRAMS:
        process = subprocess.Popen([sys.executable, '-B', os.path.abspath(__file__), *words, mode, module], stdout=subprocess.PIPE, text=True,
                                   stderr=subprocess.DEVNULL)
        longest = LONGEST / 5 if mode == 'quick' else LONGEST
        try:
            printed, _ = process.communicate(timeout=longest)
        except subprocess.TimeoutExpired:
            process.kill()
            printed, _ = process.communicate()
        # the programs print warnings of their own
        print(*(line for line in printed.splitlines() if re.match(r'(setting|missing|failed) |\w+( [-+.\de]+){5}$', line)), sep='\n', flush=True)
        if process.returncode != 0:
            name = module.split('_')[0].capitalize()
            print('failed', f'{name}: ended with code {process.returncode}' if process.returncode != -signal.SIGKILL else
                  f'{name}: its further settings took longer than {longest:g} s', flush=True)


def run_one():
    mech9d, folder, problem, mode, module = sys.argv[1:]
    path, name, _, end = PROBLEMS[problem]
    quick = mode == 'quick'
    if quick:
        end /= 20
    try:
        program = importlib.import_module(module)
    except (ImportError, OSError) as absent:
        print('missing', module.split('_')[0], str(absent).splitlines()[0])
        return
    path = os.path.join(TREE, path)
    mechanism = Mechanism(path, first_row(mech9d, path, folder))
    print('setting', program.NAME, f'{program.VERSION}: {program.WORDS}', flush=True)
    try:
        if hasattr(program, 'build'):
            program.build(folder)
        measure(program, mechanism, problem, reference(name, end), end, quick)
    except Exception as failure:
        print('failed', f'{program.NAME}:', *str(failure).splitlines()[:1])


if __name__ == '__main__':
    main() if len(sys.argv) == 5 else run_one()
