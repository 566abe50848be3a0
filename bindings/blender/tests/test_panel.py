"""The panels: they name only properties and operators that exist. Drawing itself needs a window."""

from types import SimpleNamespace

import bpy
import scenes
from test_simulation import select


class Layout:
    """A stand-in for Blender's layout that checks the names it gets."""

    def __init__(self, shown):
        self.shown = shown

    def prop(self, data, name, **_):
        assert name in data.bl_rna.properties, name
        self.shown.append(name)

    def prop_search(self, data, name, source, names, **_):
        assert name in data.bl_rna.properties and hasattr(source, names)
        self.shown.append(name)

    def operator(self, name, text="", **_):
        group, own = name.split(".")
        assert own in dir(getattr(bpy.ops, group)), name
        self.shown.extend([name, text])
        return SimpleNamespace()

    def label(self, text="", **_):
        self.shown.append(text)

    def row(self, **_):
        return self

    column = split = row


def drawn(package):
    """Return what all panels show."""
    shown = []
    for panel in package.panel.CLASSES:
        if not hasattr(panel, "poll") or panel.poll(bpy.context):
            panel.draw(type("Panel", (), {"layout": Layout(shown)})(), bpy.context)
    return shown


def test_panels_show_hair_and_every_parameter(package, saved):
    scenes.empty(last=2)
    body, _ = scenes.ball()
    select(body)
    assert "Select hair: an object of curves" in drawn(package)
    thing = scenes.hair(body, 5)
    select(thing)
    shown = drawn(package)
    assert {"mode", "settle", "stiffness", "tresses.simulate", "tresses.live", "tresses.export"} <= set(shown)
    rows = [row for group in package.parameters.rows().values() for row in group]
    assert {package.parameters.identifier(row.name) for row in rows} <= set(shown)
    thing.tresses.use_scene_range = False
    assert {"first", "last"} <= set(drawn(package))
