"""Contacts that stay closed on paths with corners: motions and derivatives against closed forms in complex numbers, whose derivatives are
exact, and quantities of forces that jump where a ball comes onto a corner.

Compares the program with itself: derivatives of a pendulum on a path against differences of runs; few and many outputs."""
import cmath
from math import cos, pi, sin

import numpy as np
import pytest

from event_derivative_cases import TIGHT, against_differences, go, kinds

SLOPE, LENGTH, RADIUS, G = 0.3, 0.4, 0.5, 9.81
WAY, NORMAL = np.array([cos(SLOPE), sin(SLOPE)]), np.array([-sin(SLOPE), cos(SLOPE)])
DOWN, BEYOND = np.array([cos(SLOPE), -sin(SLOPE)]), np.array([sin(SLOPE), cos(SLOPE)])
ROOF = 'roof.dat'
PARAMETERS = {'vx': 'initial(1).velocity', 'vy': 'initial(2).velocity', 'x': 'initial(1).position', 'y': 'initial(2).position',
              'g': 'gravity(1).acceleration(2)', 'r': 'contact(1).radius', 'ox': 'contact(1).origin(1)', 'oy': 'contact(1).origin(2)',
              'mu': 'contact(1).friction'}


def numbers_of(friction, height=0.01):
    """A ball above the left slope of a roof, that moves along it and falls."""
    start = RADIUS*NORMAL - LENGTH*WAY + np.array([0.0, height])
    return dict(zip(PARAMETERS, [1.9*WAY[0], 1.9*WAY[1], start[0], start[1], -G, RADIUS, 0.0, 0.0, friction]))


def data_file(numbers, names):
    """A particle of 2 kg with a ball that meets the roof."""
    friction = f", friction={numbers['mu']!r}" if numbers['mu'] else ''
    return f"""&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,1,0 /
&body link=3, mass=2 /
&point name='P', link=3 /
&gravity acceleration=0,{numbers['g']!r},0 /
&contact point='P', kind='path', file='{ROOF}', side='left', radius={numbers['r']!r}, origin={numbers['ox']!r},{numbers['oy']!r},0{friction} /
&initial coordinate=1, position={float(numbers['x'])!r}, velocity={float(numbers['vx'])!r} /
&initial coordinate=2, position={float(numbers['y'])!r}, velocity={float(numbers['vy'])!r} /
""" + ''.join(f"&parameter name='{name}', sets='{PARAMETERS[name]}' /\n" for name in names)


def integral(function, low, high):
    """By Gauss's rule, exact to round-off for smooth functions, also for complex ends."""
    x, w = np.polynomial.legendre.leggauss(60)
    return (high - low)/2*np.sum(w*function(low + (high - low)*(x + 1)/2))


class Roof:
    """The motion in closed form: a fall without a rebound, the left slope, the circle about the ridge, and the right slope."""

    def __init__(self, numbers):
        g, r, mu = -numbers['g'], numbers['r'], numbers['mu']
        start = np.array([numbers['x'] - numbers['ox'], numbers['y'] - numbers['oy']])
        v = np.array([numbers['vx'], numbers['vy']])
        gap, rate = start @ NORMAL - r, v @ NORMAL
        a = g*NORMAL[1]
        self.met = (rate + cmath.sqrt(rate**2 + 2*a*gap))/a
        at = start + v*self.met - np.array([0, g])*self.met**2/2
        v = v - np.array([0, g])*self.met
        # friction takes the coefficient times the impulse along the normal
        v1 = v @ WAY + mu*(v @ NORMAL)
        s, self.origin, self.r = at @ WAY, np.array([numbers['ox'], numbers['oy']]), r
        a = -g*sin(SLOPE) - mu*g*cos(SLOPE)
        entry = v1**2 - 2*a*s
        self.onto = self.met + (cmath.sqrt(entry) - v1)/a
        # the square w of the rate about the ridge, by the angle from the vertical: w' - 2 mu w = 2 r g (sin - mu cos)
        b = -2*r*g*(1 - 2*mu**2)/(1 + 4*mu**2)
        c = 2*mu*b - 2*r*g*mu
        c = c if mu else 0.0
        d = (entry - b*cos(SLOPE) + c*sin(SLOPE))*np.exp(2*mu*SLOPE)
        self.w = lambda angle: b*np.cos(angle) + c*np.sin(angle) + d*np.exp(2*mu*angle)
        self.off = self.onto + self.time_on_circle(SLOPE)
        self.leaving, self.a = self.w(SLOPE), g*sin(SLOPE) - mu*g*cos(SLOPE)
        self.g = g

    def time_on_circle(self, angle):
        """From the left slope to an angle."""
        return integral(lambda p: self.r/np.sqrt(self.w(p)), -SLOPE, angle)

    def place(self, t):
        """Position and normal force per mass at a time on the circle or on the right slope."""
        if t > self.off.real:
            tau = t - self.off
            s = cmath.sqrt(self.leaving)*tau + self.a*tau**2/2
            return self.origin + self.r*BEYOND + s*DOWN, self.g*cos(SLOPE)
        angle = 0.0
        for _ in range(40):
            angle = angle - (self.onto + self.time_on_circle(angle) - t)*np.sqrt(self.w(angle))/self.r
        return self.origin + self.r*np.array([np.sin(angle), np.cos(angle)]), self.g*np.cos(angle) - self.w(angle)/self.r


