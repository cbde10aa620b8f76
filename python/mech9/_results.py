"""Tables of results, as NumPy arrays that share the memory of the library."""
from __future__ import annotations

import ctypes
import html
import json
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, Iterator, Mapping, Sequence

import numpy as np

from ._errors import UsageError
from ._files import write_run
from ._library import lib

if TYPE_CHECKING:
    from ._mechanism import Mechanism
    from ._pictures import Picture

# ends of columns by the names of pairs, and the beginnings of the same columns by numbers
COLUMNS_OF_COORDINATES = {'q': 'q', 'dq': 'dq', 'ddq': 'ddq', 'drive': 'F'}
# the marks of events in plots: of more than this number there are short ticks in place of lines
MOST_LINES = 40
EVENT_STYLES: dict[str, dict[str, Any]] = {
    'impact': {'marker': '^', 'color': '#d55e00'}, 'close': {'marker': 's', 'color': '#000000'},
    'open': {'marker': 's', 'color': '#000000', 'fillstyle': 'none'}, 'lift': {'marker': '^', 'color': '#d55e00', 'fillstyle': 'none'},
    'stick': {'marker': 'o', 'color': '#0072b2'}, 'slip': {'marker': 'o', 'color': '#0072b2', 'fillstyle': 'none'}}


class _Memory:
    """The table of results of the library, which lives as long as an array refers to it."""

    def __init__(self, handle: int):
        self.handle = handle
        rows, columns, address = lib.results_rows(handle), lib.results_columns(handle), lib.results_data(handle)
        if address:
            self.__array_interface__ = {'version': 3, 'shape': (rows, columns), 'typestr': '<f8', 'data': (address, True)}

    def __del__(self) -> None:
        lib.results_destroy(self.handle)

    def text(self) -> bytes:
        """The report."""
        return lib.results_text(self.handle) or b'{}'

    def __reduce__(self) -> Any:
        """What another process gets, and a copy: the report. The table travels as an array."""
        return _Report, (self.text(),)


class _Report:
    """The report of results that come from another process, or are a copy."""
    handle = None

    def __init__(self, text: bytes):
        self._text = text

    def text(self) -> bytes:
        return self._text


@dataclass(frozen=True)
class Matrix:
    """A matrix with names and units for its rows and columns."""
    values: np.ndarray
    rows: tuple[str, ...]
    row_units: tuple[str, ...]
    columns: tuple[str, ...]
    column_units: tuple[str, ...]


def _matrix(handle: int, i: int) -> Matrix:
    n, m, address = lib.results_matrix_rows(handle, i), lib.results_matrix_columns(handle, i), lib.results_matrix_data(handle, i)
    values = np.array(np.ctypeslib.as_array(ctypes.cast(address, ctypes.POINTER(ctypes.c_double)), (n, m))) if address \
        else np.empty((n, m))
    values.flags.writeable = False

    def texts(function: Any, count: int) -> tuple[str, ...]:
        if count and function(handle, i, 0) is None:
            return ()   # points of a section have no names
        return tuple(function(handle, i, k).decode() for k in range(count))
    return Matrix(values, texts(lib.results_matrix_row_name, n), texts(lib.results_matrix_row_unit, n),
                  texts(lib.results_matrix_column_name, m), texts(lib.results_matrix_column_unit, m))


