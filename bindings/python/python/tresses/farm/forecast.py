"""Estimates how long a plan takes with a number of workers, by simulating its schedule with measured costs.

It assumes that all workers are as fast as the measured ones and share no resources. The driver serves one worker at a
time.
"""

from __future__ import annotations

import heapq
import json
import os
import statistics
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Sequence

from . import sweep
from .checks import PlanError
from .plan import Plan
from .schedule import Schedule


# Counted units of work, and the categories of a worker's time that they use.
_KINDS = {"grooms": ("groom",), "shots": ("shot",), "steps": ("steps",), "pictures": ("pictures", "writing")}


@dataclass(frozen=True)
class Costs:
    """Costs in seconds.

    `each` is the mean per unit of work and `shots` the same per shot, where measured. `start` is a worker's startup,
    including the extra time of its first shard. `dispatch` is the driver's time per shard.
    """

    each: dict[str, float]
    start: float
    dispatch: float
    shots: dict[str, dict[str, float]]
    source: str

    def of(self, shot: str) -> dict[str, float]:
        return self.shots.get(shot, self.each)


@dataclass(frozen=True)
class Forecast:
    workers: int
    seconds: float
    # Shares of the workers' time: rendering and writing; repeating steps that another worker also did; idle.
    drawing: float
    again: float
    idle: float


def read(file: str | os.PathLike[str]) -> Costs:
    """Read the costs in a run's ``costs.json``."""
    try:
        found = json.loads(Path(file).read_text())
        run, shards = found["run"], found["shards"]
        warm = [shard for shard in shards if not shard["first"]]
        each = _means(warm or shards, {})
        groups: dict[str, list] = {}
        for shard in warm:
            groups.setdefault(shard["shot"], []).append(shard)
        shots = {name: _means(group, each) for name, group in groups.items()}
        longer = [
            sum(shard["seconds"].values()) - sum(shots.get(shard["shot"], each)[kind] * shard[kind] for kind in _KINDS)
            for shard in shards
            if shard["first"] and warm
        ]
        start = run["engine_start"] + run["start"] + run["open"] + max(0.0, statistics.median(longer or [0.0]))
        source = f"{len(shards)} shards on {run['engine']} with {run['workers']} workers"
        return Costs(each, start, max(0.0, run["dispatch"]), shots, source)
    except (OSError, ValueError, KeyError, TypeError) as error:
        reason = getattr(error, "strerror", None) or "the file has no costs of a run"
        raise PlanError(f"{file}: {reason}; a completed run writes costs.json into its folder") from None


def _means(shards: Sequence[dict], default: dict[str, float]) -> dict[str, float]:
    out = {}
    for count, kinds in _KINDS.items():
        times = sum(shard[count] for shard in shards)
        seconds = sum(shard["seconds"].get(kind, 0.0) for shard in shards for kind in kinds)
        out[count] = seconds / times if times else default.get(count, 0.0)
    return out


def forecast(plan: Plan, costs: Costs, workers: int) -> Forecast:
    each = plan.frames * plan.every * costs.each["steps"]
    again = each / (each + plan.frames * len(plan.cameras) * costs.each["pictures"])
    schedule = Schedule(plan.runs({shard.index for shard in plan.shards}), plan.places(), again)
    stands: dict[int, tuple[int, int]] = {}
    grooms: dict[int, Any] = {}
    drawing = stepping = working = 0.0
    driver = end = 0.0
    free = [(costs.start, worker) for worker in range(workers)]
    heapq.heapify(free)
    while free:
        now, worker = heapq.heappop(free)
        index = schedule.take(worker)
        if index is None:
            continue
        driver = max(now, driver) + costs.dispatch
        shard = plan.shards[index]
        shot = plan.shots[shard.shot]
        cost = costs.of(shot.name)
        took = 0.0
        at, reached = stands.get(worker, (-1, 0))
        if at != shard.shot or reached > plan.steps(shard.first):
            reached = 0
            key = (shot.groom, sweep.parted(shot.settings)[0])
            if grooms.get(worker) != key:
                grooms[worker] = key
                took += cost["grooms"]
            took += cost["shots"]
        last = plan.steps(shard.end - 1)
        stepping += (last - reached) * cost["steps"]
        drawing += plan.pictures(shard) * cost["pictures"]
        took += (last - reached) * cost["steps"] + plan.pictures(shard) * cost["pictures"]
        stands[worker] = (shard.shot, last)
        working += took
        end = max(end, driver + took)
        heapq.heappush(free, (driver + took, worker))
    once = sum(plan.steps(plan.frames - 1) * costs.of(shot.name)["steps"] for shot in plan.shots)
    all_of_it = workers * end
    return Forecast(workers, end, drawing / all_of_it, max(0.0, stepping - once) / all_of_it, 1 - working / all_of_it)


def table(plan: Plan, costs: Costs, counts: Sequence[int]) -> str:
    rows = [forecast(plan, costs, count) for count in counts]
    one = rows[0] if rows[0].workers == 1 else forecast(plan, costs, 1)
    lines = [
        "| workers | seconds | speedup | rendering | repeated steps | idle |",
        "|---|---|---|---|---|---|",
    ]
    for row in rows:
        lines.append(
            f"| {row.workers} | {row.seconds:.1f} | {one.seconds / row.seconds:.2f} | {row.drawing:.0%} | {row.again:.0%} "
            f"| {row.idle:.0%} |"
        )
    return "\n".join(lines)
