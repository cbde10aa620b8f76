"""Many positions of one mechanism."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

import numpy as np

from ._errors import UsageError
from ._library import Handle, call, call_stoppable, lib

if TYPE_CHECKING:
    from ._mechanism import Mechanism


class PositionFinder:
    """The assembled mechanism whose positions are found."""

    def __init__(self, mechanism: Mechanism):
        self.handle = Handle(procedures=mechanism._handle.procedures)
        call(lib.positions_create, mechanism._handle, ctypes.byref(self.handle))
        self.coordinates: int = lib.positions_coordinates(self.handle)
        self.independent: int = lib.positions_independent(self.handle)

    def __del__(self) -> None:
        lib.positions_destroy(self.handle)

    def rows(self, values: Any) -> np.ndarray:
        """Values as an array (n, I)."""
        array = np.ascontiguousarray(values, dtype=float)
        if array.ndim < 2:
            array = array.reshape(-1, 1) if self.independent == 1 else array.reshape(1, -1)
        if array.ndim != 2 or array.shape[1] != self.independent:
            raise UsageError(f'values of the independent coordinates must have the shape (n, {self.independent}), '
                             f'not {np.shape(values)}', 2)
        return array

    def find(self, given: list[np.ndarray], found: list[np.ndarray], code: np.ndarray) -> None:
        """Fill arrays: positions, and rates and accelerations where these are given."""
        def address(arrays: list[np.ndarray], i: int) -> int | None:
            return arrays[i].ctypes.data if i < len(arrays) else None
        failure = call_stoppable(lib.positions_find, lambda stop: (
            self.handle, len(code), address(given, 0), address(given, 1), address(given, 2), stop,
            address(found, 0), address(found, 1), address(found, 2), code.ctypes.data))
        if failure is not None:
            raise failure