class Results(Mapping[str, np.ndarray]):
    """The answer of an analysis: columns by their names, numbers by theirs.

    names, units: of the columns. table: (rows, columns), read-only. quantities: numbers with names, as those of &quantity.
    gradients: their derivatives by parameters, where &output gradients asks for them.
    """

    def __init__(self, handle: int, list_parameters: Callable[[], tuple[str, ...]] = tuple):
        memory = _Memory(handle)
        self._memory: _Memory | _Report = memory
        self.names: tuple[str, ...] = tuple(lib.results_name(handle, i).decode() for i in range(lib.results_columns(handle)))
        self.units: dict[str, str] = {name: lib.results_unit(handle, i).decode() for i, name in enumerate(self.names)}
        self.table: np.ndarray = (np.asarray(memory) if hasattr(memory, '__array_interface__')
                                  else np.empty((0, len(self.names))))
        self._columns = {name: i for i, name in enumerate(self.names)}
        numbers = [lib.results_number_name(handle, i).decode() for i in range(lib.results_numbers(handle))]
        self.quantities: dict[str, float] = {name: lib.results_number(handle, i) for i, name in enumerate(numbers)}
        self.quantity_units: dict[str, str] = {name: lib.results_number_unit(handle, i).decode() for i, name in enumerate(numbers)}
        self.matrices: dict[str, Matrix] = {lib.results_matrix_name(handle, i).decode(): _matrix(handle, i)
                                            for i in range(lib.results_matrices(handle))}
        parameters = list_parameters() if lib.results_parameters(handle) else ()
        self.gradients = Gradients({name: {parameter: lib.results_derivative(handle, i, p) for p, parameter in enumerate(parameters)}
                                    for i, name in enumerate(numbers)} if parameters else {})

    @property
    def report(self) -> dict[str, Any]:
        """How a run ended and the work that it took, or what was found of a cam, as the option --report writes it.

        That of equilibria, modes, assemblies, ranges and cams has the names of links and coordinates; other analyses have none."""
        return dict(json.loads(self._memory.text()))

    @property
    def events(self) -> list[dict[str, Any]]:
        """The events of a run under forces, in their order: impacts, stops and contacts that close and open, friction that sticks and
        slips.

        Each has `time` [s], `kind` ('impact', 'close', 'open', 'lift', 'stick', 'slip'), `group` ('stop', 'friction',
        'contact'), `number` (of the group in the data file), and `impulse` on the coordinate [N m s, N s], positive where it
        increases its rate, or along the normal of a contact; None where there is none. Impacts of a run with reactions have
        `pairs`, too: `pair`, `force` [N s] and `moment` [N m s] of each.
        """
        return list(self.report.get('events', []))

    @property
    def section(self) -> Section:
        """The points of the section of a run, where the mechanism has a group &section."""
        if 'section' not in self.matrices:
            raise UsageError("the run has no section; m.add('section', coordinate=1) requests one", 2)
        return Section(self.matrices['section'])

    @property
    def coordinate_changes(self) -> list[dict[str, Any]]:
        """Changes of the independent coordinates of a run under forces, in their order.

        Each has `t` [s], `independent` (the coordinates from then on) and `replaced` (angles for which others are integrated).
        """
        return list(self.report.get('coordinate_changes', []))

    def _of_run(self, mechanism: Mechanism, with_forces: bool) -> None:
        """Remember the run, for pictures of it."""
        self._mechanism, self._with_forces = mechanism, with_forces

    def sketch(self, view: str | None = None) -> Picture:
        """The assembled start of the run as a drawing."""
        return self._drawn_mechanism().sketch(view)

    def animate(self, kind: str = 'html', view: str | None = None) -> Picture:
        """The run as a moving picture of a kind: 'html', 'svg', 'gif' or 'mp4'. The run is made again."""
        return self._drawn_mechanism().animate(kind=kind, view=view, dynamics=self._with_forces)

    def _drawn_mechanism(self) -> Mechanism:
        mechanism = self._run_mechanism()
        if 'periodic' in self.report:
            raise UsageError('a periodic motion is drawn by the program: mech9d FILE --periodic --animate film.html', 2)
        return mechanism

    def _run_mechanism(self, refusal: str = 'only the results of kinematics and dynamics have pictures') -> Mechanism:
        if not hasattr(self, '_mechanism'):
            raise UsageError(refusal, 2)
        return self._mechanism

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write a run to an HDF5 file, as the programs write theirs (needs h5py). A file of this name is replaced when the new one is
        whole; a file that the mechanism reads is not."""
        mechanism = self._run_mechanism('only the results of kinematics and dynamics can be written')
        if self._memory.handle is None:
            raise UsageError('these results are a copy, or come from another process; write them there, where they were computed', 2)
        write_run(self._memory.handle, mechanism, path)

    def plot(self, *columns: str) -> Any:
        """Columns over the time, with marks of events, or, of two columns, the second over the first: a matplotlib Figure."""
        if not columns:
            raise UsageError('name the columns to plot', 2)
        from matplotlib.figure import Figure
        figure = Figure()
        axes = figure.add_subplot()
        if len(columns) == 2 and 't' not in columns:
            axes.plot(self[columns[0]], self[columns[1]])
            axes.set_xlabel(f'{columns[0]} [{self._unit_of(columns[0])}]')
            axes.set_ylabel(f'{columns[1]} [{self._unit_of(columns[1])}]')
        else:
            for name in columns:
                axes.plot(self.t, self[name], label=f'{name} [{self._unit_of(name)}]')
            axes.set_xlabel(f't [{self.units["t"]}]')
            self._mark_events(axes)
            axes.legend()
        return figure

    def _mark_events(self, axes: Any) -> None:
        """Mark events over the time as the option --plot does: a line at each, or many short ticks, and on the axis a symbol of its kind."""
        events = self.events
        top, size = (1.0, 6) if len(events) <= MOST_LINES else (0.03, 3)
        for kind, style in EVENT_STYLES.items():
            times = [event['time'] for event in events if event['kind'] == kind]
            if times:
                along = axes.get_xaxis_transform()
                axes.vlines(times, 0, top, colors='0.7', linestyles='dashed', linewidth=0.8, zorder=0.5, transform=along)
                axes.plot(times, [0] * len(times), linestyle='none', clip_on=False, transform=along, label=kind, markersize=size, **style)

    def __getitem__(self, name: str) -> np.ndarray:
        """A column (rows,), read-only; it shares the memory of the table."""
        try:
            return self.table[:, self._columns[name if name in self._columns else self._numbered(name)]]
        except KeyError:
            raise KeyError(f'there is no column {name!r}; the columns are {", ".join(self.names)}') from None

    def _unit_of(self, name: str) -> str:
        """The unit of a column, also where it is called by the name of a pair or a link."""
        return self.units[name if name in self._columns else self._numbered(name)]

    def _numbered(self, name: str) -> str:
        """The name of a column by numbers, where it has that of a pair or a link: B.q is q2, B.fx is R2.fx, rod.phi is L3.phi."""
        if not isinstance(name, str):
            return name
        part, _, end = name.partition('.')
        report = self.report
        pairs, links = report.get('coordinate_names', []), report.get('link_names', [])
        pair = next((i for i, given in enumerate(pairs, 1) if given and given in (part, f'{part}(1)')), 0)
        if part and part in pairs and end in COLUMNS_OF_COORDINATES:
            return f'{COLUMNS_OF_COORDINATES[end]}{pairs.index(part) + 1}'
        if part and part in pairs and end in ('q.re', 'q.im'):   # of modes
            return f'q{pairs.index(part) + 1}{end[1:]}'
        if pair and f'R{pair}.{end}' in self._columns:
            return f'R{pair}.{end}'
        if part and part in links and f'L{links.index(part) + 1}.{end}' in self._columns:
            return f'L{links.index(part) + 1}.{end}'
        return name

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    @property
    def t(self) -> np.ndarray:
        """The times of the rows [s]."""
        return self['t']

    def to_pandas(self) -> Any:
        """The table as a pandas.DataFrame, with the time as its index where there is one."""
        import pandas  # type: ignore[import-untyped,unused-ignore]
        frame = pandas.DataFrame(self.table, columns=list(self.names))
        frame.attrs['units'] = dict(self.units)
        return frame.set_index('t') if 't' in self._columns else frame

    def to_xarray(self) -> Any:
        """The table as an xarray.Dataset over the time, or over the number of the row; units stand in the attributes."""
        import xarray
        along = 't' if 't' in self._columns else 'row'
        data = {name: (along, self[name], {'units': self.units[name]}) for name in self.names if name != along}
        over = (along, self[along], {'units': self.units[along]}) if along in self._columns else (along, np.arange(len(self.table)))
        return xarray.Dataset(data, coords={along: over}, attrs={**self.quantities})

    def _repr_html_(self) -> str:
        """The first and the last rows, for notebooks."""
        shown = self.table if len(self.table) <= 10 else np.vstack([self.table[:5], self.table[-5:]])
        rows = [''.join(f'<td>{number:.6g}</td>' for number in row) for row in shown]
        if len(self.table) > 10:
            rows.insert(5, f'<td colspan="{len(self.names)}">{len(self.table) - 10} rows</td>')
        heads = ''.join(f'<th>{html.escape(name)}<br>{html.escape(self.units[name])}</th>' for name in self.names)
        return f'<table><thead><tr>{heads}</tr></thead><tbody>' + ''.join(f'<tr>{row}</tr>' for row in rows) + '</tbody></table>'

    __eq__ = object.__eq__   # arrays have no single answer
    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return f'<mech9.Results: {len(self.table)} rows of {", ".join(self.names[:8])}{"" if len(self.names) <= 8 else " and others"}>'


class Section(Mapping[str, np.ndarray]):
    """The points of a section: `point`, `t` and the columns of the run, by their names.

    names, units: of the columns. table: (points, columns), read-only.
    """

    def __init__(self, matrix: Matrix):
        self.names: tuple[str, ...] = matrix.columns
        self.units: dict[str, str] = dict(zip(matrix.columns, matrix.column_units))
        self.table: np.ndarray = matrix.values
        self._columns = {name: i for i, name in enumerate(self.names)}

    @property
    def t(self) -> np.ndarray:
        """The times of the points [s]."""
        return self['t']

    def plot(self, x: str, y: str, reduce_angles: bool = False) -> Any:
        """The points in two columns: a matplotlib Figure. With reduce_angles, angles are shown within one turn."""
        from matplotlib.figure import Figure
        figure = Figure()
        axes = figure.add_subplot()
        axes.plot(*(self._drawn(name, reduce_angles) for name in (x, y)), linestyle='none', marker='.',
                  markersize=4 if len(self.table) <= 300 else 1)
        axes.set_xlabel(f'{x} [{self.units[x]}]')
        axes.set_ylabel(f'{y} [{self.units[y]}]')
        return figure

    def _drawn(self, name: str, reduce_angles: bool) -> np.ndarray:
        """A column as it is drawn."""
        turn = {'rad': 2 * np.pi, 'deg': 360.0}.get(self.units[name])
        return self[name] - turn * np.rint(self[name] / turn) if reduce_angles and turn else self[name]

    def __getitem__(self, name: str) -> np.ndarray:
        """A column (points,), read-only."""
        try:
            return self.table[:, self._columns[name]]
        except KeyError:
            raise KeyError(f'the section has no column {name!r}; its columns are {", ".join(self.names)}') from None

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    def __repr__(self) -> str:
        return f'<mech9.Section: {len(self.table)} points of {", ".join(self.names[:8])}{"" if len(self.names) <= 8 else " and others"}>'

    __eq__ = object.__eq__   # arrays have no single answer
    __hash__ = object.__hash__


@dataclass(frozen=True)
class SecondOrder:
    """M x'' + C x' + K x = u over the free coordinates, in SI units."""
    M: np.ndarray
    C: np.ndarray
    K: np.ndarray


