"""The command ``python -m tresses.farm``."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import tresses

from . import FolderError, Plan, PlanError, forecast, read, run, verify
from .drive import duration


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m tresses.farm",
        description="Render the shots of a plan into a data set of WebDataset shards, with many workers. Finished "
        "shards are kept: run the same command again to resume.",
        epilog="Exit codes: 0 success, 1 the run failed, 2 the plan or an argument is invalid, 130 Ctrl-C. "
        "Guide: docs/guide/datasets.md.",
    )
    parser.add_argument("plan", help="plan file (TOML)")
    parser.add_argument("--out", metavar="FOLDER", help="output folder; default: out/NAME for NAME.toml")
    parser.add_argument("--workers", type=_count, metavar="N", help="number of workers; default: 1, or on Ray one per core")
    parser.add_argument("--ray", metavar="ADDRESS", help="run on Ray: an address, auto, or local to start Ray for this run")
    parser.add_argument("--gpus", type=_gpu_fraction, default=0.0, metavar="SHARE", help="share of a GPU per worker, on Ray")
    parser.add_argument("--dry-run", action="store_true", help="print the shots and render nothing")
    parser.add_argument("--simulate", type=_counts, metavar="N,N,…", help="estimate the time for N workers")
    parser.add_argument("--costs", metavar="FILE", help="costs.json of an earlier run, for --simulate and --dry-run")
    parser.add_argument("--verify", action="store_true", help="compare all shards with the manifest")
    return parser


def _count(text: str) -> int:
    if not text.isdigit() or not 1 <= int(text) <= 10_000:
        raise argparse.ArgumentTypeError(f"{text} is not a whole number from 1 to 10000")
    return int(text)


def _counts(text: str) -> list[int]:
    return [_count(word) for word in text.split(",")]


def _gpu_fraction(text: str) -> float:
    try:
        fraction = float(text)
    except ValueError:
        fraction = -1.0
    if not 0 <= fraction <= 16:
        raise argparse.ArgumentTypeError(f"{text} is not a number from 0 to 16")
    return fraction


def _described(plan: Plan, costs: forecast.Costs | None) -> str:
    shots, cameras, shards = len(plan.shots), len(plan.cameras), len(plan.shards)
    total = shots * plan.frames * cameras
    lines = [
        f"{shots} shots of {plan.frames} frames by {cameras} cameras: {total} images of {plan.size[0]} x {plan.size[1]}, "
        f"{shards} shards, seed {plan.seed}",
        f"outputs: {', '.join(plan.outputs)}; cameras: {', '.join(camera.name for camera in plan.cameras)}",
    ]
    for shot in plan.shots[:20]:
        own = [shard.index for shard in plan.shards if shard.shot == shot.index]
        lines.append(f"  shot {shot.index}: {shot.name}; seed {shot.seed}; shards {own[0]} to {own[-1]}")
        drawn = ", ".join(f"{name} = {value}" for name, value in shot.settings.items())
        if drawn:
            lines.append(f"    {drawn}")
    if shots > 20:
        lines.append(f"  and {shots - 20} more")
    if costs:
        one = forecast.forecast(plan, costs, 1)
        lines.append(f"one worker takes {duration(one.seconds)}, estimated from {costs.source}")
    return "\n".join(lines)


def main() -> int:
    words = _parser().parse_args()
    out = Path(words.out or Path("out", Path(words.plan).stem))

    def tell(line: str) -> None:
        print(line, file=sys.stderr, flush=True)

    try:
        if words.verify:
            print(verify(out))
            return 0
        plan = read(words.plan)
        costs = forecast.read(words.costs or out / "costs.json") if words.costs or words.simulate else None
        if words.simulate and costs:
            print(forecast.table(plan, costs, words.simulate))
            return 0
        if words.dry_run:
            print(_described(plan, costs))
            return 0
        began = time.monotonic()
        manifest = run(plan, out, workers=words.workers, ray=words.ray, gpus=words.gpus, tell=tell)
        tell(f"{manifest} in {duration(time.monotonic() - began)}")
        return 0
    except PlanError as error:
        tell(f"error: {words.plan}: {error}")
        return 2
    except (FolderError, tresses.TressesError, OSError) as error:
        tell(f"error: {error}")
        return 1
    except KeyboardInterrupt:
        tell(f"interrupted; run the same command again to resume from the shards in {out}")
        return 130


if __name__ == "__main__":
    sys.exit(main())
