"""Simulated frames on disk, so that memory does not grow and a crash loses nothing.

A cache is a description (`frames.json`), the positions of all frames as float32 (`frames.f32`), and the state of the
simulation after frame N (`state-N.bin`, counted from 1).
"""

import json
import os

import bpy
import numpy as np


def folder(hair_object):
    """Return the folder for the frames of an object: beside the file, or in Blender's temporary folder."""
    base = bpy.path.abspath("//tresses") if bpy.data.filepath else os.path.join(bpy.app.tempdir, "tresses")
    return os.path.join(base, bpy.path.clean_name(hair_object.name))


class Cache:
    """Positions of the vertices of one object in each frame.

    Parameters
    ----------
    path : str
        Folder of the cache.
    """

    def __init__(self, path):
        self.path = path
        head = _head(path)
        self.first, self.count, self.vertices, self.done = (head[k] for k in ("first", "count", "vertices", "done"))
        # A text that describes the simulation, and the number of frames at the stored state, 0 without one.
        self.made, self.state_at = head.get("made"), head.get("state_at", 0)
        self.values = np.memmap(self._file(), np.float32, "r+", shape=(self.count, self.vertices, 3))

    def _file(self):
        return os.path.join(self.path, "frames.f32")

    def _state(self):
        return os.path.join(self.path, f"state-{self.state_at}.bin")

    @classmethod
    def create(cls, path, first, count, vertices, description=None):
        """Begin a cache of `count` frames from `first` on. Replaces another in this folder."""
        os.makedirs(path, exist_ok=True)
        with open(os.path.join(path, "frames.f32"), "wb") as file:
            file.truncate(count * vertices * 12)
        for name in os.listdir(path):
            if name.startswith("state-"):
                os.remove(os.path.join(path, name))
        _write(path, dict(first=first, count=count, vertices=vertices, done=0, made=description))
        return cls(path)

    def _write(self):
        _write(self.path, {k: getattr(self, k) for k in ("first", "count", "vertices", "done", "made", "state_at")})

    def append(self, positions):
        """Store the next frame."""
        self.values[self.done] = positions
        self.values.flush()
        self.done += 1
        self._write()

    def keep(self, state):
        """Store the state of the simulation after the last frame."""
        if self.state_at == self.done:
            return
        before, self.state_at = self._state(), self.done
        with open(self._state(), "wb") as file:
            file.write(state)
        # A crash before this line leaves the state before.
        self._write()
        if os.path.exists(before):
            os.remove(before)

    def state(self):
        """Return the stored state, or None."""
        if not 0 < self.state_at < self.count or not os.path.exists(self._state()):
            return None
        with open(self._state(), "rb") as file:
            return file.read()

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


def next_frame(hair_object):
    """Return the frame of the scene with which an interrupted simulation of an object resumes, or None."""
    path = folder(hair_object)
    head = _head(path) if Cache.exists(path) else {}
    at = head.get("state_at", 0)
    return head["first"] + at if 0 < at and head["done"] < head["count"] else None


def _head(path):
    with open(os.path.join(path, "frames.json"), encoding="utf8") as file:
        return json.load(file)


def _write(path, head):
    file = os.path.join(path, "frames.json")
    with open(file + ".new", "w", encoding="utf8") as new:
        json.dump(head, new)
    os.replace(file + ".new", file)
