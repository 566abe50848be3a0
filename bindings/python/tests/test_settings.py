"""Parameters by name."""

import numpy as np
import pytest

import tresses


def test_parameters_have_rows_and_values():
    rows = tresses.parameters()
    settings = tresses.Settings()
    assert len(rows) == len(settings) > 80 and [row.name for row in rows] == list(settings)
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
