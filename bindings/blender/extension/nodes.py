"""The nodes that carry simulated positions: a bake in the modifier stack of the hair."""

import bpy

from . import versions

# Name of the modifier, of its node group and of the attribute that a simulation writes.
NAME = "Tresses"
ATTRIBUTE = "tresses_position"


def group():
    """Return the node group. It is made at the first call.

    The lower branch is baked, and only its positions return to the hair: what goes through a Bake node itself loses its
    attachment to the surface.
    """
    found = bpy.data.node_groups.get(NAME)
    if found is not None:
        return found
    tree = bpy.data.node_groups.new(NAME, "GeometryNodeTree")
    tree.is_modifier = True
    for side in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=side, socket_type="NodeSocketGeometry")
    node = lambda kind, **values: _node(tree, kind, values)
    link = tree.links.new
    into, out = node("NodeGroupInput"), node("NodeGroupOutput")
    named = node("GeometryNodeInputNamedAttribute", data_type="FLOAT_VECTOR")
    named.inputs["Name"].default_value = ATTRIBUTE
    position, index = node("GeometryNodeInputPosition"), node("GeometryNodeInputIndex")
    live = node("GeometryNodeSwitch", input_type="VECTOR")
    link(_output(named, "Exists"), live.inputs["Switch"])
    link(position.outputs[0], _input(live, "False"))
    link(_output(named, "Attribute"), _input(live, "True"))
    set_live = node("GeometryNodeSetPosition")
    link(into.outputs[0], set_live.inputs["Geometry"])
    link(_output(live, "Output"), set_live.inputs["Position"])
    bake = node("GeometryNodeBake")
    versions.add_bake_item(bake)
    link(set_live.outputs[0], bake.inputs[0])
    sample = node("GeometryNodeSampleIndex", data_type="FLOAT_VECTOR", domain="POINT")
    link(bake.outputs[0], sample.inputs["Geometry"])
    link(position.outputs[0], _input(sample, "Value"))
    link(index.outputs[0], sample.inputs["Index"])
    # An edited groom has another number of vertices, and passes unchanged.
    sizes = [node("GeometryNodeAttributeDomainSize", component="CURVE") for _ in range(2)]
    link(into.outputs[0], sizes[0].inputs[0])
    link(bake.outputs[0], sizes[1].inputs[0])
    same = node("FunctionNodeCompare", data_type="INT", operation="EQUAL")
    for size, name in zip(sizes, "AB"):
        link(size.outputs["Point Count"], _input(same, name))
    set_baked = node("GeometryNodeSetPosition")
    link(into.outputs[0], set_baked.inputs["Geometry"])
    link(same.outputs["Result"], set_baked.inputs["Selection"])
    link(_output(sample, "Value"), set_baked.inputs["Position"])
    link(set_baked.outputs[0], out.inputs[0])
    return tree


def _node(tree, kind, values):
    new_node = tree.nodes.new(kind)
    for name, value in values.items():
        setattr(new_node, name, value)
    return new_node


def _named(sockets, name):
    # Nodes of several types have a socket for each under one name; only the current one is enabled.
    return next(socket for socket in sockets if socket.name == name and socket.enabled)


def _input(node, name):
    return _named(node.inputs, name)


def _output(node, name):
    return _named(node.outputs, name)


def modifier(hair_object):
    """Return the modifier of a hair object, or None."""
    return next(
        (m for m in hair_object.modifiers if m.type == "NODES" and m.node_group and m.node_group.name == NAME), None
    )


def add_modifier(hair_object):
    """Return the modifier of a hair object; it is the first of its stack."""
    found = modifier(hair_object)
    if found is None:
        found = hair_object.modifiers.new(NAME, "NODES")
        found.node_group = group()
        hair_object.modifiers.move(len(hair_object.modifiers) - 1, 0)
    return found
