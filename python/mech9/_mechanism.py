"""Mechanisms: read, built, changed, and analysed."""
from __future__ import annotations

import ctypes
import html
import os
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, Sequence, TypeVar

import numpy as np

from ._errors import DataError, Error, UsageError
from ._library import Handle, call, call_stoppable, count, lib, warn_of_raised
from ._library import text as text_of
from ._pictures import Picture, drawn
from ._positions import PositionFinder
from ._procedures import Procedure, Progress
from ._results import Branches, Exponents, Linear, LinearMotion, Periodic, Results, linear_at_rest, linear_motion, multipliers_of
from ._words import group, run_setting, written

if TYPE_CHECKING:
    from ._equations import Equations
    from ._function import Function
    from ._simulation import Simulation, Simulations


F = TypeVar('F')


def _path(path: str | os.PathLike[str]) -> bytes:
    name = os.fsencode(path)
    if b'\0' in name:
        raise UsageError('a path must not have zero bytes', 2)
    return name


def read(path: str | os.PathLike[str]) -> Mechanism:
    """Read a data file, and check its syntax. `check` or a run checks whether the mechanism makes sense."""
    handle = Handle()
    call(lib.read_file, _path(path), ctypes.byref(handle))
    return Mechanism(_handle=handle)


_importing = threading.Lock()   # the library imports one robot at a time


def import_robot(path: str | os.PathLike[str], loops: str | os.PathLike[str] | None = None, *, driven: bool = True) -> Mechanism:
    """Import a robot from a file in URDF, MJCF or SDF, as `mech9k --import` does; loops: a file of <loop> elements for URDF. With
    driven=False no drive holds the independent coordinates, as by mech9d.

    `imported_text` of the mechanism is the data file as it was imported, with comments; `import_messages` tells in a line each what is
    not taken over, and last the numbers of links and coordinates.
    """
    handle = Handle()
    with _importing:
        call(lib.import_file, _path(path), None if loops is None else _path(loops), int(not driven), ctypes.byref(handle))
    m = Mechanism(_handle=handle)
    m.imported_text = (lib.mechanism_imported_text(handle) or b'').decode('utf-8', 'replace')
    m.import_messages = tuple((lib.mechanism_import_messages(handle) or b'').decode('utf-8', 'replace').splitlines())
    return m


def read_text(text: str) -> Mechanism:
    """Read a text that has the form of a data file."""
    handle = Handle()
    call(lib.read_text, text_of(text), ctypes.byref(handle))
    return Mechanism(_handle=handle)


def _double(value: Any) -> float:
    try:
        return float(value)
    except OverflowError:
        raise UsageError(f'{value} is too large', 2) from None


@dataclass(frozen=True)
class Check:
    """What `Mechanism.check` found: the mobility, the number of redundant equations, and a report in words."""
    mobility: int
    redundant: int
    text: str

    def __str__(self) -> str:
        return self.text


