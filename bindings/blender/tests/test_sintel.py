"""A real groom on its way through Blender: USD in, simulation, Alembic for Unreal out."""

import os

import bpy
import numpy as np
import pytest
import scenes
from test_simulation import arrays, select

FOLDER = os.path.join(os.environ.get("TRESSES_ASSETS", ""), "sintel")


@pytest.mark.skipif(not os.path.isdir(FOLDER), reason="the assets are not there")
def test_sintels_groom_keeps_guides_groups_uvs_and_widths(tresses, saved, tmp_path):
    found = tresses.read(
        os.path.join(FOLDER, "SintelHairOriginal-sintel_hair.16points.tfx"), os.path.join(FOLDER, "sintel.obj")
    )
    # Every fourth strand, to be quick; a sixteenth of them are guides, in three groups.
    lines = found.strands.grid()[::4]
    count = len(lines)
    roots = lines[:, 0]
    guides = np.arange(count) % 16 == 0
    away = ((roots[:, None] - roots[guides][None]) ** 2).sum(-1)
    near = np.argsort(away, 1)[:, :3]
    ids = 5000 + np.arange(count)
    weights = 1 / (np.sqrt(np.take_along_axis(away, near, 1)) + 1e-3)
    weights /= weights.sum(1, keepdims=True)
    groups = np.digitize(roots[:, 0], [-0.03, 0.03])
    given = tresses.Strands(
        lines, widths=9e-5, root_uvs=roots[:, ::2] * 3 + 0.5,
        guides=guides, ids=ids, groups=groups, closest=ids[guides][near], weights=weights,
        colors=np.clip(lines.reshape(-1, 3), 0, 1), attributes={"age": ids % 7, "height": lines[..., 1].ravel()},
    )  # fmt: skip
    file, head = str(tmp_path / "hair.usdc"), str(tmp_path / "head.obj")
    given.write(file)
    found.head.write(head)
    scene = scenes.empty(last=4)
    bpy.ops.wm.usd_import(filepath=file)
    bpy.ops.wm.obj_import(filepath=head)
    thing = next(o for o in scene.objects if o.type == "CURVES")
    body = next(o for o in scene.objects if o.type == "MESH")
    scene.frame_start, scene.frame_end = 1, 4
    for frame, angle in ((1, 0.0), (4, 0.3)):
        for moved in (thing, body):
            moved.rotation_mode = "XYZ"
        body.rotation_euler.z = angle
        body.keyframe_insert("rotation_euler", frame=frame)
    scene.frame_set(1)
    saved()
    select(thing)
    thing.tresses.body = body
    assert bpy.ops.tresses.simulate() == {"FINISHED"}
    scene.frame_set(1)
    first = arrays(thing)
    scene.frame_set(4)
    assert np.abs(arrays(thing) - first).max() > 0.01
    out = str(tmp_path / "groom.abc")
    assert bpy.ops.tresses.export(filepath=out) == {"FINISHED"}
    back = tresses.read(out, head=head).strands
    assert np.array_equal(back.guides, guides) and np.array_equal(back.groups, groups)
    assert np.array_equal(np.sort(back.ids), back.ids) and len(set(back.ids.tolist())) == count
    assert np.allclose(back.root_uvs, given.root_uvs, atol=1e-6) and np.allclose(back.widths, 9e-5, rtol=1e-3)
    assert np.array_equal(back.closest, given.closest) and np.allclose(back.weights, weights, atol=1e-6)
    assert np.array_equal(back.attributes["age"], ids % 7)
    assert np.allclose(back.attributes["height"], given.attributes["height"], atol=1e-6)
    assert np.allclose(back.colors, given.colors, atol=1e-5)
    assert np.abs(back.positions - given.positions).max() < 1e-4
