"""Time per position of the driven four-bar linkage of bench_positions by pylinkage, where it is installed.

usage: positions.py full|quick
Prints its version, microseconds of a position, microseconds with velocities and accelerations, and the largest error of the rocker's
pin over the crank's length, against two circles that meet. Its compiled solver runs; the time in which it is compiled does not count.
A line `missing` tells that it is not installed.
"""
import math
import statistics
import sys
import time

GROUND, CRANK, COUPLER, ROCKER = 0.40, 0.15, 0.35, 0.30
SPEED = 10.0


def pin(angle):
    """The pin between coupler and rocker, on the open branch."""
    x, y = CRANK * math.cos(angle), CRANK * math.sin(angle)
    distance = math.hypot(GROUND - x, y)
    along = (COUPLER ** 2 - ROCKER ** 2 + distance ** 2) / (2 * distance)
    across = math.sqrt(COUPLER ** 2 - along ** 2)
    c, s = (GROUND - x) / distance, -y / distance
    return x + along * c - across * s, y + along * s + across * c


def main():
    quick = sys.argv[1] == 'quick'
    try:
        import numpy
        import pylinkage
    except ImportError:
        print('missing pylinkage')
        return
    steps = 1000 if quick else 10000
    crank_bearing, rocker_bearing = pylinkage.Ground(0.0, 0.0), pylinkage.Ground(GROUND, 0.0)
    crank = pylinkage.Crank(crank_bearing, radius=CRANK, angular_velocity=2 * math.pi / steps)
    rocker = pylinkage.RRRDyad(crank.output, rocker_bearing, COUPLER, ROCKER, *pin(0.0))
    linkage = pylinkage.Linkage([crank_bearing, rocker_bearing, crank, rocker])
    linkage.set_input_velocity(crank, SPEED)
    start = linkage.get_coords()
    times = [[], []]
    # the first pass compiles
    for i in range(3 if quick else 16):
        for kind, run in enumerate((linkage.step_fast, linkage.step_fast_with_kinematics)):
            linkage.set_coords(start)
            begin = time.perf_counter()
            found = run(steps)
            if i > 0:
                times[kind].append((time.perf_counter() - begin) / steps)
            if kind == 0:
                places = found
    path, crank_path = places[:, 3], places[:, 2]
    exact = numpy.array([pin(math.atan2(y, x)) for x, y in crank_path])
    error = numpy.abs(path - exact).max() / CRANK
    print(f'pylinkage {pylinkage.__version__}\t{1e6 * statistics.median(times[0]):.4f}\t{1e6 * statistics.median(times[1]):.4f}\t{error:.1e}')


if __name__ == '__main__':
    main()