class Optimum:
    """What `Mechanism.optimize` found: the best design (value, parameters, mechanism), and all distinct ones, best first (optima)."""

    def __init__(self, searched: Mechanism, with_forces: bool, optima: Results):
        self.optima = optima
        self.made = int(optima.quantities['made'])
        self._searched, self._with_forces = searched.copy(), with_forces

    @property
    def value(self) -> float:
        """The value of the best design; smaller is better."""
        return float(self.optima['value'][0])

    @property
    def parameters(self) -> dict[str, float]:
        """The parameters of the best design."""
        return {name: float(self.optima[name][0]) for name in self._searched.parameters}

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism of the best design."""
        return self.design(0)

    def design(self, i: int) -> Mechanism:
        """The mechanism of one of the designs, from 0 on."""
        row = self.optima.table[i]
        n = len(self._searched.parameters)
        parameters, q = np.array(row[1:1 + n]), np.array(row[1 + n:-1])
        handle = Handle(procedures=self._searched._handle.procedures)
        call(lib.mechanism_design, self._searched._handle, int(self._with_forces), parameters.ctypes.data, q.ctypes.data,
             ctypes.byref(handle))
        return Mechanism(_handle=handle)

    def __repr__(self) -> str:
        return f'<mech9.Optimum: {len(self.optima.table)} designs, the best one with value {self.value:.6g}>'


class Positions(np.ndarray):
    """Positions (n, M), one column for each coordinate; `code` (n,) is 0, or the exit code of a position that was not reached."""
    code: np.ndarray

    def __array_finalize__(self, made_from: Any) -> None:
        if made_from is not None and not hasattr(self, 'code'):
            # of other rows the codes are not known
            self.code = getattr(made_from, 'code', None) if self.shape == made_from.shape else None   # type: ignore[assignment]

    def __reduce__(self) -> Any:
        function, arguments, state = super().__reduce__()   # type: ignore[misc]
        return function, arguments, (state, self.code)

    def __setstate__(self, state: Any) -> None:
        of_array, self.code = state
        super().__setstate__(of_array)


class Mechanism:
    """A mechanism: groups of a data file in memory.

    Mechanism(title='four-bar') makes an empty one, to which `add` brings groups. It takes all words of &mechanism: length_unit='mm'.
    """
    imported_text: str = ''                    # of import_robot
    import_messages: tuple[str, ...] = ()      # of import_robot

    def __init__(self, title: str | None = None, *, _handle: Handle | None = None, **words: Any):
        if _handle is None:
            _handle = Handle()
            call(lib.read_text, b'', ctypes.byref(_handle))
        self._handle = _handle
        if title is not None:
            words = {'title': title, **words}
        if words:
            self.add('mechanism', **words)

    def __del__(self) -> None:
        if getattr(self, '_handle', None):
            lib.mechanism_destroy(self._handle)

    # groups and numbers

    def add(self, name: str, /, **words: Any) -> Mechanism:
        """Add a group of the data file: add('pair', coordinate=1, links=(1, 2), kind='revolute')."""
        call(lib.mechanism_add, self._handle, text_of(group(name, words)))
        return self

    def remove(self, name: str) -> Mechanism:
        """Remove all groups of a name: remove('drive'). There may be none."""
        call(lib.mechanism_remove, self._handle, text_of(name))
        return self

    def __getitem__(self, name: str) -> float:
        """A number by the name that --set has for it, or the value of a parameter."""
        value = ctypes.c_double()
        call(lib.mechanism_number, self._handle, text_of(self._full_name(name)), ctypes.byref(value))
        return value.value

    def __setitem__(self, name: str, value: Any) -> None:
        """Set a number, or a name of a group to a text, a truth value or a list."""
        if isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool):
            try:
                call(lib.mechanism_set, self._handle, text_of(self._full_name(name)), _double(value))
            except DataError as reason:
                try:   # a group or a name that is missing is added
                    call(lib.mechanism_apply, self._handle, text_of(f'{name}={written(value)}'))
                except Error:
                    raise reason from None
        else:
            call(lib.mechanism_apply, self._handle, text_of(f'{name}={written(value)}'))

    __iter__ = None   # numbers have names, not places
    __contains__ = None

    def _full_name(self, name: str) -> str:
        if not isinstance(name, str):
            raise UsageError(f'a number has a name such as pair(2).point(1), and not {name!r}', 2)
        if '.' in name:
            return name
        if name not in self.parameters:
            raise DataError(f'there is no parameter {name!r}; a number has a name such as pair(2).point(1)', 3)
        return f"parameter('{name}').value"

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of the parameters, without those that are formulas."""
        return tuple(lib.mechanism_parameter(self._handle, i).decode() for i in range(lib.mechanism_parameters(self._handle)))

    def copy(self) -> Mechanism:
        """An independent copy."""
        handle = Handle(procedures=self._handle.procedures)
        call(lib.mechanism_copy, self._handle, ctypes.byref(handle))
        return Mechanism(_handle=handle)

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> Mechanism:
        return self.copy()

    def with_(self, **values: Any) -> Mechanism:
        """A copy with other numbers: with_(crank=0.36), or with_(**{'pair(2).point(1)': 0.36})."""
        changed = self.copy()
        for name, value in values.items():
            changed[name] = value
        return changed

    def text(self) -> str:
        """The text of a data file that makes this mechanism."""
        return str(lib.mechanism_text(self._handle).decode('utf-8', 'replace'))

    def __getstate__(self) -> tuple[str, list[tuple[str, Any]]]:
        return self.text(), [(procedure.name, procedure.function) for procedure in self._handle.procedures]

    def __setstate__(self, state: tuple[str, list[tuple[str, Any]]]) -> None:
        text, procedures = state
        handle = Handle()
        call(lib.read_text, text.encode('utf-8'), ctypes.byref(handle))
        self._handle = handle
        for name, function in procedures:
            self._use(name, function)

    def __repr__(self) -> str:
        groups = sum(line.startswith('&') for line in self.text().splitlines())
        return f'<mech9.Mechanism: {groups} groups>'

    # user procedures

    def pair(self, function: F) -> F:
        """Register a function for pairs with kind='user', also as @m.pair: f(coordinate, q, parameters) returns three points (3, 3)
        [m] of the moving link in its reference link: its origin, a point on its x axis, and a third one with y along
        (r2 - r1) x (r3 - r1), as one on -z; or (3, 3, 3): the points and their two derivatives by q.

        A compiled function has an `address`, as one of numba.cfunc (mech9.numba has the signatures).
        """
        return self._use('pair', function)

    def drive(self, function: F) -> F:
        """Register a function for drives with kind='user', also as @m.drive: f(coordinate, t, parameters) returns the coordinate
        [rad, m], or three numbers: the coordinate and its two derivatives by t."""
        return self._use('drive', function)

    def coupling(self, function: F) -> F:
        """Register a function for couplings with kind='user', also as @m.coupling: f(coupling, first, parameters) returns the second
        coordinate [rad, m], or three numbers: this coordinate and its two derivatives by the first one."""
        return self._use('coupling', function)

    def force(self, function: F) -> F:
        """Register a function for loads with kind='user', also as @m.force: f(t, motion, parameters, loads) reads the motion and adds
        to the loads (see Motion and Loads)."""
        return self._use('force', function)

    def _use(self, name: str, function: F) -> F:
        procedure = Procedure(name, function)
        call(getattr(lib, 'mechanism_use_' + name), self._handle, procedure.address, None)
        self._handle.procedures = tuple(one for one in self._handle.procedures if one.name != name) + (procedure,)
        return function

    # analyses

    def check(self) -> Check:
        """Judge structure and assembly."""
        handle = ctypes.c_void_p()
        call(lib.check, self._handle, ctypes.byref(handle))
        text = (lib.results_text(handle) or b'').decode('utf-8')
        found = Results(handle.value)   # type: ignore[arg-type]
        return Check(int(found.quantities['mobility']), int(found.quantities['redundant']), text)

    @property
    def is_driven(self) -> bool:
        """Whether drives move all independent coordinates."""
        driven = ctypes.c_int()
        call(lib.mechanism_is_driven, self._handle, ctypes.byref(driven))
        return bool(driven.value)

    def kinematics(self, *, progress: Callable[[float], Any] | None = None, **words: Any) -> Results:
        """A driven run, as mech9k makes it. It takes the words of &time, &output and &solver; they hold for this run alone.

        progress(done) is called about ten times a second with the share that is done, from 0 to 1, in the thread of the computation;
        what it raises stops the run.
        """
        return self._run(lib.kinematics, words, progress)

    def dynamics(self, *, progress: Callable[[float], Any] | None = None, **words: Any) -> Results:
        """A run under forces, as mech9d makes it. It takes the words of &time, &output and &solver; they hold for this run alone.
        progress as for kinematics."""
        return self._run(lib.dynamics, words, progress)

    def _run(self, function: Any, words: dict[str, Any], progress: Callable[[float], Any] | None) -> Results:
        run = self._with_words(words)
        results = None
        try:
            results = run._results(function, lambda run, stop, out: (run, stop, out), progress)
        except BaseException as reason:
            results = getattr(reason, 'results', None)
            raise
        finally:
            if results is not None:
                results._of_run(run if run is not self else self.copy(), function is not lib.kinematics)
        return results

    def _with_words(self, words: dict[str, Any]) -> Mechanism:
        """This mechanism, or a copy with the words of a run."""
        if not words:
            return self
        changed = self.copy()
        for word, value in words.items():
            call(lib.mechanism_apply, changed._handle, text_of(run_setting(word, value)))
        return changed

    def _results(self, function: Any, arguments: Any, progress: Callable[[float], Any] | None = None) -> Results:
        """Call an analysis that may take long; a failure keeps what was computed before it."""
        handle = ctypes.c_void_p()
        called = self
        told = None
        if progress is not None:
            told = Progress(progress)
            called = self.copy()
            call(lib.mechanism_use_progress, called._handle, told.address, None)
        failure, stopped = None, None
        try:
            failure = call_stoppable(function, lambda stop: arguments(called._handle, stop, ctypes.byref(handle)), (called, handle, told))
        except KeyboardInterrupt as interrupt:
            stopped = interrupt
        results = Results(handle.value, lambda: self.parameters) if handle.value else None
        reason = told.raised[0] if told is not None and told.raised else stopped if stopped is not None else failure
        if reason is not None:
            reason.results = results   # type: ignore[attr-defined]
            raise reason
        assert results is not None
        return results

    def equilibrium(self, starts: int = 0) -> Results:
        """The equilibrium to which the start leads, or those of many random starts: a row for each."""
        return self._results(lib.equilibrium, lambda m, stop, out: (m, count(starts, 'starts'), stop, out))

    def modes(self) -> Results:
        """The modes of vibration about the equilibrium to which the start leads: a row for each."""
        return self._results(lib.modes, lambda m, stop, out: (m, out))

    def assemblies(self, starts: int = 100) -> Results:
        """The assemblies with the independent coordinates of the start: a row of coordinates for each."""
        return self._results(lib.assemblies, lambda m, stop, out: (m, count(starts, 'starts'), stop, out))

    def range(self) -> Results:
        """How far each independent coordinate can go while the others are held: coordinate, lower, upper; infinite where nothing stops it.

        report['ranges'] tells the name of each coordinate and what limits it."""
        return self._results(lib.range, lambda m, stop, out: (m, stop, out))

    def exponents(self, how_many: int = 1, **words: Any) -> Exponents:
        """The largest Lyapunov exponents of the motion under forces. It takes the words of &exponents, as transient=100 and time=1000; they
        hold for this call alone."""
        moved = self
        if words:
            moved = self.copy()
            for word, value in words.items():
                call(lib.mechanism_apply, moved._handle, text_of(f'exponents.{word}={written(value)}'))
        found = moved._results(lib.exponents, lambda m, stop, out: (m, count(how_many, 'how_many', 1), stop, out))
        numbers = np.array(list(found.quantities.values()))
        return Exponents(*numbers[:-1].reshape(3, -1), found.t, found.table[:, 1:], float(numbers[-1]))

    def periodic(self, **words: Any) -> Periodic:
        """A periodic motion under forces, stable or not, near the start. It takes the words of &periodic, as period=9.42 and starts=20, and
        those of &time, &output and &solver; they hold for this call alone."""
        moved = self.copy()
        for word, value in words.items():
            setting = f'periodic.{word}={written(value)}' if word in ('period', 'starts') else run_setting(word, value)
            call(lib.mechanism_apply, moved._handle, text_of(setting))
        run = moved._run(lib.periodic, {}, None)
        found = run.report['periodic']
        return Periodic(found['period'], multipliers_of(found), found['stability'], run, tuple(run.report.get('periodic_motions', [found])))

    def branch(self, parameter: str, forces: bool = True, **words: Any) -> Branches:
        """Branches over a parameter: positions of rest, periodic motions with of='periodic', or with forces=False positions of a driven
        mechanism. It takes the words of &branch, as low=0 and high=20; they stand in place of all groups &branch for this call alone."""
        moved = self.copy().remove('branch').add('branch', parameter=parameter, **words) if words else self
        found = moved._results(lib.branch, lambda m, stop, out: (m, text_of(parameter), int(forces), stop, out))
        return Branches(parameter, found.names, found.units, found.table, found.report.get('branches', []))

    def cam(self, number: int = 1) -> Results:
        """The profile of a cam, of which &cam describes the follower: the columns of --cam, and its entry of a report as `report`."""
        return self._results(lib.cam, lambda m, stop, out: (m, count(number, 'number', 1), out))

    def study(self, threads: int = 1, dynamics: bool | None = None, *, carry: str | None = None,
              progress: Callable[[float], Any] | None = None, **values: Any) -> Any:
        """Make all runs of &study, or one for each of the values of parameters or numbers: study(crank=np.linspace(0.2, 0.4, 5)).

        Several lists of values have the same length. The answer is an xarray.Dataset over `run`, with parameters, quantities and
        exit codes, and with the points of a &section as `section.q1` and so on over `section_point`; without xarray it is Results.
        carry: 'forwards', 'backwards' or 'both' begin each run where the one before ended. dynamics: whether forces move the mechanism; by default where a coordinate has no drive.
        progress as for kinematics. A warning tells what a procedure raised that made runs fail.
        """
        if not values and carry is not None:
            changed = self.copy()
            call(lib.mechanism_apply, changed._handle, text_of(f'study.carry={written(carry)}'))
            return changed.study(threads, dynamics, progress=progress)
        if not values:
            return self._study(threads, dynamics, {}, progress)
        changed = self.copy()
        names = {}
        for i, name in enumerate(values):
            if name in self.parameters:
                continue
            new = free_name(changed.parameters, i + 1)
            names[new] = name
            changed.add('parameter', name=new, value=self[name], sets=name)
        lists = {name: np.atleast_1d(np.asarray(one, dtype=float)) for name, one in values.items()}
        n = {len(one) for one in lists.values()}
        if any(one.ndim != 1 or not np.isfinite(one).all() for one in lists.values()) or 0 in n:
            raise UsageError('the values of a study are lists of finite numbers', 2)
        if len(n) != 1:
            raise UsageError('the lists of values must have the same length', 2)
        columns = [lists[names.get(name, name)] if names.get(name, name) in lists else np.full(max(n), changed[name])
                   for name in changed.parameters]
        with tempfile.TemporaryDirectory(prefix='mech9_') as folder:
            path = os.path.join(folder, 'values.dat')
            np.savetxt(path, np.column_stack(columns), fmt='%.17g')
            changed.remove('study').add('study', kind='list', file=path, **({} if carry is None else {'carry': carry}))
            return changed._study(threads, dynamics, names, progress)

    def _study(self, threads: int, dynamics: bool | None, names: dict[str, str], progress: Callable[[float], Any] | None) -> Any:
        with_forces = not self.is_driven if dynamics is None else dynamics
        runs = self._results(lib.study, lambda m, stop, out: (m, int(with_forces), count(threads, 'threads', 1), stop, out), progress)
        warn_of_raised(self._handle.procedures, int(np.count_nonzero(runs['exit_code'])), 'run', 3)
        try:
            import xarray
        except ImportError:
            return runs
        data = {names.get(name, name): ('run', runs[name].astype(int) if name == 'exit_code' else runs[name],
                                        {'units': runs.units[name]} if runs.units[name] else {})
                for name in runs.names if name != 'run'}
        if 'section' in runs.matrices:
            data |= {f'section.{name}': ('section_point', runs.section[name]) for name in runs.section.names}
        return xarray.Dataset(data, coords={'run': runs['run'].astype(int)})

    def linear(self, at: float | str | Sequence[float] | np.ndarray | None = None) -> Linear | LinearMotion:
        """The equations of motion linearised about the equilibrium to which the start leads; or, at a time, times in order or 'outputs', about the motion."""
        if at is None:
            return linear_at_rest(self._results(lib.linear, lambda m, stop, out: (m, out)))
        return linear_motion(at, lambda times: self._results(lib.linear_at, lambda m, stop, out: (m, len(times), times.ctypes.data, stop, out)))

    def optimize(self, *, threads: int = 1, dynamics: bool | None = None, progress: Callable[[float], Any] | None = None,
                 **words: Any) -> Optimum:
        """Search for the best design. It takes the words of &optimum, as seed=1 and starts=100; they hold for this search alone.
        progress as for kinematics."""
        with_forces = not self.is_driven if dynamics is None else dynamics
        searched = self
        if words:
            searched = self.copy()
            for word, value in words.items():
                call(lib.mechanism_apply, searched._handle, text_of(f'optimum.{word}={written(value)}'))
        found = searched._results(lib.optimize, lambda m, stop, out: (m, int(with_forces), count(threads, 'threads', 1), stop, out), progress)
        return Optimum(searched, with_forces, found)

    # pictures

    def sketch(self, view: str | None = None) -> Picture:
        """The assembled start as a drawing; view as for the option --view."""
        return drawn(lambda path: call(lib.sketch, self._handle, path, text_of(view or '')), 'svg')

    def animate(self, *, kind: str = 'html', view: str | None = None, dynamics: bool | None = None, **words: Any) -> Picture:
        """A run as a moving picture of a kind: 'html', 'svg', 'gif' or 'mp4'. It takes the words of a run."""
        run = self._with_words(words)
        with_forces = not run.is_driven if dynamics is None else dynamics

        def draw(path: bytes) -> None:
            failure = call_stoppable(lib.animate, lambda stop: (run._handle, int(with_forces), path, text_of(view or ''), stop))
            if failure is not None:
                raise failure
        return drawn(draw, kind)

    def _repr_html_(self) -> str:
        """The drawing of the start, or the text where it cannot be drawn."""
        try:
            return self.sketch()._repr_html_()
        except Error as failure:
            return f'<pre>{html.escape(str(failure))}</pre><pre>{html.escape(self.text())}</pre>'

    # many positions

    def positions(self, q: Any, *, threads: int = 1) -> Positions:
        """Positions for values of the independent coordinates, (n, I) in the order of cq; for one such coordinate also (n,).

        The solver goes from the assembled start to each position directly: the order of the rows does not matter, and far values take
        long. The result is (n, M), with `code` (n,). A position that is not reached is NaN. Positions of planar mechanisms are found
        side by side in vector registers, as many at once as these hold: to round-off the same as one by one.
        """
        return self._positions(threads, q)[0]

    def rates(self, q: Any, dq: Any, *, threads: int = 1) -> Positions:
        """Rates of all coordinates (n, M) in positions q (n, I), from the rates dq (n, I) of the independent ones.

        Singular positions of several independent coordinates have code 6 and no rates.
        """
        return self._positions(threads, q, dq)[1]

    def accelerations(self, q: Any, dq: Any, ddq: Any, *, threads: int = 1) -> Positions:
        """Second derivatives of all coordinates (n, M), from those of the independent ones (n, I)."""
        return self._positions(threads, q, dq, ddq)[2]

    def _positions(self, threads: int, *given: Any) -> list[Positions]:
        first = PositionFinder(self)
        arrays = [first.rows(values) for values in given]
        if any(array.shape != arrays[0].shape for array in arrays):
            raise UsageError('positions, rates and accelerations must have the same shape', 2)
        n = len(arrays[0])
        found = [np.empty((n, first.coordinates)) for _ in arrays]
        code = np.zeros(n, dtype=np.intc)
        threads = max(1, min(count(threads, 'threads', 1), n))
        bounds = [n*i//threads for i in range(threads + 1)]
        finders = [first] + [PositionFinder(self) for _ in range(threads - 1)]

        def work(i: int) -> None:
            part = slice(bounds[i], bounds[i + 1])
            finders[i].find([array[part] for array in arrays], [array[part] for array in found], code[part])

        if threads == 1:
            work(0)
        else:
            with ThreadPoolExecutor(threads) as pool:
                list(pool.map(work, range(threads)))
        code.flags.writeable = False
        shown = []
        for array in found:
            array.flags.writeable = False
            positions = array.view(Positions)
            positions.code = code
            shown.append(positions)
        return shown

    # others

    def function(self, inputs: Sequence[str], outputs: Sequence[str]) -> Function:
        """Quantities as a function of numbers: f(x), f.jacobian(x)."""
        from ._function import Function
        return Function(self, inputs, outputs)

    def equations(self, q: Any = None, *, clock: bool = False) -> Equations:
        """The equations of motion as a function with exact derivatives, for other programs: f(x, p, t), f.jacobian(x, p, t).

        q: all coordinates (M,) of a closed position [rad, m] at which closed chains begin; by default the assembled start. With
        clock=True cosine and sine of the phase of all drives and loads are parts of the state, in place of the time.
        """
        from ._equations import Equations
        return Equations(self, q, clock)

    def simulation(self, *, driven: bool = False, **words: Any) -> Simulation:
        """A motion that you advance step by step; it takes the words of &solver and &time."""
        from ._simulation import Simulation
        return Simulation(self._with_words(words), driven, ctypes.c_int(0))

    def simulations(self, how_many: int, *, driven: bool = False, threads: int = 1, **words: Any) -> Simulations:
        """Many motions side by side, each from the same start: q, dq (count, M), set(name, values), advance(t)."""
        from ._simulation import Simulations
        return Simulations(self._with_words(words), count(how_many, 'how_many', 1), driven, count(threads, 'threads', 1))


def free_name(taken: tuple[str, ...], i: int) -> str:
    """A name for a parameter that no other has."""
    name = f'input_{i}'
    while name in taken:
        name += '_'
    return name
