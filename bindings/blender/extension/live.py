"""Simulation while the timeline plays."""

import bpy

from . import hair, nodes, picture, run

_current = None


def is_on():
    return _current is not None


def start(context, hair_objects, meshes, options, drawn=False):
    """Simulate at each new frame from now on, and show the result without a bake. If `drawn`, Tresses draws it."""
    global _current
    stop()
    for hair_object in hair_objects:
        _forget_bake(context, hair_object)
    live = run.Run(context, hair_objects, meshes, options)
    for hair_object in hair_objects:
        nodes.add_modifier(hair_object)
    live.reset()
    live.frame = context.scene.frame_current
    _show(live)
    _current = live
    if drawn:
        picture.start(live)
    bpy.app.handlers.frame_change_post.append(_advance)


def stop():
    """End the live simulation. The hair keeps its groom."""
    global _current
    live, _current = _current, None
    if _advance in bpy.app.handlers.frame_change_post:
        bpy.app.handlers.frame_change_post.remove(_advance)
    if live is None:
        picture.stop()
        return
    picture.stop(live)
    for one in live.hair:
        run.remove_attribute(one.object.data)
    live.end()


def _forget_bake(context, hair_object):
    m = nodes.modifier(hair_object)
    if m is not None and m.bakes:
        bpy.ops.object.geometry_node_bake_delete_single(
            session_uid=hair_object.session_uid, modifier_name=m.name, bake_id=m.bakes[0].bake_id
        )


def _advance(scene, depsgraph):
    live = _current
    if live is None or scene.frame_current == live.frame:
        return
    try:
        # A jump begins anew; it is no motion.
        if scene.frame_current == live.frame + 1:
            live.step()
        else:
            live.reset()
        live.frame = scene.frame_current
        _show(live)
    except (ReferenceError, run.BodyError, run.TressesError) as error:
        print(f"Tresses: {error}")
        stop()


def _show(live):
    for one, points in live.positions():
        hair.write_vectors(one.object.data, nodes.ATTRIBUTE, points)
        one.object.data.update_tag()
