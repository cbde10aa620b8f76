"""Motions that are advanced step by step, as in a loop with a controller."""
from __future__ import annotations

import ctypes
from concurrent.futures import ThreadPoolExecutor, wait
from typing import TYPE_CHECKING, Any, Callable

import numpy as np

from ._errors import INTERRUPTED, UsageError
from ._library import Handle, call, call_with_pauses, forget_raised, lib, raise_pending, text, warn_of_raised

if TYPE_CHECKING:
    from ._mechanism import Mechanism


class Simulation:
    """A motion from its start: t [s], q, dq, ddq (M,) in the units of the data file."""

    def __init__(self, mechanism: Mechanism, driven: bool, stop: ctypes.c_int):
        handle = Handle(procedures=mechanism._handle.procedures)
        self._stop = stop   # another number than 0 stops the motion
        call(lib.simulation_create, mechanism._handle, 0 if driven else 1, ctypes.addressof(stop), ctypes.byref(handle))
        self._handle: Handle | None = handle
        self._n: int = lib.simulation_coordinates(handle)

    def _open(self) -> ctypes.c_void_p:
        if self._handle is None:
            raise UsageError('this simulation is closed; start another one', 2)
        return self._handle

    def close(self) -> None:
        """End the motion and free its memory."""
        if getattr(self, '_handle', None) is not None:
            lib.simulation_destroy(self._handle)
            self._handle = None

    __del__ = close

    def __copy__(self) -> Simulation:
        raise UsageError('a simulation cannot be copied; start another one, and give it the state of this one', 2)

    def __deepcopy__(self, memo: Any) -> Simulation:
        return self.__copy__()

    def __reduce__(self) -> Any:
        return self.__copy__()

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *reason: Any) -> None:
        self.close()

    def advance(self, t: float) -> None:
        """Go on to a time [s]. A motion that cannot go on stays at the last time that it reached, until set_state; after Ctrl-C it can go on."""
        call_with_pauses(lib.simulation_advance, self._stop, self._open(), float(t))

    def set(self, name: str, value: float) -> None:
        """Change a number of a load or a motor, from the present time on: set('load(1).force(2)', 3.5)."""
        call(lib.simulation_set, self._open(), text(name), float(value))

    def mass_matrix(self) -> np.ndarray:
        """The mass matrix (n, n) of the free coordinates in the order of cq, in SI units: M ddq + bias = 0."""
        n = lib.simulation_free(self._open())
        found = np.empty((n, n))
        call(lib.simulation_equations, self._open(), None, found.ctypes.data, None)
        return found

    def bias(self) -> np.ndarray:
        """The bias (n,): terms of velocity, and loads, in SI units: M ddq + bias = 0."""
        found = np.empty(lib.simulation_free(self._open()))
        call(lib.simulation_equations, self._open(), None, None, found.ctypes.data)
        return found

    @property
    def free(self) -> tuple[int, ...]:
        """The numbers of the free coordinates in the order of cq."""
        found = np.empty(lib.simulation_free(self._open()), dtype=np.intc)
        call(lib.simulation_equations, self._open(), found.ctypes.data, None, None)
        return tuple(int(number) for number in found)

    def state(self) -> np.ndarray:
        """The state as numbers in SI units, for set_state: time, coordinates, rates, states of motors."""
        found = np.empty(lib.simulation_state_size(self._open()))
        call(lib.simulation_state, self._open(), found.ctypes.data)
        return found

    def set_state(self, state: Any) -> None:
        """Go to a state, perhaps of another simulation of the same mechanism; the motion starts there anew.

        Coordinates that do not close the chains are corrected. After a failure the motion is where it was.
        """
        numbers = np.ascontiguousarray(state, dtype=float).ravel()
        call(lib.simulation_set_state, self._open(), len(numbers), numbers.ctypes.data)

    @property
    def t(self) -> float:
        """The present time [s]."""
        return float(lib.simulation_time(self._open()))

    def _take(self, place: int) -> np.ndarray:
        found = np.empty(self._n)
        addresses: list[int | None] = [None, None, None]
        addresses[place] = found.ctypes.data
        call(lib.simulation_take, self._open(), *addresses)
        return found

    @property
    def q(self) -> np.ndarray:
        """The coordinates (M,)."""
        return self._take(0)

    @property
    def dq(self) -> np.ndarray:
        """Their rates (M,)."""
        return self._take(1)

    @property
    def ddq(self) -> np.ndarray:
        """Their second derivatives (M,)."""
        return self._take(2)

    def point(self, name: str) -> np.ndarray:
        """Position, velocity and acceleration of a named point, (3, 3), in the system of link 1 [m, m/s, m/s2]."""
        found = np.empty((3, 3))
        call(lib.simulation_point, self._open(), text(name), *(row.ctypes.data for row in found))
        return found

    @property
    def energies(self) -> tuple[float, float]:
        """Kinetic and potential energy [J]."""
        kinetic, potential = ctypes.c_double(), ctypes.c_double()
        call(lib.simulation_energies, self._open(), ctypes.byref(kinetic), ctypes.byref(potential))
        return kinetic.value, potential.value

    @property
    def closure(self) -> float:
        """Largest gap of a closed chain [m]."""
        return float(lib.simulation_closure(self._open()))


