"""A simulation: frames of the scene become positions of hair, then a bake.

1. Each frame: body and roots as Blender poses them, a step of Tresses, positions into a cache.
2. The cache goes through Blender's own bake, so that the file plays without this extension.
"""

import json
import os
import time
from contextlib import nullcontext
from dataclasses import dataclass, field

import bpy
import numpy as np
import tresses
from tresses import TressesError

from . import cache, export, hair, nodes, versions
from .body import Body, BodyError
from .space import ROTATION, Space
from .tripods import Tripods, is_attached


# Seconds between stored states.
KEEP = 3.0


@dataclass
class Options:
    """What a simulation needs besides the objects."""

    first: int
    last: int
    # Frames that hair takes to come to rest in the pose of the first frame.
    settle: int = 24
    # Whether hair and body are at rest in the pose of the first frame, instead of the body's own rest pose.
    posed: bool = False
    # Values of Tresses' parameters by name.
    settings: dict = field(default_factory=dict)


class Hair:
    """One hair object in a simulation."""

    def __init__(self, hair_object, scene):
        self.object = hair_object
        if len(hair_object.data.curves) == 0:
            raise BodyError(f"{hair_object.name} has no curves")
        self.starts, self.rest = hair.offsets(hair_object.data), hair.positions(hair_object.data)
        self.stiffness = stiffness(hair_object, self.starts)
        self.tripods = None
        self.attached = is_attached(hair_object)
        if self.attached:
            if hair_object.data.surface is None or hair.root_uvs(hair_object.data) is None:
                raise BodyError(f"{hair_object.name} is not attached: use Curves > Snap to Nearest Surface")
            self.tripods = Tripods(hair_object, scene)

    def stored(self, points, depsgraph):
        """Return what the modifier must give for vertices at `points` (of the object) to end there."""
        if not self.attached:
            return points
        root_positions, rotations = self.tripods.frames(depsgraph)
        of = np.repeat(np.arange(len(root_positions)), np.diff(self.starts))
        # The root lies where Blender attaches it.
        first = points[self.starts[:-1]]
        points = points + (root_positions - first)[of]
        return np.einsum("nij,nj->ni", rotations[of], points - root_positions[of]) + self.tripods.roots[of]

    def end(self):
        if self.tripods:
            self.tripods.remove()


class Run:
    """A simulation of hair objects on one body. Hair of several objects meets.

    Parameters
    ----------
    hair_objects : list of bpy.types.Object
        Hair.
    meshes : list of bpy.types.Object
        The body, its surface first; empty for hair without a body.
    options : Options
    """

    def __init__(self, context, hair_objects, meshes, options):
        self.scene, self.view_layer, self.options = context.scene, context.view_layer, options
        self.space = Space(self.scene)
        self.hair, self.caches, self.muted = [], [], []
        # Whether a wind field has been seen.
        self.has_wind = False
        self.before = self.scene.frame_current
        self.scene.frame_set(options.first)
        try:
            for hair_object in hair_objects:
                self.hair.append(Hair(hair_object, self.scene))
            self._build(meshes)
        except BaseException:
            self.end()
            raise

    def _build(self, meshes):
        depsgraph = bpy.context.evaluated_depsgraph_get
        self.body = Body(meshes, self.space) if meshes else None
        # Hair without a body moves with its object.
        self.placed = self.hair[0].object.matrix_world.copy()
        mesh = rig = None
        if self.body:
            with nullcontext() if self.options.posed else self.body.at_rest(self.view_layer):
                triangles = self.body.triangles(depsgraph())
                mesh = tresses.Mesh(self.body.vertices(depsgraph()), triangles)
                rig = tresses.Rig(*self.body.rig(depsgraph()))
        strands = tresses.Strands(*export.joined(export.strands(one.object, self.space) for one in self.hair))
        settings = {"lod.mode": "off", "style.all_guides": len(strands) <= 20_000, **self.options.settings}
        factors = np.concatenate([one.stiffness for one in self.hair])
        groom = tresses.Groom.of(strands, mesh, settings, rig=rig, stiffness=factors)
        self.notes = list(groom.notes)
        self.simulation = tresses.Simulation(groom)

    def _pose(self):
        if not self.body:
            now = self.hair[0].object.matrix_world @ self.placed.inverted()
            return dict(body=rigid(self.space.matrices(now)))
        return dict(skin=self.body.vertices(bpy.context.evaluated_depsgraph_get()), joints=self.body.joints())

    def _wind(self):
        """Return the sum of the scene's visible wind force fields, as m/s. A scene that never had one keeps the wind of
        the settings; once all are hidden, the air is calm."""
        fields = [o for o in self.scene.objects if o.field and o.field.type == "WIND" and o.visible_get()]
        self.has_wind |= bool(fields)
        if not self.has_wind:
            return {}
        velocity = sum((np.array(o.matrix_world.col[2][:3]) * o.field.strength for o in fields), np.zeros(3))
        return dict(wind=ROTATION @ velocity)

    def _mute(self):
        """Switch off the modifiers that only shape the result: they take time in each frame."""
        for one in self.hair:
            for m in one.object.modifiers:
                if m.show_viewport:
                    m.show_viewport = False
                    self.muted.append(m)

    def frames(self, resume=False):
        """Simulate all frames, or with `resume` those that an interrupted simulation left out. Yields the share that is
        done after each."""
        options = self.options
        count = options.last - options.first + 1
        self._mute()
        done = self._resume() if resume else 0
        if done == 0:
            self.scene.frame_set(options.first)
            self.caches = [
                cache.Cache.create(cache.folder(one.object), options.first, count, len(one.rest), self._description())
                for one in self.hair
            ]
            self.reset(0)
            for i in range(options.settle):
                self.step()
                yield i / (options.settle + count)
        saved = time.monotonic()
        try:
            for i in range(done, count):
                if i > 0:
                    self.scene.frame_set(options.first + i)
                    self.step()
                for kept, (_, points) in zip(self.caches, self.positions()):
                    kept.append(points)
                if time.monotonic() - saved >= KEEP:
                    self.caches[0].keep(self.simulation.state())
                    saved = time.monotonic()
                yield (options.settle + i + 1) / (options.settle + count)
        except GeneratorExit:
            # Esc: *Go On* resumes after this frame.
            self.caches[0].keep(self.simulation.state())
            raise

    def _description(self):
        """Return a text that differs if the simulation would."""
        options = self.options
        objects = [(one.object.name, len(one.rest)) for one in self.hair]
        return json.dumps([objects, options.first, options.last, options.settle, options.posed, options.settings])

    def _resume(self):
        """Continue from the state on disk. Returns the number of frames that are done."""
        folders = [cache.folder(one.object) for one in self.hair]
        if not all(map(cache.Cache.exists, folders)):
            raise BodyError("There are no frames to go on from")
        self.caches = [cache.Cache(folder) for folder in folders]
        state, description = self.caches[0].state(), self._description()
        if state is None or any(kept.made != description for kept in self.caches):
            raise BodyError("The hair or its settings have changed since: simulate it again")
        done = self.caches[0].state_at
        for kept in self.caches:
            kept.done = done
        self.scene.frame_set(self.options.first + done - 1)
        self.simulation.reset(**self._pose(), **self._wind(), state=state)
        return done

    def reset(self, settle=None):
        """Put the hair at rest in the pose of the scene, and let it hang for some frames."""
        self.simulation.reset(**self._pose())
        for _ in range(self.options.settle if settle is None else settle):
            self.step()

    def step(self):
        """Advance to the pose of the scene, by a frame."""
        render = self.scene.render
        self.simulation.step(render.fps_base / render.fps, **self._pose(), **self._wind())

    def positions(self):
        """Yield each hair object with the positions that its modifier must give now."""
        given, first = self.simulation.given(), 0
        depsgraph = bpy.context.evaluated_depsgraph_get()
        for one in self.hair:
            points = self.space.back(given[first : first + len(one.rest)], one.object.matrix_world)
            yield one, one.stored(points, depsgraph)
            first += len(one.rest)

    def end(self):
        """Restore the scene. The caches stay."""
        for m in self.muted:
            m.show_viewport = True
        self.muted = []
        for one in self.hair:
            one.end()
        self.hair = []
        self.scene.frame_set(self.before)


