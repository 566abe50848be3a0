"""Differences between versions of Blender, from 4.2 on."""


def set_bake(bake, folder, first, last):
    """Let `bake` of a modifier store the frames `first` to `last` in `folder`."""
    bake.bake_mode = "ANIMATION"
    if hasattr(bake, "bake_target"):
        bake.bake_target = "DISK"
    bake.use_custom_path, bake.directory = True, folder
    bake.use_custom_simulation_frame_range = True
    bake.frame_start, bake.frame_end = first, last


def add_bake_item(node):
    """Give a new Bake node the geometry that it stores. Versions differ in whether it has one."""
    if len(node.bake_items) == 0:
        node.bake_items.new("GEOMETRY", "Geometry")
