"""Grooms and caches in files."""

import bpy
import numpy as np
import scenes
from test_simulation import arrays, select


def test_groups_and_root_uvs_reach_the_file(tresses, saved, tmp_path):
    scenes.empty(last=2)
    body, _ = scenes.ball()
    things = [scenes.hair(body, 20), scenes.hair(body, 12)]
    select(*things)
    file = str(tmp_path / "groom.abc")
    assert bpy.ops.tresses.export(filepath=file) == {"FINISHED"}
    back = tresses.read(file).strands
    assert len(back) == 32 and sorted(np.bincount(back.groups).tolist()) == [12, 20]
    assert back.root_uvs.shape == (32, 2) and np.allclose(back.widths, 8e-5)
    assert np.ptp(back.positions[:, 1]) < 1, "meters, not centimeters"


def test_strands_name_the_guides_that_they_follow(tresses, tmp_path):
    # In the middle of a turn; the file has the rest pose.
    scene = scenes.empty(last=24)
    body, _ = scenes.ball()
    thing = scenes.hair(body, 10)
    scene.frame_set(7)
    # A node group that doubles each curve and says which it came from, as Interpolate Hair Curves does.
    group = bpy.data.node_groups.new("Children", "GeometryNodeTree")
    for side in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Geometry", in_out=side, socket_type="NodeSocketGeometry")
    make = group.nodes.new
    into, double, store, out = map(
        make,
        ("NodeGroupInput", "GeometryNodeDuplicateElements", "GeometryNodeStoreNamedAttribute", "NodeGroupOutput"),
    )
    double.domain = "SPLINE"
    double.inputs["Amount"].default_value = 3
    index = make("GeometryNodeInputIndex")
    store.data_type, store.domain = "INT", "CURVE"
    store.inputs["Name"].default_value = "guide_curve_index"
    divide = make("ShaderNodeMath")
    divide.operation, divide.inputs[1].default_value = "DIVIDE", 3
    floor = make("ShaderNodeMath")
    floor.operation = "FLOOR"
    link = group.links.new
    link(into.outputs[0], double.inputs[0])
    link(double.outputs[0], store.inputs[0])
    link(index.outputs[0], divide.inputs[0])
    link(divide.outputs[0], floor.inputs[0])
    value = next(s for s in store.inputs if s.name == "Value" and s.enabled)
    link(floor.outputs[0], value)
    link(store.outputs[0], out.inputs[0])
    thing.modifiers.new("Children", "NODES").node_group = group
    select(thing)
    file = str(tmp_path / "groom.abc")
    assert bpy.ops.tresses.export(filepath=file) == {"FINISHED"}
    back = tresses.read(file).strands
    assert back.guides.sum() == 10 and len(back) == 40
    guides = {int(back.ids[i]): back[i] for i in np.flatnonzero(back.guides)}
    for i in np.flatnonzero(~back.guides):
        assert np.abs(back[i] - guides[int(back.closest[i][0])]).max() < 1e-4
        assert np.allclose(back.weights[i], [1, 0, 0])
    assert len(tresses.Groom.of(back).guides) == 10