class Simulations:
    """Many motions of one mechanism side by side: q, dq, ddq (count, M) in the units of the data file, t and `code` (count,).

    A motion that cannot go on keeps the exit code of its failure, and its rows are NaN from then on; `advance` of this one alone, many[i],
    raises the failure. A warning tells what a procedure raised that stopped motions.
    """

    def __init__(self, mechanism: Mechanism, count: int, driven: bool, threads: int):
        if count < 1:
            raise UsageError('there must be at least one motion', 2)
        self._stop = ctypes.c_int(0)
        self._all = [Simulation(mechanism, driven, self._stop) for _ in range(count)]
        self._handles = (ctypes.c_void_p*count)(*(one._handle.value for one in self._all if one._handle is not None))
        self._procedures = mechanism._handle.procedures
        self._pool = ThreadPoolExecutor(max(1, threads))
        threads = max(1, min(threads, count))
        self._bounds = [count*i//threads for i in range(threads + 1)]
        self._code = np.zeros(count, dtype=np.intc)

    @property
    def code(self) -> np.ndarray:
        """The exit codes (count,), read-only: 0, or why a motion cannot go on."""
        shown = self._code.view()
        shown.flags.writeable = False
        return shown

    @property
    def t(self) -> np.ndarray:
        """The present times (count,) [s]; that of a motion that cannot go on is the last one that it reached."""
        return np.array([one.t for one in self._all])

    def __len__(self) -> int:
        return len(self._all)

    def __getitem__(self, i: int) -> Simulation:
        """One of the motions, many[i]."""
        return self._all[i]

    def __enter__(self) -> Simulations:
        return self

    def __exit__(self, *reason: Any) -> None:
        self.close()

    def close(self) -> None:
        """End all motions and free their memory."""
        for one in self._all:
            one.close()
        self._pool.shutdown()

    def _each_part(self, function: Callable[..., int], *arguments: Any) -> None:
        """Call a function for the motions of each part, in threads. An array among its arguments has a row for each motion."""
        for one in self._all:
            one._open()

        def part(first: int, last: int) -> None:
            handles = ctypes.c_void_p(ctypes.addressof(self._handles) + first*ctypes.sizeof(ctypes.c_void_p))
            call(function, handles, last - first, *(
                argument[first:].ctypes.data if isinstance(argument, np.ndarray) else argument for argument in arguments))
        forget_raised(self._procedures)
        parts = [self._pool.submit(part, *bounds) for bounds in zip(self._bounds, self._bounds[1:])]
        try:
            # Python handles Ctrl-C in the main thread alone, which must not wait without end
            while wait(parts, 0.05).not_done:
                pass
        except BaseException:
            self._stop.value = 1
            wait(parts)
            self._stop.value = 0
            self._code[self._code == INTERRUPTED] = 0
            raise
        for done in parts:
            done.result()
        raise_pending(self._procedures)

    def advance(self, t: float) -> None:
        """Go on to a time [s] with all motions that can go on."""
        before = np.count_nonzero(self._code)
        self._each_part(lib.simulations_advance, float(t), self._code)
        warn_of_raised(self._procedures, int(np.count_nonzero(self._code)) - int(before), 'motion', 2)

    def set(self, name: str, values: Any) -> None:
        """Give a number of a load or a motor a value in each motion, from now on: one for all, or (count,)."""
        given = np.ascontiguousarray(np.broadcast_to(np.asarray(values, dtype=float), (len(self._all),)))
        self._each_part(lib.simulations_set, text(name), given, self._code)

    def _take(self, place: int) -> np.ndarray:
        found = np.empty((len(self._all), self._all[0]._n))
        arrays: list[np.ndarray | None] = [None, None, None]
        arrays[place] = found
        self._each_part(lib.simulations_take, self._code, *arrays)
        return found

    @property
    def q(self) -> np.ndarray:
        """The coordinates (count, M)."""
        return self._take(0)

    @property
    def dq(self) -> np.ndarray:
        """Their rates (count, M)."""
        return self._take(1)

    @property
    def ddq(self) -> np.ndarray:
        """Their second derivatives (count, M)."""
        return self._take(2)
