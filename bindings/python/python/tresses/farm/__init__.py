"""Data sets of hair: sweeps of grooms, looks, motions and cameras, rendered by many workers.

Workers are processes on this machine or actors on a Ray cluster.

    python -m tresses.farm plan.toml --out shots --workers 2

The guide is docs/guide/datasets.md in the repository.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Callable, Optional

from .checks import PlanError
from .folder import Folder, FolderError, verify
from .plan import Plan, parse, read

__all__ = ["FolderError", "Plan", "PlanError", "parse", "read", "run", "verify"]


def run(
    plan: Plan,
    out: str | os.PathLike[str],
    *,
    workers: Optional[int] = None,
    ray: Optional[str] = None,
    gpus: float = 0.0,
    tell: Callable[[str], Any] = print,
) -> Path:
    """Render a plan into a folder. Shards that are there already are kept.

    Parameters
    ----------
    plan : Plan
        Plan to render.
    out : path
        Folder of this plan, an empty folder, or a path that does not exist.
    workers : int, optional
        Number of workers. The default is 1, or on Ray one per core of the cluster.
    ray : str, optional
        Address of a Ray cluster, ``"auto"``, or ``"local"`` to start Ray for this run.
    gpus : float
        Share of a GPU that each worker reserves on Ray.
    tell : callable
        Called with each line of progress.

    Returns
    -------
    Path
        The manifest.

    Raises
    ------
    FolderError
        If the folder cannot be used, or if shots failed and were left out.
    """
    from .drive import Driver

    if ray is not None:
        from .on_ray import OnRay, installed

        installed()
    folder = Folder(out, plan)
    folder.open()
    if len(folder.records()) == len(plan.shards):
        folder.finish(folder.records())
        tell(f"all {len(plan.shards)} shards are done already")
        return folder.path / "manifest.json"
    if ray is None:
        from .local import Local

        workers = workers or 1
        engine: Any = Local(plan, str(folder.path), workers)
    else:
        engine = OnRay(plan, str(folder.path), ray, workers, gpus)
        workers = engine.workers
    driver = Driver(folder, engine, workers, tell)
    driver.run()
    if driver.refused:
        raise FolderError(f"{len(driver.refused)} of {len(plan.shots)} shots failed; no manifest was written")
    driver.close()
    return folder.path / "manifest.json"
