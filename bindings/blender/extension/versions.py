"""Differences between versions of Blender, from 4.2 on."""

import bpy

# Inputs of modifiers are properties of their own since 5.2.
HAS_INPUTS = bpy.app.version >= (5, 2, 0)


def set_bake(bake, folder, first, last):
    """Let `bake` of a modifier store the frames `first` to `last` in `folder`, or in the file if `folder` is None."""
    bake.bake_mode = "ANIMATION"
    if hasattr(bake, "bake_target"):
        bake.bake_target = "PACKED" if folder is None else "DISK"
    if folder is not None:
        bake.use_custom_path = True
        bake.directory = folder
    bake.use_custom_simulation_frame_range = True
    bake.frame_start, bake.frame_end = first, last


def add_bake_item(node):
    """Give a new Bake node the geometry that it stores. Versions differ in whether it has one."""
    if len(node.bake_items) == 0:
        node.bake_items.new("GEOMETRY", "Geometry")


def copy_inputs(source, target):
    """Copy the inputs of a Geometry Nodes modifier to another of the same group."""
    for item in source.node_group.interface.items_tree:
        if item.item_type != "SOCKET" or item.in_out != "INPUT" or item.socket_type == "NodeSocketGeometry":
            continue
        name = item.identifier
        if HAS_INPUTS:
            own, other = (getattr(m.properties.inputs, name, None) for m in (source, target))
            if own is None or other is None:
                continue
            for field in ("type", "value", "attribute_name"):
                if hasattr(own, field):
                    try:
                        setattr(other, field, getattr(own, field))
                    except (AttributeError, TypeError):
                        pass
        elif name in source:
            target[name] = source[name]
