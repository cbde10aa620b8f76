"""Equations of motion as a function, for programs that integrate them or follow their solutions."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

import numpy as np

from ._errors import UsageError
from ._library import Handle, call, lib
from ._positions import PositionFinder

if TYPE_CHECKING:
    from ._mechanism import Mechanism


class Equations:
    """x' = f(x, p, t): the state x has the free coordinates, then their rates, in SI units; p has the parameters of the mechanism, in
    the units of the data file, by default as they are there. Closed chains follow the state from call to call. `names` and `units` are
    those of the state, `parameters` the names of p; `start` is the state and `values` the parameters at which the equations began.
    """

    def __init__(self, mechanism: Mechanism, q: Any, clock: bool):
        self._handle: Handle | None = None
        handle = Handle(procedures=mechanism._handle.procedures)
        place = None if q is None else np.ascontiguousarray(q, dtype=float)
        if place is not None:
            count = PositionFinder(mechanism).coordinates
            if place.shape != (count,):
                raise UsageError(f'q must have the shape ({count},), not {place.shape}', 2)
        call(lib.equations_create, mechanism._handle, None if place is None else place.ctypes.data, int(clock), ctypes.byref(handle))
        self._handle = handle
        n, m = lib.equations_states(handle), lib.equations_parameters(handle)
        names = tuple(lib.equations_name(handle, i).decode() for i in range(n + m))
        self.names: tuple[str, ...] = names[:n]
        self.parameters: tuple[str, ...] = names[n:]
        self.units: dict[str, str] = {name: lib.equations_unit(handle, i).decode() for i, name in enumerate(self.names)}
        self.start, self.values = np.empty(n), np.empty(m)
        call(lib.equations_start, handle, self.start.ctypes.data, self.values.ctypes.data)
        for array in (self.start, self.values):
            array.flags.writeable = False

    def __del__(self) -> None:
        if getattr(self, '_handle', None) is not None:
            lib.equations_destroy(self._handle)

    def _find(self, x: Any, p: Any, t: float, *rows: np.ndarray | None) -> np.ndarray:
        state = np.ascontiguousarray(x, dtype=float)
        values = self.values if p is None else np.ascontiguousarray(p, dtype=float)
        if state.shape != self.start.shape or values.shape != self.values.shape:
            raise UsageError(f'x must have the shape {self.start.shape}, and p {self.values.shape}', 2)
        found = np.empty(len(state))
        call(lib.equations_find, self._handle, float(t), state.ctypes.data, values.ctypes.data, found.ctypes.data,
             *(None if array is None else array.ctypes.data for array in rows))
        return found

    def __call__(self, x: Any, p: Any = None, t: float = 0.0) -> np.ndarray:
        """The rates (states,) of a state."""
        return self._find(x, p, t, None, None)

    def jacobian(self, x: Any, p: Any = None, t: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives of the rates by the state (states, states), and by the parameters (states, parameters)."""
        n = len(self.names)
        by_state, by_parameters = np.empty((n, n)), np.empty((n, len(self.parameters)))
        self._find(x, p, t, by_state, by_parameters)
        return by_state, by_parameters