@dataclass(frozen=True)
class StateSpace:
    """x' = A x + B u, y = C x + D u; states, inputs and outputs are names, with units."""
    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    states: tuple[str, ...]
    state_units: tuple[str, ...]
    inputs: tuple[str, ...]
    input_units: tuple[str, ...]
    outputs: tuple[str, ...]
    output_units: tuple[str, ...]


@dataclass(frozen=True)
class Linear:
    """The linearised equations of motion about an equilibrium q, where `free` names the free coordinates."""
    q: np.ndarray
    free: tuple[str, ...]
    second_order: SecondOrder
    state_space: StateSpace


@dataclass(frozen=True)
class LinearMotion(Linear):
    """The linearised equations of motion about a motion: deviations from it go on by them. At several times t all arrays have these as first
    dimension; names do not. dq and ddq are rates and accelerations of the motion."""
    t: np.ndarray | float
    dq: np.ndarray
    ddq: np.ndarray


def _linear_parts(of_time: Sequence[Mapping[str, Matrix]], alone: bool) -> tuple[tuple[str, ...], SecondOrder, StateSpace]:
    """The free coordinates and both forms of linearised equations, from matrices by name: those of one time alone, or over times."""
    def over_time(name: str) -> np.ndarray:
        return of_time[0][name].values if alone else np.stack([matrices[name].values for matrices in of_time])
    a, b, c = (of_time[0][f'state_space/{name}'] for name in 'ABC')
    return of_time[0]['second_order/M'].rows, SecondOrder(*(over_time(f'second_order/{name}') for name in 'MCK')), StateSpace(
        *(over_time(f'state_space/{name}') for name in 'ABCD'), states=a.rows, state_units=a.row_units, inputs=b.columns,
        input_units=b.column_units, outputs=c.rows, output_units=c.row_units)


