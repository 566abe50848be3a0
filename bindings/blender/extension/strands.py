"""Strands that modifiers have made, as an object of their own."""

import bpy

from . import hair
from .body import BodyError


def evaluated(thing, context):
    """Return a new object with the curves that the modifiers of `thing` make now, in the same place. Hides `thing`."""
    depsgraph = context.evaluated_depsgraph_get()
    now = thing.evaluated_get(depsgraph)
    if now.type != "CURVES" or len(now.data.curves) == 0:
        raise BodyError(f"the modifiers of {thing.name} make no curves")
    data = bpy.data.hair_curves.new(f"{thing.data.name} strands")
    hair.copied(now.data, data)
    data.surface = thing.data.surface
    made = bpy.data.objects.new(f"{thing.name} strands", data)
    made.matrix_world = thing.matrix_world
    for collection in thing.users_collection:
        collection.objects.link(made)
    own, other = made.tresses, thing.tresses
    own.body, own.colliders, own.settle, own.source = other.body, other.colliders, other.settle, thing
    for name in ("use_scene_gravity", "use_scene_range", "first", "last"):
        setattr(own, name, getattr(other, name))
    for name in other.values.bl_rna.properties.keys():
        if other.values.is_property_set(name) and name not in ("rna_type", "name"):
            setattr(own.values, name, getattr(other.values, name))
    other.result = made
    thing.hide_render = True
    thing.hide_set(True)
    return made


def of_particles(body, context):
    """Return objects of curves made from the hair of all particle systems of `body`, with their children."""
    made = []
    for index, system in enumerate(body.particle_systems):
        if system.settings.type != "HAIR":
            continue
        body.particle_systems.active_index = index
        for selected in context.selected_objects:
            selected.select_set(False)
        body.select_set(True)
        context.view_layer.objects.active = body
        bpy.ops.curves.convert_from_particle_system()
        thing = context.view_layer.objects.active
        if thing is body or thing.type != "CURVES":
            continue
        if thing.data.surface is None:
            thing.data.surface = body
        made.append(thing)
        for m in body.modifiers:
            if m.type == "PARTICLE_SYSTEM" and m.particle_system == system:
                m.show_viewport = m.show_render = False
    return made
