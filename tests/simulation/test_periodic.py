"""Periodic motions against closed forms and independent integrations: linear oscillators and motors, Duffing's equation, the free pendulum
(elliptic integral), van der Pol's equation, Kapitza's pendulum, the period doubling of the driven pendulum, rotations, closed chains; laws
of time and their common periods; refusals.

Compares the program with itself: a four-bar by two independent coordinates, and by its motion after many periods."""
import json

import numpy as np
import pytest

from four_bars import HEAVY_ROCKER
from mech9_cases import read_table, run

TIGHT = '&solver relative_tolerance=1e-12, absolute_tolerance=1e-13 /\n'
SLIDER = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1 /
&initial coordinate=1, position=0.3, velocity=0.4 /
"""
SPRING = "&load kind='coordinate', coordinate=1, stiffness=4, damping=0.3 /\n"
PENDULUM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&body link=2, mass=1, centre=0,-1,0 /
&gravity acceleration=0,-1,0 /
"""
FOUR_BAR = HEAVY_ROCKER + """&load kind='coordinate', coordinate=1, damping=0.05 /
&load kind='coordinate', coordinate=1, force=0.5, law='harmonic', amplitude=1, angular_frequency=5 /
&solver relative_tolerance=1e-10, absolute_tolerance=1e-11 /
"""


def harmonic(frequency, force=1.0):
    """A force on coordinate 1: force cos(frequency t)."""
    return (f"&load kind='coordinate', coordinate=1, force={force!r}, law='harmonic', amplitude=1, angular_frequency={frequency!r}, "
            f"phase={np.pi / 2!r} /\n")


def go(program, folder, text, code=0, *options):
    """The entry of --periodic in the report, the table, and standard error."""
    path, report, table = folder / 'motion.nml', folder / 'motion.json', folder / 'motion.dat'
    path.write_text(text + ('' if '&time' in text else '&time end=5, intervals=40 /\n'), encoding='utf-8')
    done = run(program, path, '--periodic', '--report', report, '--table', table, *options)
    assert done.returncode == code, done.stderr
    if code:
        return None, None, done.stderr
    found = json.loads(report.read_text())
    found['periodic']['all'] = found.get('periodic_motions')
    return found['periodic'], read_table(table.read_text()), done.stderr


def quarter_period(amplitude):
    """The complete elliptic integral of a pendulum, by the arithmetic-geometric mean."""
    a, b = np.longdouble(1), np.cos(np.longdouble(amplitude) / 2)
    for _ in range(8):
        a, b = (a + b) / 2, np.sqrt(a * b)
    return float(np.pi / 2 / a)


def multipliers(found):
    """The multipliers as complex numbers."""
    return np.array([complex(*pair) for pair in found['multipliers']])


def parts(numbers):
    """Real and imaginary parts of complex numbers, in order."""
    ordered = np.sort_complex(numbers)
    return np.array([ordered.real, ordered.imag])


def test_a_linear_oscillator(checks, mech9d, tmp_path):
    """x'' + 0.3 x' + 4 x = cos 1.5 t: the multipliers are exp(root T), the motion is that of the amplitude response."""
    found, table, said = go(mech9d, tmp_path, SLIDER + SPRING + harmonic(1.5) + TIGHT)
    period = 2 * np.pi / 1.5
    roots = np.roots([1, 0.3, 4])
    checks.near(found['period'], period, 1e-15, 'the period is that of the force')
    # tolerance: some hundred steps of 1e-12
    checks.near(parts(multipliers(found)), parts(np.exp(roots * period)), 1e-10, 'multipliers', scale=1)
    checks.near([found['product'], found['product_by_divergence']], np.exp(-0.3 * period), 1e-10, 'their product', scale=1)
    response = 1 / (4 - 1.5**2 + 0.3j * 1.5)
    exact = response * np.exp(1.5j * table['t'])
    checks.near(table['q1'], exact.real, 1e-10, 'positions', scale=1)
    checks.near(table['dq1'], (1.5j * exact).real, 1e-10, 'rates', scale=1)
    checks.near([table['t'][0], table['t'][-1]], [0, period], 1e-15, 'one period, from the start of &time', scale=1)
    checks.true(found['stability'] == 'stable' and 'stable' in said and not found['trivial'], 'it is stable')
    checks.true(max(map(abs, found['residual'])) < 1e-10, 'both ends agree')