def linear_at_rest(found: Results) -> Linear:
    """The matrices of an equilibrium."""
    free, second_order, state_space = _linear_parts([found.matrices], True)
    return Linear(found.table[0], free, second_order, state_space)


def linear_motion(at: Any, find: Callable[[np.ndarray], Results]) -> LinearMotion:
    """The matrices of a motion, whose names begin with the number of the time; those of a single time are without this dimension."""
    found, alone = find(_times_along(at)), np.ndim(at) == 0 and not isinstance(at, str)
    of_time: list[dict[str, Matrix]] = [{} for _ in found.table]
    for name, matrix in found.matrices.items():
        number, _, rest = name.partition('/')
        of_time[int(number)][rest] = matrix
    m = (found.table.shape[1] - 1) // 3
    t, q, dq, ddq = (found.table[0, part] if alone else found.table[:, part]
                     for part in (0, slice(1, m + 1), slice(m + 1, 2 * m + 1), slice(2 * m + 1, None)))
    free, second_order, state_space = _linear_parts(of_time, alone)
    return LinearMotion(q, free, second_order, state_space, t, dq, ddq)


def _times_along(at: Any) -> np.ndarray:
    """The times that `at` asks for; none for all outputs."""
    times = np.ascontiguousarray([] if isinstance(at, str) else np.atleast_1d(at), dtype=float)
    if at != 'outputs' if isinstance(at, str) else times.ndim != 1 or not times.size or not np.isfinite(times).all():
        raise UsageError(f"at is a time, times in the order of the motion, or 'outputs', not {at!r}", 2)
    return times


