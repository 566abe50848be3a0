"""Creates a character in Blender: `blender --background --python blender.py -- body.glb`, or `body.usdc` with one
action.

The character has shoulders, a neck and a head: one skinned mesh with three bones, 1.8 units high, Z up as in
Blender. It has one shape key and two actions."""

import sys

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)

# The mesh: smooth-shaded stacked rings, with a nose that marks the front (-Y in Blender).
import math

RINGS = [
    (1.20, 0.20), (1.32, 0.21), (1.42, 0.16), (1.46, 0.07), (1.52, 0.055), (1.56, 0.075),
    (1.62, 0.095), (1.68, 0.10), (1.74, 0.092), (1.78, 0.06), (1.80, 0.02),
]
SIDES = 32
vertices, faces = [], []
for height, radius in RINGS:
    for side in range(SIDES):
        angle = 2 * math.pi * side / SIDES
        depth = 0.6 if height < 1.45 else 1.1
        x, y = radius * math.cos(angle), depth * radius * math.sin(angle)
        if abs(height - 1.62) < 0.01 and side == 24:
            y -= 0.03
        vertices.append((x, y, height))
for ring in range(len(RINGS) - 1):
    for side in range(SIDES):
        a, b = ring * SIDES + side, ring * SIDES + (side + 1) % SIDES
        faces.append((a, b, b + SIDES, a + SIDES))
top = len(vertices)
vertices.append((0, 0, RINGS[-1][0] + 0.002))
last = (len(RINGS) - 1) * SIDES
faces += [(last + side, last + (side + 1) % SIDES, top) for side in range(SIDES)]
mesh = bpy.data.meshes.new("Skin")
mesh.from_pydata(vertices, [], faces)
for polygon in mesh.polygons:
    polygon.use_smooth = True
body = bpy.data.objects.new("Skin", mesh)
bpy.context.collection.objects.link(body)

# The bones.
armature = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
bpy.context.collection.objects.link(armature)
bpy.context.view_layer.objects.active = armature
bpy.ops.object.mode_set(mode="EDIT")
parent = None
for name, low, high in [("Chest", 1.20, 1.44), ("Neck", 1.44, 1.55), ("Head", 1.55, 1.80)]:
    bone = armature.data.edit_bones.new(name)
    bone.head, bone.tail, bone.parent = (0, 0, low), (0, 0, high), parent
    parent = bone
bpy.ops.object.mode_set(mode="OBJECT")

# Weights blend smoothly from bone to bone.
def share(height, low, high):
    return min(max((height - low) / (high - low), 0.0), 1.0)

groups = {name: body.vertex_groups.new(name=name) for name in ("Chest", "Neck", "Head")}
for i, (_, _, height) in enumerate(vertices):
    neck, head = share(height, 1.40, 1.48), share(height, 1.52, 1.58)
    for name, weight in (("Chest", 1 - neck), ("Neck", neck * (1 - head)), ("Head", head)):
        if weight > 0:
            groups[name].add([i], weight, "REPLACE")
body.parent = armature
body.modifiers.new("Armature", "ARMATURE").object = armature

# A shape key that raises the crown.
body.shape_key_add(name="Basis")
tall = body.shape_key_add(name="Tall")
for i, (x, y, height) in enumerate(vertices):
    tall.data[i].co = (x, y, height + 0.02 * share(height, 1.66, 1.80))

# Two actions as NLA tracks: the exporter writes each as an animation.
armature.animation_data_create()
bpy.context.scene.render.fps = 24
for name, axis, degrees in (("Turn", 1, 50), ("Nod", 0, 20)):
    action = bpy.data.actions.new(name)
    armature.animation_data.action = action
    for bone in ("Neck", "Head"):
        pose = armature.pose.bones[bone]
        pose.rotation_mode = "XYZ"
        for frame, part in ((0, 0.0), (12, 0.5), (36, -0.5), (48, 0.0)):
            pose.rotation_euler = [0.0, 0.0, 0.0]
            pose.rotation_euler[axis] = math.radians(degrees) * part
            pose.keyframe_insert("rotation_euler", frame=frame)
    track = armature.animation_data.nla_tracks.new()
    track.name = name
    track.strips.new(name, 0, action)
armature.animation_data.action = None

if sys.argv[-1].endswith(".glb"):
    bpy.ops.export_scene.gltf(filepath=sys.argv[-1], export_format="GLB")
else:
    # A USD scene has a single timeline, so it stores one action.
    for track in list(armature.animation_data.nla_tracks)[1:]:
        armature.animation_data.nla_tracks.remove(track)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 0, 48
    bpy.ops.wm.usd_export(filepath=sys.argv[-1], export_animation=True)
