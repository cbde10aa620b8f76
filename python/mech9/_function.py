"""Quantities as functions of numbers of the mechanism, with exact Jacobians."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Sequence

import numpy as np

from ._errors import DataError, UsageError
from ._library import call, lib
from ._mechanism import free_name

if TYPE_CHECKING:
    from ._mechanism import Mechanism


class Function:
    """Outputs are names of quantities, inputs are names of parameters or numbers. f(x) is (outputs,), f.jacobian(x) is
    (outputs, inputs)."""

    def __init__(self, mechanism: Mechanism, inputs: Sequence[str], outputs: Sequence[str]):
        if isinstance(inputs, str) or isinstance(outputs, str):
            raise UsageError("inputs and outputs are lists of names: ['pair(2).point(1)']", 2)
        self.inputs, self.outputs = tuple(inputs), tuple(outputs)
        self._mechanism = mechanism.copy()
        known = self._mechanism.parameters
        self._names = []
        for i, name in enumerate(self.inputs):
            if name not in known:
                new = free_name(self._mechanism.parameters, i + 1)
                self._mechanism.add('parameter', name=new, sets=name)
            self._names.append(name if name in known else new)
        self._columns = [self._mechanism.parameters.index(name) for name in self._names]
        self._places = [f"parameter('{name}').value".encode() for name in self._names]
        self._numbers: list[int] = []
        self._is_driven = self._mechanism.is_driven
        self._with_gradients = self._mechanism.copy()
        self._with_gradients['output.gradients'] = True

    def _run(self, mechanism: Mechanism, x: Any) -> ctypes.c_void_p:
        """The results of a run at x, which are to be destroyed."""
        values = np.asarray(x, dtype=float)
        if values.shape != (len(self.inputs),):
            raise UsageError(f'x must have the shape ({len(self.inputs)},), not {values.shape}', 2)
        for place, value in zip(self._places, values.tolist()):
            call(lib.mechanism_set, mechanism._handle, place, value)
        handle = ctypes.c_void_p()
        try:
            call(lib.kinematics if self._is_driven else lib.dynamics, mechanism._handle, None, ctypes.byref(handle))
            if not self._numbers:
                self._numbers = self._find_numbers(handle)
        except BaseException:
            lib.results_destroy(handle)
            raise
        return handle

    def __call__(self, x: Any) -> np.ndarray:
        """The outputs (outputs,) at x (inputs,)."""
        handle = self._run(self._mechanism, x)
        found = np.array([lib.results_number(handle, i) for i in self._numbers])
        lib.results_destroy(handle)
        return found

    def jacobian(self, x: Any) -> np.ndarray:
        """Derivatives of the outputs by the inputs at x, (outputs, inputs)."""
        handle = self._run(self._with_gradients, x)
        found = np.array([[lib.results_derivative(handle, i, p) for p in self._columns] for i in self._numbers])
        lib.results_destroy(handle)
        return found

    def _find_numbers(self, handle: ctypes.c_void_p) -> list[int]:
        """The places of the outputs among the quantities of a run."""
        known = [lib.results_number_name(handle, i).decode() for i in range(lib.results_numbers(handle))]
        for name in self.outputs:
            if name not in known:
                raise DataError(f'there is no quantity {name!r}; the quantities are {", ".join(known) or "none"}', 3)
        return [known.index(name) for name in self.outputs]