@pytest.fixture
def roof(tmp_path):
    """The path: two slopes and the corner between them."""
    (tmp_path / ROOF).write_text(f'{float(-4*WAY[0])!r} {float(-4*WAY[1])!r}\n0 0\n\n{float(4*DOWN[0])!r} {float(4*DOWN[1])!r}\n',
                                 encoding='utf-8')
    return tmp_path


@pytest.mark.parametrize('friction', [0.0, 0.04])
@pytest.mark.parametrize('way', [1, -1])
def test_over_the_ridge(checks, mech9d, roof, friction, way):
    """A ball slides up a roof, about its ridge and down, in both directions: position and force, with derivatives by all numbers."""
    numbers = numbers_of(friction)
    names = [name for name in PARAMETERS if friction or name != 'mu']
    signs = {name: way if name in ('vx', 'x', 'ox') else 1 for name in PARAMETERS}
    given = data_file({name: signs[name]*number for name, number in numbers.items()}, names)
    motion = Roof(numbers)
    for end in (0.5*(motion.onto + motion.off).real, motion.off.real + 0.2):
        table, report, _ = go(mech9d, roof, given + '&output sensitivities=.true., reactions=.true. /\n' + TIGHT, end=end)
        checks.equal(kinds(report)[:2], [('impact', 1), ('close', 1)], 'it falls onto the roof and stays there')
        at, force = motion.place(end)
        # tolerance: some ten tolerances of the integration over a second
        checks.near(table['q1'][-1], way*at[0].real, 1e-10, 'x')
        checks.near(table['q2'][-1], at[1].real, 1e-10, 'y')
        checks.near(table['K1.fn'][-1], 2*force.real, 1e-9, 'the normal force')
        for name in names:
            at, _ = Roof({**numbers, name: numbers[name] + 1e-30j}).place(end)
            for column, value in (('q1', way*at[0]), ('q2', at[1])):
                # tolerance: derivatives have the error of the motion times their growth
                checks.near(signs[name]*table[f'd({column})/d({name})'][-1], value.imag/1e-30, 1e-8, f'd{column}/d{name} at {end}')


def test_extremes_where_curvature_jumps(checks, mech9d, roof):
    """Force and acceleration are least in the moment in which the ball comes onto the ridge, for few outputs, too: g cos - v^2/r and
    -g sin^2 - v^2 cos/r."""
    start = RADIUS*NORMAL - LENGTH*WAY
    v = 1.85
    numbers = dict(zip(PARAMETERS, [v*WAY[0], v*WAY[1], start[0], start[1], -G, RADIUS, 0.0, 0.0, 0.0]))
    motion = Roof(numbers)
    square = v**2 - 2*G*LENGTH*sin(SLOPE)
    force = 2*(G*cos(SLOPE) - square/RADIUS)
    acceleration = -G*sin(SLOPE)**2 - square*cos(SLOPE)/RADIUS
    # the parameter is the component of gravity, which is negative
    change = sin(SLOPE)**2 - 2*LENGTH*sin(SLOPE)*cos(SLOPE)/RADIUS
    for intervals in (1, 7, 150):
        _, report, _ = go(mech9d, roof, data_file(numbers, ['g']) + "&quantity name='force', of='K1.fn', take='min' /\n"
                          "&quantity name='acceleration', of='ddq2', take='min' /\n&output gradients=.true., reactions=.true. /\n" + TIGHT,
                          end=0.5*(motion.onto + motion.off).real, intervals=intervals)
        found = {one['name']: one for one in report['quantities']}
        # tolerance: the time at which it comes there is exact to 1e-11 s
        checks.near(found['force']['value'], force, 1e-9, f'force with {intervals} outputs')
        checks.near(found['acceleration']['value'], acceleration, 1e-9, f'acceleration with {intervals} outputs')
        # tolerance: slopes in time of accelerations come from differences of rows
        checks.near(found['acceleration']['gradient'][0]['value'], change, 1e-5, f'its derivative by gravity with {intervals} outputs')


