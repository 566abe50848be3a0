"""Installs the packed extension into a folder of its own, before anything else."""

import os
import sys
import tempfile

import pytest

# Blender's folders of this run: no extension or setting of the user takes part.
FOLDER = tempfile.mkdtemp(prefix="tresses-blender-")
os.environ["BLENDER_USER_RESOURCES"] = FOLDER
sys.path.insert(0, os.path.dirname(__file__))


@pytest.fixture(scope="session")
def package():
    """Return the installed package of the extension, named by TRESSES_EXTENSION."""
    import bpy

    bpy.ops.extensions.package_install_files(
        filepath=os.environ["TRESSES_EXTENSION"], repo="user_default", enable_on_install=True
    )
    return sys.modules["bl_ext.user_default.tresses"]


@pytest.fixture(scope="session")
def tresses(package):
    """Return the wheel in the extension."""
    import tresses

    return tresses


@pytest.fixture()
def saved(package, tmp_path):
    """Return a function that saves the file, so that caches lie beside it."""
    import bpy

    def save():
        file = str(tmp_path / "scene.blend")
        bpy.ops.wm.save_as_mainfile(filepath=file)
        return file

    return save


def pytest_sessionfinish():
    import shutil

    if "bpy" in sys.modules:
        import bpy

        # bpy crashes at its end with classes of an extension still registered.
        bpy.ops.preferences.addon_disable(module="bl_ext.user_default.tresses")
    shutil.rmtree(FOLDER, ignore_errors=True)
