"""User procedures: functions of Python, or compiled ones, that the library calls for groups with kind='user'."""
from __future__ import annotations

import ctypes
import operator
from ctypes import CFUNCTYPE, POINTER, c_double, c_int, c_void_p
from typing import Any, Callable

import numpy as np

from ._errors import UsageError
from ._library import lib, pause

_Numbers = POINTER(c_double)
_Three = c_double*3
_PAIR = CFUNCTYPE(c_int, c_int, c_double, c_int, _Numbers, _Numbers, c_void_p)
_CURVE = _PAIR   # of drives and couplings
_FORCE = CFUNCTYPE(c_int, c_double, c_void_p, c_int, _Numbers, c_void_p, c_void_p)


def _three(values: Any) -> Any:
    if len(values) != 3:
        raise UsageError(f'points and vectors have three numbers, not {values!r}', 2)
    return _Three(*values)


def _number(value: Any) -> int:
    """A number of a link or a coordinate for C."""
    try:
        number = operator.index(value)
    except TypeError:
        raise UsageError(f'links and coordinates have whole numbers, not {value!r}', 2) from None
    return number if abs(number) < 2**31 else 0   # which no link and no coordinate has


class Motion:
    """The motion of links and coordinates in a call for forces, in SI units. Links and coordinates have their numbers, from 1.

    Points and directions are given in the system of the link; all else is along the axes of link 1.
    """

    def __init__(self, address: int):
        self._address: int | None = address

    def _open(self) -> int:
        if self._address is None:
            raise UsageError('motion and loads can be used within the call alone', 2)
        return self._address

    def _ask(self, function: Callable[..., None], *arguments: Any) -> np.ndarray:
        found = _Three()
        function(self._open(), *arguments, found)
        return np.array(found)

    def position(self, link: int, point: Any) -> np.ndarray:
        """Position of a point of a link (3,) [m]."""
        return self._ask(lib.motion_position, _number(link), _three(point))

    def velocity(self, link: int, point: Any) -> np.ndarray:
        """Velocity of a point of a link (3,) [m/s]."""
        return self._ask(lib.motion_velocity, _number(link), _three(point))

    def turned(self, link: int, direction: Any) -> np.ndarray:
        """A direction that is fixed in a link (3,)."""
        return self._ask(lib.motion_turned, _number(link), _three(direction))

    def angular_velocity(self, link: int) -> np.ndarray:
        """Angular velocity of a link (3,) [rad/s]."""
        return self._ask(lib.motion_angular_velocity, _number(link))

    def q(self, coordinate: int) -> float:
        """A coordinate [rad, m]."""
        return float(lib.motion_q(self._open(), _number(coordinate)))

    def dq(self, coordinate: int) -> float:
        """The rate of a coordinate [rad/s, m/s]."""
        return float(lib.motion_dq(self._open(), _number(coordinate)))


class Loads:
    """The forces of a call, to which a procedure adds its own, in SI units along the axes of link 1."""

    def __init__(self, motion: Motion):
        self._motion = motion
        self._added: list[tuple[Callable[..., None], tuple[Any, ...]]] = []   # what the library gets when the procedure has returned

    def _add(self, function: Callable[..., None], *arguments: Any) -> None:
        self._motion._open()
        self._added.append((function, arguments))

    def add_force(self, link: int, point: Any, force: Any) -> None:
        """Add a force [N] at a point of a link, which is given in its system [m]."""
        self._add(lib.loads_add_force, self._motion._open(), _number(link), _three(point), _three(force))

    def add_torque(self, link: int, torque: Any) -> None:
        """Add a torque [N m] on a link."""
        self._add(lib.loads_add_torque, _number(link), _three(torque))

    def add_generalized(self, coordinate: int, value: float) -> None:
        """Add a torque or force [N m, N] on a coordinate: on its moving link, and the opposite on its reference link."""
        self._add(lib.loads_add_generalized, _number(coordinate), float(value))