def stiffness(hair_object, starts):
    """Return the factor on the stiffness of each curve, [n], from the attribute that the object names."""
    name, counts = hair_object.tresses.stiffness, np.diff(starts)
    if not name:
        return np.ones(len(counts), np.float32)
    per_curve, points = (hair.attribute(hair_object.data, name, domain) for domain in ("CURVE", "POINT"))
    if per_curve is None and points is None:
        raise BodyError(f"{hair_object.name} has no attribute {name} of numbers")
    return np.maximum(per_curve if per_curve is not None else np.add.reduceat(points, starts[:-1]) / counts, 0)


def rigid(matrix):
    """Return the rigid motion that is nearest to an affine one, [4, 4]."""
    left, _, right = np.linalg.svd(matrix[:3, :3])
    rotation = left @ np.diag([1, 1, np.linalg.det(left @ right)]) @ right
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = rotation, matrix[:3, 3]
    return out


def bake(context, hair_object):
    """Let Blender bake the cache of a hair object into its modifier."""
    frames = cache.Cache(cache.folder(hair_object))
    if frames.vertices != len(hair_object.data.points) or frames.done == 0:
        raise BodyError(f"{hair_object.name} has been edited since: simulate it again")
    m = nodes.add_modifier(hair_object)

    def write(scene, *_):
        hair.write_vectors(hair_object.data, nodes.ATTRIBUTE, frames.frame(scene.frame_current))

    current = context.scene.frame_current
    bpy.app.handlers.frame_change_pre.append(write)
    try:
        context.view_layer.update()
        baked = m.bakes[0]
        versions.set_bake(baked, os.path.join(frames.path, "bake"), frames.first, frames.last)
        bpy.ops.object.geometry_node_bake_single(
            session_uid=hair_object.session_uid, modifier_name=m.name, bake_id=baked.bake_id
        )
    finally:
        bpy.app.handlers.frame_change_pre.remove(write)
        remove_attribute(hair_object.data)
        # Blender learns here that the hair now depends on time.
        m.node_group = m.node_group
        context.scene.frame_set(current)


def remove_attribute(curves):
    """Remove the positions that a simulation has written."""
    found = curves.attributes.get(nodes.ATTRIBUTE)
    if found is not None:
        curves.attributes.remove(found)


def clear(hair_object):
    """Remove the result of a simulation from a hair object."""
    m = nodes.modifier(hair_object)
    if m is not None:
        hair_object.modifiers.remove(m)
    remove_attribute(hair_object.data)


def findings(context, hair_object):
    """Return the problems of the curves of a hair object: a list of tresses.Finding."""
    if len(hair_object.data.curves) == 0:
        raise BodyError(f"{hair_object.name} has no curves")
    points, starts, widths = export.strands(hair_object, Space(context.scene))
    return tresses.Strands(points, starts, widths).lint()
