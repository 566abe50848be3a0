"""The body that hair grows on and meets: meshes with their armatures."""

from contextlib import contextmanager

import numpy as np

from . import hair


class BodyError(Exception):
    """A body that cannot be simulated with. The message is one sentence."""


class Body:
    """Meshes as one, with the vertices of each frame.

    Parameters
    ----------
    objects : list of bpy.types.Object
        Meshes; the first is the surface that hair grows on.
    space : Space
        Conversion to Tresses' space.
    """

    def __init__(self, objects, space):
        self.objects, self.space = objects, space
        self.counts = []

    def armatures(self):
        """Return the armature of each mesh, or None."""

        def of(mesh):
            found = (m.object for m in mesh.modifiers if m.type == "ARMATURE" and m.object and m.show_viewport)
            parent = mesh.parent if mesh.parent and mesh.parent.type == "ARMATURE" else None
            return next(found, parent if mesh.parent_type == "ARMATURE" else None)

        return [of(mesh) for mesh in self.objects]

    @contextmanager
    def at_rest(self, view_layer):
        """Pose the body at rest: armatures in their rest position, shape keys off."""
        armatures = {armature.data for armature in self.armatures() if armature}
        before = [(armature, armature.pose_position) for armature in armatures]
        keys = [(m, m.show_only_shape_key, m.active_shape_key_index) for m in self.objects if m.data.shape_keys]
        try:
            for armature, _ in before:
                armature.pose_position = "REST"
            for mesh, _, _ in keys:
                mesh.show_only_shape_key, mesh.active_shape_key_index = True, 0
            view_layer.update()
            yield
        finally:
            for armature, position in before:
                armature.pose_position = position
            for mesh, only, index in keys:
                mesh.show_only_shape_key, mesh.active_shape_key_index = only, index
            view_layer.update()

    def vertices(self, depsgraph):
        """Return the evaluated vertices of all meshes, [v, 3], in Tresses' space."""
        parts = []
        for i, mesh in enumerate(self.objects):
            evaluated = mesh.evaluated_get(depsgraph)
            points = hair.read(evaluated.data.attributes["position"].data, "vector", 3)
            if self.counts and len(points) != self.counts[i]:
                raise BodyError(
                    f"{mesh.name} has {len(points)} vertices now and {self.counts[i]} at rest: switch off modifiers "
                    "that change the number of vertices over time"
                )
            parts.append(self.space.points(points, evaluated.matrix_world))
        return np.concatenate(parts)

    def triangles(self, depsgraph):
        """Return the corners of all triangles, [t, 3], and remember the numbers of vertices."""
        parts, first, self.counts = [], 0, []
        for mesh in self.objects:
            data = mesh.evaluated_get(depsgraph).data
            data.calc_loop_triangles()
            parts.append(hair.read(data.loop_triangles, "vertices", 3, np.int32) + first)
            self.counts.append(len(data.vertices))
            first += len(data.vertices)
        if sum(map(len, parts)) == 0:
            raise BodyError(f"{self.objects[0].name} has no faces")
        return np.concatenate(parts)

    def joints(self):
        """Return the transforms of all joints now, [j, 4, 4], in Tresses' space."""
        out = []
        for kind, owner, bone in self.joint_sources:
            out.append(owner.matrix_world @ owner.pose.bones[bone].matrix if kind == "bone" else owner.matrix_world)
        return self.space.matrices(np.array(out, np.float64))

    def rig(self, depsgraph):
        """Return the arguments of `tresses.Rig` for the body at rest. `joints` follows the same order."""
        self.joint_sources, names, parents, first = [], [], [], {}
        for armature in dict.fromkeys(a for a in self.armatures() if a):
            # Parents first.
            bones = sorted(armature.data.bones, key=lambda bone: len(bone.parent_recursive))
            index = {bone.name: len(names) + i for i, bone in enumerate(bones)}
            for bone in bones:
                self.joint_sources.append(("bone", armature, bone.name))
                names.append(bone.name)
                parents.append(index[bone.parent.name] if bone.parent else -1)
            first[armature] = index
        joints, weights = [], []
        for mesh, armature in zip(self.objects, self.armatures()):
            own = len(names)
            self.joint_sources.append(("object", mesh, None))
            names.append(mesh.name)
            parents.append(-1)
            data = mesh.evaluated_get(depsgraph).data
            count = len(data.vertices)
            of, vertex_weights = np.full((count, 8), own, np.int64), np.zeros((count, 8), np.float32)
            vertex_weights[:, 0] = 1
            index = first.get(armature, {})
            group = {g.index: index[g.name] for g in mesh.vertex_groups if g.name in index}
            for i, vertex in enumerate(data.vertices if group else ()):
                held = sorted(((g.weight, group[g.group]) for g in vertex.groups if g.group in group), reverse=True)[:8]
                if held and held[0][0] > 0:
                    vertex_weights[i] = 0
                    for k, (weight, joint) in enumerate(held):
                        of[i, k], vertex_weights[i, k] = joint, weight
            joints.append(of)
            weights.append(vertex_weights)
        return names, parents, self.joints(), np.concatenate(joints), np.concatenate(weights)
