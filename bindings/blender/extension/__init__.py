# SPDX-License-Identifier: GPL-3.0-or-later
"""Tresses for Blender: hair that moves.

    panel, operators ─► run ─┬─ body, tripods, hair: what Blender deforms, as arrays
                             ├─ tresses.Simulation
                             └─ cache ─► nodes: a bake in the hair's own modifiers
    export, gltf: grooms in files
"""

import bpy

from . import gltf, live, operators, panel, properties

CLASSES = (*properties.CLASSES, *operators.CLASSES, *panel.CLASSES)

# Blender's glTF exporter looks for this name.
glTF2ExportUserExtension = gltf.Exporter


@bpy.app.handlers.persistent
def _file_opened(*_):
    live.stop()


def register():
    for one in CLASSES:
        bpy.utils.register_class(one)
    bpy.types.Object.tresses = bpy.props.PointerProperty(type=properties.TressesHair)
    bpy.app.handlers.load_pre.append(_file_opened)


def unregister():
    live.stop()
    bpy.app.handlers.load_pre.remove(_file_opened)
    del bpy.types.Object.tresses
    for one in reversed(CLASSES):
        bpy.utils.unregister_class(one)
