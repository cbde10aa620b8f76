"""Mechanisms with contacts, and derivatives of their motions against motions in complex numbers."""
import cmath

from event_derivative_cases import COLUMNS, FOUR_BAR, TIGHT, go

BALL_AT_ROCKER = """&point name='T', link=4, position=1,0,0 /
&contact point='T', kind='sphere', origin=0.2,0.3,0, radius=0.05, other_radius=0.08, restitution=0.7 /
&parameter name='e', sets='contact(1).restitution' /
&parameter name='R', sets='contact(1).other_radius' /
&parameter name='px', sets='point(1).position(1)' /
&parameter name='oy', sets='contact(1).origin(2)' /
"""
#: The four-bar of the stops, whose rocker hits a ball of the frame in place of a stop.
ROCKER = '\n'.join(line for line in FOUR_BAR.splitlines() if 'stop' not in line) + '\n' + BALL_AT_ROCKER
#: A double pendulum in space with skew axes, whose lower link hits a plane of a third link that swings, and slides on it.
SKEW = """&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,1,0.2 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.5,0,0, axis=0.1,0.9,0.4 /
&pair coordinate=3, links=1,4, kind='revolute', point=0,0,-0.9, axis=0.3,1,0 /
&body link=2, mass=1, centre=0.25,0,0, inertia=0.01,0.03,0.03,0,0,0 /
&body link=3, mass=0.7, centre=0.8,0,0, inertia=0.01,0.02,0.02,0,0,0 /
&body link=4, mass=2, centre=0.1,0,-0.9, inertia=0.1,0.2,0.2,0,0,0 /
&gravity acceleration=0,0,-9.81 /
&load kind='coordinate', coordinate=3, stiffness=60, damping=2 /
&point name='T', link=3, position=1,0.1,0 /
&contact point='T', link=4, radius=0.05, origin=0,0,-0.8, normal=0.1,-0.2,1, restitution=0.3 /
&initial coordinate=1, position=0 /
&initial coordinate=2, position=0.3 /
&initial coordinate=3, position=0 /
&parameter name='m', sets='body(1).mass' /
&parameter name='l', sets='pair(2).point(1)' /
&parameter name='a', sets='pair(3).axis(1)' /
&parameter name='px', sets='point(1).position(2)' /
&parameter name='r', sets='contact(1).radius' /
&parameter name='ny', sets='contact(1).normal(2)' /
&parameter name='oz', sets='contact(1).origin(3)' /
&parameter name='w', sets='initial(2).position' /
"""
BILLIARD = """&structure cq=1,2,3,4,5,6 /
&pair coordinates=1,2,3,4,5,6, links=1,2, kind='free' /
&initial coordinate=1, position=0, velocity=1 /
&initial coordinate=2, position=0, velocity=0.1 /
&initial coordinate=3, position=0.2, velocity=0 /
&initial coordinate=4, position=0, velocity=1 /
&initial coordinate=5, position=0 /
&initial coordinate=6, position=0, velocity=0.3 /
&body link=2, mass=2, inertia=0.032,0.032,0.032,0,0,0 /
&gravity acceleration=0,0,-9.81 /
&point name='C', link=2, position=0,0,0 /
&contact point='C', radius=0.2, friction=0.2 /
&parameter name='v', sets='initial(1).velocity' /
&parameter name='w', sets='initial(4).velocity' /
&parameter name='m', sets='body(1).mass' /
&parameter name='mu', sets='contact(1).friction' /
&parameter name='g', sets='gravity(1).acceleration(3)' /
"""
#: A foot on an elastic leg, which slides and sticks on the ground; its sole is round.
FOOT = """&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,1,0 /
&body link=4, mass=2, centre=0.05,0,0.1, inertia=0.02,0.03,0.02,0,0,0 /
&gravity acceleration=0,0,-9.81 /
&load kind='coordinate', coordinate=3, stiffness=30, damping=0.3 /
&load kind='coordinate', coordinate=1, stiffness=40 /
&point name='F', link=4, position=0,0,-0.25 /
&contact point='F', radius=0.05, friction=0.25 /
&initial coordinate=1, position=0.1, velocity=1.5 /
&initial coordinate=2, position=0.3 /
&initial coordinate=3, position=0 /
&parameter name='m', sets='body(1).mass' /
&parameter name='c', sets='body(1).centre(1)' /
&parameter name='k', sets='load(2).stiffness' /
&parameter name='mu', sets='contact(1).friction' /
&parameter name='v', sets='initial(1).velocity' /
"""
#: A mass point that slides into a plane at the bound of its friction, if e = 0.
SLIDER = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,0,1 /
&body link=3, mass=2 /
&point name='C', link=3, position=0,0,0 /
&contact point='C', radius=0, friction=0.5 /
&initial coordinate=1, position=0, velocity=0.5 /
&initial coordinate=2, position=1, velocity=-1 /
&parameter name='v', sets='initial(1).velocity' /
"""


def against_complex(checks, program, folder, text, motion, at, end, tol, columns=('q1', 'dq1', 'q2', 'dq2')):
    """Columns and their derivatives against a motion that is computed with complex numbers."""
    table, report, _ = go(program, folder, text + COLUMNS + TIGHT, end=end)
    values = motion(end, **at)
    for i, column in enumerate(columns):
        checks.near(table[column][-1], complex(values[i]).real, tol, column, scale=max(1.0, abs(values[i])))
        for name in at:
            moved = {key: value + (1e-30j if key == name else 0) for key, value in at.items()}
            slope = complex(motion(end, **moved)[i]).imag / 1e-30
            checks.near(table[f'd({column})/d({name})'][-1], slope, tol, f'{column} by {name}', scale=max(1.0, abs(slope)))
    return report


def first_root(a, b, c):
    """The least positive root of a t^2 + b t + c that is more than round-off; None if there is none."""
    root = cmath.sqrt(b * b - 4 * a * c)
    if root.real <= 0:
        return None
    roots = [t for t in ((-b - root) / (2 * a), (-b + root) / (2 * a)) if t.real > 1e-9]
    return min(roots, key=lambda t: t.real) if roots else None


def runge_kutta(rates, state, h):
    """One step of the classical method."""
    k1 = rates(state)
    k2 = rates([s + h / 2 * k for s, k in zip(state, k1)])
    k3 = rates([s + h / 2 * k for s, k in zip(state, k2)])
    k4 = rates([s + h * k for s, k in zip(state, k3)])
    return [s + h / 6 * (a + 2 * b + 2 * c + d) for s, a, b, c, d in zip(state, k1, k2, k3, k4)]


def integrate(rates, left, state, end, h):
    """Integrate until a function of the state passes zero, or to the end: the state, and the time that is left."""
    t = 0
    while (end - t).real > h:
        after = runge_kutta(rates, state, h)
        if left(after).real <= 0:
            step = h / 2
            for _ in range(60):
                value, near = left(runge_kutta(rates, state, step)), left(runge_kutta(rates, state, step + 1e-6))
                step -= value / ((near - value) / 1e-6)
            return runge_kutta(rates, state, step), end - t - step
        state, t = after, t + h
    return runge_kutta(rates, state, end - t), 0
