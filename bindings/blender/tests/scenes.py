"""Scenes for the tests, made without files: a ball with hair, turned by a bone."""

import bpy
import numpy as np

RADIUS, LENGTH = 0.1, 0.25


def empty(fps=24, last=24):
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene = bpy.context.scene
    scene.render.fps, scene.frame_start, scene.frame_end = fps, 1, last
    scene.frame_set(1)
    return scene


def ball(degrees=40, shape_key=False):
    """Return a ball and the armature that turns it to and fro, once a second."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=RADIUS)
    body = bpy.context.object
    body.name = "Body"
    bpy.ops.object.armature_add(location=(0, 0, -0.1))
    armature = bpy.context.object
    body.modifiers.new("Armature", "ARMATURE").object = armature
    bone = armature.data.bones[0].name
    body.vertex_groups.new(name=bone).add(range(len(body.data.vertices)), 1.0, "REPLACE")
    posed = armature.pose.bones[0]
    posed.rotation_mode = "XYZ"
    scene = bpy.context.scene
    for frame in range(scene.frame_start, scene.frame_end + 1):
        posed.rotation_euler.z = np.radians(degrees) * np.sin(2 * np.pi * (frame - 1) / scene.render.fps)
        posed.keyframe_insert("rotation_euler", frame=frame)
    if shape_key:
        body.shape_key_add(name="Basis")
        key = body.shape_key_add(name="Swell")
        for point in key.data:
            point.co *= 1.2
        for frame, value in ((1, 0.0), (scene.frame_end, 1.0)):
            key.value = value
            key.keyframe_insert("value", frame=frame)
    scene.frame_set(scene.frame_start)
    return body, armature


def roots(count):
    """Return directions on the upper half of a ball, [count, 3], evenly."""
    i = np.arange(count)
    down, turn = 1.2 * np.sqrt((i + 0.5) / count), 2.399963 * i
    return np.stack([np.sin(down) * np.cos(turn), np.sin(down) * np.sin(turn), np.cos(down)], -1)


def hair(body, count=100, vertices=16):
    """Return hair on `body` as Add > Curve > Empty Hair makes it, with `count` guides straight out."""
    for thing in bpy.context.selected_objects:
        thing.select_set(False)
    body.select_set(True)
    bpy.context.view_layer.objects.active = body
    bpy.ops.object.curves_empty_hair_add()
    thing = bpy.context.object
    curves = thing.data
    curves.add_curves([vertices] * count)
    out = roots(count)
    points = out[:, None] * (RADIUS + np.linspace(0, LENGTH, vertices))[None, :, None]
    curves.position_data.foreach_set("vector", points.astype(np.float32).ravel())
    radius = curves.attributes.get("radius") or curves.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", np.full(count * vertices, 4e-5, np.float32))
    bpy.ops.curves.snap_curves_to_surface(attach_mode="NEAREST")
    return thing
