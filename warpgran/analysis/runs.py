"""How the runs of a result differ, and how each of them ended."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from warpgran.schema import is_key


def swept(data: xr.Dataset) -> list[str]:
    """The dotted keys in which the runs differ: coordinates of `run`."""
    return [str(name) for name in data.coords if is_key(str(name)) and data[name].dims == ("run",)]


def status_words(data: xr.Dataset) -> np.ndarray:
    """How each run ended, as words, also where the result gives numbers and a list of meanings."""
    status = data["status"]
    meanings = str(status.attrs.get("flag_meanings", "")).split()
    flags = np.atleast_1d(status.attrs.get("flag_values", []))
    words: dict[Any, str] = dict(zip(flags.tolist(), meanings, strict=False))
    found = [words.get(value, str(value)) for value in status.values.ravel().tolist()]
    return np.array(found, dtype=object).reshape(status.shape)