def test_custom_attributes_reach_the_files(tresses, saved, tmp_path):
    scenes.empty(last=2)
    body, _ = scenes.ball()
    things = [scenes.hair(body, 20), scenes.hair(body, 12)]
    for thing in things:
        curves = thing.data
        new = curves.attributes.new
        count, vertices = len(curves.curves), len(curves.points)
        new("age", "INT", "CURVE").data.foreach_set("value", np.arange(count) - 3)
        new("soft", "BOOLEAN", "CURVE").data.foreach_set("value", np.arange(count) % 2 == 0)
        new("wet", "FLOAT", "POINT").data.foreach_set("value", np.linspace(0, 1, vertices))
        new("flow", "FLOAT_VECTOR", "POINT").data.foreach_set("vector", np.full(3 * vertices, 0.25))
        new("Cd", "FLOAT_COLOR", "POINT").data.foreach_set("color", np.tile([0.5, 0.25, 0.125, 1], vertices))
    things[0].data.attributes.new("alone", "FLOAT", "CURVE")
    select(*things)
    file = str(tmp_path / "groom.abc")
    assert bpy.ops.tresses.export(filepath=file) == {"FINISHED"}
    if "io_scene_gltf2" not in bpy.context.preferences.addons:
        bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
    both = str(tmp_path / "groom.glb")
    bpy.ops.export_scene.gltf(filepath=both)
    for file in (file, both):
        back = tresses.read(file).strands
        found = back.attributes
        assert set(found) == {"age", "soft", "wet", "flow"}
        assert sorted(found["age"]) == sorted([*range(-3, 17), *range(-3, 9)]) and found["age"].dtype == np.int32
        assert found["soft"].sum() == 16 and found["flow"].shape == (len(back.positions), 3)
        assert np.isclose(found["wet"].max(), 1) and np.allclose(back.colors, [0.5, 0.25, 0.125], atol=1e-4)


def test_a_cache_has_all_frames(tresses, saved, tmp_path):
    scene = scenes.empty(last=5)
    body, _ = scenes.ball()
    thing = scenes.hair(body, 10)
    saved()
    select(thing)
    assert bpy.ops.tresses.simulate() == {"FINISHED"}
    file = str(tmp_path / "cache.abc")
    assert bpy.ops.tresses.export(filepath=file, animated=True, unit="m") == {"FINISHED"}
    for frame in (1, 5):
        scene.frame_set(frame)
        now = arrays(thing)
        back = tresses.read(file, frame=frame - 1, up="y", front="z", mirror=False).strands
        matrix = np.array(thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world)
        world = now @ matrix[:3, :3].T + matrix[:3, 3]
        assert np.abs(back.positions - world @ np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])).max() < 1e-5


def test_gltf_holds_body_skin_and_hair(tresses, saved, tmp_path):
    scene = scenes.empty(last=24)
    body, armature = scenes.ball()
    things = [scenes.hair(body, 20), scenes.hair(body, 12)]
    material = bpy.data.materials.new("Hair")
    material.use_nodes = True
    shader = material.node_tree.nodes.new("ShaderNodeBsdfHairPrincipled")
    shader.parametrization = "MELANIN"
    shader.inputs["Melanin"].default_value, shader.inputs["Melanin Redness"].default_value = 0.8, 0.25
    things[0].data.materials.append(material)
    scene.frame_set(7)
    file = str(tmp_path / "both.glb")
    if not hasattr(bpy.ops.export_scene, "gltf") or "io_scene_gltf2" not in bpy.context.preferences.addons:
        bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
    bpy.ops.export_scene.gltf(filepath=file)
    back = tresses.read(file)
    assert len(back.strands) == 32 and back.head is not None
    assert np.bincount(back.strands.groups).tolist() == [20, 12]
    assert np.allclose(back.strands.widths, 8e-5) and back.strands.root_uvs.shape == (32, 2)
    # At rest: roots lie on the ball that the file has.
    roots = back.strands.positions[back.strands.offsets[:-1]]
    assert np.abs(np.linalg.norm(roots, axis=1) - scenes.RADIUS).max() < 1e-3
    import json
    import struct

    with open(file, "rb") as binary:
        binary.seek(12)
        size = struct.unpack("<I", binary.read(4))[0]
        binary.seek(20)
        said = json.loads(binary.read(size))
    assert "EXT_tresses_hair" in said["extensionsUsed"] and len(said["skins"]) == 1 and said["animations"]
    found = said["extensions"]["EXT_tresses_hair"]["grooms"][0]["material"]
    amount = -np.log(0.2)
    assert np.isclose(found["eumelanin"], 1.208 * amount * 0.75, rtol=1e-4)
    assert np.isclose(found["pheomelanin"], 1.831 * amount * 0.25, rtol=1e-4)
    # It moves: the animation of the file turns the body, and the hair with it.
    groom = tresses.Groom.read(file)
    assert len(groom) == 32 and groom.head is not None
