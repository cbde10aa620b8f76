"""Values over time with their first two derivatives, and checks of a table against such closed forms."""
import numpy as np

from mech9_cases import tolerance_of


class Jet:
    """Values over time with their first two derivatives: plain calculus, written out once."""
    __array_ufunc__ = None   # a numpy number times a Jet is a Jet

    def __init__(self, value, first=0.0, second=0.0):
        self.value, self.first, self.second = value, first, second

    def through(self, f, f1, f2):
        """Chain rule for a function with the derivatives f1, f2."""
        return Jet(f, f1 * self.first, f2 * self.first ** 2 + f1 * self.second)

    def __add__(self, other):
        other = jet(other)
        return Jet(self.value + other.value, self.first + other.first, self.second + other.second)

    def __mul__(self, other):
        other = jet(other)
        return Jet(self.value * other.value, self.first * other.value + self.value * other.first,
                   self.second * other.value + 2 * self.first * other.first + self.value * other.second)

    def __sub__(self, other):
        return self + jet(other) * -1.0

    def __truediv__(self, other):
        v = jet(other).value
        return self * jet(other).through(1 / v, -1 / v ** 2, 2 / v ** 3)

    __radd__, __rmul__ = __add__, __mul__

    def __rsub__(self, other):
        return jet(other) - self


def jet(x):
    return x if isinstance(x, Jet) else Jet(x)


def sin(x):
    return x.through(np.sin(x.value), np.cos(x.value), -np.sin(x.value))


def cos(x):
    return x.through(np.cos(x.value), -np.sin(x.value), -np.cos(x.value))


def sqrt(x):
    root = np.sqrt(x.value)
    return x.through(root, 0.5 / root, -0.25 / root ** 3)


def arcsin(x):
    root = np.sqrt(1 - x.value ** 2)
    return x.through(np.arcsin(x.value), 1 / root, x.value / root ** 3)


def arctan(x):
    slope = 1 / (1 + x.value ** 2)
    return x.through(np.arctan(x.value), slope, -2 * x.value * slope ** 2)


def arccos(x):
    root = np.sqrt(1 - x.value ** 2)
    return x.through(np.arccos(x.value), -1 / root, -x.value / root ** 3)


def check_coordinate(checks, table, k, expected, why, turns=False):
    """q_k, dq_k, ddq_k against a closed form; an angle may differ by whole turns, the same in all rows."""
    value = expected.value
    if turns:
        value = value + 2 * np.pi * np.round((table[f'q{k}'][0] - value[0]) / (2 * np.pi))
    for column, numbers in ((f'q{k}', value), (f'dq{k}', expected.first), (f'ddq{k}', expected.second)):
        checks.near(table[column], numbers, tolerance_of(column), f'{why}: {column} by its closed form')


def check_point(checks, table, point, components, why):
    for axis, expected in zip('xyz', components):
        expected = jet(expected)
        for column, numbers in ((f'{point}.{axis}', expected.value), (f'{point}.v{axis}', expected.first),
                                (f'{point}.a{axis}', expected.second)):
            checks.near(table[column], numbers, tolerance_of(column), f'{why}: {column} by its closed form')
