"""The functions of libmech9.so, as include/mech9.h declares them."""
from __future__ import annotations

import ctypes
import operator
import os
import threading
import time
import warnings
from ctypes import POINTER, c_char_p, c_double, c_int, c_void_p
from typing import Any, Callable

from ._errors import CODES, INTERRUPTED, Error, Finding, UsageError

_NAME = 'libmech9.so.0'
_STATUS = 'status'   # a function that can fail: its last argument is the error handle

_FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {
    'version': (c_int, []),
    'error_create': (c_void_p, []),
    'error_destroy': (None, [c_void_p]),
    'error_message': (c_char_p, [c_void_p]),
    'error_findings': (c_int, [c_void_p]),
    'error_finding_message': (c_char_p, [c_void_p, c_int]),
    'error_finding_file': (c_char_p, [c_void_p, c_int]),
    'error_finding_line': (c_int, [c_void_p, c_int]),
    'error_finding_column': (c_int, [c_void_p, c_int]),
    'read_file': (_STATUS, [c_char_p, POINTER(c_void_p)]),
    'read_text': (_STATUS, [c_char_p, POINTER(c_void_p)]),
    'import_file': (_STATUS, [c_char_p, c_char_p, c_int, POINTER(c_void_p)]),
    'mechanism_imported_text': (c_char_p, [c_void_p]),
    'mechanism_import_messages': (c_char_p, [c_void_p]),
    'mechanism_copy': (_STATUS, [c_void_p, POINTER(c_void_p)]),
    'mechanism_destroy': (None, [c_void_p]),
    'mechanism_add': (_STATUS, [c_void_p, c_char_p]),
    'mechanism_remove': (_STATUS, [c_void_p, c_char_p]),
    'mechanism_apply': (_STATUS, [c_void_p, c_char_p]),
    'mechanism_set': (_STATUS, [c_void_p, c_char_p, c_double]),
    'mechanism_number': (_STATUS, [c_void_p, c_char_p, POINTER(c_double)]),
    'mechanism_text': (c_char_p, [c_void_p]),
    'mechanism_reads': (c_char_p, [c_void_p, c_char_p]),
    'mechanism_parameters': (c_int, [c_void_p]),
    'mechanism_parameter': (c_char_p, [c_void_p, c_int]),
    'mechanism_is_driven': (_STATUS, [c_void_p, POINTER(c_int)]),
    'mechanism_use_pair': (_STATUS, [c_void_p, c_void_p, c_void_p]),
    'mechanism_use_drive': (_STATUS, [c_void_p, c_void_p, c_void_p]),
    'mechanism_use_coupling': (_STATUS, [c_void_p, c_void_p, c_void_p]),
    'mechanism_use_force': (_STATUS, [c_void_p, c_void_p, c_void_p]),
    'mechanism_use_progress': (_STATUS, [c_void_p, c_void_p, c_void_p]),
    'motion_position': (None, [c_void_p, c_int, c_void_p, c_void_p]),
    'motion_velocity': (None, [c_void_p, c_int, c_void_p, c_void_p]),
    'motion_turned': (None, [c_void_p, c_int, c_void_p, c_void_p]),
    'motion_angular_velocity': (None, [c_void_p, c_int, c_void_p]),
    'motion_q': (c_double, [c_void_p, c_int]),
    'motion_dq': (c_double, [c_void_p, c_int]),
    'loads_add_force': (None, [c_void_p, c_void_p, c_int, c_void_p, c_void_p]),
    'loads_add_torque': (None, [c_void_p, c_int, c_void_p]),
    'loads_add_generalized': (None, [c_void_p, c_int, c_double]),
    'results_destroy': (None, [c_void_p]),
    'results_columns': (c_int, [c_void_p]),
    'results_rows': (c_int, [c_void_p]),
    'results_data': (c_void_p, [c_void_p]),
    'results_name': (c_char_p, [c_void_p, c_int]),
    'results_unit': (c_char_p, [c_void_p, c_int]),
    'results_numbers': (c_int, [c_void_p]),
    'results_number_name': (c_char_p, [c_void_p, c_int]),
    'results_number_unit': (c_char_p, [c_void_p, c_int]),
    'results_number': (c_double, [c_void_p, c_int]),
    'results_parameters': (c_int, [c_void_p]),
    'results_derivative': (c_double, [c_void_p, c_int, c_int]),
    'results_text': (c_char_p, [c_void_p]),
    'results_matrices': (c_int, [c_void_p]),
    'results_matrix_name': (c_char_p, [c_void_p, c_int]),
    'results_matrix_rows': (c_int, [c_void_p, c_int]),
    'results_matrix_columns': (c_int, [c_void_p, c_int]),
    'results_matrix_data': (c_void_p, [c_void_p, c_int]),
    'results_matrix_row_name': (c_char_p, [c_void_p, c_int, c_int]),
    'results_matrix_row_unit': (c_char_p, [c_void_p, c_int, c_int]),
    'results_matrix_column_name': (c_char_p, [c_void_p, c_int, c_int]),
    'results_matrix_column_unit': (c_char_p, [c_void_p, c_int, c_int]),
    'results_lay_out': (_STATUS, [c_void_p, c_void_p]),
    'results_data_sets': (c_int, [c_void_p]),
    'results_data_set_path': (c_char_p, [c_void_p, c_int]),
    'results_data_set_kind': (c_int, [c_void_p, c_int]),
    'results_data_set_rank': (c_int, [c_void_p, c_int]),
    'results_data_set_extent': (c_int, [c_void_p, c_int, c_int]),
    'results_data_set_chunk': (c_int, [c_void_p, c_int]),
    'results_data_set_compression': (c_int, [c_void_p, c_int]),
    'results_data_set_is_scale': (c_int, [c_void_p, c_int]),
    'results_data_set_scale': (c_char_p, [c_void_p, c_int, c_int]),
    'results_data_set_text': (c_char_p, [c_void_p, c_int, c_int]),
    'results_data_set_take': (_STATUS, [c_void_p, c_int, c_int, c_int, c_void_p]),
    'results_attributes': (c_int, [c_void_p]),
    'results_attribute_path': (c_char_p, [c_void_p, c_int]),
    'results_attribute_name': (c_char_p, [c_void_p, c_int]),
    'results_attribute_text': (c_char_p, [c_void_p, c_int]),
    'check': (_STATUS, [c_void_p, POINTER(c_void_p)]),
    'sketch': (_STATUS, [c_void_p, c_char_p, c_char_p]),
    'animate': (_STATUS, [c_void_p, c_int, c_char_p, c_char_p, c_void_p]),
    'kinematics': (_STATUS, [c_void_p, c_void_p, POINTER(c_void_p)]),
    'dynamics': (_STATUS, [c_void_p, c_void_p, POINTER(c_void_p)]),
    'periodic': (_STATUS, [c_void_p, c_void_p, POINTER(c_void_p)]),
    'equilibrium': (_STATUS, [c_void_p, c_int, c_void_p, POINTER(c_void_p)]),
    'modes': (_STATUS, [c_void_p, POINTER(c_void_p)]),
    'assemblies': (_STATUS, [c_void_p, c_int, c_void_p, POINTER(c_void_p)]),
    'range': (_STATUS, [c_void_p, c_void_p, POINTER(c_void_p)]),
    'exponents': (_STATUS, [c_void_p, c_int, c_void_p, POINTER(c_void_p)]),
    'branch': (_STATUS, [c_void_p, c_char_p, c_int, c_void_p, POINTER(c_void_p)]),
    'cam': (_STATUS, [c_void_p, c_int, POINTER(c_void_p)]),
    'study': (_STATUS, [c_void_p, c_int, c_int, c_void_p, POINTER(c_void_p)]),
    'linear_at': (_STATUS, [c_void_p, c_int, c_void_p, c_void_p, POINTER(c_void_p)]),
    'linear': (_STATUS, [c_void_p, POINTER(c_void_p)]),
    'optimize': (_STATUS, [c_void_p, c_int, c_int, c_void_p, POINTER(c_void_p)]),
    'mechanism_design': (_STATUS, [c_void_p, c_int, c_void_p, c_void_p, POINTER(c_void_p)]),
    'positions_create': (_STATUS, [c_void_p, POINTER(c_void_p)]),
    'positions_destroy': (None, [c_void_p]),
    'positions_coordinates': (c_int, [c_void_p]),
    'positions_independent': (c_int, [c_void_p]),
    'positions_independent_at': (c_int, [c_void_p, c_int]),
    'positions_find': (_STATUS, [c_void_p, c_int] + 8*[c_void_p]),
    'equations_create': (_STATUS, [c_void_p, c_void_p, c_int, POINTER(c_void_p)]),
    'equations_destroy': (None, [c_void_p]),
    'equations_states': (c_int, [c_void_p]),
    'equations_parameters': (c_int, [c_void_p]),
    'equations_name': (c_char_p, [c_void_p, c_int]),
    'equations_unit': (c_char_p, [c_void_p, c_int]),
    'equations_start': (_STATUS, [c_void_p, c_void_p, c_void_p]),
    'equations_find': (_STATUS, [c_void_p, c_double] + 5*[c_void_p]),
    'simulation_create': (_STATUS, [c_void_p, c_int, c_void_p, POINTER(c_void_p)]),
    'simulation_destroy': (None, [c_void_p]),
    'simulation_advance': (_STATUS, [c_void_p, c_double]),
    'simulation_time': (c_double, [c_void_p]),
    'simulation_coordinates': (c_int, [c_void_p]),
    'simulation_take': (_STATUS, [c_void_p, c_void_p, c_void_p, c_void_p]),
    'simulation_point': (_STATUS, [c_void_p, c_char_p, c_void_p, c_void_p, c_void_p]),
    'simulation_energies': (_STATUS, [c_void_p, POINTER(c_double), POINTER(c_double)]),
    'simulation_set': (_STATUS, [c_void_p, c_char_p, c_double]),
    'simulation_free': (c_int, [c_void_p]),
    'simulation_equations': (_STATUS, [c_void_p, c_void_p, c_void_p, c_void_p]),
    'simulation_state_size': (c_int, [c_void_p]),
    'simulation_state': (_STATUS, [c_void_p, c_void_p]),
    'simulation_set_state': (_STATUS, [c_void_p, c_int, c_void_p]),
    'simulation_closure': (c_double, [c_void_p]),
    'simulations_advance': (_STATUS, [c_void_p, c_int, c_double, c_void_p]),
    'simulations_set': (_STATUS, [c_void_p, c_int, c_char_p, c_void_p, c_void_p]),
    'simulations_take': (_STATUS, [c_void_p, c_int] + 4*[c_void_p]),
}


