"""Numbers in 16 bits: what comes out is what went in, to half a step."""

from __future__ import annotations

import base64
import gzip
import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from warpgran.viewer.sixteen_bits import MISSING, Packing, quantized

ANY = st.floats(-1e300, 1e300) | st.sampled_from([np.nan, np.inf, -np.inf])


@given(arrays(float, st.integers(0, 50), elements=ANY))
def test_a_value_comes_back_to_half_a_step_or_as_missing(values: np.ndarray) -> None:
    codes, offset, step = quantized(values)
    finite = np.isfinite(values)
    assert ((codes == MISSING) == ~finite).all()
    back = offset + step * codes[finite].astype(float)
    size = np.abs(values[finite]).max(initial=0.0)
    assert (np.abs(back - values[finite]) <= 0.5 * step * (1 + 1e-9) + 1e-14 * size).all()


def test_the_largest_and_the_smallest_value_are_kept_and_a_constant_is_exact() -> None:
    codes, offset, step = quantized(np.array([0.3, -0.2, 0.7]))
    assert codes.tolist()[1] == 0 and offset == -0.2
    assert offset + step * int(codes[2]) == pytest.approx(0.7, rel=1e-14)
    codes, offset, step = quantized(np.full(3, 0.1))
    assert codes.tolist() == [0, 0, 0] and (offset, step) == (0.1, 0.0)


@pytest.mark.parametrize("word", ["a", "ab"])
def test_codes_begin_at_an_even_place_after_a_line_of_json(word: str) -> None:
    packing = Packing({"word": word})
    packing.add("values", np.array([[1.0, np.nan], [2.0, 3.0]]))
    data = gzip.decompress(base64.b64decode(packing.text()))
    end = data.index(b"\n")
    head = json.loads(data[:end])
    assert (end + 1) % 2 == 0
    assert head["word"] == word and head["arrays"]["values"]["shape"] == [2, 2]
    assert np.frombuffer(data[end + 1 :], "<u2").tolist()[:2] == [0, MISSING]
