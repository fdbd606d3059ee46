"""The operator. It runs in the background if there is an interface, otherwise synchronously."""

import bpy

import spectral_remesh

from . import source, target
from .job import Cancelled, Job
from .settings import options

# Seconds between two checks of the job.
TICK = 0.1


class OBJECT_OT_spectral_remesh(bpy.types.Operator):
    """Make a copy of the active object with exactly the requested number of vertices, evenly spread, in triangles close
    to equilateral"""

    bl_idname = "object.spectral_remesh"
    bl_label = "Spectral Remesh"
    bl_options = {"REGISTER", "UNDO"}

    #: The job that runs in the background, if there is one.
    running = None

    @classmethod
    def poll(cls, context):
        obj = context.object
        if obj is None or obj.type != "MESH" or obj.mode != "OBJECT":
            cls.poll_message_set("Select a mesh, in object mode")
            return False
        if OBJECT_OT_spectral_remesh.running:
            cls.poll_message_set("Another object is being remeshed")
            return False
        return True

    def invoke(self, context, event):
        return self.execute(context) if bpy.app.background else self.begin(context)

    def begin(self, context):
        """Starts the job in the background. `modal` continues it."""
        job = self._start(context)
        if job is None:
            return {"CANCELLED"}
        OBJECT_OT_spectral_remesh.running = job
        manager = context.window_manager
        self._timer = manager.event_timer_add(TICK, window=context.window)
        manager.progress_begin(0, 100)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        job = OBJECT_OT_spectral_remesh.running
        if event.type == "ESC" and event.value == "PRESS":
            self.cancel(context)
            self.report({"INFO"}, "Remeshing was cancelled; nothing was changed")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if job.is_done:
            self._leave(context)
            return self._finish(context, job)
        context.window_manager.progress_update(100 * job.share)
        context.workspace.status_text_set(f"Remeshing: {job.stage}, {job.share:.0%}    Esc: Cancel")
        self._redraw(context)
        return {"RUNNING_MODAL"}

    def cancel(self, context):
        """Cancels the job. Blender calls this, too, when it exits or opens another file."""
        OBJECT_OT_spectral_remesh.running.cancel()
        self._leave(context)

    def execute(self, context):
        job = self._start(context)
        return {"CANCELLED"} if job is None else self._finish(context, job)

    def _start(self, context):
        """Starts the job for the active object. If that is impossible, reports why and returns `None`."""
        obj = context.object
        try:
            self._source = source.read(obj)
            chosen = options(context.scene.spectral_remesh, self._source)
        except ValueError as error:
            self.report({"ERROR"}, str(error))
            return None
        # The object is remembered by name, since undo replaces all objects.
        self._name = obj.name
        mesh = self._source.as_mesh()
        return Job(lambda progress: spectral_remesh.remesh(mesh, progress=progress, **chosen))

    def _finish(self, context, job):
        """Adds the result next to the original."""
        try:
            remeshed = job.result()
        except Cancelled:
            return {"CANCELLED"}
        except spectral_remesh.SpectralRemeshError as error:
            self.report({"ERROR"}, f"{self._name}: {error}")
            return {"CANCELLED"}
        obj = bpy.data.objects.get(self._name)
        if obj is None or obj.type != "MESH":
            self.report({"ERROR"}, f"{self._name} no longer exists; the result was discarded")
            return {"CANCELLED"}
        made = target.add(obj, self._source, remeshed)
        self._show(context, obj, made)
        self._tell(made, remeshed)
        return {"FINISHED"}

    def _show(self, context, obj, made):
        view_layer = context.view_layer
        if obj.name in view_layer.objects:
            obj.select_set(False)
            if context.scene.spectral_remesh.hide_original:
                obj.hide_set(True)
        if made.name in view_layer.objects:
            made.hide_set(False)
            made.select_set(True)
            view_layer.objects.active = made

    def _tell(self, made, remeshed):
        left_out = [f"without {what}" for what in self._source.left_out]
        for note in left_out + remeshed.notes:
            self.report({"INFO"}, note)
        shape = remeshed.report["output"]["shape"]
        text = f"{made.name}: {len(remeshed.vertices):,} vertices, smallest angle {shape['theta_min']:.0f}°"
        if remeshed.verified:
            self.report({"INFO"}, f"{text}, verified")
        else:
            why = ", ".join(remeshed.shortcomings)
            self.report({"WARNING"}, f"{text}, not verified: {why}; try another seed or more vertices")

    def _leave(self, context):
        """Restores the interface."""
        OBJECT_OT_spectral_remesh.running = None
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)
        self._redraw(context)

    def _redraw(self, context):
        for area in context.screen.areas if context.screen else ():
            if area.type == "VIEW_3D":
                area.tag_redraw()
