"""Validation of plans: errors for missing, invalid and unknown values name the path of the value."""

from __future__ import annotations

import math
from typing import Any, Iterable, Sequence


class PlanError(ValueError):
    """Error in a plan. The message is one sentence that begins with the path of the value."""


class Table:
    """A table of a plan and its path, such as ``camera[2]`` for the third ``[[camera]]``."""

    def __init__(self, values: Any, path: str = "") -> None:
        if not isinstance(values, dict):
            raise PlanError(f"{path} is {kind(values)}, but must be a table")
        self._left = dict(values)
        self._known: list[str] = []
        self.path = path

    def at(self, key: str) -> str:
        return f"{self.path}.{key}" if self.path else key

    def has(self, key: str) -> bool:
        self._known.append(key)
        return key in self._left

    def any(self, key: str, default: Any = None) -> Any:
        self._known.append(key)
        return self._left.pop(key, default)

    def integer(self, key: str, minimum: int, maximum: int, default: int | None = None) -> int:
        value = self.any(key, default)
        if value is None:
            raise PlanError(f"{self.at(key)} is missing: a whole number from {minimum} to {maximum}")
        if isinstance(value, bool) or not isinstance(value, int):
            raise PlanError(f"{self.at(key)} is {kind(value)}, but must be a whole number from {minimum} to {maximum}")
        if not minimum <= value <= maximum:
            raise PlanError(f"{self.at(key)} is {value}, but must be from {minimum} to {maximum}")
        return value

    def number(self, key: str, minimum: float, maximum: float, default: float | None = None) -> float | None:
        value = self.any(key, default)
        return None if value is None else number(value, self.at(key), minimum, maximum)

    def text(self, key: str, default: str | None = None) -> str | None:
        value = self.any(key, default)
        if value is not None and (not isinstance(value, str) or not value):
            raise PlanError(f"{self.at(key)} is {kind(value)}, but must be a string")
        return value

    def flag(self, key: str, default: bool = False) -> bool:
        value = self.any(key, default)
        if not isinstance(value, bool):
            raise PlanError(f"{self.at(key)} is {kind(value)}, but must be true or false")
        return value

    def texts(self, key: str, default: Sequence[str] | None = None) -> list[str]:
        """Return a list of distinct strings, from one string or a list."""
        value = self.any(key, default)
        values = [value] if isinstance(value, str) else value
        if not isinstance(values, (list, tuple)) or not values or not all(isinstance(v, str) and v for v in values):
            raise PlanError(f"{self.at(key)} is {kind(value)}, but must be a string or a list of strings")
        check_distinct(values, self.at(key))
        return list(values)

    def vector(self, key: str, length: int = 3) -> tuple[float, ...] | None:
        value = self.any(key)
        if value is None:
            return None
        if not isinstance(value, list) or len(value) != length:
            raise PlanError(f"{self.at(key)} is {kind(value)}, but must be a list of {length} numbers")
        return tuple(number(v, f"{self.at(key)}[{i}]", -1e6, 1e6) for i, v in enumerate(value))

    def tables(self, key: str) -> list[Table]:
        value = self.any(key, [])
        if not isinstance(value, list):
            raise PlanError(f"{self.at(key)} is {kind(value)}, but must be tables, [[{key}]]")
        return [Table(each, f"{self.at(key)}[{i}]") for i, each in enumerate(value)]

    def done(self) -> None:
        """Raise an error for keys that have not been read."""
        for key in self._left:
            raise PlanError(f"{self.at(key)} is unknown; {self.path or 'a plan'} has {', '.join(sorted(set(self._known)))}")


def kind(value: Any) -> str:
    """Describe a value in a few characters for error messages."""
    if value is None:
        return "missing"
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:37]}..."


def number(value: Any, path: str, minimum: float, maximum: float) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise PlanError(f"{path} is {kind(value)}, but must be a number from {minimum:g} to {maximum:g}")
    if not (math.isfinite(value) and minimum <= value <= maximum):
        raise PlanError(f"{path} is {value}, but must be from {minimum:g} to {maximum:g}")
    return float(value)


def check_distinct(values: Iterable[Any], path: str) -> None:
    """Raise an error for duplicate values."""
    known: list[Any] = []
    for value in values:
        # 1, 1.0 and True compare equal, but are different settings.
        if any(value == other and type(value) is type(other) for other in known):
            raise PlanError(f"{path} has {kind(value)} twice")
        known.append(value)
