"""Cameras of a plan: a named angle, eye and target, or a position around the hair, which may be random per shot."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any, Optional, Union

import numpy as np

from .checks import PlanError, Table, number
from .sweep import Range, range_of

ANGLES = ("front", "three-quarter", "side", "back")
Amount = Union[float, Range]
# Vertical field of view of `Simulation.render`.
_FIELD = math.radians(30)


@dataclass(frozen=True)
class Camera:
    """A camera. Angles are in degrees; azimuth runs from the face (+Z) to the character's left (+X)."""

    name: str
    angle: Optional[str] = None
    zoom: float = 1.0
    eye: Optional[tuple] = None
    target: Optional[tuple] = None
    azimuth: Optional[Amount] = None
    elevation: Amount = 0.0
    distance: Optional[Amount] = None

    def placed(self, seed: int, rest: np.ndarray, size: tuple[int, int]) -> dict[str, Any]:
        """Return the camera keywords of `Simulation.render` for a shot with this seed and these guides at rest."""

        def amount(name: str) -> Any:
            value = getattr(self, name)
            return value.drawn(seed, f"camera.{self.name}.{name}") if isinstance(value, Range) else value

        if self.angle is not None:
            return {"camera": self.angle, "zoom": self.zoom, "distance": amount("distance")}
        if self.eye is not None:
            return {"camera": (self.eye, self.target)}
        points = rest.reshape(-1, 3).astype(float)
        target = np.array(self.target) if self.target else (points.min(axis=0) + points.max(axis=0)) / 2
        distance = amount("distance")
        if distance is None:
            # Fit all hair at rest into the frame, with a margin of a quarter for motion.
            radius = np.linalg.norm(points - target, axis=1).max()
            half = math.atan(math.tan(_FIELD / 2) * min(1.0, size[0] / size[1]))
            distance = 1.25 * radius / math.sin(half)
        azimuth, elevation = math.radians(amount("azimuth")), math.radians(amount("elevation"))
        flat = math.cos(elevation)
        away = np.array([math.sin(azimuth) * flat, math.sin(elevation), math.cos(azimuth) * flat])
        return {"camera": ((target + distance * away).tolist(), target.tolist())}


def _amount(table: Table, key: str, minimum: float, maximum: float) -> Amount | None:
    value = table.any(key)
    if value is None:
        return None
    path = table.at(key)
    return range_of(value, path, minimum, maximum) if isinstance(value, dict) else number(value, path, minimum, maximum)


def cameras(plan: Table) -> list[Camera]:
    found: list[Camera] = []
    for table in plan.tables("camera") or [Table({"name": "three-quarter"}, "camera")]:
        name = table.text("name")
        if name is None or not re.fullmatch(r"[a-z0-9][a-z0-9_-]{0,39}", name):
            raise PlanError(
                f"{table.at('name')} is {'missing' if name is None else repr(name)}, but must consist of a to z, 0 to 9, - "
                "and _, because file names contain it"
            )
        angle, eye, target = table.text("angle"), table.vector("eye"), table.vector("target")
        azimuth, elevation = _amount(table, "azimuth", -360, 360), _amount(table, "elevation", -89, 89)
        distance, count = _amount(table, "distance", 0.01, 1e4), table.integer("count", 1, 1000, 1)
        zoom = table.number("zoom", 0.01, 100)
        table.done()
        if angle is None and name in ANGLES and eye is None and azimuth is None:
            angle = name
        if angle is not None and angle not in ANGLES:
            raise PlanError(f"{table.at('angle')} is {angle}, but must be one of {', '.join(ANGLES)}")
        if sum(placement is not None for placement in (angle, eye, azimuth)) != 1:
            raise PlanError(f"{table.path} ({name}) must have one of: angle, eye and target, azimuth")
        if eye is not None and (target is None or math.dist(eye, target) < 1e-4):
            raise PlanError(f"{table.path} ({name}) has an eye, so it must have a target at another point")
        for key, value, fits in [
            ("target", target, angle is None),
            ("zoom", zoom, angle is not None),
            ("elevation", elevation, azimuth is not None),
            ("distance", distance, eye is None),
            ("count", count if count > 1 else None, any(isinstance(v, Range) for v in (azimuth, elevation, distance))),
        ]:
            if value is not None and not fits:
                raise PlanError(f"{table.at(key)} does not apply to camera {name}")
        for i in range(count):
            each = name if count == 1 else f"{name}-{i}"
            at = Camera(each, angle, zoom or 1.0, eye, target, azimuth, elevation or 0.0, distance)
            if any(each == other.name for other in found):
                raise PlanError(f"{table.path}: there are two cameras called {each}")
            found.append(at)
    return found
