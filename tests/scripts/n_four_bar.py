"""Writes the data file of the N-four-bar mechanism: N windows of N + 1 uprights and N couplers, uniform rods of 1 m and 1 kg.

usage: n_four_bar.py N [END]      to standard output; END of the run in s, 10 if left out
"""
import sys


def data_file(n, end=10.0):
    """The mechanism upright at t = 0, the upper ends moving with 1 m/s to +x, results every 0.05 s."""
    uprights = [2 + i for i in range(n + 1)]
    couplers = [n + 3 + i for i in range(n)]
    lines = [f'! {n} windows: uprights are links {uprights[0]} to {uprights[-1]}, couplers links {couplers[0]} to {couplers[-1]}.',
             '! Written by tests/scripts/n_four_bar.py.',
             '',
             f"&mechanism title='{n}-four-bar', links={2 * n + 2}, coordinates={3 * n + 1} /",
             '&structure cq=1 /',
             '']
    joints = [(1, upright, i, 0) for i, upright in enumerate(uprights)]
    for i, coupler in enumerate(couplers):
        joints += [(uprights[i], coupler, i, 1), (uprights[i + 1], coupler, i + 1, 1)]
    lines += [f"&pair coordinate={k}, links={reference},{moving}, kind='revolute', point={x},{y},0, axis=0,0,1 /"
              for k, (reference, moving, x, y) in enumerate(joints, 1)]
    lines += ['&initial coordinate=1, position=0, velocity=-1 /', '']
    lines += [f'&body link={link}, mass=1, centre={i},0.5,0, inertia={1 / 12!r},0,{1 / 12!r},0,0,0 /'
              for i, link in enumerate(uprights)]
    lines += [f'&body link={link}, mass=1, centre={i + 0.5},1,0, inertia=0,{1 / 12!r},{1 / 12!r},0,0,0 /'
              for i, link in enumerate(couplers)]
    lines += ['&gravity acceleration=0,-9.81,0 /',
              f"&point name='B0', link={uprights[0]}, position=0,1,0 /",
              '',
              f'&time start=0, end={end:g}, intervals={round(20 * end)} /',
              '&solver relative_tolerance=1e-10, absolute_tolerance=1e-10 /',
              f"&output table='n_four_bar_{n}.dat' /"]
    return '\n'.join(lines) + '\n'


if __name__ == '__main__':
    sys.stdout.write(data_file(int(sys.argv[1]), *map(float, sys.argv[2:3])))
