"""Branches of the doubled period from period doublings: the cascade of the driven pendulum, a hanging pendulum whose pivot vibrates, a third-order
oscillator with a period of its own, and a torus of two coupled self-excited oscillators; all against integrations in numpy."""

import numpy as np

from branch_cases import follow

PENDULUM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=-0.2214, velocity=1.9597 /
&body link=2, mass=1, centre=0,-1,0 /
&gravity acceleration=0,-1,0 /
&load kind='coordinate', coordinate=1, damping=0.5 /
&load kind='coordinate', coordinate=1, force=1.065, law='harmonic', amplitude=1, angular_frequency=0.6666666666666666, phase=1.5707963267948966 /
&parameter name='g', sets='load(2).force', low=1.05, high=1.0825 /
&branch parameter='g', of='periodic' /
&time end=1 /
"""
# x''' + A x'' - x'^2 + x = 0 (Sprott): a slider with the acceleration of a rotor's rate, which is braked, driven by the slider's speed, and held
# back by its place; no force depends on the angle of the rotor
SPROTT = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=1,3, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=5.5 /
&initial coordinate=2, position=0, velocity=-2.15 /
&body link=2, mass=1 /
&body link=3, mass=0, inertia=0,0,1,0,0,0 /
&load kind='coordinate', coordinate=1, force=1, law='polynomial', coefficients=0,1, over='dq2' /
&load kind='coordinate', coordinate=2, damping=2.11 /
&load kind='coordinate', coordinate=2, force=1, law='polynomial', coefficients=0,0,1, over='dq1' /
&load kind='coordinate', coordinate=2, force=-1, law='polynomial', coefficients=0,1, over='q1' /
&parameter name='A', sets='load(2).damping', low=2.069, high=2.15 /
&branch parameter='A', of='periodic', step=0.2 /
&periodic period=11.9 /
&time end=1 /
"""


def runge_kutta(rates, y, span, steps, start=0.0):
    """The state after a time, by the method of Runge and Kutta."""
    h = span/steps
    for i in range(steps):
        t = start + i*h
        a = rates(t, y)
        b = rates(t + h/2, y + h/2*a)
        c = rates(t + h/2, y + h/2*b)
        y = y + h/6*(a + 2*b + 2*c + rates(t + h, y + h*c))
    return y


def zero(function, low, high):
    """A zero of a function, by the secant method."""
    at_low, at_high = function(low), function(high)
    for _ in range(30):
        low, high, at_low = high, high - at_high*(high - low)/(at_high - at_low), at_high
        if abs(high - low) < 1e-12:
            break
        at_high = function(high)
    return high


def richardson(function, steps):
    """The value for an error of fourth order, and what it is exact to."""
    coarse, fine = function(steps), function(2*steps)
    return fine + (fine - coarse)/15, abs(fine - coarse)/15


def doubling_of_pendulum(periods, first, second, start, steps):
    """The torque at which a motion of so many periods of the torque has the multiplier -1."""
    w = 2/3
    state = np.array(start)

    def rates_at(g):
        def rates(t, y):
            s, c = np.sin(y[0]), np.cos(y[0])
            return np.array([y[1], -s - 0.5*y[1] + g*np.cos(w*t), y[3], -c*y[2] - 0.5*y[3], y[5], -c*y[4] - 0.5*y[5]])
        return rates

    def excess(g):
        nonlocal state
        for _ in range(20):
            end = runge_kutta(rates_at(g), np.array([*state, 1, 0, 0, 1]), periods*2*np.pi/w, periods*steps)
            matrix = end[2:].reshape(2, 2).T
            change = np.linalg.solve(matrix - np.eye(2), state - end[:2])
            state = state + change
            if np.abs(change).max() < 1e-12:
                break
        return np.linalg.det(matrix + np.eye(2))

    return zero(excess, first, second)


def test_cascade(checks, mech9d, tmp_path):
    """The period of the driven pendulum doubles again and again, at distances with the ratio of Feigenbaum in the end."""
    rows, branches, said = follow(mech9d, tmp_path, PENDULUM, 'g')
    checks.equal([branch['period_doublings'] for branch in branches], [0, 1, 2, 3], 'one branch after the other')
    checks.equal([branch['ends'][0] for branch in branches], ['low'] + 3*['period doubling'], 'where they begin')
    checks.true('twice the period' in said and '4 times the period' in said, 'what is told', said)
    places = [branch['special_points'][-1]['value'] for branch in branches[:3]]
    checks.near([branch['special_points'][0]['value'] for branch in branches[1:]], places, 1e-13, 'where the branches begin')
    checks.near(places[0], 1.066372862455, 1e-11, 'the first doubling')
    # the start of the doubled motion, to which stable motions come
    exact, error = richardson(lambda steps: doubling_of_pendulum(2, 1.0793, 1.07932, [-0.0988, 1.892], steps), 200)
    checks.near(places[1], exact, 1e-10 + error, 'the second doubling', scale=1)
    # 4.6692, which the ratio of the first distances comes near to
    checks.near((places[1] - places[0])/(places[2] - places[1]), 4.669, 5e-3, 'the ratio')
    second = rows['branch'] == 2
    checks.true((rows['growth'][second][1:] < 0)[rows['g'][second][1:] < places[1] - 1e-9].all(), 'the doubled motion is stable first', rows['growth'][second])
    checks.true((rows['growth'][second][rows['g'][second] > places[1] + 1e-9] > 0).all(), 'and unstable then', rows['growth'][second])


