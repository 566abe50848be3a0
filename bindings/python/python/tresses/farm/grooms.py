"""Grooms of a plan: built-in styles, files, or presets."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import tresses

from .checks import PlanError, Table
from .sweep import settings

COMPANION_FILES = (
    "density_map",
    "thickness_map",
    "length_map",
    "curl_map",
    "stiffness_map",
    "color_map",
    "curl_curve",
    "lod_maps",
    "colliders",
    "ties",
    "environment",
)
STYLES = ("long", "bob", "curly", "short")


@dataclass(frozen=True)
class Groom:
    """Source of a groom. Paths are absolute."""

    name: str
    way: str
    of: Any
    head: tuple = ()
    words: dict[str, Any] = field(default_factory=dict)
    files: dict[str, Any] = field(default_factory=dict)
    settings: dict[str, Any] = field(default_factory=dict)

    def build(self, values: dict[str, Any]) -> tresses.Groom:
        if self.way == "style":
            return tresses.Groom.built_in(self.of, values, **self.files)
        if self.way == "preset":
            return tresses.Groom.preset(self.of, values)
        return tresses.Groom.read(list(self.of), list(self.head) or None, values, **self.words, **self.files)

    def paths(self) -> list[str]:
        named = [] if self.way == "style" else [self.of] if self.way == "preset" else list(self.of)
        return [*named, *self.head, *self.files.values()]


def grooms(plan: Table, folder: Path) -> list[Groom]:
    found: list[Groom] = []
    for table in plan.tables("groom") or [Table({"style": "long"}, "groom")]:
        groom = _groom(table, folder)
        if any(groom.name == other.name for other in found):
            raise PlanError(f"{table.path}: there are two grooms called {groom.name}; give each its own name")
        found.append(groom)
    return found


def _groom(table: Table, folder: Path) -> Groom:
    sources = [source for source in ("style", "file", "preset") if table.has(source)]
    if len(sources) != 1:
        raise PlanError(f"{table.path} must have one of style, file or preset")
    source = sources[0]
    names = table.texts(source)
    if source != "file" and len(names) > 1:
        raise PlanError(f"{table.at(source)} must be one name; write a [[groom]] for each")
    default_name = names[0] if source == "style" else Path(names[0]).stem
    name = table.text("name") or default_name
    own = settings(table)
    if source == "style":
        if names[0] not in STYLES:
            raise PlanError(f"{table.at('style')} is {names[0]}, but must be one of {', '.join(STYLES)}")
        return Groom(name, source, names[0], files=_companion_files(table, folder), settings=own)
    files = tuple(str(folder / each) for each in names)
    if source == "preset":
        table.done()
        try:
            tresses.Settings.open(files[0])
        except tresses.TressesError as error:
            raise PlanError(f"{table.at(source)}: {error}") from None
        return Groom(name, source, files[0], settings=own)
    head = tuple(str(folder / each) for each in table.texts("head")) if table.has("head") else ()
    words: dict[str, Any] = {word: table.text(word) for word in ("unit", "up", "front")}
    if table.has("mirror"):
        words["mirror"] = table.flag("mirror")
    words = {word: value for word, value in words.items() if value is not None}
    companion_files = _companion_files(table, folder)
    # Read the files once, so that errors show now and not an hour later in a worker.
    try:
        tresses.read(list(files), list(head) or None, **words)
    except tresses.TressesError as error:
        raise PlanError(f"{table.at(source)}: {error}") from None
    return Groom(name, source, files, head, words, companion_files, own)


def _companion_files(table: Table, folder: Path) -> dict[str, str]:
    companion_files = {}
    for key in COMPANION_FILES:
        name = table.text(key)
        if name is not None:
            path = folder / name
            if not path.exists():
                raise PlanError(f"{table.at(key)}: {path} does not exist")
            companion_files[key] = str(path)
    table.done()
    return companion_files
