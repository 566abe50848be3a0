"""Strands that modifiers have made, as an object of their own."""

import bpy

from . import hair
from .body import BodyError


def evaluated(hair_object, context):
    """Return a new object with the curves that the modifiers of `hair_object` make now, in the same place. Hides it."""
    depsgraph = context.evaluated_depsgraph_get()
    now = hair_object.evaluated_get(depsgraph)
    if now.type != "CURVES" or len(now.data.curves) == 0:
        raise BodyError(f"the modifiers of {hair_object.name} make no curves")
    data = bpy.data.hair_curves.new(f"{hair_object.data.name} strands")
    hair.copied(now.data, data)
    data.surface = hair_object.data.surface
    created = bpy.data.objects.new(f"{hair_object.name} strands", data)
    created.matrix_world = hair_object.matrix_world
    for collection in hair_object.users_collection:
        collection.objects.link(created)
    own, other = created.tresses, hair_object.tresses
    own.body, own.colliders, own.settle, own.source = other.body, other.colliders, other.settle, hair_object
    for name in ("use_scene_gravity", "use_scene_range", "first", "last"):
        setattr(own, name, getattr(other, name))
    for name in other.values.bl_rna.properties.keys():
        if other.values.is_property_set(name) and name not in ("rna_type", "name"):
            setattr(own.values, name, getattr(other.values, name))
    other.result = created
    hair_object.hide_render = True
    hair_object.hide_set(True)
    return created


def of_particles(body, context):
    """Return objects of curves made from the hair of all particle systems of `body`, with their children."""
    created = []
    for index, system in enumerate(body.particle_systems):
        if system.settings.type != "HAIR":
            continue
        body.particle_systems.active_index = index
        for selected in context.selected_objects:
            selected.select_set(False)
        body.select_set(True)
        context.view_layer.objects.active = body
        bpy.ops.curves.convert_from_particle_system()
        hair_object = context.view_layer.objects.active
        if hair_object is body or hair_object.type != "CURVES":
            continue
        if hair_object.data.surface is None:
            hair_object.data.surface = body
        created.append(hair_object)
        for m in body.modifiers:
            if m.type == "PARTICLE_SYSTEM" and m.particle_system == system:
                m.show_viewport = m.show_render = False
    return created
