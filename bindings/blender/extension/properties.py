"""What the extension stores with an object of hair."""

import bpy

from . import look, parameters


def _is_mesh(_, candidate):
    return candidate.type == "MESH"


class TressesParameters(bpy.types.PropertyGroup):
    """Values of Tresses' parameters."""

    __annotations__ = parameters.annotations()


class TressesHair(bpy.types.PropertyGroup):
    """How an object of hair is simulated."""

    mode: bpy.props.EnumProperty(
        name="Simulate",
        items=[
            ("GUIDES", "Guides", "Simulate the curves of the object; its modifiers make the strands from them"),
            ("STRANDS", "Strands", "Simulate what the modifiers make, as a new object; this one is hidden"),
        ],
        description="Which curves move",
    )
    body: bpy.props.PointerProperty(
        type=bpy.types.Object, poll=_is_mesh, name="Body", description="Mesh that hair grows on; empty for its surface"
    )
    colliders: bpy.props.PointerProperty(
        type=bpy.types.Collection, name="Colliders", description="Further meshes that hair meets"
    )
    stiffness: bpy.props.StringProperty(
        name="Stiffness", description="Attribute of the curves or points: a factor on the stiffness of each curve"
    )
    settle: bpy.props.IntProperty(
        name="Settle", default=24, min=0, max=1000, description="Frames before the first in which hair comes to rest"
    )
    use_scene_gravity: bpy.props.BoolProperty(
        name="Scene Gravity", default=True, description="Take the strength of gravity from the scene"
    )
    drawn: bpy.props.BoolProperty(
        name="Drawn by Tresses", default=False, description="Live: draw the hair by Tresses in place of Blender"
    )
    use_scene_range: bpy.props.BoolProperty(
        name="Scene Range", default=True, description="Simulate the frames of the scene"
    )
    first: bpy.props.IntProperty(name="First", default=1, description="First simulated frame")
    last: bpy.props.IntProperty(name="Last", default=250, description="Last simulated frame")
    result: bpy.props.PointerProperty(type=bpy.types.Object, name="Result")
    source: bpy.props.PointerProperty(type=bpy.types.Object, name="Source")
    values: bpy.props.PointerProperty(type=TressesParameters)

    def meshes(self):
        """Return the body and the colliders."""
        body = self.body or self.id_data.data.surface
        others = self.colliders.all_objects if self.colliders else ()
        return list(dict.fromkeys([m for m in (body, *others) if m is not None and m.type == "MESH"]))

    def settings(self, scene):
        """Return values of Tresses' parameters by name."""
        out = {**look.settings(self.id_data), **parameters.changed(self.values)}
        if self.use_scene_gravity:
            strength = -scene.gravity.z * (scene.unit_settings.scale_length or 1.0) if scene.use_gravity else 0.0
            out["simulation.gravity"] = min(max(strength, 0.0), 50.0)
        return out

    def range(self, scene):
        """Return the first and the last frame."""
        return (scene.frame_start, scene.frame_end) if self.use_scene_range else (self.first, max(self.first, self.last))


CLASSES = (TressesParameters, TressesHair)
