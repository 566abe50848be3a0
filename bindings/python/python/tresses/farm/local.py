"""Workers as processes of this machine."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import traceback
from multiprocessing import connection
from typing import Any, Iterator

import tresses

from .plan import Plan

# What an engine tells: ("ready", worker, facts), ("done", worker, record), ("refused", worker, sentence),
# ("broken", worker, sentence) for what is no fault of a shot, ("lost", worker, how).


def facts(worker: Any) -> dict[str, Any]:
    return {"opened": worker.opened, "process": os.getpid(), "adapter": worker.adapter}


def tried(call: Any) -> tuple[str, Any]:
    """What a call gives, or why it cannot."""
    try:
        return "done", call()
    except tresses.TressesError as error:
        return "refused", str(error)
    except OSError as error:
        return "broken", f"{error.filename or 'the folder'}: {error.strerror or error}"
    except Exception:
        return "broken", traceback.format_exc().strip()


def _serve(pipe: connection.Connection, plan: Plan, folder: str) -> None:
    """A worker's process: shards in, records out, until the pipe ends."""
    from .work import Worker

    kind, worker = tried(lambda: Worker(plan))
    try:
        if kind != "done":
            pipe.send(("broken", worker))
            return
        pipe.send(("ready", facts(worker)))
        while True:
            shard = pipe.recv()
            pipe.send(tried(lambda: worker.do(shard, folder)))
    except (EOFError, BrokenPipeError, ConnectionResetError):
        # The driver is no more.
        pass


class Local:
    name = "processes"
    # What it took to be there at all.
    seconds = 0.0

    def __init__(self, plan: Plan, folder: str, workers: int) -> None:
        self._plan, self._folder = plan, folder
        # A process that is forked cannot use a GPU that was opened before.
        self._context = multiprocessing.get_context("spawn")
        self._pipes: dict[int, connection.Connection] = {}
        self._processes: dict[int, Any] = {}
        # A software driver takes all cores for one picture; workers side by side share them.
        self._threads = str(max(1, (os.cpu_count() or 1) // workers))

    def start(self, worker: int) -> None:
        ours, theirs = self._context.Pipe()
        process = self._context.Process(target=_serve, args=(theirs, self._plan, self._folder), daemon=True)
        given = os.environ.get("LP_NUM_THREADS")
        os.environ["LP_NUM_THREADS"] = given or self._threads
        # Ctrl-C is for the driver, which ends its workers; one that is started now inherits that it ignores it.
        main = threading.current_thread() is threading.main_thread()
        handler = signal.signal(signal.SIGINT, signal.SIG_IGN) if main else None
        try:
            process.start()
        finally:
            if main:
                signal.signal(signal.SIGINT, handler)
            if given is None:
                del os.environ["LP_NUM_THREADS"]
        theirs.close()
        self._pipes[worker], self._processes[worker] = ours, process

    def give(self, worker: int, shard: int) -> None:
        try:
            self._pipes[worker].send(shard)
        except (BrokenPipeError, ConnectionResetError):
            # `wait` sees that it is lost.
            pass

    def wait(self, seconds: float) -> Iterator[tuple[str, int, Any]]:
        workers: dict[Any, int] = {pipe: worker for worker, pipe in self._pipes.items()}
        pipe: Any
        for pipe in connection.wait(list(workers), seconds):
            worker = workers[pipe]
            try:
                kind, value = pipe.recv()
            except (EOFError, ConnectionResetError):
                process = self._processes.pop(worker)
                process.join(5)
                self._pipes.pop(worker).close()
                yield "lost", worker, f"its process ended with {process.exitcode}"
            else:
                yield kind, worker, value

    def stop(self) -> None:
        for process in self._processes.values():
            process.terminate()
        for process in self._processes.values():
            process.join(5)
            if process.is_alive():
                process.kill()
        for pipe in self._pipes.values():
            pipe.close()
        self._pipes, self._processes = {}, {}
