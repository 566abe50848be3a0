"""Hair in files of Blender's glTF exporter: the extension EXT_tresses_hair beside body, skin and animations."""

import numpy as np

from . import export, look

NAME = "EXT_tresses_hair"
FLOAT, UNSIGNED_INT = 5126, 5125


def _io():
    # The exporter's modules have moved between versions.
    try:
        from io_scene_gltf2.io.exp.binary_data import BinaryData
    except ImportError:
        from io_scene_gltf2.io.exp.gltf2_io_binary_data import BinaryData
    from io_scene_gltf2.io.com import gltf2_io
    from io_scene_gltf2.io.com.gltf2_io_extensions import ChildOfRootExtension, Extension

    return gltf2_io.Accessor, BinaryData, ChildOfRootExtension, Extension


def _accessor(values, kind):
    """Return an accessor for an array [n] or [n, k]."""
    accessor, binary, *_ = _io()
    integer = np.issubdtype(values.dtype, np.integer) or values.dtype == bool
    data = np.ascontiguousarray(values, np.uint32 if integer else np.float32)
    # Negative numbers are in two's complement.
    return accessor(
        buffer_view=binary(data.tobytes()), byte_offset=None, component_type=UNSIGNED_INT if integer else FLOAT,
        count=len(data), extensions=None, extras=None, max=None, min=None, name=None, normalized=None, sparse=None,
        type=kind,
    )  # fmt: skip


def _attribute(values, count):
    """Return a custom attribute of `count` strands."""
    kind = ("SCALAR", "VEC2", "VEC3", "VEC4")[values.shape[1] - 1 if values.ndim > 1 else 0]
    said = {"accessor": _accessor(values.astype(np.float32), kind), "per": "strand" if len(values) == count else "vertex"}
    if np.issubdtype(values.dtype, np.integer):
        said["integer"] = True
    return said


def groom(context, things):
    """Return the members of the extension for hair objects at rest."""
    strands = export.at_rest(context, things).strands()
    counts = np.diff(strands.offsets)
    vertices = np.concatenate([strands.positions, strands.widths[:, None]], 1)
    said = {"count": len(strands), "vertices": _accessor(vertices, "VEC4"), "width": 1.0}
    if len(set(counts.tolist())) == 1:
        said["vertexCount"] = int(counts[0])
    else:
        said["vertexCounts"] = _accessor(counts, "SCALAR")
    if strands.root_uvs is not None:
        said["rootUvs"] = _accessor(strands.root_uvs, "VEC2")
    if strands.colors is not None:
        said["colors"] = _accessor(strands.colors, "VEC3")
    if strands.attributes:
        said["attributes"] = {name: _attribute(values, len(strands)) for name, values in strands.attributes.items()}
    said["groups"] = _accessor(strands.groups, "SCALAR")
    if strands.guides.any():
        said["flags"] = _accessor(strands.guides, "SCALAR")
        said["ids"] = _accessor(strands.ids, "SCALAR")
        said["closest"] = _accessor(strands.closest, "VEC3")
        said["weights"] = _accessor(strands.weights, "VEC3")
    out = {
        "name": things[0].name,
        "groupNames": {str(group): thing.name for group, thing in enumerate(things)},
        "strands": said,
    }
    material = look.fiber(things[0])
    if material:
        out["material"] = material
    return out


class Exporter:
    """What Blender's exporter calls."""

    def gather_gltf_hook(self, active_scene, scenes, _animations, export_settings):
        import bpy

        context = bpy.context
        chosen = lambda thing: thing.select_get() if export_settings.get("gltf_selected") else thing.visible_get()
        things = [o for o in context.scene.objects if o.type == "CURVES" and len(o.data.curves) and chosen(o)]
        if not things or not scenes:
            return
        *_, child, extension = _io()
        held = child(path=["grooms"], name=NAME, extension=groom(context, things), required=False)
        scene = scenes[active_scene if active_scene is not None else 0]
        scene.extensions = dict(scene.extensions or {})
        scene.extensions[NAME] = extension(name=NAME, extension={"groom": held}, required=False)
        kept = export_settings.get("gltf_need_to_keep_extension_declaration")
        if kept is not None and NAME not in kept:
            kept.append(NAME)