class Handle(c_void_p):
    """The address of an object of the library, and the user procedures that calls with it may call."""
    procedures: tuple[Any, ...] = ()

    def __init__(self, value: int | None = None, procedures: tuple[Any, ...] = ()):
        super().__init__(value)
        if procedures:
            self.procedures = procedures


class Library:
    """The functions of the shared library, by their names without mech9_."""

    def __init__(self, path: str):
        loaded = ctypes.CDLL(path)
        for name, (result, arguments) in _FUNCTIONS.items():
            function = getattr(loaded, 'mech9_' + name)
            function.restype = c_int if result is _STATUS else result
            function.argtypes = arguments + [c_void_p] if result is _STATUS else arguments
            setattr(self, name, function)

    def __getattr__(self, name: str) -> Callable[..., Any]:
        raise AttributeError(name)


def _load() -> Library:
    """The library beside this package, or one that the system has; the variable MECH9_LIBRARY names another one."""
    beside = os.path.join(os.path.dirname(os.path.abspath(__file__)), _NAME)
    return Library(os.environ.get('MECH9_LIBRARY') or (beside if os.path.exists(beside) else _NAME))


lib = _load()


def count(value: Any, name: str, least: int = 0) -> int:
    """A whole number for a function of C; refuses all else."""
    try:
        number = operator.index(value)
    except TypeError:
        raise UsageError(f'{name} is a whole number, not {value!r}', 2) from None
    if not least <= number < 2**31:
        raise UsageError(f'{name} is a whole number from {least} on, below 2^31', 2)
    return number


