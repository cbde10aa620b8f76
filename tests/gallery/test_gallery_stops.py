"""Impacts of the gallery's stops against closed forms: parabolas of a slider, and energy integrals of a four-bar."""
from math import acos, atan2, cos, hypot, log, sin, sqrt

import numpy as np

from gallery_list import examples
from mech9_cases import table_and_report

G = 9.81


def events_of(mech9d, name):
    example = next(example for example in examples() if example.name == name)
    _, report = table_and_report(mech9d, example.data)
    return report['events'], report['relative_tolerance'] * report['steps']


def test_bouncing_slider(checks, mech9d):
    """Flight n lasts 2 t1 e^n; the impacts end at t1 (1 + e)/(1 - e)."""
    events, _ = events_of(mech9d, 'bouncing_slider')
    e, first = 0.9, sqrt(2 / G)
    hits = [event for event in events if event['kind'] == 'impact']
    # the program leaves out rebounds below 1e-12 m and what ends within a millionth of the run
    least = log(1e-5 * (1 - e) / (2 * first)) / log(e)
    n = np.arange(len(hits))
    checks.true(len(hits) > least, 'almost all impacts are there', (len(hits), least))
    # tolerance: the round-off of the way, 1e-13 m, over the least rate, 1e-5 m/s
    checks.near([event['time'] for event in hits], first + 2 * first * (e - e**(n + 1)) / (1 - e), 1e-9, 'times', scale=10)
    checks.near([event['impulse'] for event in hits], 2 * (1 + e) * G * first * e**n, 1e-8, 'impulses are m (1 + e) u')
    checks.equal([event['kind'] for event in events[len(hits):]], ['close'], 'and then the stop closes')
    checks.near(events[-1]['time'], 8.578949178728887, 1e-10, 'at the end of all flights')
    checks.true(all(event['group'] == 'stop' and event['number'] == 1 for event in events), 'the stop is named')


class FourBar:
    """Uniform rods of 0.2, 0.5 and 0.4 m; the crank turns about (0, 0), the rocker about (0.6, 0)."""
    lengths, masses = (0.2, 0.5, 0.4), (0.2, 0.5, 2.0)

    def angles(self, crank):
        """Of coupler and rocker: the crank pin and the end of the rocker are 0.5 m apart."""
        x, y = 0.2 * cos(crank) - 0.6, 0.2 * sin(crank)
        apart = hypot(x, y)
        rocker = atan2(y, x) - acos((0.4**2 + apart**2 - 0.5**2) / (2 * 0.4 * apart))
        rocker %= 6.283185307179586
        return atan2(0.4 * sin(rocker) - y, 0.4 * cos(rocker) - x), rocker

    def energies(self, crank):
        """Inertia of the crank's coordinate and potential energy."""
        coupler, rocker = self.angles(crank)
        (a, b, c), (m2, m3, m4) = self.lengths, self.masses
        w3 = -a * sin(rocker - crank) / (b * sin(rocker - coupler))
        w4 = a * sin(crank - coupler) / (c * sin(rocker - coupler))
        inertia = m2 * a**2 / 3 + m4 * c**2 / 3 * w4**2 + m3 * (a**2 + b**2 * w3**2 / 3 + a * b * w3 * cos(crank - coupler))
        potential = G * (m2 * a / 2 * sin(crank) + m3 * (a * sin(crank) + b / 2 * sin(coupler)) + m4 * c / 2 * sin(rocker))
        return inertia, potential, w4

    def fall(self, top, bottom, energy):
        """Time from the turning point to the stop: dt = dq sqrt(M/2/(E - V)), with q = top - s^2."""
        nodes, weights = np.polynomial.legendre.leggauss(60)
        end = sqrt(top - bottom)
        total = 0.0
        for s, weight in zip(end * (nodes + 1) / 2, end * weights / 2):
            inertia, potential, _ = self.energies(top - s**2)
            total += weight * 2 * s * sqrt(inertia / (2 * (energy - potential)))
        return total


def bisect(function, low, high):
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if function(low) * function(middle) > 0 else (low, middle)
    return (low + high) / 2


def test_four_bar_stop(checks, mech9d):
    """Times and impulses of the first four impacts by energy: the kinetic energy falls to a quarter at each."""
    events, tolerance = events_of(mech9d, 'four_bar_stop')
    hits = [event for event in events if event['kind'] == 'impact']
    linkage, e = FourBar(), 0.5
    stop = bisect(lambda crank: linkage.angles(crank)[1] - 2.4, 0.5, -1.3)
    inertia, at_stop, w4 = linkage.energies(stop)
    top, time = 0.5, 0.0
    energy = linkage.energies(top)[1]
    for k, hit in enumerate(hits[:4]):
        fall = linkage.fall(top, stop, energy)
        time += fall if k == 0 else 2 * fall
        rate = sqrt(2 * (energy - at_stop) / inertia)
        # tolerance: the errors of all steps, some times greater at later impacts; a short flight is ill conditioned
        checks.near(hit['time'], time, 10 * tolerance, f'time of impact {k + 1}', scale=1)
        # the impulse on the rocker changes the rate of the crank from u to -e u: P dq4/dq1 = M (1 + e) u
        checks.near(hit['impulse'], inertia * (1 + e) * rate / w4, 100 * tolerance, f'impulse {k + 1}', scale=1)
        energy = at_stop + e**2 * (energy - at_stop)
        top = bisect(lambda crank: linkage.energies(crank)[1] - energy, stop, top)
    checks.equal(events[-1]['kind'], 'close', 'the rocker comes to rest')
