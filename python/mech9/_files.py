"""HDF5 files of runs, as the programs write them: the library has the table of their data sets, and h5py writes these."""
from __future__ import annotations

import fcntl
import math
import os
import stat
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Iterator

import numpy as np

from ._errors import FileError, UsageError
from ._library import call, lib

if TYPE_CHECKING:
    from ._mechanism import Mechanism

_NUMBERS: dict[int, np.dtype[Any]] = {1: np.dtype('<f8'), 2: np.dtype('<i4'), 3: np.dtype('<i8')}   # by the kinds of the library; others are texts
_TOGETHER = 2**20   # numbers that are written together


def write_run(handle: int, mechanism: Mechanism, path: str | os.PathLike[str]) -> None:
    """Write the file of a run. A file of this name is replaced when the new one is whole."""
    import h5py
    name = os.fsdecode(path)
    if name in ('', '-') or '\0' in name:
        raise FileError(f"{name!r} is not the name of a file for HDF5 results", 8)
    read = lib.mechanism_reads(mechanism._handle, os.fsencode(name))
    if read is not None:
        raise UsageError(f"'{name}' would overwrite '{os.fsdecode(read)}', which is read; give it another name", 2)
    call(lib.results_lay_out, handle, mechanism._handle)
    with _replaced(name) as part:
        try:
            with h5py.File(part, 'w') as file:
                _write(file, handle, h5py)
        except (OSError, RuntimeError, ValueError) as reason:   # h5py has no exceptions of its own
            number = getattr(reason, 'errno', None)
            raise FileError(f"cannot write to '{name}': {os.strerror(number) if number else reason}", 8) from reason


@contextmanager
def _replaced(name: str) -> Iterator[str]:
    """A name for a file that is being made, in the folder of the one that it replaces when it is whole. A file that cannot be
    replaced, as a device or that of another user, is written itself."""
    place = os.path.realpath(name)
    folder, permissions = os.path.dirname(place), None
    try:
        there = os.stat(place) if os.path.exists(place) else None
        if there is not None:
            if stat.S_ISDIR(there.st_mode):
                raise IsADirectoryError(21, 'it is a folder')
            permissions = stat.S_IMODE(there.st_mode)
            with open(place, 'r+b') as file:
                if stat.S_ISREG(there.st_mode):
                    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)   # HDF5 locks the files that it writes
    except BlockingIOError as reason:
        raise FileError(f"cannot open '{name}' for writing: another program has it open", 8) from reason
    except OSError as reason:
        raise FileError(f"cannot open '{name}' for writing: {reason.strerror or reason}", 8) from reason
    replaces = there is None or (stat.S_ISREG(there.st_mode) and there.st_uid == os.geteuid())
    if not (replaces and os.access(folder, os.W_OK | os.X_OK)):
        yield place
        return
    part = os.path.join(folder, f'.{os.path.basename(place)}.part')
    try:
        yield part
        if permissions is not None:
            os.chmod(part, permissions)
        os.replace(part, place)
    except BaseException:
        if os.path.exists(part):
            os.unlink(part)
        raise


def _write(file: Any, handle: int, h5py: Any) -> None:
    """Make all data sets, then their attributes and scales."""
    made = {}
    for i in range(lib.results_data_sets(handle)):
        path = lib.results_data_set_path(handle, i).decode()
        made[path] = _make(file, handle, i, path, h5py)
    for i in range(lib.results_attributes(handle)):
        described = file[lib.results_attribute_path(handle, i).decode() or '/']
        described.attrs.create(lib.results_attribute_name(handle, i).decode(), lib.results_attribute_text(handle, i),
                               dtype=h5py.string_dtype())
    for i, (path, data_set) in enumerate(made.items()):
        if lib.results_data_set_is_scale(handle, i):
            data_set.make_scale(path.split('/')[-1])
    for i, data_set in enumerate(made.values()):
        for dimension in range(data_set.ndim):
            scale = lib.results_data_set_scale(handle, i, dimension)
            if scale is not None:
                data_set.dims[dimension].attach_scale(made[scale.decode()])


def _make(file: Any, handle: int, i: int, path: str, h5py: Any) -> Any:
    """Make a data set with its values."""
    shape = tuple(lib.results_data_set_extent(handle, i, k) for k in range(lib.results_data_set_rank(handle, i)))
    kind = _NUMBERS.get(lib.results_data_set_kind(handle, i))
    if kind is None:
        texts = np.empty(shape, dtype=object)
        texts.ravel()[:] = [lib.results_data_set_text(handle, i, k) for k in range(texts.size)]
        return file.create_dataset(path, data=texts, dtype=h5py.string_dtype())
    settings: dict[str, Any] = {}
    chunk, compression = lib.results_data_set_chunk(handle, i), lib.results_data_set_compression(handle, i)
    if chunk:
        settings = {'maxshape': (None, *shape[1:]), 'chunks': (chunk, *shape[1:])}
    if compression:
        settings.update(shuffle=True, compression='gzip', compression_opts=compression)
    data_set = file.create_dataset(path, shape, kind, **settings)
    rows = shape[0] if shape else 1
    together = max(1, _TOGETHER//max(1, math.prod(shape[1:])))
    if chunk:
        together = max(chunk, together//chunk*chunk)   # each chunk is compressed once
    for first in range(0, rows, together):
        n = min(together, rows - first)
        values = np.empty((n, *shape[1:]), kind)
        call(lib.results_data_set_take, handle, i, first, n, values.ctypes.data)
        if shape:
            data_set[first:first + n] = values
        else:
            data_set[()] = values[0]
    return data_set