def text(value: Any) -> bytes:
    """A text for a function of C."""
    if not isinstance(value, str):
        raise UsageError(f'a text is wanted, not {value!r}', 2)
    encoded = value.encode('utf-8')
    if b'\0' in encoded:
        raise UsageError('a text must not have zero bytes', 2)
    return encoded


def version() -> str:
    """The version of the library, as '0.9.0'."""
    number = lib.version()
    return f'{number//10000}.{number//100 % 100}.{number % 100}'


class _ErrorHandle(threading.local):
    """The error handle of a thread."""

    def __init__(self) -> None:
        self.address = lib.error_create()

    def __del__(self, destroy: Callable[[int], None] = lib.error_destroy) -> None:
        destroy(self.address)


_handle = _ErrorHandle()


def _text(value: bytes | None) -> str:
    return '' if value is None else value.decode('utf-8', 'replace')


def _begin(arguments: tuple[Any, ...]) -> tuple[Any, ...]:
    """Forget what user procedures raised in earlier calls, and return those that this call may call."""
    procedures: tuple[Any, ...] = getattr(arguments[0], 'procedures', ()) if arguments else ()
    forget_raised(procedures)
    return procedures


def forget_raised(procedures: tuple[Any, ...]) -> None:
    """Forget what user procedures raised."""
    for procedure in procedures:
        procedure.raised.clear()


