"""Assignment of shards to workers, used by the driver and by the forecast.

A worker stays with its shot and takes shard after shard, because its simulation has already reached the start of the
next one. A worker without a shot takes one that has not been started. If none is left, it takes the tail of another
worker's shot, cut so that both finish at the same time; it must first simulate the shot up to there without rendering.
It waits if that would not finish sooner.
"""

from __future__ import annotations

from typing import Hashable, Optional, Sequence


class Schedule:
    """Schedule of `runs`, lists of consecutive shards of one shot.

    `positions` holds for each shard its shot and its index within the shot. `again` is the cost of simulating a shard
    without rendering it, relative to the cost of the whole shard.
    """

    def __init__(self, runs: list[list[int]], positions: Sequence[tuple[int, int]], again: float = 0.2) -> None:
        self.again = again
        self._positions = positions
        self._last: dict[Hashable, int] = {}
        self._open = [list(run) for run in runs]
        self._mine: dict[Hashable, list[int]] = {}
        self._running: dict[Hashable, int] = {}

    def take(self, worker: Hashable) -> Optional[int]:
        """Return the next shard for a worker that has finished its last one; None if nothing is left to start."""
        self._running.pop(worker, None)
        if not self._mine.get(worker):
            self._mine[worker] = self._open.pop(0) if self._open else self._end(worker)
        if not self._mine[worker]:
            return None
        self._running[worker] = self._last[worker] = self._mine[worker].pop(0)
        return self._running[worker]

    def lost(self, worker: Hashable) -> Optional[int]:
        """Reopen the shards of a lost worker. Return the shard that it was working on."""
        shard, rest = self._running.pop(worker, None), self._mine.pop(worker, [])
        self._last.pop(worker, None)
        run = ([] if shard is None else [shard]) + rest
        if run:
            self._open.insert(0, run)
        return shard

    def refused(self, worker: Hashable, shards: set[int]) -> None:
        """Remove shards that cannot be rendered."""
        self._open = [run for run in ([s for s in run if s not in shards] for run in self._open) if run]
        for run in self._mine.values():
            run[:] = [shard for shard in run if shard not in shards]

    @property
    def running(self) -> dict[Hashable, int]:
        return dict(self._running)

    @property
    def left(self) -> int:
        """Number of unfinished shards."""
        return sum(map(len, self._open)) + sum(map(len, self._mine.values())) + len(self._running)

    def _end(self, worker: Hashable) -> list[int]:
        """Return the shards that a worker takes over from another worker's run."""
        best, gain = None, 0.0
        for run in self._mine.values():
            for kept in range(len(run)):
                # The other worker is halfway through a shard that is no longer in its run.
                others = 0.5 + kept
                own = self.again * self._before(worker, run[kept]) + len(run) - kept
                sooner = 0.5 + len(run) - max(others, own)
                if sooner > gain + 1e-9:
                    best, gain = (run, kept), sooner
        if best is None:
            return []
        run, kept = best
        end = run[kept:]
        del run[kept:]
        return end

    def _before(self, worker: Hashable, shard: int) -> int:
        """Return the number of shards that a worker must simulate to reach `shard`."""
        shot, before = self._positions[shard]
        if worker in self._last:
            other, passed = self._positions[self._last[worker]]
            if other == shot and passed < before:
                return before - passed - 1
        return before