def test_a_later_start_and_units(checks, mech9d, tmp_path):
    """The period begins at the start of &time; millimetres; twice the period is told, with the squares of the multipliers."""
    text = SLIDER.replace('position=0.3, velocity=0.4', 'position=300, velocity=400') + "&mechanism length_unit='mm' /\n"
    text += SPRING.replace('stiffness=4, damping=0.3', 'stiffness=0.004, damping=0.0003')
    found, table, said = go(mech9d, tmp_path, text + harmonic(1.5) + TIGHT + '&time start=0.7, end=3 /\n&periodic period=8.37758041 /\n')
    period = 2 * np.pi / 1.5
    exact = 1000 / (4 - 1.5**2 + 0.3j * 1.5) * np.exp(1.5j * table['t'])
    checks.near(table['q1'], exact.real, 1e-8, 'positions in mm', scale=1000)
    checks.near([table['t'][0], table['t'][-1]], [0.7, 0.7 + 2 * period], 1e-14, 'its times', scale=1)
    checks.near(found['start'], exact.real[0], 1e-8, 'the start in mm', scale=1000)
    checks.near([found['period'], found['repeats_after']], [2 * period, period], 1e-14, 'the exact multiple, and the least period')
    checks.true('repeats already after' in said, 'it is told', said)
    checks.near(np.prod(multipliers(found)).real, np.exp(-0.6 * period), 1e-10, 'multipliers of two periods', scale=1)


def test_a_motor(checks, mech9d, tmp_path):
    """A motor with inductance at a voltage cos 2t on a slider with a spring: three states, three roots, the complex response."""
    text = SLIDER + SPRING + ("&motor coordinate=1, kind='dc', law='harmonic', amplitude=1, angular_frequency=2, phase=1.5707963267948966, "
                              "resistance=2, inductance=0.5, constant=0.7 /\n")
    found, table, _ = go(mech9d, tmp_path, text + TIGHT)
    # x'' = -4 x - 0.3 x' + 0.7 i, 0.5 i' = cos 2t - 2 i - 0.7 x'
    a = np.array([[0, 1, 0], [-4, -0.3, 0.7], [0, -1.4, -4]])
    period = np.pi
    checks.near(parts(multipliers(found)), parts(np.exp(np.linalg.eigvals(a) * period)), 1e-9, 'multipliers', scale=1)
    response = np.linalg.solve(2j * np.eye(3) - a, [0, 0, 2])
    exact = response[:, None] * np.exp(2j * table['t'])
    checks.near([table['q1'], table['dq1']], exact.real[:2], 1e-9, 'motion', scale=1)
    current = next(name for name in table if name not in ('t', 'q1', 'dq1', 'ddq1') and np.allclose(table[name], exact.real[2], atol=1e-6))
    checks.near(table[current], exact.real[2], 1e-9, 'the current begins with its value', scale=1)


def duffing(x, v, frequency, steps):
    """x'' + 0.2 x' + x + x^3 = 0.9 cos(frequency t) over a period in extended precision, with its derivatives by the start: Runge's method."""
    real = np.longdouble
    y = np.array([x, v, 1, 0, 0, 1], real)
    h = 2 * np.pi / real(frequency) / steps

    def rate(t, y):
        stiffness = -1 - 3 * y[0]**2
        return np.array([y[1], -real('0.2') * y[1] - y[0] - y[0]**3 + real('0.9') * np.cos(frequency * t), y[3],
                         stiffness * y[2] - real('0.2') * y[3], y[5], stiffness * y[4] - real('0.2') * y[5]])
    for i in range(steps):
        t = i * h
        a = rate(t, y)
        b = rate(t + h / 2, y + h / 2 * a)
        c = rate(t + h / 2, y + h / 2 * b)
        y = y + h / 6 * (a + 2 * b + 2 * c + rate(t + h, y + h * c))
    return y


