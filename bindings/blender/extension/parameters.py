"""Properties of Blender from Tresses' table of parameters."""

import bpy
import tresses

# Groups of the table that have an effect on curves of Blender, with their titles.
GROUPS = {"simulation": "Physics", "wind": "Wind", "style": "Strands", "avoidance": "Contact of Strands"}
# Parameters that a simulation sets itself.
OWN = {"style.all_guides", "style.strands", "style.beard", "style.brows", "style.lashes"}


def rows():
    """Return the parameters of the table, by group."""
    out = {group: [] for group in GROUPS}
    for row in tresses.parameters():
        group = row.name.split(".")[0]
        if group in out and row.name not in OWN:
            out[group].append(row)
    return out


def identifier(name):
    return name.replace(".", "__")


def _property(row):
    unit = f", {row.unit}" if row.unit else ""
    texts = dict(name=row.label, description=f"{row.hint.rstrip('.')}{unit}")
    if row.kind == "toggle":
        return bpy.props.BoolProperty(default=bool(row.default), **texts)
    if row.kind == "choice":
        # Unset means automatic.
        items = [(value, value.replace("-", " ").title(), hint) for value, hint in row.choices]
        return bpy.props.EnumProperty(items=items, default=row.default or items[0][0], **texts)
    if row.kind == "color":
        return bpy.props.StringProperty(default=row.default or "", **texts)
    max_integer = 2**31 - 1
    default = row.min if row.default is None else row.default
    if row.kind == "integer":
        return bpy.props.IntProperty(
            default=int(default), min=int(row.min), max=min(int(row.max), max_integer), **texts
        )
    return bpy.props.FloatProperty(default=default, min=row.min, max=row.max, precision=3, **texts)


def annotations():
    """Return a property for each parameter, for a class of properties."""
    return {identifier(row.name): _property(row) for group in rows().values() for row in group}


def changed(properties):
    """Return the values that the user has set, by name of the parameter. Others keep their defaults."""
    out = {}
    for row in (row for group in rows().values() for row in group):
        name = identifier(row.name)
        if properties.is_property_set(name):
            out[row.name] = getattr(properties, name)
    return out
