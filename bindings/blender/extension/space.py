"""Blender's space (Z up, any unit) and Tresses' space (meters, Y up, face toward +Z)."""

import numpy as np

# Rows of the rotation from Blender to Tresses: (x, y, z) becomes (x, z, -y).
ROTATION = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], np.float64)


class Space:
    """The conversion for a scene.

    Parameters
    ----------
    scene : bpy.types.Scene
        Its unit scale gives the length of a Blender unit, in meters.
    """

    def __init__(self, scene):
        self.unit = scene.unit_settings.scale_length if scene.unit_settings.system != "NONE" else 1.0

    def points(self, points, matrix):
        """Return points [n, 3] of an object with the world matrix `matrix` in Tresses' space."""
        matrix = np.asarray(matrix, np.float64)
        world = points @ matrix[:3, :3].T + matrix[:3, 3]
        return ((world @ ROTATION.T) * self.unit).astype(np.float32)

    def back(self, points, matrix):
        """Return points [n, 3] of Tresses' space in the space of an object with the world matrix `matrix`."""
        inverse = np.linalg.inv(np.asarray(matrix, np.float64))
        world = (points.astype(np.float64) / self.unit) @ ROTATION
        return world @ inverse[:3, :3].T + inverse[:3, 3]

    def matrices(self, matrices):
        """Return transforms [n, 4, 4] from Blender's world to themselves in Tresses' space."""
        rotation = np.eye(4)
        rotation[:3, :3] = ROTATION
        out = rotation @ np.asarray(matrices, np.float64) @ rotation.T
        out[..., :3, 3] *= self.unit
        return out