def test_duffing(checks, mech9d, tmp_path):
    """A hardening spring where three motions exist: two stable and one unstable, found from random starts; starts and multipliers as an
    independent shooting has them."""
    text = SLIDER + "&load kind='coordinate', coordinate=1, stiffness=1, damping=0.2 /\n"
    text += "&load kind='coordinate', coordinate=1, stiffness=1, law='polynomial', coefficients=0,0,1, over='q1' /\n"
    found, _, said = go(mech9d, tmp_path, text + harmonic(2.0, 0.9) + TIGHT + '&periodic starts=20 /\n')
    checks.equal(sorted(motion['stability'] for motion in found['all']), ['stable', 'stable', 'unstable'], 'three motions')
    checks.true('3 periodic motions from 21 starts' in said, 'and their number', said)
    for motion in found['all']:
        x, v = motion['start'][0], motion['start_rates'][0]
        for _ in range(3):
            # Richardson's extrapolation
            y = (16 * duffing(x, v, 2.0, 800) - duffing(x, v, 2.0, 400)) / 15
            monodromy = y[2:].reshape(2, 2).T.astype(float)
            dx, dv = np.linalg.solve(monodromy - np.eye(2), -(y[:2] - [x, v]).astype(float))
            x, v = x + dx, v + dv
        checks.near([motion['start'][0], motion['start_rates'][0]], [x, v], 1e-9, 'the start', scale=1)
        checks.near(parts(multipliers(motion)), parts(np.linalg.eigvals(monodromy)), 1e-8, 'multipliers', scale=1)
        checks.near(motion['product'], np.exp(-0.2 * np.pi), 1e-10, 'their product', scale=1)


def test_a_free_pendulum(checks, mech9d, tmp_path):
    """Without losses a family of motions: the one through the start, whose period is the elliptic integral; multipliers 1 and 1."""
    text = PENDULUM + '&initial coordinate=1, position=2 /\n&periodic period=7 /\n' + TIGHT
    found, table, said = go(mech9d, tmp_path, text)
    amplitude = table['q1'][0]
    checks.near(amplitude, 2, 1e-4, 'the energy of the start')
    checks.near(found['period'], 4 * quarter_period(amplitude), 1e-11, 'the elliptic integral')
    # a double root is known by the square root of the errors
    checks.near(parts(multipliers(found)), [[1, 1], [0, 0]], 1e-4, 'multipliers', scale=1)
    checks.near(found['product'], 1, 1e-10, 'their product')
    checks.true(found['stability'] == 'neutral' and 'family of motions' in said, 'neither stable nor unstable', said)


def test_a_crank_in_a_closed_chain_comes_back_by_whole_turns(checks, mech9d, tmp_path):
    """Gravity along its axis and a torque that falls with its speed leave the angle of a crank out of all forces. Its chain does not: the
    period is one turn. In it the torque does no work."""
    torque, damping = 1.0, 0.1
    text = '&structure cq=1 /\n' + HEAVY_ROCKER.replace('0,-9.81,0', '0,0,-9.81') + '&initial coordinate=1, position=0.5, velocity=10 /\n'
    text += f"&load kind='coordinate', coordinate=1, force={torque!r}, damping={damping!r} /\n&periodic period=0.6 /\n" + TIGHT
    found, table, _ = go(mech9d, tmp_path, text + '&time end=1, intervals=400 /\n')
    checks.true('advance' not in found, 'no coordinate goes on by any amount', found.get('advance'))
    checks.equal(found['turns'][0], 1, 'one turn')
    # the trapezoidal rule of a periodic function
    checks.near(damping * np.mean(table['dq1'][:-1]**2) * found['period'], torque * 2 * np.pi, 1e-9, 'the work of damper and torque')


