#!/usr/bin/env python3
"""Measures what the Python package adds to the library: steps of many motions side by side, against the same loop in Fortran.

usage: library_overhead.py BENCH_MANY LIBRARY [MOTIONS [STEPS]]
BENCH_MANY is the program of that name, and LIBRARY is libmech9.so.0 of the same build. Prints the time of a step of one motion.
"""
import os
import statistics
import subprocess
import sys
import time

TREE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PROBLEMS = ('pendulum_four_bar', 'double_pendulum', 'andrews')
REPETITIONS = 5
LENGTH = {'pendulum_four_bar': 0.01, 'double_pendulum': 0.01, 'andrews': 0.0003}   # of a step [s]


def in_python(path, motions, steps, length):
    """Time of a step of one motion [us]."""
    import mech9
    with mech9.read(path).simulations(motions) as many:
        began = time.perf_counter()
        for k in range(1, steps + 1):
            many.advance(k*length)
        spent = time.perf_counter() - began
        assert not many.code.any(), many.code
    return 1e6*spent/(motions*steps)


def in_fortran(program, path, motions, steps, length):
    """The same in Fortran."""
    words = [program, path, str(motions), str(steps), repr(length)]
    return float(subprocess.run(words, check=True, capture_output=True, text=True).stdout)


def main(program, library, motions=4096, steps=20):
    os.environ['MECH9_LIBRARY'] = os.path.abspath(library)
    sys.path.insert(0, os.path.join(TREE, 'python'))
    print('| problem | Fortran [us] | Python [us] | ratio |')
    print('| --- | --- | --- | --- |')
    for name in PROBLEMS:
        path = os.path.join(TREE, 'examples', name, name + '.nml')
        pairs = [(in_fortran(program, path, motions, steps, LENGTH[name]), in_python(path, motions, steps, LENGTH[name]))
                 for _ in range(REPETITIONS)]
        ours, theirs = (statistics.median(column) for column in zip(*pairs))
        print(f'| {name} | {ours:.2f} | {theirs:.2f} | {theirs/ours:.2f} |', flush=True)


if __name__ == '__main__':
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2], *map(int, sys.argv[3:]))
