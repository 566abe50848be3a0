"""Plans: read from TOML and expanded into shots and shards."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tresses

from . import sweep
from .cameras import Camera, cameras
from .checks import PlanError, Table, check_distinct, kind
from .grooms import Groom, grooms

OUTPUTS = (
    "color", "linear", "body_depth", "body_normal", "coverage", "depth", "motion", "strand", "groom", "share", "along",
    "tangent",
)  # fmt: skip
# Outputs per frame instead of per image: the geometry of the hair.
SHAPES = ("guides", "strands")
_MAX_SHOTS = 1_000_000


@dataclass(frozen=True)
class Shot:
    """A simulation run: hair with a look and a motion."""

    index: int
    name: str
    seed: int
    groom: int
    motion: str
    settings: dict[str, Any]


@dataclass(frozen=True)
class Shard:
    """Consecutive frames of a shot by all cameras: the unit of work, and one file."""

    index: int
    shot: int
    first: int
    end: int


@dataclass(frozen=True)
class Plan:
    seed: int
    frames: int
    every: int
    settle: int
    rate: float
    size: tuple[int, int]
    outputs: tuple[str, ...]
    background: Any
    compress: bool
    grooms: tuple[Groom, ...]
    cameras: tuple[Camera, ...]
    shots: tuple[Shot, ...]
    shards: tuple[Shard, ...]
    # Base folder of relative paths.
    folder: str
    fingerprint: str = ""

    def steps(self, frame: int) -> int:
        """Return the number of simulation steps before a frame."""
        return self.settle + frame * self.every

    def pictures(self, shard: Shard) -> int:
        return (shard.end - shard.first) * len(self.cameras)

    def places(self) -> list[tuple[int, int]]:
        """Return for each shard its shot and its index within the shot."""
        each = len(self.shards) // len(self.shots)
        return [(shard.shot, shard.index % each) for shard in self.shards]

    def runs(self, missing: set[int]) -> list[list[int]]:
        """Group missing shards into runs of consecutive shards of one shot."""
        found: list[list[int]] = []
        last = None
        for shard in self.shards:
            if shard.index in missing:
                if last is not None and last.shot == shard.shot and last.end == shard.first:
                    found[-1].append(shard.index)
                else:
                    found.append([shard.index])
                last = shard
        return found


def read(file: str | os.PathLike[str]) -> Plan:
    """Read a plan from a file."""
    file = Path(file)
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise PlanError(f"cannot be read: {getattr(error, 'strerror', None) or error}") from None
    return parse(text, file.resolve().parent)


def parse(text: str, folder: str | os.PathLike[str] = ".") -> Plan:
    """Parse a plan. `folder` is the base of relative paths."""
    toml = _toml()
    try:
        table = Table(toml.loads(text))
    except toml.TOMLDecodeError as error:
        raise PlanError(f"is not valid TOML: {error}") from None
    return _plan(table, Path(folder).absolute())


def _toml() -> Any:
    try:
        import tomllib as toml
    except ModuleNotFoundError:
        try:
            import tomli as toml
        except ModuleNotFoundError:
            raise PlanError("needs Python 3.11 or the package tomli: pip install tomli") from None
    return toml


def _plan(table: Table, folder: Path) -> Plan:
    table.integer("version", 1, 1, 1)
    seed = table.integer("seed", 0, 2**32 - 1, 0)
    frames, every = table.integer("frames", 1, 1_000_000), table.integer("every", 1, 100_000, 1)
    settle, draws = table.integer("settle", 0, 1_000_000, 0), table.integer("draws", 1, _MAX_SHOTS, 1)
    per_shard = table.integer("shard", 1, 1_000_000, min(frames, 32))
    rate = table.number("rate", 1, 10_000) or 60.0
    size = _size(table)
    outputs = table.texts("outputs", ["color"])
    for name in outputs:
        if name not in OUTPUTS + SHAPES:
            raise PlanError(f"outputs: there is no output {name}; choose {', '.join(OUTPUTS + SHAPES)}")
    background = _background(table)
    compress = table.flag("compress")
    motions = [_motion(name, folder) for name in table.texts("motions", ["still"])]
    check_distinct((name for name, _ in motions), "motions")
    common = sweep.settings(table)
    hair, views = grooms(table, folder), cameras(table)
    looks = _looks(table)
    lists, draw = sweep.listed(table), sweep.drawn(table)
    table.done()
    if draws > 1 and not draw and not any(isinstance(v, sweep.Range) for view in views for v in vars(view).values()):
        raise PlanError("draws is more than 1, but nothing is random: add [draw] or a range to a camera")
    _one_source(looks, lists, draw)
    count = len(hair) * len(looks) * len(motions) * draws
    for each in lists.values():
        count *= len(each)
    if count > _MAX_SHOTS or count * frames > 100 * _MAX_SHOTS:
        raise PlanError(f"has {count} shots of {frames} frames, but the limit is {_MAX_SHOTS} and {100 * _MAX_SHOTS} frames")

    shots: list[Shot] = []
    for groom_index, groom in enumerate(hair):
        for look, values in looks:
            for combination in sweep.combinations(lists):
                for motion, path in motions:
                    for number in range(draws):
                        what = [groom.name, look, combination, motion, number]
                        own = sweep.seed_of(seed, what)
                        picked = {name: of.drawn(own, name) for name, of in draw.items()}
                        all_values = {**common, **groom.settings, **values, **combination, **picked}
                        words = [groom.name, look, *(f"{n}={v}" for n, v in combination.items()), motion]
                        name = " ".join(word for word in [*words, f"#{number}" if draws > 1 else ""] if word)
                        sweep.checked_together(all_values, name)
                        shots.append(Shot(len(shots), name, own, groom_index, path, all_values))
    shards: list[Shard] = []
    for shot in shots:
        for first in range(0, frames, per_shard):
            shards.append(Shard(len(shards), shot.index, first, min(first + per_shard, frames)))

    paths = {path for groom in hair for path in groom.paths()} | {path for _, path in motions if os.path.isabs(path)}
    plan = Plan(
        seed, frames, every, settle, rate, size, tuple(outputs), background, compress, tuple(hair), tuple(views),
        tuple(shots), tuple(shards), str(folder),
    )  # fmt: skip
    return _sealed(plan, sorted(paths))


def _sealed(plan: Plan, paths: list[str]) -> Plan:
    """Set the fingerprint: a hash of everything that affects the output, including the contents of files."""
    digest = hashlib.sha256(sweep.canonical(described(plan)).encode())
    for path in paths:
        try:
            digest.update(hashlib.sha256(Path(path).read_bytes()).digest())
        except OSError as error:
            raise PlanError(f"{path}: {error.strerror}") from None
    return Plan(**{**vars(plan), "fingerprint": digest.hexdigest()})


def described(plan: Plan) -> dict[str, Any]:
    """Return the plan as JSON values, with paths relative to its folder."""

    def local(value: Any) -> Any:
        if isinstance(value, str) and os.path.isabs(value):
            return Path(os.path.relpath(value, plan.folder)).as_posix()
        if isinstance(value, dict):
            return {key: local(each) for key, each in value.items()}
        if isinstance(value, (list, tuple)):
            return [local(each) for each in value]
        return local(vars(value)) if hasattr(value, "__dataclass_fields__") else value

    return {key: local(value) for key, value in vars(plan).items() if key not in ("fingerprint", "folder", "shards")}


def _size(table: Table) -> tuple[int, int]:
    size = table.any("size", [640, 640])
    if not isinstance(size, list) or len(size) != 2 or any(type(side) is not int for side in size):
        raise PlanError(f"size is {kind(size)}, but must be [width, height]")
    if not all(1 <= side <= 16384 for side in size):
        raise PlanError(f"size is {kind(size)}, but each side must be from 1 to 16384 pixels")
    return (size[0], size[1])


def _background(table: Table) -> Any:
    value = table.any("background")
    if value is None or value == "transparent":
        return value
    if not isinstance(value, list):
        raise PlanError(f'background is {kind(value)}, but must be "transparent" or three numbers')
    return Table({"background": value}).vector("background")


def _motion(name: str, folder: Path) -> tuple[str, str]:
    """Return the name of the motion and the argument of `tresses.Motion`."""
    path = str(folder / name) if name.endswith(".json") else name
    try:
        tresses.Motion(path)
    except tresses.TressesError as error:
        raise PlanError(f"motions: {error}") from None
    return name, path


def _looks(plan: Table) -> list[tuple[str, dict[str, Any]]]:
    looks = []
    for table in plan.tables("look"):
        name = table.text("name")
        if name is None:
            raise PlanError(f"{table.at('name')} is missing")
        looks.append((name, sweep.settings(table)))
        table.done()
    check_distinct((name for name, _ in looks), "look")
    return looks or [("", {})]


def _one_source(looks: list, lists: dict, draw: dict) -> None:
    for name in draw:
        if name in lists:
            raise PlanError(f"draw: {name} is also in [sweep]")
    for look, values in looks:
        for name in values:
            if name in lists or name in draw:
                raise PlanError(f"look {look}: {name} is also in [{'sweep' if name in lists else 'draw'}]")
