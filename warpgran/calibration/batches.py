"""Batches of runs whose predictions are kept in a folder, so that a stage that was killed goes on to the same bits."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

import numpy as np

from warpgran.arrays import Array
from warpgran.calibration.archive import read_arrays, write_arrays
from warpgran.files import StorageError

Predict = Callable[[Array], Array]
"""Predictions (points, data) of points (points, parameters)."""
BATCH = "[0-9a-f]*.npz"
"""Names of files of batches; what a killed process has left unfinished begins with a dot."""


class Batches:
    """A function of points that remembers what it has computed, also from one process to the next."""

    def __init__(self, predict: Predict, folder: Path, identity: str) -> None:
        """Keep what is in the folder if it is of the same identity, and remove what is not, or is damaged.

        Args:
            predict: What computes a batch.
            folder: Where batches are kept; made if it is not there.
            identity: Of all that the predictions depend on beside the points.

        Raises:
            StorageError: The folder holds something else.
        """
        self._predict, self._folder = predict, folder
        self._known: dict[bytes, Array] = {}
        mark = folder / "identity.txt"
        folder.mkdir(parents=True, exist_ok=True)
        if not mark.exists() and any(folder.iterdir()):
            raise StorageError(f"cannot keep runs in {folder}: it holds files of something else; move them")
        if mark.exists() and mark.read_bytes() != identity.encode():
            for path in folder.glob(BATCH):
                path.unlink()
        mark.write_text(identity)
        for path in sorted(folder.glob(BATCH)):
            try:
                theta, predictions = read_arrays(path, "theta", "predictions")
            except StorageError:
                path.unlink()
            else:
                self._learn(theta, predictions)

    def __call__(self, theta: Array) -> Array:
        """Predictions of a batch; what the folder does not hold of it is computed together and kept."""
        theta = np.ascontiguousarray(theta)
        keys = [point.tobytes() for point in theta]
        missing = [i for i, key in enumerate(keys) if key not in self._known]
        if missing:
            points = theta[missing]
            predictions = self._predict(points)
            name = hashlib.sha256(points.tobytes()).hexdigest()[:16]
            write_arrays(self._folder / f"{name}.npz", theta=points, predictions=predictions)
            self._learn(points, predictions)
        return np.array([self._known[key] for key in keys])

    def _learn(self, theta: Array, predictions: Array) -> None:
        self._known.update(zip((point.tobytes() for point in theta), predictions, strict=True))
