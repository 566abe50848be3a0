"""Simulated frames on disk, so that memory does not grow and a crash loses nothing.

A cache is two files: numbers of vertices and frames (`.json`), and the positions of all frames as float32 (`.f32`).
"""

import json
import os

import bpy
import numpy as np


def folder(thing):
    """Return the folder for the frames of an object: beside the file, or in Blender's temporary folder."""
    base = bpy.path.abspath("//tresses") if bpy.data.filepath else os.path.join(bpy.app.tempdir, "tresses")
    return os.path.join(base, bpy.path.clean_name(thing.name))


class Cache:
    """Positions of the vertices of one object in each frame.

    Parameters
    ----------
    path : str
        Folder of the cache.
    """

    def __init__(self, path):
        self.path = path
        with open(os.path.join(path, "frames.json"), encoding="utf8") as file:
            head = json.load(file)
        self.first, self.count, self.vertices, self.done = (head[k] for k in ("first", "count", "vertices", "done"))
        self.values = np.memmap(self._file(), np.float32, "r+", shape=(self.count, self.vertices, 3))

    def _file(self):
        return os.path.join(self.path, "frames.f32")

    @classmethod
    def create(cls, path, first, count, vertices):
        """Begin a cache of `count` frames from `first` on. Replaces another in this folder."""
        os.makedirs(path, exist_ok=True)
        with open(os.path.join(path, "frames.f32"), "wb") as file:
            file.truncate(count * vertices * 12)
        cls._write(path, first, count, vertices, 0)
        return cls(path)

    @staticmethod
    def _write(path, first, count, vertices, done):
        file = os.path.join(path, "frames.json")
        with open(file + ".new", "w", encoding="utf8") as new:
            json.dump(dict(first=first, count=count, vertices=vertices, done=done), new)
        os.replace(file + ".new", file)

    def append(self, positions):
        """Store the next frame."""
        self.values[self.done] = positions
        self.values.flush()
        self.done += 1
        self._write(self.path, self.first, self.count, self.vertices, self.done)

    def frame(self, number):
        """Return the positions at a frame of the scene, [vertices, 3]; the nearest one that is stored."""
        return self.values[min(max(number - self.first, 0), max(self.done - 1, 0))]

    @property
    def last(self):
        """The last stored frame of the scene."""
        return self.first + self.done - 1

    @staticmethod
    def exists(path):
        return os.path.exists(os.path.join(path, "frames.json"))