def test_van_der_pol(checks, mech9d, tmp_path):
    """The limit cycle for mu = 1 from far away: its period, and the multiplier exp(integral of the divergence)."""
    text = SLIDER.replace('0.3, velocity=0.4', '0.5') + "&load kind='coordinate', coordinate=1, stiffness=1 /\n"
    text += "&load kind='coordinate', coordinate=1, damping=-1, law='polynomial', coefficients=1,0,-1, over='q1' /\n"
    found, table, _ = go(mech9d, tmp_path, text + '&periodic period=6 /\n' + TIGHT + '&time end=1, intervals=400 /\n')
    checks.near(found['period'], 6.6632868593231301896996820305, 1e-12, 'the period')
    # the trapezoidal rule of a periodic function
    divergence = np.mean(1 - table['q1'][:-1]**2) * found['period']
    checks.near(found['multipliers'], [[1, 0], [np.exp(divergence), 0]], 1e-10, 'multipliers', scale=1)
    checks.near(found['product_by_divergence'], np.exp(divergence), 1e-9, 'the divergence')
    checks.equal(found['stability'], 'stable', 'stable')
    back, _, _ = go(mech9d, tmp_path, text.replace('damping=-1', 'damping=1').replace('position=0.5', 'position=2.0') + '&periodic period=6 /\n' + TIGHT)
    checks.near(back['period'], 6.66328685932313, 1e-11, 'back in time the same cycle')
    checks.near(back['multipliers'][0][0] * np.exp(divergence), 1, 1e-7, 'is unstable')
    checks.equal(back['stability'], 'unstable', 'unstable')


def kapitza(frequency):
    """A pendulum of 1 m on a pivot that moves by 0.1 m, near the top."""
    return ("&structure cq=1,2 /\n&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /\n"
            "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /\n"
            f"&drive coordinate=1, kind='harmonic', amplitude=0.1, angular_frequency={frequency!r}, phase=1.5707963267948966 /\n"
            '&body link=3, mass=1, centre=0,-1,0 /\n&gravity acceleration=0,-9.81,0 /\n'
            f'&initial coordinate=2, position={np.pi!r} /\n' + TIGHT)


def test_kapitza(checks, mech9d, tmp_path):
    """The top is unstable below W = 44.39079478 and stable above: the multipliers meet at 1 there."""
    below, _, said = go(mech9d, tmp_path, kapitza(44.3))
    checks.true(below['multipliers'][0][0] > 1.001 and 'beyond 1' in said, 'unstable below', said)
    above, _, _ = go(mech9d, tmp_path, kapitza(44.5))
    checks.near(np.abs(multipliers(above)), 1, 1e-10, 'on the unit circle above')
    checks.true(above['multipliers'][0][1] > 0.001 and above['stability'] == 'neutral', 'as a pair')
    traces = [multipliers(go(mech9d, tmp_path, kapitza(44.39079478 + d))[0]).sum().real - 2 for d in (-1e-6, 1e-6)]
    root = 44.39079478 - 1e-6 - 2e-6 * traces[0] / (traces[1] - traces[0])
    # tolerance: the digits of the reference
    checks.near(root, 44.39079478, 5e-9, 'the boundary', scale=1)


def test_all_positions_of_kapitza(checks, mech9d, tmp_path):
    """At 60 rad/s with damping: top and bottom are stable, and two positions between them are not, as mirror images. The mean over the fast
    motion has them at cos q = -2 g l/(a W)^2, to the square of a/l."""
    text = kapitza(60.0) + "&load kind='coordinate', coordinate=2, damping=0.1 /\n&periodic starts=20 /\n"
    found, _, _ = go(mech9d, tmp_path, text)
    starts = sorted((motion['start'][1] % (2 * np.pi), motion['stability']) for motion in found['all'])
    checks.equal([stability for _, stability in starts], ['stable', 'unstable', 'stable', 'unstable'], 'four positions')
    checks.near([starts[0][0], starts[2][0]], [0, np.pi], 1e-10, 'bottom and top', scale=1)
    checks.near(starts[1][0] + starts[3][0], 2 * np.pi, 1e-9, 'mirror images', scale=1)
    checks.near(np.cos(starts[1][0] + 0.1 * np.sin(starts[1][0])), -2 * 9.81 / 36, 0.01, 'about the estimate', scale=1)
    for motion in found['all']:
        checks.near(motion['product'], np.exp(-0.1 * motion['period']), 1e-10, 'the product', scale=1)


