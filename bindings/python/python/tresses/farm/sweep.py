"""Parameters that vary between shots, from lists or drawn at random.

Random values are SHA-256 hashes of the seed and the parameter's name. They do not depend on the state of a generator, so
a plan that gains a look keeps the values of its existing shots.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from dataclasses import dataclass
from typing import Any, Iterator

import tresses

from .checks import PlanError, Table, check_distinct, kind, number

_ROWS = {row.name: row for row in tresses.parameters()}


def chance(seed: int, name: str) -> float:
    """Return a uniform random number in [0, 1)."""
    digest = hashlib.sha256(f"{seed}:{name}".encode()).digest()
    return int.from_bytes(digest[:8], "big") / 2**64


def seed_of(seed: int, what: Any) -> int:
    """Return a 32-bit seed for `what`. It does not depend on the rest of the plan."""
    digest = hashlib.sha256(f"{seed}:{canonical(what)}".encode()).digest()
    return int.from_bytes(digest[:4], "big")


def canonical(what: Any) -> str:
    return json.dumps(what, sort_keys=True, separators=(",", ":"))


@dataclass(frozen=True)
class Range:
    """Random numbers between two ends, with uniform or logarithmic distribution."""

    start: float
    end: float
    log: bool = False
    whole: bool = False

    def drawn(self, seed: int, name: str) -> float:
        fraction = chance(seed, name)
        if self.whole:
            return int(self.start) + int(fraction * (int(self.end) - int(self.start) + 1))
        if self.log:
            return self.start * (self.end / self.start) ** fraction
        return self.start + (self.end - self.start) * fraction


@dataclass(frozen=True)
class Choice:
    """Random choice from a tuple of values."""

    of: tuple

    def drawn(self, seed: int, name: str) -> Any:
        return self.of[int(chance(seed, name) * len(self.of))]


def range_of(value: Any, path: str, minimum: float, maximum: float, is_integer: bool = False) -> Range:
    table = Table(value, path)
    start, end = table.any("from"), table.any("to")
    log = table.flag("log")
    table.done()
    ends = [number(v, f"{path}.{key}", minimum, maximum) for key, v in (("from", start), ("to", end))]
    if is_integer and any(end != int(end) for end in ends):
        raise PlanError(f"{path} is {kind(value)}, but must have whole numbers")
    if ends[0] > ends[1]:
        raise PlanError(f"{path} goes from {ends[0]:g} down to {ends[1]:g}, but must rise")
    if log and (is_integer or ends[0] <= 0):
        raise PlanError(f"{path} is logarithmic (log), but has whole numbers or begins at 0 or below")
    return Range(ends[0], ends[1], log, is_integer)


def flat(values: Any, path: str) -> dict[str, Any]:
    """Return parameters by full name. A plan may write ``"wind.speed" = 4`` or ``wind.speed = 4``."""
    found: dict[str, Any] = {}

    def descend(value: Any, name: str) -> None:
        if name in _ROWS:
            if name in found:
                raise PlanError(f"{path}: {name} is there twice")
            found[name] = value
        elif isinstance(value, dict) and (value or not name):
            for key, each in value.items():
                descend(each, f"{name}.{key}" if name else key)
        else:
            try:
                tresses.Settings()[name]
            except KeyError as error:
                raise PlanError(f"{path}: {error.args[0]}") from None

    if not isinstance(values, dict):
        raise PlanError(f"{path} is {kind(values)}, but must be a table of parameters")
    descend(values, "")
    return found


def checked(values: dict[str, Any], path: str) -> dict[str, Any]:
    """Check that each parameter has an allowed value."""
    for name, value in values.items():
        try:
            tresses.Settings({name: value})
        except (tresses.TressesError, TypeError, ValueError, OverflowError) as error:
            raise PlanError(f"{path}: {error}") from None
    return values


def parted(values: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Split parameters into those that determine the strands, and those that a simulation can override."""
    groom_settings = {name: value for name, value in values.items() if _ROWS[name].cost == "regrow"}
    return groom_settings, {name: value for name, value in values.items() if name not in groom_settings}


def settings(table: Table, key: str = "settings") -> dict[str, Any]:
    return checked(flat(table.any(key, {}), table.at(key)), table.at(key))


def listed(table: Table) -> dict[str, list]:
    """Read ``[sweep]``: each parameter with the list of its values."""
    lists = flat(table.any("sweep", {}), "sweep")
    for name, values in lists.items():
        if not isinstance(values, list) or not values:
            raise PlanError(f"sweep: {name} is {kind(values)}, but must be a list of values")
        check_distinct(values, f"sweep: {name}")
        for value in values:
            checked({name: value}, "sweep")
    return lists


def combinations(lists: dict[str, list]) -> Iterator[dict[str, Any]]:
    for values in itertools.product(*lists.values()):
        yield dict(zip(lists, values))


def drawn(table: Table) -> dict[str, Range | Choice]:
    """Read ``[draw]``: each parameter with its random distribution."""
    out: dict[str, Range | Choice] = {}
    for name, of in flat(table.any("draw", {}), "draw").items():
        row, path = _ROWS[name], f"draw: {name}"
        if isinstance(of, list) and of:
            check_distinct(of, path)
            for value in of:
                checked({name: value}, "draw")
            out[name] = Choice(tuple(of))
        elif isinstance(of, dict) and row.kind in ("number", "integer"):
            ends = (-math.inf if row.min is None else row.min, math.inf if row.max is None else row.max)
            out[name] = range_of(of, path, *ends, is_integer=row.kind == "integer")
        else:
            numbers = ", or { from = …, to = … }" if row.kind in ("number", "integer") else ""
            raise PlanError(f"{path} is {kind(of)}, but must be a list of values{numbers}")
    return out


def checked_together(values: dict[str, Any], shot: str) -> None:
    try:
        tresses.Settings(values)
    except tresses.TressesError as error:
        raise PlanError(f"shot {shot}: {error}") from None
