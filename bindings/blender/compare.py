# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare the extension with Blender's own Hair Dynamics node: time, lengths and depth in the body, in one scene.

    TRESSES_EXTENSION=dist/blender/tresses-blender.zip python compare.py [GUIDES]

The scene is a ball of 10 cm that a bone turns by 40° to and fro, once a second for 60 frames, with guides of 25 cm. The
node exists since Blender 5.2. Times are processor times of all threads.
"""

import os
import sys
import tempfile
import time

os.environ["BLENDER_USER_RESOURCES"] = tempfile.mkdtemp()
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "tests"))

import bpy  # noqa: E402
import numpy as np  # noqa: E402

FRAMES, VERTICES = 60, 16


def main():
    guides = int(sys.argv[1]) if len(sys.argv) > 1 else 600
    bpy.ops.extensions.package_install_files(
        filepath=os.environ["TRESSES_EXTENSION"], repo="user_default", enable_on_install=True
    )
    print(f"Blender {bpy.app.version_string}, {guides} guides of {VERTICES} vertices, {FRAMES} frames")
    print("| | CPU ms a frame | mean, worst change of length | vertices > 1 mm inside | deepest |")
    print("|---|---|---|---|---|")
    for name, ready in (
        ("Hair Dynamics, Physics", lambda hair_object: node(hair_object, False)),
        ("the same, Surface Collision", lambda hair_object: node(hair_object, True)),
        ("Tresses", simulated),
    ):
        measure(name, ready, guides)


def node(hair_object, collides):
    """Let Blender's node simulate. Returns the processor time that has passed already, s."""
    m = next((m for m in hair_object.modifiers if m.node_group and m.node_group.name.startswith("Hair Dynamics")), None)
    if m is None:
        return None
    inputs = m.properties.inputs
    items = [item for item in m.node_group.interface.items_tree if item.item_type == "SOCKET"]
    names = {(item.name, item.socket_type): item.identifier for item in items if item.in_out == "INPUT"}
    mode = getattr(inputs, names["Mode", "NodeSocketMenu"])
    mode.value = next(e.identifier for e in mode.bl_rna.properties["value"].enum_items if "Physics" in e.identifier)
    getattr(inputs, names["Surface Collision", "NodeSocketBool"]).value = collides
    # A simulation in nodes follows the timeline only after a relation has changed.
    m.node_group = m.node_group
    return 0.0


def simulated(hair_object):
    """Simulate with the extension."""
    for selected in bpy.context.selected_objects:
        selected.select_set(False)
    hair_object.select_set(True)
    bpy.context.view_layer.objects.active = hair_object
    begin = time.process_time()
    bpy.ops.tresses.simulate()
    return time.process_time() - begin


def measure(name, ready, guides):
    import scenes

    scene = scenes.empty(last=FRAMES)
    body, _ = scenes.ball()
    hair_object = scenes.hair(body, guides, VERTICES)
    rest = np.full(guides, scenes.LENGTH)
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(tempfile.mkdtemp(), "scene.blend"))
    elapsed = ready(hair_object)
    if elapsed is None:
        print(f"| {name} | not in this version | | | |")
        return
    begin, changes, inside, deepest = time.process_time(), [], [], 0.0
    for frame in range(1, FRAMES + 1):
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        data = hair_object.evaluated_get(graph).data
        points = np.empty(3 * len(data.points), np.float32)
        data.position_data.foreach_get("vector", points)
        points = points.reshape(guides, VERTICES, 3)
        skin = body.evaluated_get(graph).data
        vertices = np.empty(3 * len(skin.vertices), np.float32)
        skin.attributes["position"].data.foreach_get("vector", vertices)
        vertices = vertices.reshape(-1, 3)
        center = 0.5 * (vertices.min(0) + vertices.max(0))
        depth = scenes.RADIUS - np.linalg.norm(points[:, 1:] - center, axis=2)
        lengths = np.linalg.norm(np.diff(points, axis=1), axis=2).sum(1)
        changes.append(np.abs(lengths / rest - 1))
        inside.append((depth > 1e-3).mean())
        deepest = max(deepest, depth.max())
    cost = 1e3 * (elapsed + time.process_time() - begin) / FRAMES
    changes = np.array(changes)
    print(
        f"| {name} | {cost:.0f} | {100 * changes.mean():.2g} %, {100 * changes.max():.2g} % | "
        f"{100 * np.mean(inside):.1f} % | {1e3 * max(deepest, 0):.1f} mm |",
        flush=True,
    )


if __name__ == "__main__":
    main()