def test_period_doubling(checks, mech9d, tmp_path):
    """The driven pendulum of Baker and Gollub: a multiplier passes -1 at g = 1.066372862455."""
    text = PENDULUM + "&load kind='coordinate', coordinate=1, damping=0.5 /\n&initial coordinate=1, position=0.2 /\n" + TIGHT
    values = []
    for force in (1.066372862455 - 1e-7, 1.066372862455, 1.066372862455 + 1e-7):
        found, _, said = go(mech9d, tmp_path, text + harmonic(0.6666666666666666, force))
        values.append(found['multipliers'][0][0] + 1)
        checks.near(found['product'], np.exp(-1.5 * np.pi), 1e-9, 'the product', scale=1)
    # tolerance: the digits of the reference
    slope = (values[2] - values[0]) / 2e-7
    checks.true(abs(values[1] / slope) < 2e-12, 'the force at which it is -1', (values, slope))
    checks.true(values[0] > 0 > values[2] and 'beyond -1' in said, 'stable before, then it alternates', values)


def test_rotations(checks, mech9d, tmp_path):
    """A pendulum that a constant torque turns: it comes back but for a turn; where a spring winds up it does not."""
    text = PENDULUM + "&load kind='coordinate', coordinate=1, damping=0.5 /\n&load kind='coordinate', coordinate=1, force=2 /\n"
    text += '&initial coordinate=1, position=0, velocity=3 /\n&periodic period=1.5 /\n' + TIGHT
    found, table, said = go(mech9d, tmp_path, text)
    checks.equal(found['turns'], [1], 'turns')
    checks.true('turns by 1 whole turn' in said, 'they are told', said)
    checks.near(table['q1'][-1] - table['q1'][0], 2 * np.pi, 1e-10, 'the table has the turn')
    checks.near(found['multipliers'], [[1, 0], [np.exp(-0.5 * found['period']), 0]], 1e-10, 'multipliers', scale=1)
    # over a period: the trapezoidal rule of a periodic function
    checks.near(0.5 * np.mean(table['dq1'][:-1]**2) * found['period'], 2 * 2 * np.pi, 1e-10, 'the torque makes up for the damper')
    wound = text.replace('force=2 ', 'force=0.1 ') + "&load kind='coordinate', coordinate=1, stiffness=1e-5 /\n"
    _, _, said = go(mech9d, tmp_path, wound.replace('damping=0.5', 'damping=0.02').replace('velocity=3', 'velocity=5'), 5)
    checks.true('comes back but for whole turns, and forces differ there' in said, 'a spring that winds up', said)


def test_an_equilibrium(checks, mech9d, tmp_path):
    """A damped pendulum at rest is a trivial periodic motion: it is told, with the multipliers of the time that was given."""
    text = PENDULUM + "&load kind='coordinate', coordinate=1, damping=0.5 /\n&initial coordinate=1, position=0.1 /\n&periodic period=3 /\n"
    found, _, said = go(mech9d, tmp_path, text + TIGHT)
    checks.true(found['trivial'] and 'equilibrium' in said, 'it is told', said)
    checks.near(found['start'], [0], 1e-9, 'it hangs', scale=1)
    exact = np.exp(np.roots([1, 0.5, 1]) * found['period'])
    checks.near(parts(multipliers(found)), parts(exact), 1e-9, 'multipliers', scale=1)


