"""Compiled user procedures by Numba: signatures for numba.cfunc, and what such procedures may call.

    @m.force
    @numba.cfunc(mech9.numba.FORCE)
    def drag(t, motion, n, parameters, loads, data):
        tip = np.array([0.5, 0.0, 0.0])
        mech9.numba.add_force(loads, motion, 2, tip, -0.1*mech9.numba.velocity(motion, 2, tip))
        return 0

Numbers of the group &user are in parameters[0] to parameters[n - 1]. A procedure returns 0, or 1 where it has no values. Numba ignores
exceptions in it: guard divisions, and return 1.
"""
from __future__ import annotations

from typing import Any

import numba
import numpy as np

from ._library import lib

# f(t, motion, n, parameters, loads, data)
FORCE = 'int32(float64, voidptr, int32, CPointer(float64), voidptr, voidptr)'
# f(coordinate, q, n, parameters, points, data): points[0] to points[8] are three points, as for m.pair; two derivatives by q may follow
PAIR = 'int32(int32, float64, int32, CPointer(float64), CPointer(float64), voidptr)'
# f(coordinate, t, n, parameters, values, data), f(coupling, first, n, parameters, values, data): values[0] is the value; two
# derivatives may follow
DRIVE = PAIR
COUPLING = PAIR

_position, _velocity, _turned = lib.motion_position, lib.motion_velocity, lib.motion_turned
_angular_velocity, _q, _dq = lib.motion_angular_velocity, lib.motion_q, lib.motion_dq
_add_force, _add_torque, _add_generalized = lib.loads_add_force, lib.loads_add_torque, lib.loads_add_generalized
_compiled: Any = numba.njit   # has no types for mypy


@_compiled
def _three(values):   # type: ignore[no-untyped-def]
    """Three numbers side by side, whatever they are given as; not numbers, which end the run, where there are not three."""
    copied = np.full(3, np.nan)
    if len(values) == 3:
        for i in range(3):
            copied[i] = values[i]
    return copied


@_compiled
def position(motion, link, point):   # type: ignore[no-untyped-def]
    """Position of a point of a link (3,) [m]; the point is given in the system of the link."""
    found = np.empty(3)
    _position(motion, link, _three(point).ctypes, found.ctypes)
    return found


@_compiled
def velocity(motion, link, point):   # type: ignore[no-untyped-def]
    """Velocity of a point of a link (3,) [m/s]."""
    found = np.empty(3)
    _velocity(motion, link, _three(point).ctypes, found.ctypes)
    return found


@_compiled
def turned(motion, link, direction):   # type: ignore[no-untyped-def]
    """A direction that is fixed in a link (3,), along the axes of link 1."""
    found = np.empty(3)
    _turned(motion, link, _three(direction).ctypes, found.ctypes)
    return found


@_compiled
def angular_velocity(motion, link):   # type: ignore[no-untyped-def]
    """Angular velocity of a link (3,) [rad/s]."""
    found = np.empty(3)
    _angular_velocity(motion, link, found.ctypes)
    return found


@_compiled
def q(motion, coordinate):   # type: ignore[no-untyped-def]
    """A coordinate [rad, m]."""
    return _q(motion, coordinate)


@_compiled
def dq(motion, coordinate):   # type: ignore[no-untyped-def]
    """The rate of a coordinate [rad/s, m/s]."""
    return _dq(motion, coordinate)


@_compiled
def add_force(loads, motion, link, point, force):   # type: ignore[no-untyped-def]
    """Add a force [N] at a point of a link."""
    _add_force(loads, motion, link, _three(point).ctypes, _three(force).ctypes)


@_compiled
def add_torque(loads, link, torque):   # type: ignore[no-untyped-def]
    """Add a torque [N m] on a link."""
    _add_torque(loads, link, _three(torque).ctypes)


@_compiled
def add_generalized(loads, coordinate, value):   # type: ignore[no-untyped-def]
    """Add a torque or force [N m, N] on a coordinate."""
    _add_generalized(loads, coordinate, value)
