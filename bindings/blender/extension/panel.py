"""The panel in the sidebar of the 3D view."""

import bpy
import tresses

from . import cache, live, nodes, parameters
from .operators import selected_hair


class TressesPanel:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Tresses"


class TRESSES_PT_hair(TressesPanel, bpy.types.Panel):
    bl_label = "Tresses"

    def draw(self, context):
        layout = self.layout
        hair_objects = selected_hair(context)
        if not hair_objects:
            layout.label(text="Select hair: an object of curves")
            layout.operator("tresses.from_particles")
            return
        hair_object = hair_objects[0]
        own = hair_object.tresses
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(own, "mode", expand=True)
        layout.prop(own, "body")
        if own.body is None and hair_object.data.surface is not None:
            row = layout.split(factor=0.4)
            row.label(text="")
            row.label(text=hair_object.data.surface.name, icon="MESH_DATA")
        layout.prop(own, "colliders")
        layout.prop_search(own, "stiffness", hair_object.data, "attributes")
        layout.prop(own, "settle")
        layout.prop(own, "use_scene_range")
        if not own.use_scene_range:
            row = layout.column(align=True)
            row.prop(own, "first")
            row.prop(own, "last")
        layout.prop(own, "use_scene_gravity")
        column = layout.column(align=True)
        column.operator("tresses.simulate", icon="PLAY")
        frame = cache.next_frame(hair_object)
        if frame is not None:
            column.operator("tresses.simulate", text=f"Go On from Frame {frame}", icon="FRAME_NEXT").resume = True
        column.operator("tresses.live", text="End Live" if live.is_on() else "Live", depress=live.is_on())
        layout.prop(own, "drawn")
        row = layout.row(align=True)
        row.operator("tresses.check")
        row.operator("tresses.clear")
        layout.operator("tresses.export", icon="EXPORT")
        if nodes.modifier(hair_object) is None and cache.Cache.exists(cache.folder(hair_object)):
            layout.operator("tresses.bake")
        layout.label(text=f"{len(hair_object.data.curves):,} curves, {len(hair_object.data.points):,} points")


class TRESSES_PT_parameters(TressesPanel, bpy.types.Panel):
    bl_label = "Parameters"
    bl_parent_id = "TRESSES_PT_hair"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return bool(selected_hair(context))

    def draw(self, context):
        self.layout.label(text=f"Tresses {tresses.__version__}")
        self.layout.label(text="Right-click resets a value")


def _group_panel(group, title, advanced):
    shown = [row for row in parameters.rows()[group] if row.advanced == advanced]
    parent = f"TRESSES_PT_{group}" if advanced else "TRESSES_PT_parameters"

    class Panel(TressesPanel, bpy.types.Panel):
        bl_label = "Advanced" if advanced else title
        bl_idname = f"TRESSES_PT_{group}_advanced" if advanced else f"TRESSES_PT_{group}"
        bl_parent_id = parent
        bl_options = {"DEFAULT_CLOSED"}

        def draw(self, context):
            hair_objects = selected_hair(context)
            self.layout.use_property_split = True
            self.layout.use_property_decorate = False
            for row in shown if hair_objects else ():
                self.layout.prop(hair_objects[0].tresses.values, parameters.identifier(row.name))

    return Panel if shown else None


def _panels():
    groups = [(group, title, advanced) for group, title in parameters.GROUPS.items() for advanced in (False, True)]
    return [panel for panel in (_group_panel(*group) for group in groups) if panel]


CLASSES = (TRESSES_PT_hair, TRESSES_PT_parameters, *_panels())