def test_a_closed_chain(checks, mech9d, tmp_path):
    """A driven four-bar by its crank, and by its rocker through a change of coordinates: the same multipliers, whose product is that of the
    divergence; its motion after many periods leads there."""
    crank = '&structure cq=1 /\n&initial coordinate=1, position=0.5, velocity=1 /\n&initial coordinate=4, position=1.7 /\n' + FOUR_BAR
    found, table, _ = go(mech9d, tmp_path, crank)
    rocker = ('&structure cq=4 /\n&initial coordinate=4, position=2.6179938779914944, velocity=0 /\n&initial coordinate=1, position=0.5 /\n'
              + FOUR_BAR)
    again, other, said = go(mech9d, tmp_path, rocker)
    checks.true('independent coordinates are now' in said, 'the independent coordinates change', said)
    checks.near(parts(multipliers(again)), parts(multipliers(found)), 1e-9, 'the same multipliers', scale=1)
    checks.near(other['q4'], table['q4'], 1e-8, 'and motion', scale=1)
    checks.near([found['product'], again['product']], [found['product_by_divergence'], again['product_by_divergence']], 1e-9,
                'the divergence', scale=1)
    (tmp_path / 'long.nml').write_text(crank + f'&time end={40 * found["period"]!r}, intervals=40 /\n', encoding='utf-8')
    done = run(mech9d, tmp_path / 'long.nml', '--table', tmp_path / 'long.dat')
    checks.equal(done.returncode, 0, 'the motion')
    long = read_table((tmp_path / 'long.dat').read_text())
    checks.near([long['dq1'][-1], np.cos(long['q1'][-1])], [table['dq1'][0], np.cos(table['q1'][0])], 1e-7, 'leads there', scale=1)


def test_impacts(checks, mech9d, tmp_path):
    """x'' + 0.2 x' + x = cos 2.5 t above a stop at 0 with e = 0.8: with one impact in n periods the product of the multipliers is
    e^2 exp(-0.2 T), whatever the motion."""
    text = SLIDER.replace('stiffness', '') + ("&load kind='coordinate', coordinate=1, stiffness=1, damping=0.2 /\n"
                                              '&stop coordinate=1, low=0, restitution=0.8 /\n') + harmonic(2.5) + TIGHT
    for n in (1, 2, 3):
        period = n * 2 * np.pi / 2.5
        found, table, _ = go(mech9d, tmp_path, text + f'&periodic period={period!r}, starts=6 /\n')
        for motion in found['all']:
            checks.near(motion['product'], motion['product_by_divergence'], 1e-8, 'both products', scale=1)
            impacts = np.log(motion['product'] / np.exp(-0.2 * period)) / np.log(0.8**2)
            checks.near(impacts, round(impacts), 1e-6, 'a whole number of impacts, each of which counts e^2', scale=1)
        checks.true(table['q1'].min() > -1e-9, 'above the stop')


def test_rest_on_a_stop(checks, mech9d, tmp_path):
    """A force lifts a body that falls back and comes to rest: nothing of a deviation is left after a period."""
    text = ("&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /\n&body link=2, mass=1 /\n"
            '&gravity acceleration=0,-9.81,0 /\n&initial coordinate=1, position=0.05 /\n&stop coordinate=1, low=0, restitution=0.3 /\n')
    found, table, said = go(mech9d, tmp_path, text + harmonic(2.5, 12.0).replace(repr(np.pi / 2), '0'))
    checks.equal((found['multipliers'], found['stability'], found['start']), ([[0, 0], [0, 0]], 'stable', [0]), 'multipliers are zero')
    checks.true('stop 1 opens' in said and table['q1'].max() > 0.1, 'it is lifted', said)


def test_bouncing_ends_within_the_search(checks, mech9d, tmp_path):
    """A slider that nothing drives bounces lower after each guess, until it rests: rebounds that round-off keeps alive must end."""
    text = ("&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /\n&body link=2, mass=2 /\n"
            '&gravity acceleration=0,-9.81,0 /\n&initial coordinate=1, position=1 /\n&stop coordinate=1, low=0, restitution=0.9 /\n'
            '&solver relative_tolerance=1e-10, absolute_tolerance=1e-12 /\n&periodic period=0.1 /\n')
    found, table, said = go(mech9d, tmp_path, text)
    checks.equal((found['multipliers'], found['stability'], found['start']), ([[0, 0], [0, 0]], 'stable', [0]), 'it rests')
    checks.true('equilibrium' in said and abs(table['q1']).max() == 0, 'on its stop', said)


