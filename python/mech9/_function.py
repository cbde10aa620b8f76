"""Quantities as functions of numbers of the mechanism, with exact Jacobians."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Mapping, Sequence

import numpy as np

from ._errors import DataError, UsageError
from ._library import call, lib
from ._mechanism import free_name
from ._results import Results

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
        self._places = [f'parameter({self._mechanism.parameters.index(name) + 1}).value'.encode() for name in self._names]
        self._analysis = lib.kinematics if self._mechanism.is_driven else lib.dynamics
        self._with_gradients = self._mechanism.copy()
        self._with_gradients['output.gradients'] = True

    def _run(self, mechanism: Mechanism, x: Any) -> Results:
        values = np.asarray(x, dtype=float)
        if values.shape != (len(self.inputs),):
            raise UsageError(f'x must have the shape ({len(self.inputs)},), not {values.shape}', 2)
        for place, value in zip(self._places, values):
            call(lib.mechanism_set, mechanism._handle, place, value)
        handle = ctypes.c_void_p()
        try:
            call(self._analysis, mechanism._handle, None, ctypes.byref(handle))
        except BaseException:
            lib.results_destroy(handle)
            raise
        return Results(handle.value, mechanism.parameters)   # type: ignore[arg-type]

    def __call__(self, x: Any) -> np.ndarray:
        """The outputs (outputs,) at x (inputs,)."""
        found = self._run(self._mechanism, x).quantities
        return np.array([found[self._known(name, found)] for name in self.outputs])

    def jacobian(self, x: Any) -> np.ndarray:
        """Derivatives of the outputs by the inputs at x, (outputs, inputs)."""
        found = self._run(self._with_gradients, x).gradients
        return np.array([[found[self._known(name, found)][parameter] for parameter in self._names] for name in self.outputs])

    @staticmethod
    def _known(name: str, found: Mapping[str, Any]) -> str:
        if name not in found:
            raise DataError(f'there is no quantity {name!r}; the quantities are {", ".join(found) or "none"}', 3)
        return name