def warn_of_raised(procedures: tuple[Any, ...], failed: int, what: str, level: int) -> None:
    """Warn of what user procedures raised in a call that went on with other runs or motions, of which some failed. The user's call is
    `level` calls above."""
    for procedure in procedures:
        for reason in list(procedure.raised):
            if failed > 0:
                told = f'1 {what} has' if failed == 1 else f'{failed} {what}s have'
                warnings.warn(f'{told} failed; the procedure for groups of {procedure.name} raised {type(reason).__name__}: {reason}'
                              + _place(reason), RuntimeWarning, stacklevel=level + 1)


def _place(reason: BaseException) -> str:
    """File and line where an exception was raised."""
    trace = reason.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    return '' if trace is None else f' ({trace.tb_frame.f_code.co_filename}, line {trace.tb_lineno})'


def raise_pending(procedures: tuple[Any, ...]) -> None:
    """Raise the KeyboardInterrupt or SystemExit of a user procedure, which ended or paused the call."""
    for procedure in procedures:
        for reason in list(procedure.raised):
            if not isinstance(reason, Exception):
                raise reason


def _failure(code: int, procedures: tuple[Any, ...]) -> Error:
    """The failure of the last call in this thread; what a user procedure raised is its cause."""
    raise_pending(procedures)
    handle = _handle.address
    found = []
    for i in range(lib.error_findings(handle)):
        line = lib.error_finding_line(handle, i)
        found.append(Finding(_text(lib.error_finding_message(handle, i)), _text(lib.error_finding_file(handle, i)) or None,
                             line or None, lib.error_finding_column(handle, i) or None if line else None))
    failure = CODES.get(code, Error)(_text(lib.error_message(handle)), code, tuple(found))
    for procedure in procedures:
        for reason in list(procedure.raised):
            failure.__cause__ = reason
            failure.message += f'\nthe procedure raised {type(reason).__name__}: {reason}'
            failure.args = (failure.message,)
    return failure


def call(function: Callable[..., int], *arguments: Any) -> None:
    """Call a function that can fail, and raise its failure."""
    procedures = _begin(arguments)
    code = function(*arguments, _handle.address)
    if code:
        raise _failure(code, procedures)
    if procedures:
        raise_pending(procedures)


