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
from warpgran.results.numbers import Numbers
from warpgran.results.reading import reading
from warpgran.schema import FIELDS, PER_RUN, SERIES, Status, is_key


@contextmanager
def opened_columns(path: Path) -> Iterator[RunColumns]:
    """What a file says of its runs, for a block that uses the arrays. Numbers of pending runs are NaN.

    Raises:
        StorageError: It cannot be read, or some of its numbers.
    """
    with reading(path) as file:
        runs, waiting = file["run"][:], file["status"][:] == Status.PENDING

        def known(name: str) -> Any:
            over = (runs, waiting) if file[name].dims[0][0].name == "/run" else ()
            return _Variable(file[name], Numbers(path, name, *over))

        yield RunColumns(
            run=runs,
            swept={name: _values(known(name)) for name in file if is_key(name)},
            status=words_of(file["status"][:], file["status"].attrs),
            values={name: _values(known(name)) for name in PER_RUN if name != "status"},
            series={name: known(name) for name in SERIES},
            fields={name: known(name) for name in FIELDS},
            time=file["time"][:],
            series_time=file["series_time"][:],
            x=known("x") if "cell" in file else file["x"],
            bed=known("bed"),
            texts=np.array(file.attrs["case_toml"]),
            source=str(path),
        )


class _Variable:
    """A variable of a file, whose numbers are judged where they are read."""

    def __init__(self, data: h5py.Dataset, numbers: Numbers) -> None:
        self._data, self._numbers = data, numbers
        self.dtype, self.shape, self.ndim, self.size = data.dtype, data.shape, data.ndim, data.size
        self.attrs, self.asstr = data.attrs, data.asstr

    def __len__(self) -> int:
        return int(self.shape[0])

    def __getitem__(self, key: Any) -> Array:
        return self._numbers.read(lambda: self._data[key], key[0] if isinstance(key, tuple) else key)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        return np.asarray(self[:], dtype)


def _values(data: _Variable) -> Array:
    """Numbers, truth values or text as they are in a Dataset."""
    if h5py.check_string_dtype(data.dtype):
        return np.asarray(data.asstr()[:])
    return np.asarray(data[:].astype(bool) if data.attrs.get("dtype") == "bool" else data[:])
