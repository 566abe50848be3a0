"""Reading and writing curves of Blender as arrays."""

import numpy as np


def read(values, name, width, dtype=np.float32):
    """Return the property `name` of a collection of Blender as an array [n, width], or [n] for a width of 1."""
    out = np.empty(len(values) * width, dtype)
    values.foreach_get(name, out)
    return out.reshape(-1, width) if width > 1 else out


def positions(curves):
    """Return the vertices of `curves`, [n, 3], in the space of their object."""
    return read(curves.position_data, "vector", 3)


def offsets(curves):
    """Return the offsets of the curves among the vertices, [n + 1]."""
    return read(curves.curve_offset_data, "value", 1, np.int32)


def attribute(curves, name, domain, width=1, dtype=np.float32):
    """Return the attribute `name` of `domain`, or None if there is none."""
    found = curves.attributes.get(name)
    if found is None or found.domain != domain or len(found.data) == 0:
        return None
    field = {"FLOAT_VECTOR": "vector", "FLOAT2": "vector", "FLOAT_COLOR": "color", "BYTE_COLOR": "color"}
    # `foreach_get` fills Booleans only into an array of them.
    dtype = bool if found.data_type == "BOOLEAN" else dtype
    try:
        return read(found.data, field.get(found.data_type, "value"), width, dtype)
    except (TypeError, RuntimeError):
        return None


# Numbers per value of each data type.
WIDTHS = {
    "FLOAT": 1, "INT": 1, "INT8": 1, "BOOLEAN": 1, "FLOAT2": 2, "INT32_2D": 2, "FLOAT_VECTOR": 3, "FLOAT_COLOR": 4,
    "BYTE_COLOR": 4, "QUATERNION": 4,
}  # fmt: skip
INTEGERS = ("INT", "INT8", "BOOLEAN", "INT32_2D")
# Attributes of curves that Blender or this extension interprets, and beginnings of such names.
KNOWN = (
    "position", "radius", "resolution", "curve_type", "cyclic", "tilt", "normal_mode", "custom_normal", "nurbs_weight",
    "nurbs_order", "knots_mode", "surface_uv_coordinate", "guide_curve_index", "velocity", "material_index",
)  # fmt: skip
BEGINNINGS = (".", "handle_", "groom_", "tresses_")
COLORS = ("groom_color", "Cd", "displayColor", "color")


def colors(curves):
    """Return the linear colors of the vertices, [n, 3], or None."""
    for name in COLORS:
        found = curves.attributes.get(name)
        if found is not None and found.domain == "POINT" and WIDTHS.get(found.data_type, 0) >= 3:
            return attribute(curves, name, "POINT", WIDTHS[found.data_type])[:, :3]
    return None


def custom(curves):
    """Return the custom attributes: a dict of names to arrays and whether they have a value per vertex."""
    out = {}
    for found in curves.attributes:
        name, width = found.name, WIDTHS.get(found.data_type)
        if width is None or found.domain not in ("POINT", "CURVE"):
            continue
        if name in (*KNOWN, *COLORS) or name.startswith(BEGINNINGS):
            continue
        values = attribute(curves, name, found.domain, width, np.int32 if found.data_type in INTEGERS else np.float32)
        if values is not None:
            out[name] = values, found.domain == "POINT"
    return out


def diameters(curves):
    """Return the diameters of the vertices, [n], in units of the object, or None if they have none."""
    radii = attribute(curves, "radius", "POINT")
    return None if radii is None or not (radii > 0).any() else 2 * radii


def root_uvs(curves):
    """Return the place of each root in the UV map of the surface, [n, 2], or None."""
    return attribute(curves, "surface_uv_coordinate", "CURVE", 2)


def write_vectors(curves, name, vectors):
    """Write vectors [n, 3] to the vertex attribute `name`, which is created if it is missing."""
    found = curves.attributes.get(name) or curves.attributes.new(name, "FLOAT_VECTOR", "POINT")
    found.data.foreach_set("vector", np.ascontiguousarray(vectors, np.float32).ravel())


def copied(curves, target):
    """Give the new curves `target` the shapes, the widths and the root UVs of `curves`."""
    starts = offsets(curves)
    target.add_curves(np.diff(starts).tolist())
    target.position_data.foreach_set("vector", positions(curves).ravel())
    radii = attribute(curves, "radius", "POINT")
    if radii is not None:
        own = target.attributes.get("radius") or target.attributes.new("radius", "FLOAT", "POINT")
        own.data.foreach_set("value", radii)
    uvs = root_uvs(curves)
    if uvs is not None:
        own = target.attributes.new("surface_uv_coordinate", "FLOAT2", "CURVE")
        own.data.foreach_set("vector", uvs.ravel())
    for material in curves.materials:
        target.materials.append(material)


def select_curve(curves, index):
    """Select a single curve."""
    found = curves.attributes.get(".selection")
    if found is not None:
        curves.attributes.remove(found)
    selected = np.zeros(len(curves.curves), bool)
    selected[index] = True
    curves.attributes.new(".selection", "BOOLEAN", "CURVE").data.foreach_set("value", selected)
    curves.selection_domain = "CURVE"
