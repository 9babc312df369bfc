"""A recording's chunks as columns by entity and name."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any

import numpy as np

from wsim.recording import columns as names

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Times = NDArray[np.float64]


class Table:
    """A file's columns by entity and name, whatever chunks they came in."""

    def __init__(self) -> None:
        self._chunks: dict[tuple[str, str], list[tuple[Any, Any, Any]]] = defaultdict(list)

    def add(self, entity: str, batch: Any) -> None:
        """Take in one chunk, as an Arrow record batch."""
        by_name = {field.name: batch.column(i) for i, field in enumerate(batch.schema)}
        rows = by_name.pop("rerun.controls.RowId")
        times = by_name.pop(names.TIMELINE, None)
        for name, column in by_name.items():
            self._chunks[entity, name].append((rows, times, column))

    def entities(self, column: str) -> list[str]:
        """Entities that have a column."""
        return sorted({entity for entity, name in self._chunks if name == column})

    def cells(self, entity: str, column: str) -> tuple[NDArray[np.int64], list[Any]]:
        """Times [ns] and Arrow lists of an entity's column, by time; static ones have the time 0, the last wins."""
        cells = []
        for rows, times, values in self._chunks.get((entity, column), ()):
            stamps = times.cast("int64").to_pylist() if times is not None else [0] * len(rows)
            ids = rows.to_pylist()
            cells += [(t, ids[i], values[i]) for i, t in enumerate(stamps) if values[i].is_valid]
        cells.sort(key=lambda cell: cell[:2])
        return np.array([cell[0] for cell in cells], dtype=np.int64), [cell[2].values for cell in cells]

    def get(
        self, entity: str, column: str, shape: tuple[int, ...], dtype: type, ragged: bool = False
    ) -> tuple[NDArray[np.int64], NDArray[Any]]:
        """Times [ns] and values (T, *shape) of an entity's column, by time; (T, N, *shape) when `ragged`."""
        times, arrays = [], []
        for _, stamps, values in self._chunks.get((entity, column), ()):
            flat = values.flatten()
            while hasattr(flat.type, "list_size"):
                flat = flat.flatten()
            times.append(stamps.cast("int64").to_numpy())
            rows = (len(values), -1, *shape) if ragged and len(flat) else (len(values), *((0,) * ragged), *shape)
            arrays.append(flat.to_numpy(zero_copy_only=False).reshape(rows))
        if not times:
            return np.zeros(0, np.int64), np.zeros((0, *((0,) * ragged), *shape), dtype)
        stamp = np.concatenate(times)
        value = np.concatenate(arrays) if len(arrays) > 1 else arrays[0]
        if np.any(stamp[1:] < stamp[:-1]):
            order = np.argsort(stamp, kind="stable")
            stamp, value = stamp[order], value[order]
        return stamp, value.astype(dtype, copy=False)


class Clock:
    """Rerun keeps whole nanoseconds; the frames' times are stored as they were given, and looked up here."""

    def __init__(self, frame_ns: NDArray[np.int64], frame_time: Times) -> None:
        self.ns = frame_ns
        self._time = frame_time

    def seconds(self, ns: NDArray[np.int64]) -> Times:
        """Times [ns] in seconds: a frame's as it was given, others to the nanosecond."""
        seconds = ns / 1e9
        if len(self.ns):
            index = np.minimum(np.searchsorted(self.ns, ns), len(self.ns) - 1)
            same = self.ns[index] == ns
            seconds[same] = self._time[index[same]]
        return seconds