class Procedure:
    """A function for groups of one name, as the library calls it. `raised` is what its last call in the present analysis raised."""

    def __init__(self, name: str, function: Any):
        self.name, self.function = name, function
        self.raised: list[BaseException] = []
        address = getattr(function, 'address', None)
        if isinstance(address, int):
            self.address: int | None = address   # compiled, as numba.cfunc does
            return
        if not callable(function):
            raise UsageError(f'a procedure is a function, not {function!r}', 2)
        self._thunk = _MAKERS[name](function, self.raised)
        self.address = ctypes.cast(self._thunk, c_void_p).value


def _answered(raised: list[BaseException], work: Callable[[], Any], give: Callable[[Any], None]) -> int:
    """Do the work of a call, and give its values to the library. An exception must not leave it: it is kept, and the library learns
    that there are no values. Ctrl-C comes amid a procedure, whose work is then done again, so that the motion can go on after the
    pause."""
    try:
        try:
            values = work()
        except KeyboardInterrupt as reason:
            raised[:] = [reason]
            pause()
            values = work()
        give(values)
        return 0
    except BaseException as reason:
        if not any(isinstance(earlier, KeyboardInterrupt) for earlier in raised):
            raised[:] = [reason]
        return 1


def _parameters(n: int, address: Any) -> np.ndarray:
    return np.array(address[:n])


def _fill(values: Any, shape: tuple[int, ...], address: Any) -> None:
    """Give values back, with or without two derivatives."""
    if values is None:
        raise UsageError('the procedure returned None; it must return its values', 2)
    array = np.asarray(values)
    if array.dtype.kind not in 'iuf':
        raise UsageError(f'the procedure must return real numbers, not {values!r}', 2)
    array = array.astype(float)
    if array.shape not in (shape, (3, *shape)):
        raise UsageError(f'the procedure must return an array of the shape {shape}, or {(3, *shape)} with two derivatives, '
                         f'not {array.shape}', 2)
    ctypes.memmove(address, np.ascontiguousarray(array).ctypes.data, array.nbytes)


def _pair(function: Callable[..., Any], raised: list[BaseException]) -> Any:
    def call(coordinate: int, q: float, n: int, parameters: Any, points: Any, data: Any) -> int:
        return _answered(raised, lambda: function(coordinate, q, _parameters(n, parameters)), lambda values: _fill(values, (3, 3), points))
    return _PAIR(call)


def _curve(function: Callable[..., Any], raised: list[BaseException]) -> Any:
    def call(number: int, x: float, n: int, parameters: Any, values: Any, data: Any) -> int:
        return _answered(raised, lambda: function(number, x, _parameters(n, parameters)), lambda found: _fill(found, (), values))
    return _CURVE(call)


def _force(function: Callable[..., Any], raised: list[BaseException]) -> Any:
    def call(t: float, motion: int, n: int, parameters: Any, loads: int, data: Any) -> int:
        seen = Motion(motion)

        def work() -> Loads:
            added = Loads(seen)
            answer = function(t, seen, _parameters(n, parameters), added)
            if answer is not None:
                raise UsageError(f'a procedure for forces adds to the loads and returns nothing, not {answer!r}', 2)
            return added

        def give(added: Loads) -> None:
            for add, arguments in added._added:
                add(loads, *arguments)
        code = _answered(raised, work, give)
        seen._address = None
        return code
    return _FORCE(call)


_PROGRESS = CFUNCTYPE(c_int, c_double, c_void_p)


class Progress:
    """A function that learns how far a call is. What it raises stops the call, and is kept in `raised`."""

    def __init__(self, function: Callable[[float], Any]):
        if not callable(function):
            raise UsageError(f'progress is a function of the share that is done, not {function!r}', 2)
        self.raised: list[BaseException] = []

        def call(done: float, data: Any) -> int:
            if self.raised:
                return 1
            try:
                function(done)
                return 0
            except BaseException as reason:
                self.raised.append(reason)
                return 1
        self._thunk = _PROGRESS(call)
        self.address: int | None = ctypes.cast(self._thunk, c_void_p).value


_MAKERS: dict[str, Callable[..., Any]] = {'pair': _pair, 'drive': _curve, 'coupling': _curve, 'force': _force}
