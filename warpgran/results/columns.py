"""The runs of a result file as arrays, read without xarray, whose import takes longer than many a run."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np

from warpgran.analysis.run_columns import RunColumns, words_of
from warpgran.arrays import Array
from warpgran.results.reading import reading, unspoiled
from warpgran.schema import FIELDS, PER_RUN, SERIES, is_key


@contextmanager
def opened_columns(path: Path) -> Iterator[RunColumns]:
    """What a finished file says of its runs, for a block that uses the arrays.

    Raises:
        StorageError: It cannot be read, or some of its numbers.
    """
    with reading(path) as file, unspoiled(path):
        yield RunColumns(
            run=file["run"][:],
            swept={name: _values(file[name]) for name in file if is_key(name)},
            status=words_of(file["status"][:], file["status"].attrs),
            values={name: _values(file[name]) for name in PER_RUN if name != "status"},
            series={name: file[name] for name in SERIES},
            fields={name: file[name] for name in FIELDS},
            time=file["time"][:],
            series_time=file["series_time"][:],
            x=file["x"],
            bed=file["bed"],
            texts=np.array(file.attrs["case_toml"]),
            source=str(path),
        )


def _values(data: h5py.Dataset) -> Array:
    """Numbers, truth values or text as they are in a Dataset."""
    if h5py.check_string_dtype(data.dtype):
        return np.asarray(data.asstr()[:])
    return np.asarray(data[:].astype(bool) if data.attrs.get("dtype") == "bool" else data[:])
