"""Sweeps of grooms, looks, motions and cameras as data sets, by many workers: processes of this machine, or a Ray cluster.

    python -m tresses.farm plan.toml --out shots --workers 2

The guide is docs/farm.md of the project.
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
    """Draws a plan into a folder; what is there already is kept. Raises `FolderError` where that cannot be, also when shots
    were refused and left out.

    Parameters
    ----------
    plan : Plan
    out : path
        A folder of this plan, an empty one, or one that does not exist.
    workers : int, optional
        How many; 1 without Ray, as many as the cluster has cores with it.
    ray : str, optional
        Where Ray is: an address, ``"auto"``, or ``"local"`` for one that is started for this run.
    gpus : float
        What a worker takes of Ray's GPUs.
    tell : callable
        Is called with each line of what goes on.

    Returns
    -------
    Path
        The manifest.
    """
    from .drive import Driver

    if ray is not None:
        from .on_ray import OnRay, installed

        installed()
    folder = Folder(out, plan)
    folder.open()
    if len(folder.records()) == len(plan.shards):
        folder.finish(folder.records())
        tell(f"all {len(plan.shards)} shards are there")
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
        raise FolderError(f"{len(driver.refused)} of {len(plan.shots)} shots were left out; there is no manifest")
    driver.close()
    return folder.path / "manifest.json"