# Seconds that a call may take to stop.
MOST_SECONDS = 1.0
# What calls need that could not be stopped.
_forgotten: list[Any] = []


def call_stoppable(function: Callable[..., int], arguments: Callable[[Any], tuple[Any, ...]], kept: Any = None) -> Error | None:
    """Call a function that may take long, and return its failure. `arguments` makes its arguments from the address of the number that
    stops it. Ctrl-C stops it and raises KeyboardInterrupt: Python handles signals in the main thread alone, so that the function
    runs in another one. `kept` must live as long as the call.
    """
    stop = c_int(0)
    made = arguments(ctypes.addressof(stop))
    procedures = _begin(made)
    failures: list[Error | None] = []
    broken: list[BaseException] = []
    done = threading.Event()

    def work() -> None:
        try:
            code = function(*made, _handle.address)
            failures.append(_failure(code, procedures) if code else None)
        except BaseException as reason:
            broken.append(reason)
        finally:
            done.set()

    if threading.current_thread() is not threading.main_thread():
        work()
    else:
        threading.Thread(target=work, daemon=True).start()
        try:
            # a signal that does not come from the system, as in a notebook, does not end a wait
            while not done.wait(0.05):
                pass
        except BaseException:
            stop.value = 1
            # some calls cannot be stopped: they go on alone, and keep what they need
            if not done.wait(MOST_SECONDS):
                _forgotten.append((stop, made, kept))
            raise
    if broken:
        raise broken[0]
    raise_pending(procedures)
    failure = failures[0]
    if failure is not None and failure.code == INTERRUPTED:
        raise KeyboardInterrupt(failure.message)
    return failure


class _Watch:
    """Lets a long call of the main thread return for a moment, again and again: Python handles Ctrl-C between two calls alone. A
    thread of its own stops the call; it rests where there is none."""
    _interval = 0.1

    def __init__(self) -> None:
        self.stop: c_int | None = None     # of the present call
        self.calls = 0
        self._is_resting = True
        self._wake = threading.Event()
        self._thread: threading.Thread | None = None

    def begin(self, stop: c_int) -> None:
        """A call begins that another number than 0 in `stop` stops."""
        self.stop = stop
        self.calls += 1
        if self._is_resting:
            self._is_resting = False
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, daemon=True)
                self._thread.start()
            self._wake.set()

    def _work(self) -> None:
        last_change = time.monotonic()
        while True:
            calls, stop = self.calls, self.stop
            time.sleep(self._interval)
            if self.calls != calls:
                last_change = time.monotonic()
            elif stop is not None and self.stop is stop:
                stop.value = 1
            elif self.stop is None and time.monotonic() - last_change > 2.0:
                self._wake.clear()
                self._is_resting = True
                if self.stop is None:   # or a call has just begun
                    self._wake.wait()
                self._is_resting = False
                last_change = time.monotonic()


_watch = _Watch()


def _forget_watch() -> None:
    """A process that was made by fork has no thread that watches."""
    global _watch
    _watch = _Watch()


os.register_at_fork(after_in_child=_forget_watch)


def call_with_pauses(function: Callable[..., int], stop: c_int, *arguments: Any) -> None:
    """Call a function that goes on where it was stopped by a number, and raise its failure; Ctrl-C raises KeyboardInterrupt."""
    procedures = _begin(arguments)
    is_main = threading.current_thread() is threading.main_thread()
    code = INTERRUPTED
    try:
        while code == INTERRUPTED:
            stop.value = 0
            if is_main:
                _watch.begin(stop)
            code = function(*arguments, _handle.address)
            if procedures:
                raise_pending(procedures)
    finally:
        if is_main:
            _watch.stop = None
    if code:
        raise _failure(code, procedures)


def pause() -> None:
    """Let the present call of the main thread return soon."""
    if _watch.stop is not None and threading.current_thread() is threading.main_thread():
        _watch.stop.value = 1
