"""Which worker does which shard next. The driver and the simulation of a plan ask the same schedule.

A worker stays with its shot, shard after shard, since its simulation stands there already. Who has none takes a shot that
nobody has begun; when there is none left, the second half of what another has still to do of a shot, and simulates from the
shot's beginning without drawing.
"""

from __future__ import annotations

from typing import Hashable, Optional


class Schedule:
    def __init__(self, runs: list[list[int]]) -> None:
        self._open = [list(run) for run in runs]
        self._mine: dict[Hashable, list[int]] = {}
        self._busy: dict[Hashable, int] = {}

    def take(self, worker: Hashable) -> Optional[int]:
        """The next shard of a worker that has done its last one; None when nothing is left to begin."""
        self._busy.pop(worker, None)
        if not self._mine.get(worker):
            self._mine[worker] = self._open.pop(0) if self._open else self._half()
        if not self._mine[worker]:
            return None
        self._busy[worker] = self._mine[worker].pop(0)
        return self._busy[worker]

    def lost(self, worker: Hashable) -> Optional[int]:
        """A worker is no more: what it had is open again. The shard that it was doing."""
        shard, rest = self._busy.pop(worker, None), self._mine.pop(worker, [])
        run = ([] if shard is None else [shard]) + rest
        if run:
            self._open.insert(0, run)
        return shard

    def refused(self, worker: Hashable, shards: set[int]) -> None:
        """These are not to be done by anybody."""
        self._open = [run for run in ([s for s in run if s not in shards] for run in self._open) if run]
        for run in self._mine.values():
            run[:] = [shard for shard in run if shard not in shards]

    @property
    def busy(self) -> dict[Hashable, int]:
        return dict(self._busy)

    @property
    def left(self) -> int:
        """Shards that are not done."""
        return sum(map(len, self._open)) + sum(map(len, self._mine.values())) + len(self._busy)

    def _half(self) -> list[int]:
        longest = max(self._mine.values(), key=len, default=[])
        kept = len(longest) // 2
        half = longest[kept:]
        del longest[kept:]
        return half
