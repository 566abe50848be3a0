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
    attribute = {
        "accessor": _accessor(values.astype(np.float32), kind),
        "per": "strand" if len(values) == count else "vertex",
    }
    if np.issubdtype(values.dtype, np.integer):
        attribute["integer"] = True
    return attribute


def groom(context, hair_objects):
    """Return the members of the extension for hair objects at rest."""
    strands = export.at_rest(context, hair_objects).strands()
    counts = np.diff(strands.offsets)
    vertices = np.concatenate([strands.positions, strands.widths[:, None]], 1)
    strand_data = {"count": len(strands), "vertices": _accessor(vertices, "VEC4"), "width": 1.0}
    if len(set(counts.tolist())) == 1:
        strand_data["vertexCount"] = int(counts[0])
    else:
        strand_data["vertexCounts"] = _accessor(counts, "SCALAR")
    if strands.root_uvs is not None:
        strand_data["rootUvs"] = _accessor(strands.root_uvs, "VEC2")
    if strands.colors is not None:
        strand_data["colors"] = _accessor(strands.colors, "VEC3")
    if strands.attributes:
        strand_data["attributes"] = {name: _attribute(values, len(strands)) for name, values in strands.attributes.items()}
    strand_data["groups"] = _accessor(strands.groups, "SCALAR")
    if strands.guides.any():
        strand_data["flags"] = _accessor(strands.guides, "SCALAR")
        strand_data["ids"] = _accessor(strands.ids, "SCALAR")
        strand_data["closest"] = _accessor(strands.closest, "VEC3")
        strand_data["weights"] = _accessor(strands.weights, "VEC3")
    out = {
        "name": hair_objects[0].name,
        "groupNames": {str(group): hair_object.name for group, hair_object in enumerate(hair_objects)},
        "strands": strand_data,
    }
    material = look.fiber(hair_objects[0])
    if material:
        out["material"] = material
    return out


class Exporter:
    """What Blender's exporter calls."""

    def gather_gltf_hook(self, active_scene, scenes, _animations, export_settings):
        import bpy

        context = bpy.context
        is_exported = lambda candidate: (
            candidate.select_get() if export_settings.get("gltf_selected") else candidate.visible_get()
        )
        hair_objects = [o for o in context.scene.objects if o.type == "CURVES" and len(o.data.curves) and is_exported(o)]
        if not hair_objects or not scenes:
            return
        *_, child, extension = _io()
        held = child(path=["grooms"], name=NAME, extension=groom(context, hair_objects), required=False)
        scene = scenes[active_scene if active_scene is not None else 0]
        scene.extensions = dict(scene.extensions or {})
        scene.extensions[NAME] = extension(name=NAME, extension={"groom": held}, required=False)
        kept = export_settings.get("gltf_need_to_keep_extension_declaration")
        if kept is not None and NAME not in kept:
            kept.append(NAME)
