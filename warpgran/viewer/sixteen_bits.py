"""Numbers as 16-bit integers with an offset and a step, gzipped and in base64, as the page unpacks them."""

from __future__ import annotations

import base64
import gzip
import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from warpgran.arrays import Array

MISSING = 65535
"""The code of what is not a number, or not finite."""
LARGEST = 65534
"""The code of the largest value."""


class Packing:
    """A head of words and numbers, and arrays of 16-bit codes; together a piece of the page.

    Attributes:
        head: What the page reads as JSON; `arrays` in it says of each array its shape, offset and step.
    """

    def __init__(self, head: Mapping[str, Any]) -> None:
        self.head: dict[str, Any] = {**head, "arrays": {}}
        self._codes: list[bytes] = []

    def add(self, name: str, values: Array) -> None:
        """Add an array of any shape; a value is offset + step * code, to half a step."""
        codes, offset, step = quantized(values)
        self.head["arrays"][name] = {"shape": list(values.shape), "offset": offset, "step": step}
        self._codes.append(codes.astype("<u2").tobytes())

    def text(self) -> str:
        """Gzipped and in base64: the head as a line of JSON, blanks to an even length, the codes of all arrays."""
        head = json.dumps(self.head, allow_nan=False, separators=(",", ":"))
        line = head.encode("ascii")
        line += b" " * (1 - len(line) % 2) + b"\n"
        return base64.b64encode(gzip.compress(line + b"".join(self._codes), compresslevel=6, mtime=0)).decode("ascii")


def quantized(values: Array) -> tuple[Array, float, float]:
    """The codes of values, uint16, the value of code 0 and the step from one code to the next.

    Args:
        values: any shape; what is not finite gets the code MISSING.
    """
    finite = np.isfinite(values)
    known = values[finite]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)
    step = high / LARGEST - low / LARGEST  # each alone, so that the largest floats do not overflow
    codes = np.full(values.shape, MISSING, dtype=np.uint16)
    codes[finite] = np.rint(known / step - low / step).clip(0, LARGEST) if step else 0
    return codes, low, step
