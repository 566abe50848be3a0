"""Folder of a run: plan, shards, a record per shard, and the manifest once all shards are done.

A shard counts as done once its record exists, which is written after the shard. Both are renamed into place, so a file
is either complete or absent.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import os
import uuid
import zlib
from pathlib import Path
from typing import Any

from . import shards
from .plan import Plan, described


class FolderError(Exception):
    """Error about a folder. The message is one sentence."""


def version() -> str:
    return importlib.metadata.version("tresses")


class Folder:
    def __init__(self, path: str | os.PathLike[str], plan: Plan) -> None:
        self.path, self.plan = Path(path).absolute(), plan

    def open(self) -> None:
        """Create the folder, or check that it belongs to the same plan and version of the library."""
        own = {"fingerprint": self.plan.fingerprint, "tresses": version()}
        file = self.path / "plan.json"
        try:
            if file.exists():
                existing = json.loads(file.read_text())
                if existing["fingerprint"] != own["fingerprint"]:
                    raise FolderError(f"{self.path} contains another plan, or its files have changed: choose another folder")
                if existing["tresses"] != own["tresses"]:
                    raise FolderError(f"{self.path} was created by tresses {existing['tresses']}, but this is {own['tresses']}")
            elif self.path.is_dir() and any(self.path.iterdir()):
                raise FolderError(f"{self.path} contains other files: choose an empty folder or a new path")
            (self.path / "shards").mkdir(parents=True, exist_ok=True)
            (self.path / "records").mkdir(exist_ok=True)
            write(file, {**own, "plan": described(self.plan)})
        except OSError as error:
            raise FolderError(f"{error.filename or self.path}: {error.strerror}") from None
        except (ValueError, KeyError, TypeError):
            raise FolderError(f"{file} is not a plan that this library wrote") from None

    def record(self, record: dict[str, Any]) -> None:
        write(self.path / "records" / f"{record['shard']:06}.json", record)

    def records(self) -> dict[int, dict[str, Any]]:
        """Return the records of finished shards by shard index."""
        found = {}
        for shard in self.plan.shards:
            try:
                record = json.loads((self.path / "records" / f"{shard.index:06}.json").read_text())
                if (self.path / record["file"]).stat().st_size == record["bytes"]:
                    found[shard.index] = record
            except (FileNotFoundError, json.JSONDecodeError):
                pass
        return found

    def finish(self, records: dict[int, dict[str, Any]]) -> list[str]:
        """Write the manifest. Return the names of the adapters that took part, normally one."""
        for part in (self.path / "shards").glob(".*.part"):
            part.unlink(missing_ok=True)
        adapters = {json.dumps(record["adapter"], sort_keys=True) for record in records.values()}
        plan = self.plan
        entries = [
            {
                "file": records[shard.index]["file"],
                "sha256": records[shard.index]["sha256"],
                "bytes": records[shard.index]["bytes"],
                "samples": records[shard.index]["samples"],
                "shot": shard.shot,
                "seed": plan.shots[shard.shot].seed,
                "frames": [shard.first, shard.end - 1],
            }
            for shard in plan.shards
        ]
        manifest = {
            "version": 1,
            "tresses": version(),
            "fingerprint": plan.fingerprint,
            "adapters": [json.loads(adapter) for adapter in sorted(adapters)],
            "zlib": zlib.ZLIB_RUNTIME_VERSION,
            "samples": sum(shard["samples"] for shard in entries),
            "shards": entries,
            "plan": described(plan),
        }
        write(self.path / "manifest.json", manifest)
        return sorted(json.loads(adapter)["name"] for adapter in adapters)


def write(file: Path, what: Any) -> None:
    part = file.with_name(f".{file.name}-{uuid.uuid4().hex}.part")
    part.write_text(json.dumps(what, indent=1, sort_keys=True) + "\n")
    os.replace(part, file)


def verify(path: str | os.PathLike[str]) -> str:
    """Check the shards of a manifest and return a summary.

    Every shard must match its hash, and every sample must occur exactly once.
    """
    path = Path(path)
    try:
        manifest = json.loads((path / "manifest.json").read_text())
    except (OSError, ValueError):
        raise FolderError(f"{path} has no manifest: the run is not complete, or this is not the folder of a run") from None
    plan = manifest["plan"]
    keys: set[str] = set()
    for shard in manifest["shards"]:
        file = path / shard["file"]
        try:
            digest = hashlib.sha256(file.read_bytes()).hexdigest()
        except OSError as error:
            raise FolderError(f"{file}: {error.strerror}") from None
        if digest != shard["sha256"]:
            raise FolderError(f"{file} does not match the manifest: its SHA-256 is {digest}")
        first, last = shard["frames"]
        due = {
            f"{shard['shot']:06}-{frame:06}-{camera['name']}"
            for frame in range(first, last + 1)
            for camera in plan["cameras"]
        }
        stored = [key for key, _ in shards.read(file)]
        if len(stored) != len(due) or set(stored) != due or keys & due:
            raise FolderError(f"{file} has other samples than the plan")
        keys |= due
    if len(keys) != len(plan["shots"]) * plan["frames"] * len(plan["cameras"]):
        raise FolderError(f"{path} has {len(keys)} samples, but the plan has other ones")
    return f"{len(manifest['shards'])} shards with {len(keys)} samples match the manifest"
