"""Workers as processes on this machine."""

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

# Events of an engine: ("ready", worker, facts), ("done", worker, record), ("refused", worker, message) if a shot is
# invalid, ("broken", worker, message) for errors that no shot causes, ("lost", worker, reason).


def facts(worker: Any) -> dict[str, Any]:
    return {"opened": worker.opened, "process": os.getpid(), "adapter": worker.adapter}


def tried(call: Any) -> tuple[str, Any]:
    """Return the result of a call, or the kind and message of its error."""
    try:
        return "done", call()
    except tresses.TressesError as error:
        return "refused", str(error)
    except OSError as error:
        return "broken", f"{error.filename or 'the folder'}: {error.strerror or error}"
    except Exception:
        return "broken", traceback.format_exc().strip()


def _serve(pipe: connection.Connection, plan: Plan, folder: str) -> None:
    """Run a worker process: receive shards and send records until the pipe closes."""
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
        # The driver has ended.
        pass


class Local:
    name = "processes"
    # Startup time of the engine.
    seconds = 0.0

    def __init__(self, plan: Plan, folder: str, workers: int) -> None:
        self._plan, self._folder = plan, folder
        # A forked process cannot use a GPU that its parent has opened.
        self._context = multiprocessing.get_context("spawn")
        self._pipes: dict[int, connection.Connection] = {}
        self._processes: dict[int, Any] = {}
        # A software driver uses all cores for one frame, so divide them among the workers.
        self._threads = str(max(1, (os.cpu_count() or 1) // workers))

    def start(self, worker: int) -> None:
        driver_pipe, worker_pipe = self._context.Pipe()
        process = self._context.Process(target=_serve, args=(worker_pipe, self._plan, self._folder), daemon=True)
        given = os.environ.get("LP_NUM_THREADS")
        os.environ["LP_NUM_THREADS"] = given or self._threads
        # Ctrl-C goes to the driver, which stops its workers. A worker started here inherits the ignored signal.
        main = threading.current_thread() is threading.main_thread()
        handler = signal.signal(signal.SIGINT, signal.SIG_IGN) if main else None
        try:
            process.start()
        finally:
            if main:
                signal.signal(signal.SIGINT, handler)
            if given is None:
                del os.environ["LP_NUM_THREADS"]
        worker_pipe.close()
        self._pipes[worker], self._processes[worker] = driver_pipe, process

    def give(self, worker: int, shard: int) -> None:
        try:
            self._pipes[worker].send(shard)
        except (BrokenPipeError, ConnectionResetError):
            # `wait` reports the lost worker.
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
                yield "lost", worker, f"its process exited with code {process.exitcode}"
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
