"""The runs of a result file as arrays, read without xarray, whose import takes longer than many a run."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from warpgran.analysis.run_columns import RunColumns, words_of
from warpgran.arrays import Array
from warpgran.results.reading import reading, unspoiled
from warpgran.schema import FIELDS, PER_RUN, SERIES, Status, is_key


@contextmanager
def opened_columns(path: Path) -> Iterator[RunColumns]:
    """What a file says of its runs, for a block that uses the arrays. Numbers of pending runs are NaN.

    Raises:
        StorageError: It cannot be read, or some of its numbers.
    """
    with reading(path) as file, unspoiled(path):
        waiting = file["status"][:] == Status.PENDING

        def known(name: str) -> Any:
            return _Known(file[name], waiting) if waiting.any() else file[name]

        yield RunColumns(
            run=file["run"][:],
            swept={name: _values(file[name]) for name in file if is_key(name)},
            status=words_of(file["status"][:], file["status"].attrs),
            values={name: _values(known(name)) for name in PER_RUN if name != "status"},
            series={name: known(name) for name in SERIES},
            fields={name: known(name) for name in FIELDS},
            time=file["time"][:],
            series_time=file["series_time"][:],
            x=file["x"],
            bed=file["bed"],
            texts=np.array(file.attrs["case_toml"]),
            source=str(path),
        )


class _Known:
    """A variable over the runs whose numbers are NaN in those that are pending: a part file has none there."""

    def __init__(self, data: h5py.Dataset, waiting: Array) -> None:
        self._data, self._waiting = data, waiting
        self.dtype, self.attrs, self.size, self.asstr = data.dtype, data.attrs, data.size, data.asstr

    def __getitem__(self, key: Any) -> Array:
        values: Array = self._data[key]
        if values.dtype.kind == "f":
            values[self._waiting[key[0] if isinstance(key, tuple) else key]] = np.nan
        return values

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        return np.asarray(self[:], dtype)


def _values(data: h5py.Dataset | _Known) -> Array:
    """Numbers, truth values or text as they are in a Dataset."""
    if h5py.check_string_dtype(data.dtype):
        return np.asarray(data.asstr()[:])
    return np.asarray(data[:].astype(bool) if data.attrs.get("dtype") == "bool" else data[:])
