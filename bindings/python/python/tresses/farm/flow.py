"""Pixel motion between two frames, computed from the strands.

`Simulation.render` returns the motion since its last call, which may be for another camera. This module takes the strand
point that a pixel shows (``strand``, ``along``), finds its position one frame earlier, and projects it with the same
camera. The result is exact and does not depend on the frame at which a worker started.
"""

from __future__ import annotations

import numpy as np

LABELS = ("strand", "groom", "along")


class Moment:
    """All strands at one time, and the view-projection matrices of the cameras by name."""

    def __init__(self, grooms: list, cameras: dict[str, np.ndarray]) -> None:
        self.positions = [strands.positions for strands in grooms]
        self.offsets = [strands.offsets for strands in grooms]
        self.cameras = cameras

    def points(self, groom: int, strand: np.ndarray, along: np.ndarray) -> np.ndarray:
        """Return points on strands; `along` is the position from 0 (root) to 1 (tip) by vertex index."""
        first, last = self.offsets[groom][strand], self.offsets[groom][strand + 1] - 1
        at = along.astype(float) * (last - first)
        vertex = np.minimum(first + at.astype(np.int64), last - 1)
        fraction = (first + at - vertex)[:, None]
        positions = self.positions[groom]
        return (1 - fraction) * positions[vertex] + fraction * positions[vertex + 1]

    def pixels(self, camera: str, points: np.ndarray, size: tuple[int, int]) -> np.ndarray:
        clip = np.c_[points, np.ones(len(points))] @ self.cameras[camera].T
        return (clip[:, :2] / clip[:, 3:] * [0.5, -0.5] + 0.5) * size


def motion(rendered: dict, now: Moment, before: Moment | None, camera: str) -> np.ndarray:
    """Return the motion since the previous frame, pixels to the right and down: float32 [h, w, 2].

    It is nan without hair and in the first frame.
    """
    height, width = rendered["strand"].shape
    out = np.full((height, width, 2), np.nan, np.float32)
    if before is None:
        return out
    for groom in range(len(now.positions)):
        mask = (rendered["groom"] == groom) & np.isfinite(rendered["along"])
        which = (groom, rendered["strand"][mask], rendered["along"][mask])
        pixels = [moment.pixels(camera, moment.points(*which), (width, height)) for moment in (now, before)]
        out[mask] = pixels[0] - pixels[1]
    return out
