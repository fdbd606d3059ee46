"""The operator in the background of the interface. Stand-ins replace the parts of the interface that it uses."""

import inspect
import sys
import time
from types import SimpleNamespace

import bpy
import pytest
from objects import state, suzanne

ESC, TICK, MOVE = (SimpleNamespace(type=kind, value="PRESS") for kind in ("ESC", "TIMER", "MOUSEMOVE"))


class Interface:
    """A window manager and a workspace that record their calls."""

    def __init__(self):
        self.shares, self.texts, self.timers = [], [], 0

    def event_timer_add(self, tick, window):
        self.timers += 1
        return "timer"

    def event_timer_remove(self, timer):
        self.timers -= 1

    def progress_begin(self, low, high):
        self.shares.append(low)

    def progress_update(self, share):
        self.shares.append(share)

    def progress_end(self):
        self.shares.append("end")

    def modal_handler_add(self, operator):
        pass

    def status_text_set(self, text):
        self.texts.append(text)


@pytest.fixture
def begun():
    """The operator before it begins on Suzanne, with its context and interface."""
    module = next(m for name, m in sys.modules.items() if name.endswith("spectral_remesh.operator"))
    kind = module.OBJECT_OT_spectral_remesh
    operator = type("Operator", (), {n: f for n, f in vars(kind).items() if inspect.isfunction(f)})()
    operator.reports = []
    operator.report = lambda level, text: operator.reports.append((level, text))
    obj = suzanne()
    interface = Interface()
    context = SimpleNamespace(
        object=obj,
        scene=bpy.context.scene,
        view_layer=bpy.context.view_layer,
        window=None,
        screen=None,
        window_manager=interface,
        workspace=interface,
    )
    return SimpleNamespace(kind=kind, operator=operator, context=context, interface=interface, obj=obj)


def test_a_job_ends_with_the_result(begun):
    begun.context.scene.spectral_remesh.points = 3000
    before = state(begun.obj)
    assert begun.operator.begin(begun.context) == {"RUNNING_MODAL"}
    assert begun.kind.running is not None and not begun.kind.poll(bpy.context)
    # All events but the timer and Esc are passed on.
    assert begun.operator.modal(begun.context, MOVE) == {"PASS_THROUGH"}
    said, seen = {"RUNNING_MODAL"}, []
    while said == {"RUNNING_MODAL"}:
        time.sleep(0.02)
        said = begun.operator.modal(begun.context, TICK)
        seen += [begun.kind.running.stage] if begun.kind.running else []
    assert said == {"FINISHED"} and begun.kind.running is None
    assert "sample" in seen and any(text and "Esc" in text for text in begun.interface.texts)
    shares = begun.interface.shares
    assert shares[0] == 0 and shares[-1] == "end" and shares[1:-1] == sorted(shares[1:-1])
    assert begun.interface.texts[-1] is None and begun.interface.timers == 0
    made = bpy.data.objects["Suzanne.remeshed"]
    assert len(made.data.vertices) == 3000 and state(begun.obj) == before
    assert begun.operator.reports[-1][0] == {"INFO"} and "verified" in begun.operator.reports[-1][1]


def test_esc_ends_a_job_and_leaves_nothing(begun):
    begun.context.scene.spectral_remesh.points = 400_000
    before = state(begun.obj), len(bpy.data.objects), len(bpy.data.meshes)
    begun.operator.begin(begun.context)
    job = begun.kind.running
    time.sleep(0.5)
    assert begun.operator.modal(begun.context, TICK) == {"RUNNING_MODAL"}
    start = time.monotonic()
    assert begun.operator.modal(begun.context, ESC) == {"CANCELLED"}
    assert time.monotonic() - start < 1
    assert begun.kind.running is None and begun.interface.texts[-1] is None and begun.interface.timers == 0
    while not job.is_done:
        assert time.monotonic() - start < 60
        time.sleep(0.05)
    with pytest.raises(Exception, match="^$"):
        job.result()
    assert (state(begun.obj), len(bpy.data.objects), len(bpy.data.meshes)) == before
    # Another job may begin then.
    assert bpy.ops.object.spectral_remesh.poll()


def test_an_object_that_is_gone_is_no_crash(begun):
    begun.context.scene.spectral_remesh.points = 1000
    begun.operator.begin(begun.context)
    bpy.data.objects.remove(begun.obj)
    while begun.operator.modal(begun.context, TICK) == {"RUNNING_MODAL"}:
        time.sleep(0.02)
    assert begun.operator.reports[-1] == ({"ERROR"}, "Suzanne no longer exists; the result was discarded")
    assert not bpy.data.objects