# corners of a polygon, its origin, radius of the ball, friction, height of the pair on the frame, lengths of both arms, start
STAYS = ([(0.9*cos(a), 0.9*sin(a)) for a in np.arange(6)*pi/3 + 0.2], '0.02,0.01,0', 0.15, 0.2, 1.9, (0.8, 0.5),
         (-1.0, 0.0, -1.2, 0.3, 0.1, 1.5))
# it leaves a corner and hits another side
LEAVES = ([(0.885, 0.173), (0.462, 0.774), (-0.179, 0.923), (-0.74, 0.521), (-0.856, -0.188), (-0.518, -0.745), (0.181, -0.912),
           (0.719, -0.504)], '0.01,0,0', 0.116, 0.3, 2.1, (0.869, 0.4), (0.423, -0.5, -0.5, 0.2, 0.7, 1.114))


@pytest.mark.parametrize('case, least', [(STAYS, 4), (LEAVES, 4)])
def test_pendulum_over_corners(checks, mech9d, tmp_path, case, least):
    """A disc at the tip of a double pendulum rolls, slides and leaves a polygon that turns: derivatives by all numbers."""
    corners, origin, radius, friction, height, arms, start = case
    lines = [f'{x!r} {y!r}\n' for x, y in corners + corners[:1]]
    (tmp_path / 'polygon.dat').write_text('\n'.join(lines), encoding='utf-8')
    text = f"""&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='revolute', point=0,{height!r},0, axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point={arms[0]!r},0,0, axis=0,0,1 /
&pair coordinate=3, links=1,4, kind='revolute', axis=0,0,1 /
&body link=2, mass=0.4, centre=0.4,0,0, inertia=0,0,0.02,0,0,0 /
&body link=3, mass=0.6, centre=0.3,0,0, inertia=0,0,0.03,0,0,0 /
&body link=4, mass=3, centre=0,0,0, inertia=0,0,1.2,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&load kind='coordinate', coordinate=1, damping=0.3 /
&point name='tip', link=3, position={arms[1]!r},0,0 /
&contact point='tip', link=4, kind='path', file='polygon.dat', radius={radius!r}, origin={origin}, friction={friction!r} /
""" + ''.join(f'&initial coordinate={i + 1}, position={start[2*i]!r}, velocity={start[2*i + 1]!r} /\n' for i in range(3)) + """\
&parameter name='q', sets='initial(1).position' /
&parameter name='w', sets='initial(3).velocity' /
&parameter name='m', sets='body(2).mass' /
&parameter name='l', sets='pair(2).point(1)' /
&parameter name='r', sets='contact(1).radius' /
&parameter name='ox', sets='contact(1).origin(1)' /
&parameter name='mu', sets='contact(1).friction' /
&parameter name='g', sets='gravity(1).acceleration(2)' /
"""
    # derivatives grow to some hundreds: shorter steps
    report = against_differences(checks, mech9d, tmp_path, text, ['q1', 'q3', 'dq2'], 1.2, 3, step=1e-6, tol=2e-6)
    checks.true(len(kinds(report)) >= least, 'the disc meets the polygon', kinds(report))


def test_rest_at_a_corner(checks, mech9d, tmp_path):
    """A ball that creeps onto a corner has no derivatives behind it: the time of the event changes as the inverse of its rate."""
    (tmp_path / ROOF).write_text('-1 0\n0 0\n\n1 -1\n', encoding='utf-8')
    numbers = {**numbers_of(0.0), 'vx': 5e-8, 'vy': 0.0, 'x': -1e-8, 'y': 0.1, 'r': 0.1}
    _, _, told = go(mech9d, tmp_path, data_file(numbers, ['g']) + '&output sensitivities=.true. /\n' + TIGHT, end=1.0, code=6)
    checks.true('derivatives by the parameters do not exist at t = 0.2' in told and
                ' s: the ball of contact 1 comes to rest at a corner or an end of its path. End the run before' in told, told)