def after_a_period(state, force, frequency, coefficient):
    """State of a unit mass on a unit spring with dry friction after a period of its force, piece by piece in closed form."""
    x, v = state
    t, end, part = 0.0, 2*np.pi/frequency, force/(1 - frequency**2)

    def first_root(function):
        """The first time behind t at which a function that is negative there is zero, or the end."""
        times = np.linspace(t + 1e-9, end, 20001)
        above = np.nonzero(function(times) > 0)[0]
        if len(above) == 0:
            return end
        low, high = times[max(above[0] - 1, 0)], times[above[0]]
        for _ in range(60):
            middle = (low + high)/2
            low, high = (low, middle) if function(middle) > 0 else (middle, high)
        return high

    sticks = False
    while t < end:
        if sticks:
            held = x
            t = first_root(lambda u: np.abs(force*np.cos(frequency*u) - held) - coefficient)
            sticks, v = False, 0.0
            continue
        push = force*np.cos(frequency*t) - x
        sign = np.sign(v) if v != 0 else np.sign(push)
        a, b = x - part*np.cos(frequency*t) + sign*coefficient, v + part*frequency*np.sin(frequency*t)

        def place(u):
            return a*np.cos(u - t) + b*np.sin(u - t) + part*np.cos(frequency*u) - sign*coefficient

        def rate(u):
            return -a*np.sin(u - t) + b*np.cos(u - t) - part*frequency*np.sin(frequency*u)

        found = first_root(lambda u: -sign*rate(u))
        x, v, t = place(found), rate(found) if found == end else 0.0, found
        sticks = t < end and abs(force*np.cos(frequency*t) - x) < coefficient
    return np.array([x, v])


@pytest.mark.parametrize('frequency, coefficient, kinds', ((1.3, 0.2, {'slip'}), (0.5, 0.6, {'stick', 'slip'})))
def test_dry_friction(checks, mech9d, tmp_path, frequency, coefficient, kinds):
    """A block on a spring with dry friction, which only turns back, or sticks twice in a period: a multiplier is zero then."""
    text = (SLIDER + '&gravity acceleration=0,-1,0 /\n' + SPRING.replace('stiffness=4, damping=0.3', 'stiffness=1') + harmonic(frequency) +
            f'&friction coordinate=1, dynamic={coefficient} /\n' + TIGHT)
    found, rows, said = go(mech9d, tmp_path, text)
    checks.true(all(f'friction 1 {kind}' in said for kind in kinds) and ('stick' in kinds or 'sticks' not in said), 'how it moves', said)
    start = np.array([found['start'][0], found['start_rates'][0]])
    checks.near(after_a_period(start, 1.0, frequency, coefficient), start, 1e-9, 'the motion repeats')
    # central differences, which err by some 1e-8
    h = 1e-5
    slopes = np.column_stack([(after_a_period(start + h*e, 1.0, frequency, coefficient) -
                               after_a_period(start - h*e, 1.0, frequency, coefficient))/(2*h) for e in np.eye(2)])
    expected = sorted(np.linalg.eigvals(slopes), key=lambda one: (-abs(one), one.imag))
    multipliers = sorted((complex(*one) for one in found['multipliers']), key=lambda one: (-abs(one), one.imag))
    checks.near([[one.real, one.imag] for one in multipliers], [[one.real, one.imag] for one in expected], 1e-6, 'the multipliers')
    checks.near(rows['q1'][-1], rows['q1'][0], 1e-11, 'the table holds a period')


def test_parting_neighbours(checks, mech9d, tmp_path):
    """A motion whose ends cannot be brought together within round-off is refused, not told."""
    text = SLIDER + "&load kind='coordinate', coordinate=1, stiffness=-100 /\n" + harmonic(0.5)
    _, _, said = go(mech9d, tmp_path, text, 5)
    checks.true('no periodic motion was found' in said, 'a period of 125 growth times', said)


