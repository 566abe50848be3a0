"""Parameters by name."""

import numpy as np
import pytest

import tresses


def test_parameters_have_rows_and_values():
    rows = tresses.parameters()
    settings = tresses.Settings()
    assert [row.name for row in rows] + ["lights.list"] == list(settings) and len(settings) == len(rows) + 1 > 80
    for row in rows:
        assert row.hint and row.range and row.cost in ("frame", "regrow", "rebuild")
        assert settings[row.name] == row.default
        assert (row.default is None) <= row.automatic
        # The default and both ends of the range are allowed; values beyond are not.
        settings[row.name] = row.default
        if row.kind in ("number", "integer"):
            for end in (row.min, row.max):
                settings[row.name] = int(end) if row.kind == "integer" else end
                assert settings[row.name] == pytest.approx(end, rel=1e-6, abs=1e-12)
            with pytest.raises(tresses.TressesError, match="must be"):
                settings[row.name] = int(row.max + 1) if row.kind == "integer" else row.max * 2 + 1
        for name, _ in row.choices:
            settings[row.name] = name
            assert settings[row.name] == name
        del settings[row.name]
        assert settings[row.name] == row.default
    assert settings == tresses.Settings() and settings.changed() == {}


def test_values_convert_to_python_types():
    settings = tresses.Settings({"wind.speed": 4, "style.curl_radius": "0.9 cm", "shading.srgb": (1, 2, 254)})
    assert settings.changed() == {"wind.speed": 4.0, "style.curl_radius": 9.0, "shading.srgb": "#0102fe"}
    settings["wind.speed"] = np.float32(2.5)
    settings["renderer.samples"] = 4
    settings["style.strands"] = np.int64(1234)
    assert settings["wind.speed"] == 2.5 and settings["renderer.samples"] == "4" and settings["style.strands"] == 1234
    settings["style.strands"] = None
    assert settings["style.strands"] is None
    for name, value in [("wind.speed", -1), ("wind.speed", "fast"), ("wind.speed", [1]), ("renderer.samples", 3)]:
        with pytest.raises(tresses.TressesError, match=name):
            settings[name] = value
    with pytest.raises(KeyError, match="the nearest is wind.speed"):
        settings["wind.sped"]
    before = settings.copy()
    with pytest.raises(tresses.TressesError):
        settings.update({"wind.speed": 9, "lights.key": -1})
    assert settings == before, "all of it or nothing"


def test_presets_round_trip(tmp_path):
    settings = tresses.Settings({"wind.speed": 14, "simulation.drag": 5})
    file = tmp_path / "storm.toml"
    settings.save(file, name="storm")
    assert tresses.Settings.open(file) == settings
    groom = tresses.Groom.preset(file, {"style.strands": 100, "wind.speed": 2})
    assert groom.settings["simulation.drag"] == 5 and groom.settings["wind.speed"] == 2 and len(groom) == 100
    file.write_text("version = 1\n[wind]\nsped = 4\n")
    with pytest.raises(tresses.TressesError, match="line 3"):
        tresses.Settings.open(file)


LAMP = {"shape": "point", "name": "Lamp", "position": (0.3, 0.2, 0.4), "intensity": 0.5, "color": "#ffb070"}
WINDOW = {"shape": "rectangle", "position": [1, 0.5, 1], "target": [0, 0, 0], "width": "60 cm", "height": 0.4}


def test_lights_are_dicts(tmp_path):
    settings = tresses.Settings({"lights.list": [LAMP, WINDOW, "-10,20,3"]})
    lamp, window, distant = settings["lights.list"]
    assert lamp["position"] == pytest.approx([0.3, 0.2, 0.4]) and lamp["range"] is None and lamp["on"] is True
    assert (lamp["color"], lamp["name"], lamp["intensity"]) == ("#ffb070", "Lamp", 0.5)
    assert (window["width"], window["height"], window["roll"]) == (0.6, 0.4, 0)
    assert (distant["shape"], distant["azimuth"], distant["intensity"]) == ("distant", -10, 3)
    # Equal after a round trip through Python, and through a preset.
    assert tresses.Settings({"lights.list": [lamp, window, distant]}) == settings
    file = tmp_path / "lit.toml"
    settings.save(file)
    assert tresses.Settings.open(file) == settings
    assert "lights.list" in settings and "lights.list" in settings.changed()
    other = tresses.Settings({"wind.speed": 3})
    other.update(settings)
    assert len(other["lights.list"]) == 3 and other["wind.speed"] == 3
    settings["lights.list"] = [dict(lamp, position=np.array([0, 1, 2], np.float32), on=False)]
    assert settings["lights.list"][0]["position"] == [0, 1, 2] and settings["lights.list"][0]["on"] is False
    del settings["lights.list"]
    assert settings == tresses.Settings() and settings["lights.list"] == []


def test_invalid_lights_name_entry_and_key():
    settings = tresses.Settings({"lights.list": [LAMP]})
    for light, message in [
        ({**LAMP, "intensity": -1}, r"light 2 \(Lamp\) of lights.list: intensity is -1"),
        ({**LAMP, "radius": 1}, "a point light has no radius"),
        ({**LAMP, "positon": (0, 0, 1)}, "the nearest is position"),
        ({**LAMP, "shape": "ring"}, "must be one of distant"),
        ({**LAMP, "position": (0, 1)}, "three numbers"),
        ({"shape": "point"}, "a point light needs position"),
        ({"position": (0, 0, 1)}, "shape is missing"),
        (3, "a dict or a str"),
        ("spot", "a spot light needs position, target"),
    ]:
        with pytest.raises(tresses.TressesError, match=message):
            settings["lights.list"] = [LAMP, light]
    for lights in ("10,20", LAMP):
        with pytest.raises(tresses.TressesError, match="a list of dicts"):
            settings["lights.list"] = lights
    with pytest.raises(KeyError, match="use lights.list"):
        settings["lights.lamp1_strength"] = 2
    assert len(settings["lights.list"]) == 1, "nothing changed"
