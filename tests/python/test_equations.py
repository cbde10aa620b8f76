"""Equations of motion as a function, against closed forms; exact derivatives against those of the closed forms by complex steps (no
differences): a driven pendulum with a clock, Kapitza's pendulum over its frequency, a slider-crank over its crank, a truss in mm and
degrees. What is refused."""
import numpy as np
import pytest

import branch_cases

# a pendulum of 1 kg at 1 m, damped, under the torque g sin(0.7 t)
PENDULUM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0.2, velocity=0.5 /
&body link=2, mass=1, centre=0,-1,0 /
&gravity acceleration=0,-1,0 /
&load kind='coordinate', coordinate=1, damping=0.5 /
&load kind='coordinate', coordinate=1, force=1.0, law='harmonic', amplitude=1, angular_frequency=0.7 /
&parameter name='g', sets='load(2).force', value=1.1 /
&parameter name='w', sets='load(2).angular_frequency', value=0.7 /
&time start=2, end=10, intervals=10 /
"""
# the pivot of a pendulum of 1 m moves up and down: 0.1 cos(W t); the angle q2 counts from below
KAPITZA = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&body link=3, mass=2, centre=0,-1,0 /
&gravity acceleration=0,-9.81,0 /
&drive coordinate=1, kind='harmonic', amplitude=0.1, angular_frequency=50, phase=1.5707963267948966 /
&load kind='coordinate', coordinate=2, damping=0.3 /
&parameter name='W', sets='drive(1).angular_frequency', value=50 /
&initial coordinate=2, position=2.8 /
&time end=1, intervals=10 /
"""
# crank r from the origin, rod of 0.5 m, slider of 2 kg on x with a spring of 100 N/m and a damper of 3 N s/m; the crank has 0.01 kg m2
CRANK = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.2,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0.7,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0 /
&initial coordinate=1, position=0.6 /
&body link=2, mass=0, inertia=0,0,0.01,0,0,0 /
&body link=4, mass=2 /
&load kind='coordinate', coordinate=4, stiffness=100, damping=3 /
&parameter name='r', sets='pair(2).point(1)','pair(3).point(1)', terms=0,0.5, value=0.2 /
&time end=1, intervals=10 /
"""
TRUSS = branch_cases.TRUSS + """&parameter name='F', sets='load(2).force(2)', factors=-1, value=0, low=-8, high=8 /
&initial coordinate=1, position=-10 /
&time end=1, intervals=10 /
"""


def pendulum(x, p, t):
    """The accelerations of the first text."""
    return [-np.sin(x[0]) - 0.5*x[1] + p[0]*np.sin(p[1]*t)]


def kapitza(x, p, t):
    """The accelerations of the second text."""
    return [-(9.81 - 0.1*p[0]**2*np.cos(p[0]*t))*np.sin(x[0]) - 0.15*x[1]]


def crank(x, p, t):
    """The accelerations of the third text: its slider lies at r cos q + sqrt(l^2 - r^2 sin^2 q)."""
    r, (q, w) = p[0], x
    s, c = np.sin(q), np.cos(q)
    rod = np.sqrt(0.25 - r**2*s**2)
    first = -r*s - r**2*s*c/rod
    second = -r*c - r**2*(c**2 - s**2)/rod - r**4*s**2*c**2/rod**3
    spring = -100*(r*c + rod - r - 0.5) - 3*first*w
    return [(first*spring - 2*first*second*w**2)/(0.01 + 2*first**2)]


def truss(x, p, t):
    """The accelerations of the fourth text: y = 0.8 tan of the bar's angle."""
    angle, w = np.arctan(0.75) + x[0], x[1]
    cosine = np.cos(angle)
    stretch, stretching = 0.8/cosine - 1, 0.8*np.sin(angle)/cosine**2*w
    force = -(100*stretch + 0.5*stretching)*np.sin(angle) - p[0]
    return [(force - 1.6*w**2*np.tan(angle)/cosine**2)*cosine**2/0.8]


CASES = {'pendulum': (PENDULUM, pendulum), 'kapitza': (KAPITZA, kapitza), 'crank': (CRANK, crank), 'truss': (TRUSS, truss)}