def test_without_switching(checks, mech9d, tmp_path):
    _, branches, _ = follow(mech9d, tmp_path, PENDULUM.replace("of='periodic'", "of='periodic', switch=.false."), 'g')
    checks.equal([[point['kind'] for point in branch['special_points']] for branch in branches], [['period doubling']], 'one branch alone')


def test_from_the_doubled_motion(checks, mech9d, tmp_path):
    """A branch of the doubled period leads back to that of the single one."""
    text = PENDULUM.replace('force=1.065', 'force=1.07').replace('high=1.0825', 'high=1.0705') + f"&periodic period={6*np.pi!r} /\n"
    _, branches, said = follow(mech9d, tmp_path, text, 'g')
    checks.equal([branch['period_doublings'] for branch in branches[:2]], [0, -1], 'both')
    checks.equal([branches[0]['ends'], branches[1]['ends']], [['period doubling', 'high'], ['low', 'high']], 'ends')
    checks.near([branch['special_points'][0]['value'] for branch in branches[:2]], 1.066372862455, 1e-10, 'where they meet')
    checks.true('the period divided by 2' in said, 'what is told', said)


HANGING = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,1,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&drive coordinate=1, kind='harmonic', amplitude=0.1, angular_frequency=5.8 /
&body link=3, mass=1, centre=0,-1,0 /
&gravity acceleration=0,-9.81,0 /
&load kind='coordinate', coordinate=2, damping=0.55 /
&initial coordinate=2, position=0 /
&parameter name='W', sets='drive.angular_frequency', low=5.7, high=7 /
&branch parameter='W', of='periodic', step=0.2 /
&time end=1 /
"""


def test_bubble(checks, mech9d, tmp_path):
    """A pendulum that hangs on a vibrating pivot begins to swing with twice the period. The branch of this motion joins both points at which
    small motions alternate: where the equation of Mathieu with damping has the multiplier -1."""
    _, branches, _ = follow(mech9d, tmp_path, HANGING, 'W')
    checks.equal([branch['period_doublings'] for branch in branches], [0, 1], 'two branches')
    checks.equal(branches[1]['ends'], ['period doubling', 'period doubling'], 'the second one joins both')
    checks.equal([point['kind'] for point in branches[1]['special_points']], ['period doubling', 'fold', 'period doubling'], 'its points')
    places = [point['value'] for point in branches[0]['special_points']]

    def edge(first, second, steps):
        def excess(w):
            def rates(t, y):
                k = 9.81 - 0.1*w*w*np.sin(w*t)
                return np.array([y[1], -k*y[0] - 0.55*y[1], y[3], -k*y[2] - 0.55*y[3]])
            return np.linalg.det(runge_kutta(rates, np.array([1, 0, 0, 1.0]), 2*np.pi/w, steps).reshape(2, 2).T + np.eye(2))
        return zero(excess, first, second)

    for place, guess in zip(places, (6.03, 6.66)):
        exact, error = richardson(lambda steps: edge(guess, guess + 0.01, steps), 200)
        checks.near(place, exact, 1e-9 + error, 'the multiplier -1 of small motions', scale=1)
    checks.near(sorted(point['value'] for point in branches[1]['special_points'] if point['kind'] != 'fold'), places, 1e-9, 'where the second one ends')


def sprott_doubling(periods, first, second, start, period, steps):
    """The damping at which a motion with so many largest places has the multiplier -1, its largest place and its period."""
    state = np.array([*start, period])

    def rates_at(a):
        def rates(t, y):
            x, matrix = y[:3], y[3:].reshape(3, 3)
            jacobian = np.array([[0, 1, 0], [0, 0, 1], [-1, 2*x[1], -a]])
            return np.append([x[1], x[2], -a*x[2] + x[1]**2 - x[0]], jacobian @ matrix)
        return rates

    def excess(a):
        nonlocal state
        rates = rates_at(a)
        for _ in range(20):
            begin = np.append([state[0], 0, state[1]], np.eye(3))
            end = runge_kutta(rates, begin, state[2], periods*steps)
            matrix = end[3:].reshape(3, 3)
            system = np.column_stack([matrix[:, 0] - [1, 0, 0], matrix[:, 2] - [0, 0, 1], rates(0, end)[:3]])
            change = np.linalg.solve(system, begin[:3] - end[:3])
            state = state + change
            if np.abs(change).max() < 1e-12:
                break
        # one multiplier is 1 along the motion
        return np.linalg.det(matrix + np.eye(3))/2

    found = zero(excess, first, second)
    return np.array([found, state[0], state[2]])


def test_period_of_its_own(checks, mech9d, tmp_path):
    """A third-order oscillator doubles the period that is its own, and again."""
    rows, branches, _ = follow(mech9d, tmp_path, SPROTT, 'A')
    checks.equal([branch['period_doublings'] for branch in branches[:3]], [0, 1, 2], 'one branch after the other')
    points = [branch['special_points'][-1] for branch in branches[:2]]
    checks.equal([point['kind'] for point in points], 2*['period doubling'], 'what they have')
    for periods, point, guess in ((1, points[0], [2.1263, 5.8462, -2.3, 11.97]), (2, points[1], [2.0714, 5.1825, -2.0, 23.79])):
        coarse = sprott_doubling(periods, guess[0], guess[0] + 1e-4, guess[1:3], guess[3], 400)
        fine = sprott_doubling(periods, *coarse[:1], coarse[0] + 1e-6, [coarse[1], guess[2]], coarse[2], 800)
        exact = fine + (fine - coarse)/15
        checks.near([point['value'], point['q'][0], point['period']], exact, 1e-8, f'after {periods} periods', scale=1)
    first = branches[1]['special_points'][0]
    checks.near(first['period'], 2*points[0]['period'], 1e-10, 'the doubled period')
    # between, the doubled motion alone is stable
    at = (rows['branch'] == 2) & (rows['A'] > points[1]['value'] + 1e-6) & (rows['A'] < points[0]['value'] - 1e-6)
    checks.true((rows['growth'][at] < 0).all() and at.sum() > 3, 'the doubled motion is stable', rows['growth'][at])


# the second slider runs on the first one, by spring and damper; below a damping it begins to move by itself
TWO = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1 /
&body link=3, mass=0.4 /
&load kind='coordinate', coordinate=1, stiffness=1 /
&load kind='coordinate', coordinate=1, force=1, law='polynomial', coefficients=0,0.3,0,-0.1, over='dq1' /
&load kind='coordinate', coordinate=2, stiffness=1.3, damping=-0.09 /
&load kind='coordinate', coordinate=2, force=1, law='polynomial', coefficients=0,0,0,-0.1, over='dq2' /
&initial coordinate=1, position=-2.5 /
&initial coordinate=2, position=-0.55 /
&parameter name='d', sets='load(3).damping', low=-0.12, high=-0.08 /
&branch parameter='d', of='periodic' /
&periodic period=7.8 /
&time end=1 /
"""