@dataclass(frozen=True)
class Exponents:
    """The Lyapunov exponents [1/s], largest first, with their standard errors; the means over the times up to t, `history` (times, exponents).

    changes: what these means changed by in the second half of the time. divergence: the mean divergence along the motion [1/s], with which
    the sum of all exponents agrees; NaN where not all were asked for."""
    values: np.ndarray
    errors: np.ndarray
    changes: np.ndarray
    t: np.ndarray
    history: np.ndarray
    divergence: float


def multipliers_of(found: dict[str, Any]) -> np.ndarray:
    """The multipliers of a periodic motion in a report, as complex numbers."""
    multipliers = np.array([complex(*pair) for pair in found['multipliers']])
    multipliers.flags.writeable = False
    return multipliers


@dataclass(frozen=True)
class Periodic:
    """A periodic motion: its period [s], its multipliers, largest first, and its stability ('stable', 'unstable' or 'neutral'). run: the results
    over one period. motions: the entries of all motions in the report, that of the run first."""
    period: float
    multipliers: np.ndarray
    stability: str
    run: Results
    motions: tuple[dict[str, Any], ...]


class Branches(Mapping[str, np.ndarray]):
    """Branches over a parameter: `branch`, `point`, the parameter, the coordinates, `growth` and `type`, by their names.

    Motions with a period of their own have `period`, too.

    names, units: of the columns. table: (points, columns), read-only. branches: what a report says of each, with its special points.
    """

    def __init__(self, parameter: str, names: Sequence[str], units: Mapping[str, str], table: np.ndarray, branches: list[dict[str, Any]]):
        self.parameter = parameter
        self.names: tuple[str, ...] = tuple(names)
        self.units: dict[str, str] = dict(units)
        self.table: np.ndarray = table
        self.branches = branches
        self._columns = {name: i for i, name in enumerate(self.names)}

    @property
    def special_points(self) -> list[dict[str, Any]]:
        """All special points in the order of the table: `branch`, `point`, `type`, `kind`, `value`, `q`, `growth`;
        where motions have a period of their own, `period`."""
        return [{'branch': branch['branch'], **point} for branch in self.branches for point in branch['special_points']]

    def plot(self, y: str, x: str | None = None) -> Any:
        """A column over the parameter, or over another one: a matplotlib Figure; unstable positions are broken lines."""
        from matplotlib.figure import Figure
        figure = Figure()
        axes = figure.add_subplot()
        x = self.parameter if x is None else x
        growing = self['growth'] > 0 if 'growth' in self._columns else np.zeros(len(self.table), bool)
        between = np.where(self['type'][1:] > 0, growing[:-1], growing[1:])
        same = self['branch'][1:] == self['branch'][:-1]
        for unstable, style in ((False, '-'), (True, '--')):
            shown = same & (between == unstable)
            pairs = np.where(shown, np.arange(len(shown)), -1)
            lines = [np.array([self[name][pairs], self[name][pairs + 1], np.full(len(shown), np.nan)]).T[shown].ravel() for name in (x, y)]
            axes.plot(*lines, style, color='C1' if unstable else 'C0', label='unstable' if unstable else 'stable')
        for kind, marker, label in ((1, 'o', 'fold'), (2, 's', 'branch point'), (3, '^', 'Hopf point'), (4, 'D', 'period doubling'),
                                    (5, 'v', 'torus')):
            rows = self['type'] == kind
            if rows.any():
                axes.plot(self[x][rows], self[y][rows], marker, color='black', label=label)
        axes.set_xlabel(f'{x} [{self.units[x]}]')
        axes.set_ylabel(f'{y} [{self.units[y]}]')
        axes.legend()
        return figure

    def __getitem__(self, name: str) -> np.ndarray:
        """A column (points,), read-only."""
        try:
            return self.table[:, self._columns[name]]
        except KeyError:
            raise KeyError(f'branches have no column {name!r}; their columns are {", ".join(self.names)}') from None

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    def __repr__(self) -> str:
        return f'<mech9.Branches: {len(self.branches)} over {self.parameter}, {len(self.table)} points>'

    __eq__ = object.__eq__   # arrays have no single answer
    __hash__ = object.__hash__


class Gradients(Mapping[str, Mapping[str, float]]):
    """Derivatives of quantities: gradients['stroke']['crank']."""

    def __init__(self, values: dict[str, dict[str, float]]):
        self._values = values

    def __getitem__(self, name: str) -> Mapping[str, float]:
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __repr__(self) -> str:
        return repr(self._values)
