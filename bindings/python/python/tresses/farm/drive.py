"""The driver: assigns shards to workers until all are done."""

from __future__ import annotations

import statistics
import time
from typing import Any, Callable

from .folder import Folder, FolderError, write
from .schedule import Schedule

# Number of workers that may be lost on one shard before the run fails.
_TRIES = 3
# Minimum interval between progress messages, seconds.
_PACE = 2.0


class Driver:
    def __init__(self, folder: Folder, engine: Any, workers: int, tell: Callable[[str], Any]) -> None:
        self.folder, self.plan, self.engine, self.tell = folder, folder.plan, engine, tell
        self.records = folder.records()
        self.refused: dict[int, str] = {}
        self.began = time.monotonic()
        self._tries: dict[int, int] = {}
        self._idle: set[int] = set()
        self._given: dict[int, tuple[int, float]] = {}
        self._started: dict[int, float] = {}
        self._overheads: list[float] = []
        self._opened: list[float] = []
        self._starts: list[float] = []
        self._new = 0
        self._steps = self._all = 0.0
        self._reported = 0.0
        missing = {shard.index for shard in self.plan.shards} - set(self.records)
        self.schedule = Schedule(self.plan.runs(missing), self.plan.places())
        self.workers = min(workers, len(missing))

    def run(self) -> None:
        if self.records and self.schedule.left:
            self.tell(f"{len(self.records)} of {len(self.plan.shards)} shards are done already")
        try:
            for worker in range(self.workers):
                self._start(worker)
            while self.schedule.left:
                for event in self.engine.wait(0.5):
                    self._hear(*event)
        finally:
            self.engine.stop()

    def _start(self, worker: int) -> None:
        self._started[worker] = time.perf_counter()
        self.engine.start(worker)

    def _next(self, worker: int) -> None:
        shard = self.schedule.take(worker)
        if shard is None:
            self._idle.add(worker)
        else:
            self._given[worker] = (shard, time.perf_counter())
            self.engine.give(worker, shard)

    def _hear(self, kind: str, worker: int, value: Any) -> None:
        if kind == "ready":
            self._opened.append(value["opened"])
            self._starts.append(time.perf_counter() - self._started[worker] - value["opened"])
            where = "software driver" if value["adapter"]["software"] else "GPU"
            self.tell(f"worker {worker}: process {value['process']} on {value['adapter']['name']} ({where})")
            self._next(worker)
        elif kind == "done":
            passed = time.perf_counter() - self._given.pop(worker)[1]
            self._overheads.append(passed - sum(value["cost"]["seconds"].values()))
            self.folder.record(value)
            self.records[value["shard"]] = value
            self._new += value["samples"]
            self._learn(value["cost"])
            self._next(worker)
            self._progress()
        elif kind == "refused":
            shot = self.plan.shots[self.plan.shards[self._given.pop(worker)[0]].shot]
            if shot.index not in self.refused:
                self.tell(f"shot {shot.index} ({shot.name}) failed: {value}")
            self.refused[shot.index] = value
            self.schedule.refused(worker, {shard.index for shard in self.plan.shards if shard.shot == shot.index})
            self._next(worker)
        elif kind == "lost":
            self._given.pop(worker, None)
            shard = self.schedule.lost(worker)
            what = "no shard" if shard is None else f"shard {shard}"
            self.tell(f"worker {worker} was lost with {what} ({value}); another worker replaces it")
            # Also count workers lost before they get a shard; otherwise the run might never end.
            tries = self._tries[-1 if shard is None else shard] = self._tries.get(-1 if shard is None else shard, 0) + 1
            if tries == _TRIES:
                raise FolderError(f"{_TRIES} workers were lost with {what}; the last reason: {value}")
            self._start(worker)
            # The new worker may never start, so let idle workers take the lost shard.
            idle, self._idle = self._idle, set()
            for other in sorted(idle):
                self._next(other)
        else:
            raise FolderError(f"worker {worker}: {value}")

    def _learn(self, cost: dict[str, Any]) -> None:
        """Update the share of time that steps take. A worker's first shard is excluded because it includes warm-up."""
        if not cost["first"]:
            self._steps += cost["seconds"]["steps"]
            self._all += sum(cost["seconds"].values())
            self.schedule.again = self._steps / self._all

    def _progress(self) -> None:
        now = time.monotonic()
        if now - self._reported < _PACE and self.schedule.left:
            return
        self._reported = now
        plan, passed = self.plan, now - self.began
        pictures = sum(record["samples"] for record in self.records.values())
        total = len(plan.shots) * plan.frames * len(plan.cameras)
        rate = self._new / passed
        self.tell(
            f"{len(self.records)} of {len(plan.shards)} shards, {pictures} of {total} images, "
            f"{rate:.2f} per second, {duration((total - pictures) / rate)} left"
        )

    def costs(self) -> dict[str, Any]:
        """Return the costs of this run, except those in the shard records."""
        return {
            "engine": self.engine.name,
            "workers": self.workers,
            "seconds": time.monotonic() - self.began,
            "pictures": self._new,
            "engine_start": self.engine.seconds,
            "start": statistics.median(self._starts),
            "open": statistics.median(self._opened),
            "dispatch": statistics.median(self._overheads),
        }

    def close(self) -> None:
        """Write the costs and the manifest once all shards are done."""
        if self._new:
            write(self.folder.path / "costs.json", {"run": self.costs(), "shards": [
                {"shot": self.plan.shots[self.plan.shards[index].shot].name, **self.records[index]["cost"]}
                for index in sorted(self.records)
            ]})  # fmt: skip
        adapters = self.folder.finish(self.records)
        if len(adapters) > 1:
            self.tell(f"{len(adapters)} adapters took part, so samples may not be bit-identical: {', '.join(adapters)}")


def duration(seconds: float) -> str:
    for unit, length in (("days", 86400), ("h", 3600), ("min", 60)):
        if seconds >= 1.5 * length:
            return f"{seconds / length:.1f} {unit}"
    return f"{seconds:.0f} s"
