"""Operators of the panel."""

import bpy
from bpy_extras.io_utils import ExportHelper

from . import cache, export, hair, live, nodes, run, strands
from .body import BodyError

ERRORS = (BodyError, run.TressesError, OSError)


def selected_hair(context):
    """Return the selected objects of hair, or the active one."""
    hair_objects = [hair_object for hair_object in context.selected_objects if hair_object.type == "CURVES"]
    active = context.active_object
    return hair_objects or ([active] if active and active.type == "CURVES" else [])


def prepared(context, hair_objects):
    """Return the objects to simulate, their meshes and the options, from the properties of the first."""
    first = hair_objects[0].tresses
    scene = context.scene
    begin, end = first.range(scene)
    # Strands made by modifiers are in the pose of the first frame.
    posed = any(hair_object.tresses.source is not None for hair_object in hair_objects)
    if any(hair_object.tresses.mode == "STRANDS" for hair_object in hair_objects):
        scene.frame_set(begin)
        hair_objects = [
            strands.evaluated(hair_object, context) if hair_object.tresses.mode == "STRANDS" else hair_object
            for hair_object in hair_objects
        ]
        posed = True
    meshes = list(dict.fromkeys(mesh for hair_object in hair_objects for mesh in hair_object.tresses.meshes()))
    return hair_objects, meshes, run.Options(begin, end, first.settle, posed, first.settings(scene))


class HairOperator:
    @classmethod
    def poll(cls, context):
        return bool(selected_hair(context)) and context.mode == "OBJECT"


