"""Frames of roots on a deforming surface, from Blender's own nodes.

A tripod is a curve of four points: a root, and one step along each axis from it. Where the node that attaches hair to its
surface puts these points, the frame of the root can be read off.
"""

import bpy
import numpy as np

from . import hair

# Length of a step, in units of the object.
STEP = 0.01
# Nodes that attach hair to its surface, by the name of their type or of their group.
DEFORM = "GeometryNodeDeformCurvesOnSurface"
GROUPS = ("Surface Deform", "Hair Dynamics", "Deform Curves on Surface")


def deforms(group, visited=()):
    """Return whether a node group attaches curves to their surface."""
    if group is None or group in visited:
        return False
    if group.name.split(".")[0] in GROUPS:
        return True
    nodes = group.nodes
    return any(node.bl_idname == DEFORM for node in nodes) or any(
        deforms(getattr(node, "node_tree", None), (*visited, group)) for node in nodes if node.bl_idname == "GeometryNodeGroup"
    )


def is_attached(hair_object):
    """Return whether the modifiers of a hair object move it with its surface."""
    return any(m.type == "NODES" and m.show_viewport and deforms(m.node_group) for m in hair_object.modifiers)


class Tripods:
    """The frames of the roots of `hair_object`, an object of hair that is attached to its surface.

    `remove` deletes what this has added to the file.
    """

    def __init__(self, hair_object, scene):
        curves = hair_object.data
        starts, points = hair.offsets(curves), hair.positions(curves)
        self.roots = roots = points[starts[:-1]]
        data = bpy.data.hair_curves.new("Tresses roots")
        data.add_curves([4] * len(roots))
        legs = np.concatenate([np.zeros((1, 3)), STEP * np.eye(3)])
        data.position_data.foreach_set("vector", (roots[:, None] + legs[None]).astype(np.float32).ravel())
        uvs = hair.root_uvs(curves)
        if uvs is not None:
            data.attributes.new("surface_uv_coordinate", "FLOAT2", "CURVE").data.foreach_set("vector", uvs.ravel())
        data.surface, data.surface_uv_map = curves.surface, curves.surface_uv_map
        self.object = bpy.data.objects.new("Tresses roots", data)
        self.object.parent, self.object.matrix_world = hair_object.parent, hair_object.matrix_world
        # Blender evaluates no hidden object, but it does not draw one that only shows instances.
        self.object.instance_type, self.object.show_instancer_for_viewport = "FACES", False
        self.object.hide_render = True
        scene.collection.objects.link(self.object)
        group = bpy.data.node_groups.new("Tresses roots", "GeometryNodeTree")
        for side in ("INPUT", "OUTPUT"):
            group.interface.new_socket("Geometry", in_out=side, socket_type="NodeSocketGeometry")
        nodes = [group.nodes.new(kind) for kind in ("NodeGroupInput", DEFORM, "NodeGroupOutput")]
        for a, b in zip(nodes, nodes[1:]):
            group.links.new(a.outputs[0], b.inputs[0])
        self.group = group
        self.object.modifiers.new("Attach", "NODES").node_group = group

    def frames(self, depsgraph):
        """Return where each root is, [n, 3], and the rotation of its frame, [n, 3, 3] with the axes as rows."""
        points = hair.positions(self.object.evaluated_get(depsgraph).data).reshape(-1, 4, 3).astype(np.float64)
        return points[:, 0], (points[:, 1:] - points[:, :1]) / STEP

    def remove(self):
        """Delete the curves, their object and their nodes."""
        data = self.object.data
        bpy.data.objects.remove(self.object)
        bpy.data.hair_curves.remove(data)
        bpy.data.node_groups.remove(self.group)