def exact(function, x, p, t):
    """The rates of a state, and their derivatives by the state, the parameters and time, by complex steps of 1e-30."""
    def f(z):
        m = len(x)
        return np.array([*z[m//2:m], *function(z[:m], z[m:-1], z[-1])])
    z = np.array([*x, *p, t], dtype=complex)
    slopes = np.array([f(z + 1e-30j*unit).imag/1e-30 for unit in np.eye(len(z))]).T
    return f(z).real, slopes[:, :len(x)], slopes[:, len(x):-1], slopes[:, -1]


@pytest.mark.parametrize('name', CASES)
def test_closed_forms(checks, mech9, name):
    """Rates and derivatives at several states and values of the parameters, in an order that jumps."""
    text, function = CASES[name]
    equations = mech9.read_text(text).equations()
    random = np.random.default_rng(1)
    for t in (0.0, 0.3, 2.1):
        x = equations.start + random.uniform(-0.3, 0.3, 2)
        p = equations.values*random.uniform(0.9, 1.1, len(equations.values))
        f, by_state, by_parameters, _ = exact(function, x, p, t)
        # tolerance: a hundred units of round-off of terms that cancel, in parts of the largest
        checks.near(equations(x, p, t), f, 1e-13, f'{name}: rates', scale=abs(f).max())
        found = equations.jacobian(x, p, t)
        checks.near(found[0], by_state, 1e-12, f'{name}: by the state', scale=abs(by_state).max())
        checks.near(found[1], by_parameters, 1e-12, f'{name}: by the parameters', scale=max(1, abs(by_parameters).max()))
    checks.near(equations(equations.start), exact(function, equations.start, equations.values, 0)[0], 1e-12, f'{name}: the values of the file',
                scale=10)


@pytest.mark.parametrize('name', ('pendulum', 'kapitza'))
def test_clock(checks, mech9, name):
    """The phase in place of time: on the unit circle all is as at the time of the phase, whose period follows the parameters."""
    text, function = CASES[name]
    equations = mech9.read_text(text).equations(clock=True)
    n = len(equations.names) - 2
    checks.equal(equations.names[n:], ('cosine', 'sine'), 'the names of the clock')
    start = 2.0 if name == 'pendulum' else 0.0
    for phase, factor in ((0.4, 1.0), (-2.5, 1.05)):
        p = equations.values*factor
        w = p[-1]
        x = np.array([*(equations.start[:n] + 0.1), np.cos(phase), np.sin(phase)])
        f, by_state, by_parameters, by_time = exact(function, x[:n], p, start + phase/w)
        checks.near(equations(x, p), [*f, -w*np.sin(phase), w*np.cos(phase)], 1e-12, f'{name}: rates', scale=max(w, abs(f).max()))
        found, found_p = equations.jacobian(x, p)
        checks.near(found[:n, :n], by_state, 1e-12, f'{name}: by the state', scale=abs(by_state).max())
        # differences in time are known to 1e-10
        scale = abs(by_time).max()/w
        checks.near(found[:n, n:], np.outer(by_time/w, [-np.sin(phase), np.cos(phase)]), 1e-9, f'{name}: by the clock', scale=scale)
        by_parameters[:, -1] -= by_time*phase/w**2
        checks.near(found_p[:n], by_parameters, 1e-8, f'{name}: by the parameters', scale=abs(by_parameters).max())
        checks.near(found_p[n:, -1], [-np.sin(phase), np.cos(phase)], 1e-8, f'{name}: the clock by the frequency', scale=1)
        # the radius comes back to 1 by exp(-2 w t/2 pi)
        checks.near(found[n:, n:] @ x[n:], np.array([-np.sin(phase), np.cos(phase)])*w - x[n:]*2*w/(2*np.pi), 1e-12, f'{name}: radius', scale=w)


def test_words(checks, mech9):
    """Names, units, another start of the chains, and wrong calls."""
    m = mech9.read_text(TRUSS)
    equations = m.equations()
    checks.equal((equations.names, equations.units, equations.parameters), (('q1', 'dq1'), {'q1': 'rad', 'dq1': 'rad/s'}, ('F',)), 'names')
    checks.near(equations.start, [-np.pi/18, 0], 1e-15, 'the start in rad', scale=1)
    q = m.positions([[-40.0]])[0]*np.array([np.pi/180, 1e-3, np.pi/180, 1e-3])
    checks.near(m.equations(q)([-0.7, 0.1]), exact(truss, [-0.7, 0.1], [0.0], 0)[0], 1e-12, 'from another position', scale=10)
    for wrong in (lambda: equations([0.0]), lambda: equations([0.0, 0.0], [1.0, 2.0]), lambda: equations([np.nan, 0.0]),
                  lambda: m.equations([0.0, 0.0]), lambda: m.equations(clock=True)):
        with pytest.raises(mech9.UsageError):
            wrong()
    # the bar cannot turn beyond the vertical
    with pytest.raises(mech9.AssemblyError):
        equations([1.2, 0.0])
    checks.near(equations([0.1, 0.0]), exact(truss, [0.1, 0.0], [0.0], 0)[0], 1e-12, 'they go on after a failure', scale=100)


def test_far_states(checks, mech9):
    """A crank longer than the rod, in a state that is reached by both together: with the crank of the start the rod would be too short."""
    equations = mech9.read_text(CRANK).equations()
    for x, p in (([1.4, 0.5], [0.3]), ([0.3, -0.5], [0.7]), ([1.4, 0.5], [0.2])):
        checks.near(equations(x, p), exact(crank, x, p, 0)[0], 1e-11, f'at {x}, {p}', scale=100)
    with pytest.raises(mech9.AssemblyError):
        equations([1.4, 0.0], [0.7])
    checks.near(equations([0.3, 0.0], [0.6]), exact(crank, [0.3, 0.0], [0.6], 0)[0], 1e-11, 'they go on', scale=100)


@pytest.mark.parametrize('group, words', (
    ("&friction coordinate=1, dynamic=0.2, radius=0.1 /", 'dry friction'),
    ("&stop coordinate=1, low=-1, restitution=0.5 /", 'rigid stop'),
    ("&drive coordinate=1, kind='polynomial', coefficients=0.2 /", 'every independent coordinate is driven'),
    ("&point name='P', link=2, position=0,-1,0 /\n&contact point='P', link=1, kind='plane', normal=0,1,0, origin=0,-3,0 /", 'touch each other')))
def test_refusals(mech9, group, words):
    """Equations that are no smooth function of the state."""
    with pytest.raises(mech9.DataError, match=words):
        mech9.read_text(PENDULUM.replace('position=0.2, velocity=0.5', 'position=0.2') + group).equations()
    mech9.read_text(PENDULUM + "&stop coordinate=1, low=-1, stiffness=100 /\n").equations()