class TRESSES_OT_simulate(HairOperator, bpy.types.Operator):
    """Simulate the selected hair over the frames of the scene, and bake the result. Esc stops and keeps the finished frames"""

    bl_idname = "tresses.simulate"
    bl_label = "Simulate"
    bl_options = {"REGISTER", "UNDO"}
    resume: bpy.props.BoolProperty(
        name="Go On", description="Go on from the last stored state", options={"HIDDEN", "SKIP_SAVE"}
    )

    def invoke(self, context, _event):
        context.window.cursor_modal_set("WAIT")
        started = self._begin(context)
        context.window.cursor_modal_restore()
        if not started:
            return {"CANCELLED"}
        self.timer = context.window_manager.event_timer_add(0.01, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        if not self._begin(context):
            return {"CANCELLED"}
        try:
            for _ in self.frames:
                pass
        except ERRORS as error:
            return self._fail(context, error)
        return self._finish(context)

    def modal(self, context, event):
        if event.type == "ESC":
            return self._finish(context)
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        try:
            fraction = next(self.frames)
        except StopIteration:
            return self._finish(context)
        except ERRORS as error:
            return self._fail(context, error)
        context.window_manager.progress_update(int(100 * fraction))
        context.workspace.status_text_set(f"Tresses: {100 * fraction:.0f} %, Esc stops")
        return {"RUNNING_MODAL"}

    def _begin(self, context):
        live.stop()
        self.timer, self.run = None, None
        try:
            self.hair_objects, meshes, options = prepared(context, selected_hair(context))
            for hair_object in self.hair_objects:
                run.clear(hair_object)
            self.run = run.Run(context, self.hair_objects, meshes, options)
        except ERRORS as error:
            self._fail(context, error)
            return False
        for note in self.run.notes:
            self.report({"WARNING"}, note)
        self.frames = self.run.frames(self.resume)
        return True

    def _end(self, context):
        if self.run:
            self.run.end()
        if self.timer:
            context.window_manager.event_timer_remove(self.timer)
            context.window_manager.progress_end()
            context.workspace.status_text_set(None)

    def _fail(self, context, error):
        self._end(context)
        self.report({"ERROR"}, _sentence(error))
        return {"CANCELLED"}

    def _finish(self, context):
        self.frames.close()
        self._end(context)
        try:
            for hair_object in self.hair_objects:
                run.bake(context, hair_object)
        except ERRORS as error:
            self.report({"ERROR"}, _sentence(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class TRESSES_OT_bake(HairOperator, bpy.types.Operator):
    """Bake the frames that an interrupted simulation has left on disk"""

    bl_idname = "tresses.bake"
    bl_label = "Bake What Is There"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        for hair_object in selected_hair(context):
            if not cache.Cache.exists(cache.folder(hair_object)):
                self.report({"ERROR"}, f"There are no simulated frames of {hair_object.name}")
                return {"CANCELLED"}
            try:
                run.bake(context, hair_object)
            except ERRORS as error:
                self.report({"ERROR"}, _sentence(error))
                return {"CANCELLED"}
        return {"FINISHED"}


class TRESSES_OT_live(HairOperator, bpy.types.Operator):
    """Simulate the selected hair while the timeline plays. A second click ends it"""

    bl_idname = "tresses.live"
    bl_label = "Live"

    def execute(self, context):
        if live.is_on():
            live.stop()
            return {"FINISHED"}
        try:
            hair_objects, meshes, options = prepared(context, selected_hair(context))
            options.first = context.scene.frame_current
            live.start(context, hair_objects, meshes, options, hair_objects[0].tresses.drawn)
        except ERRORS as error:
            self.report({"ERROR"}, _sentence(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class TRESSES_OT_clear(HairOperator, bpy.types.Operator):
    """Remove the motion from the selected hair. The groom is unchanged"""

    bl_idname = "tresses.clear"
    bl_label = "Clear"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        live.stop()
        for hair_object in selected_hair(context):
            source = hair_object.tresses.source
            run.clear(hair_object)
            if source is not None:
                source.hide_render = False
                source.hide_set(False)
                bpy.data.objects.remove(hair_object)
        return {"FINISHED"}


class TRESSES_OT_from_particles(bpy.types.Operator):
    """Make curves from the particle hair of the active mesh, to simulate them"""

    bl_idname = "tresses.from_particles"
    bl_label = "Curves from Particle Hair"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        active = context.active_object
        hairy = lambda system: system.settings.type == "HAIR"
        return context.mode == "OBJECT" and active and active.type == "MESH" and any(map(hairy, active.particle_systems))

    def execute(self, context):
        created = strands.of_particles(context.active_object, context)
        if not created:
            self.report({"ERROR"}, "The particle systems have no hair")
            return {"CANCELLED"}
        for hair_object in created:
            hair_object.select_set(True)
        return {"FINISHED"}


class TRESSES_OT_check(HairOperator, bpy.types.Operator):
    """List the problems of the selected hair, and select the first curve with one"""

    bl_idname = "tresses.check"
    bl_label = "Check"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        found = 0
        for hair_object in selected_hair(context):
            try:
                findings = run.findings(context, hair_object)
            except ERRORS as error:
                self.report({"ERROR"}, _sentence(error))
                return {"CANCELLED"}
            for finding in findings:
                found += 1
                self.report({"INFO" if finding.severity == "note" else "WARNING"}, f"{hair_object.name}: {finding.detail}")
            strands = [finding.first_strand for finding in findings if finding.first_strand is not None]
            if strands:
                hair.select_curve(hair_object.data, strands[0])
        if not found:
            self.report({"INFO"}, "Nothing is wrong")
        return {"FINISHED"}


class TRESSES_OT_export(HairOperator, bpy.types.Operator, ExportHelper):
    """Write the selected hair as an Alembic groom with guides, groups and root UVs, for Unreal"""

    bl_idname = "tresses.export"
    bl_label = "Export Groom"
    filename_ext = ".abc"
    filter_glob: bpy.props.StringProperty(default="*.abc;*.usda", options={"HIDDEN"})
    animated: bpy.props.BoolProperty(
        name="Animated", description="Write all frames of the scene, as a groom cache", default=False
    )
    unit: bpy.props.EnumProperty(
        name="Unit", items=[("cm", "Centimeters", "For Unreal"), ("m", "Meters", "")], description="Unit of the file"
    )

    def execute(self, context):
        try:
            write = export.cache if self.animated else export.groom
            for note in write(context, selected_hair(context), self.filepath, self.unit):
                self.report({"WARNING"}, note)
        except ERRORS as error:
            self.report({"ERROR"}, _sentence(error))
            return {"CANCELLED"}
        return {"FINISHED"}


def _sentence(error):
    text = str(error)
    return text[:1].upper() + text[1:]


CLASSES = (
    TRESSES_OT_simulate,
    TRESSES_OT_bake,
    TRESSES_OT_live,
    TRESSES_OT_clear,
    TRESSES_OT_from_particles,
    TRESSES_OT_check,
    TRESSES_OT_export,
)
