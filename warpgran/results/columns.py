"""The runs of a result file as arrays, read without xarray, whose import takes longer than many a run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np

from warpgran.analysis.run_columns import RunColumns, value_in, words_of
from warpgran.arrays import Array
from warpgran.results.reading import reading, unspoiled
from warpgran.schema import PER_RUN, SERIES, is_key


def read_columns(path: Path) -> RunColumns:
    """What a finished file says of its runs, all of it in memory: for files of few runs.

    Raises:
        StorageError: It cannot be read, or some of its numbers.
    """
    with reading(path) as file, unspoiled(path):
        swept = {name: _values(file[name]) for name in file if is_key(name)}
        text = file.attrs["case_toml"]

        def parameter(key: str, default: Any) -> Array:
            said = value_in(text, key)
            return swept.get(key, np.array(default if said is None else said))

        return RunColumns(
            run=file["run"][:],
            swept=swept,
            status=words_of(file["status"][:], file["status"].attrs),
            values={name: _values(file[name]) for name in PER_RUN if name != "status"},
            series={name: file[name][:] for name in SERIES},
            time=file["time"][:],
            series_time=file["series_time"][:],
            rest_speed=parameter("time.rest_speed", np.nan),
            left=parameter("scheme.left", ""),
        )


def _values(data: h5py.Dataset) -> Array:
    """Numbers, truth values or text as they are in a Dataset."""
    if h5py.check_string_dtype(data.dtype):
        return np.asarray(data.asstr()[:])
    return np.asarray(data[:].astype(bool) if data.attrs.get("dtype") == "bool" else data[:])