def test_torus(checks, mech9d, tmp_path):
    """Two coupled self-excited oscillators with a period of their own: below a damping a pair of multipliers leaves the unit circle."""
    _, branches, _ = follow(mech9d, tmp_path, TWO, 'd')
    checks.equal([point['kind'] for point in branches[0]['special_points']], ['torus'], 'one special point')
    point = branches[0]['special_points'][0]

    def rates_at(d):
        def rates(t, y):
            x, matrix = y[:4], y[4:].reshape(4, 4)
            relative, slope = 1.3*x[1] + d*x[3] + 0.1*x[3]**3, d + 0.3*x[3]**2
            first, falling = -x[0] + 0.3*x[2] - 0.1*x[2]**3 + relative, 0.3 - 0.3*x[2]**2
            jacobian = np.array([[0, 0, 1, 0], [0, 0, 0, 1], [-1, 1.3, falling, slope], [1, -3.5*1.3, -falling, -3.5*slope]])
            return np.append([x[2], x[3], first, -2.5*relative - first], jacobian @ matrix)
        return rates

    def torus_point(steps):
        # the first slider begins at its largest place; rates of the second one are not in the report
        state = np.array([point['q'][0], point['q'][1], 0.0, point['period']])

        def excess(d):
            nonlocal state
            rates = rates_at(d)
            for _ in range(20):
                begin = np.append([state[0], state[1], 0, state[2]], np.eye(4))
                end = runge_kutta(rates, begin, state[3], steps)
                matrix = end[4:].reshape(4, 4)
                system = np.column_stack([(matrix - np.eye(4))[:, [0, 1, 3]], rates(0, end)[:4]])
                change = np.linalg.solve(system, begin[:4] - end[:4])
                state = state + change
                if np.abs(change).max() < 1e-12:
                    break
            pair = max(np.linalg.eigvals(matrix), key=lambda value: abs(value.imag))
            return abs(pair) - 1

        found = zero(excess, -0.1, -0.104)
        return np.array([found, state[0], state[1], state[3]])

    coarse, fine = torus_point(200), torus_point(400)
    exact = fine + (fine - coarse)/15
    checks.near([point['value'], *point['q'], point['period']], exact, 1e-8, 'the torus', scale=1)