def test_periods_of_laws(checks, mech9d, tmp_path):
    """The least common period of several laws; a drive at a constant rate; one that goes on by a quarter of a turn."""
    found, _, _ = go(mech9d, tmp_path, SLIDER + SPRING + harmonic(1.5) + harmonic(2.5, 0.3))
    checks.near(found['period'], 2 * np.pi / 0.5, 1e-14, 'of 1.5 and 2.5 rad/s')
    turning = ("&structure cq=1,2 /\n&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /\n"
               "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0 /\n"
               '&body link=3, mass=1, centre=0.6,0,0 /\n&gravity acceleration=0,-1,0 /\n&initial coordinate=2, position=1 /\n'
               "&load kind='coordinate', coordinate=2, damping=2 /\n")
    found, _, said = go(mech9d, tmp_path, turning + "&drive coordinate=1, kind='polynomial', coefficients=0,-4 /\n")
    checks.near(found['period'], np.pi / 2, 1e-14, 'a turn of the drive')
    checks.true(found['turns'][0] == -1 and 'backwards' in said, 'which is told', said)
    found, _, _ = go(mech9d, tmp_path, turning + "&drive coordinate=1, kind='segments', times=0,1,2, values=0,1.5707963267948966,"
                     "1.5707963267948966, laws='cycloidal','dwell', period=2 /\n")
    checks.near(found['period'], 8, 1e-14, 'four steps of an indexing drive')


@pytest.mark.parametrize('text, code, message', [
    (SLIDER + SPRING, 3, 'give a guess for it by period= in &periodic'),
    (SLIDER + SPRING + harmonic(1.5) + '&periodic period=5 /\n', 3, 'is no multiple of the common period 4.188790205 s of these: load 2'),
    (SLIDER + SPRING + harmonic(1.5) + harmonic(2.1213203435596424), 3, 'have no common multiple: load 2 (4.188790205 s), load 3'),
    (SLIDER + SPRING + "&load kind='coordinate', coordinate=1, force=1, law='polynomial', coefficients=0,1 /\n", 3, 'never has the same course'),
    (SLIDER.replace('&initial coordinate=1, position=0.3, velocity=0.4 /', "&drive coordinate=1, kind='harmonic', amplitude=1, angular_frequency=1 /"),
     3, 'every independent coordinate is driven'),
    (SLIDER + "&load kind='coordinate', coordinate=1, force=1 /\n" + harmonic(1.5), 5,
     'no periodic motion was found near the start: after'),
    (SLIDER + SPRING + harmonic(1.5) + "&parameter name='m', sets='body(1).mass' /\n&output sensitivities=.true. /\n", 3,
     'derivatives by parameters are not known for periodic motions')])
def test_refusals(checks, mech9d, tmp_path, text, code, message):
    """Refusals where no motion is periodic, or none is known, with the reason."""
    _, _, said = go(mech9d, tmp_path, text, code)
    checks.true(message in said, message, said)


def test_options(checks, mech9d, mech9k, tmp_path):
    """Options that are another task are refused; those of a run have their meaning; mech9k has none."""
    (tmp_path / 'm.nml').write_text(SLIDER + SPRING + harmonic(1.5) + '&time end=3 /\n', encoding='utf-8')
    for option in (('--exponents', '1'), ('--equilibrium',), ('--check',), ('--study',), ('--optimize',), ('--modes',)):
        done = run(mech9d, 'm.nml', '--periodic', *option, folder=tmp_path)
        checks.true(done.returncode == 2 and '--periodic' in done.stderr, option[0], done.stderr)
    checks.equal(run(mech9k, 'm.nml', '--periodic', folder=tmp_path).returncode, 2, 'mech9k has no periodic motions')
    done = run(mech9d, 'm.nml', '--periodic', '--hdf5', 'm.h5', '--plot', 'q1:dq1', folder=tmp_path)
    checks.true(done.returncode == 0 and (tmp_path / 'm.h5').exists(), 'files of a run', done.stderr)
