"""Which worker does which shard next. The driver and the simulation of a plan ask the same schedule.

A worker stays with its shot, shard after shard, since its simulation stands there already. Who has none takes a shot that
nobody has begun; when there is none left, the end of what another has still to do of a shot, so much of it that both are
done at the same time: who takes it must simulate what is before it without drawing. Where that would not be sooner, it waits.
"""

from __future__ import annotations

from typing import Hashable, Optional, Sequence


class Schedule:
    """Of `runs`, shards that follow one another in a shot. `places` has the shot of each shard, and how many of its shards
    are before it; `again` is what it costs to simulate a shard without drawing it, of what the whole shard costs."""

    def __init__(self, runs: list[list[int]], places: Sequence[tuple[int, int]], again: float = 0.2) -> None:
        self.again = again
        self._places = places
        self._last: dict[Hashable, int] = {}
        self._open = [list(run) for run in runs]
        self._mine: dict[Hashable, list[int]] = {}
        self._busy: dict[Hashable, int] = {}

    def take(self, worker: Hashable) -> Optional[int]:
        """The next shard of a worker that has done its last one; None when nothing is left to begin."""
        self._busy.pop(worker, None)
        if not self._mine.get(worker):
            self._mine[worker] = self._open.pop(0) if self._open else self._end(worker)
        if not self._mine[worker]:
            return None
        self._busy[worker] = self._last[worker] = self._mine[worker].pop(0)
        return self._busy[worker]

    def lost(self, worker: Hashable) -> Optional[int]:
        """A worker is no more: what it had is open again. The shard that it was doing."""
        shard, rest = self._busy.pop(worker, None), self._mine.pop(worker, [])
        self._last.pop(worker, None)
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

    def _end(self, worker: Hashable) -> list[int]:
        """What a worker takes of another's run."""
        best, gain = None, 0.0
        for run in self._mine.values():
            for kept in range(len(run)):
                # The other one is in the midst of a shard that is not in its run any more.
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
        """Shards that a worker must simulate to come to one."""
        shot, before = self._places[shard]
        if worker in self._last:
            other, passed = self._places[self._last[worker]]
            if other == shot and passed < before:
                return before - passed - 1
        return before
