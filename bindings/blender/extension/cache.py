"""Simulated frames on disk, so that memory does not grow and a crash loses nothing.

A cache is a description (`frames.json`), the positions of all frames as float32 (`frames.f32`), and the state of the
simulation after one of them (`state.bin`).
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
        # What was simulated, and the number of frames at the stored state.
        self.made, self.state_at = head.get("made"), head.get("state_at", 0)
        self.values = np.memmap(self._file(), np.float32, "r+", shape=(self.count, self.vertices, 3))

    def _file(self):
        return os.path.join(self.path, "frames.f32")

    def _state(self):
        return os.path.join(self.path, "state.bin")

    @classmethod
    def create(cls, path, first, count, vertices, made=None):
        """Begin a cache of `count` frames from `first` on. Replaces another in this folder."""
        os.makedirs(path, exist_ok=True)
        with open(os.path.join(path, "frames.f32"), "wb") as file:
            file.truncate(count * vertices * 12)
        _replace(path, json.dumps(dict(first=first, count=count, vertices=vertices, done=0, made=made)))
        return cls(path)

    def _write(self):
        head = {k: getattr(self, k) for k in ("first", "count", "vertices", "done", "made", "state_at")}
        _replace(self.path, json.dumps(head))

    def append(self, positions):
        """Store the next frame."""
        self.values[self.done] = positions
        self.values.flush()
        self.done += 1
        self._write()

    def keep(self, state):
        """Store the state of the simulation after the last frame."""
        with open(self._state() + ".new", "wb") as file:
            file.write(state)
        # Without a state in between, a crash here cannot leave one of another frame.
        self.state_at = 0
        self._write()
        os.replace(self._state() + ".new", self._state())
        self.state_at = self.done
        self._write()

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


def unfinished(thing):
    """Return the cache of an object whose simulation was interrupted and can go on, or None."""
    path = folder(thing)
    kept = Cache(path) if Cache.exists(path) else None
    return kept if kept and 0 < kept.state_at and kept.done < kept.count else None


def _replace(path, text):
    file = os.path.join(path, "frames.json")
    with open(file + ".new", "w", encoding="utf8") as new:
        new.write(text)
    os.replace(file + ".new", file)
