"""Workers as Ray actors on the machines of a cluster.

Ray places and starts the actors and reports lost ones. The driver, not Ray, assigns shards and retries lost ones: Ray
would restart a lost task without the state of its worker.
"""

from __future__ import annotations

import contextlib
import os
import socket
import time
from typing import Any, Iterator

from .folder import FolderError
from .local import facts, tried
from .plan import Plan


def installed() -> Any:
    """Return the Ray module."""
    # Disable Ray's usage statistics unless the user has chosen; a library should not opt its users in.
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    try:
        import ray
    except ModuleNotFoundError:
        raise FolderError("--ray needs the package Ray: pip install 'tresses[farm]'") from None
    return ray


def _knock(address: str) -> None:
    """Fail fast if nothing listens at a host and port. Ray would retry for minutes."""
    host, colon, port = address.removeprefix("ray://").rpartition(":")
    if not colon:
        return
    try:
        socket.create_connection((host.strip("[]"), int(port)), 5).close()
    except (OSError, ValueError, OverflowError) as error:
        raise FolderError(f"cannot connect to Ray at {address}: {getattr(error, 'strerror', None) or error}") from None


class Actor:
    """A worker in a process that Ray starts."""

    def __init__(self, plan: Plan, folder: str) -> None:
        from .work import Worker

        self._folder = folder
        self._state = tried(lambda: Worker(plan))

    def ready(self) -> tuple[str, Any]:
        kind, worker = self._state
        return ("ready", facts(worker)) if kind == "done" else ("broken", worker)

    def do(self, shard: int) -> tuple[str, Any]:
        return tried(lambda: self._state[1].do(shard, self._folder))


class OnRay:
    def __init__(self, plan: Plan, folder: str, address: str, workers: int | None, gpus: float) -> None:
        self._ray = ray = installed()
        words: dict[str, Any] = {"address": address, "log_to_driver": False, "logging_level": "error"}
        if address == "local":
            words.update(include_dashboard=False, num_cpus=max(workers or 0, os.cpu_count() or 1))
        _knock(address)
        began = time.monotonic()
        try:
            ray.init(**words)
        except (ConnectionError, ValueError, RuntimeError) as error:
            raise FolderError(f"cannot connect to Ray at {address}: {str(error).splitlines()[0]}") from None
        self.seconds = time.monotonic() - began
        resources = ray.cluster_resources()
        cores = int(resources.get("CPU", 1))
        fit = min(cores, int(resources.get("GPU", 0) / gpus)) if gpus else cores
        if fit == 0:
            ray.shutdown()
            raise FolderError(f"Ray at {address} has no GPU for a worker that reserves {gpus:g}")
        self.name, self.workers = f"Ray {ray.__version__}", workers or fit
        self._folder, self._plan = folder, ray.put(plan)
        threads = os.environ.get("LP_NUM_THREADS") or str(max(1, cores // self.workers) if address == "local" else 1)
        options: dict[str, Any] = {"num_cpus": 1, "max_restarts": 0, "runtime_env": {"env_vars": {"LP_NUM_THREADS": threads}}}
        if gpus:
            options["num_gpus"] = gpus
        self._make = ray.remote(Actor).options(**options)
        self._actors: dict[int, Any] = {}
        # Pending results and their workers.
        self._pending: dict[Any, int] = {}

    def start(self, worker: int) -> None:
        actor = self._actors[worker] = self._make.remote(self._plan, self._folder)
        self._pending[actor.ready.remote()] = worker

    def give(self, worker: int, shard: int) -> None:
        self._pending[self._actors[worker].do.remote(shard)] = worker

    def wait(self, seconds: float) -> Iterator[tuple[str, int, Any]]:
        ray = self._ray
        if not self._pending:
            return
        # With `num_returns=1`, `wait` returns only one result; fetch the other finished ones too.
        first, _ = ray.wait(list(self._pending), num_returns=1, timeout=seconds)
        more, _ = ray.wait(list(self._pending), num_returns=len(self._pending), timeout=0) if first else ([], [])
        for answer in more:
            worker = self._pending.pop(answer)
            try:
                kind, value = ray.get(answer)
            except ray.exceptions.RayActorError as error:
                actor = self._actors.pop(worker)
                with contextlib.suppress(Exception):
                    ray.kill(actor)
                yield "lost", worker, type(error).__name__
            except ray.exceptions.RayTaskError as error:
                yield "broken", worker, str(error.cause)
            else:
                yield kind, worker, value

    def stop(self) -> None:
        for actor in self._actors.values():
            with contextlib.suppress(Exception):
                self._ray.kill(actor)
        self._actors, self._pending = {}, {}
        self._ray.shutdown()
