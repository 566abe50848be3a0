"""Creates grooms in Blender, and reads grooms with it.

`python blender_grooms.py make FOLDER` creates a head with Blender's hair curves, and one with particle hair and
children, and writes them as Alembic and USD. `python blender_grooms.py count FILE` opens a file and prints as JSON
the number of curves and points, the sum of all coordinates (Y up), and the mean width.

Runs in Blender (`blender --background --python … -- …`) or with the module `bpy`. Needs a build with Alembic."""

import json
import math
import os
import random
import sys

import bpy

CURVES, POINTS = 600, 9


def head():
    """Creates an ellipsoid head whose nose points to -Y, the front of characters in Blender."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.09, location=(0, 0, 1.65))
    ball = bpy.context.object
    ball.name = "Head"
    ball.scale = (0.87, 1.05, 1.2)
    bpy.ops.object.transform_apply(location=True, rotation=True, scale=True)
    for vertex in ball.data.vertices:
        far = math.hypot(vertex.co.x, vertex.co.z - 1.62)
        if vertex.co.y < 0 and far < 0.02:
            vertex.co.y -= 0.025 * (1 - far / 0.02)
    return ball


def curves():
    """Creates hair that leaves the scalp radially, then falls. The face has none."""
    random.seed(1)
    data = bpy.data.hair_curves.new("Hair")
    hair = bpy.data.objects.new("Hair", data)
    bpy.context.collection.objects.link(hair)
    data.add_curves([POINTS] * CURVES)
    made = 0
    while made < CURVES:
        angle, z = random.uniform(0, 2 * math.pi), random.uniform(0.1, 1)
        x, y = (math.sqrt(1 - z * z) * part for part in (math.cos(angle), math.sin(angle)))
        if y < -0.45 and z < 0.75:
            continue
        for k, point in enumerate(data.curves[made].points):
            t = 0.2 * k / (POINTS - 1)
            point.position = (
                x * (0.0783 + 0.35 * t),
                y * (0.0945 + 0.35 * t),
                1.65 + z * (0.108 + 0.2 * t) - 4 * t * t,
            )
            point.radius = 5e-5 * (1 - 0.6 * k / (POINTS - 1))
        made += 1
    return hair


def make(folder):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.frame_end = 3
    ball, hair = head(), curves()
    files = {end: os.path.join(folder, "curves." + end) for end in ("abc", "usda", "usdc", "usdz")}
    bpy.ops.wm.alembic_export(filepath=files["abc"])
    for end in ("usda", "usdc", "usdz"):
        bpy.ops.wm.usd_export(filepath=files[end])
    bpy.data.objects.remove(hair)
    bpy.context.view_layer.objects.active = ball
    scalp = ball.vertex_groups.new(name="scalp")
    on = [v.index for v in ball.data.vertices if v.co.z > 1.66 and not (v.co.y < -0.04 and v.co.z < 1.70)]
    scalp.add(on, 1.0, "REPLACE")
    ball.modifiers.new("hair", "PARTICLE_SYSTEM")
    system = ball.particle_systems[0]
    settings = system.settings
    settings.type, settings.count, settings.hair_length, settings.hair_step = "HAIR", 300, 0.15, 6
    system.vertex_group_density = "scalp"
    settings.child_type, settings.rendered_child_count, settings.child_percent = "INTERPOLATED", 10, 10
    bpy.context.view_layer.update()
    bpy.ops.wm.alembic_export(filepath=os.path.join(folder, "particles.abc"), export_hair=True)
    bpy.ops.wm.usd_export(filepath=os.path.join(folder, "particles.usda"), export_hair=True)


def count(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if path.endswith(".abc"):
        bpy.ops.wm.alembic_import(filepath=path, set_frame_range=True)
    else:
        bpy.ops.wm.usd_import(filepath=path)
    found = []
    for frame in range(bpy.context.scene.frame_start, bpy.context.scene.frame_start + 3):
        bpy.context.scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        strands = points = 0
        total, width = [0.0, 0.0, 0.0], 0.0
        for item in bpy.data.objects:
            if item.type not in ("CURVES", "CURVE"):
                continue
            item = item.evaluated_get(graph)
            place = item.matrix_world
            if item.type == "CURVE":
                # Older versions import curves as splines.
                lines = [[(p.co.to_3d(), p.radius) for p in spline.points] for spline in item.data.splines]
            else:
                lines = [[(p.position, p.radius) for p in curve.points] for curve in item.data.curves]
            strands += len(lines)
            for line in lines:
                for position, radius in line:
                    x, y, z = place @ position
                    total = [a + b for a, b in zip(total, (x, z, -y))]
                    width += 2 * radius
                    points += 1
        found.append({"curves": strands, "points": points, "sum": total, "width": width / max(points, 1)})
    print("FOUND " + json.dumps(found))


if __name__ == "__main__":
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    # Blender's exporters may change the working folder.
    place = os.path.abspath(words[1])
    make(place) if words[0] == "make" else count(place)
