# SPDX-License-Identifier: GPL-3.0-or-later
"""Pack the extension and the wheel of Tresses into a .zip that Blender installs.

    python pack.py WHEEL FOLDER

Blender's own script builds and checks the .zip. It is part of `bpy`, the module of Blender on PyPI.
"""

import os
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
# Platforms of Blender by a part of the wheel's name.
PLATFORMS = {
    "manylinux": {"x86_64": "linux-x64", "aarch64": "linux-arm64"},
    "macosx": {"arm64": "macos-arm64", "x86_64": "macos-x64"},
    "win": {"amd64": "windows-x64", "arm64": "windows-arm64"},
}


def platform(wheel):
    """Return Blender's name of the platform of a wheel."""
    name = os.path.basename(wheel)
    for system, machines in PLATFORMS.items():
        for machine, platform in machines.items():
            if f"-{system}" in name and name.endswith(f"{machine}.whl"):
                return platform
    raise SystemExit(f"{name}: there is no Blender for this platform")


def builder():
    """Return the path of Blender's script for extensions."""
    import bpy

    file = os.path.join(bpy.utils.system_resource("SCRIPTS"), "addons_core", "bl_pkg", "cli", "blender_ext.py")
    if not os.path.exists(file):
        raise SystemExit(f"{file}: there is no such script")
    return file


def pack(wheel, folder):
    """Write the .zip into `folder` and return its path."""
    os.makedirs(folder, exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        source = os.path.join(temporary, "tresses")
        shutil.copytree(os.path.join(HERE, "extension"), source, ignore=shutil.ignore_patterns("__pycache__"))
        os.makedirs(os.path.join(source, "wheels"))
        shutil.copy(wheel, os.path.join(source, "wheels"))
        file = os.path.join(source, "blender_manifest.toml")
        with open(file, encoding="utf8") as manifest:
            text = manifest.read()
        text = text.replace("wheels = []", f'wheels = ["./wheels/{os.path.basename(wheel)}"]')
        text = text.replace('platforms = ["linux-x64"]', f'platforms = ["{platform(wheel)}"]')
        with open(file, "w", encoding="utf8") as manifest:
            manifest.write(text)
        script = builder()
        out = os.path.join(os.path.abspath(folder), "tresses-blender.zip")
        for words in (["build", "--source-dir", source, "--output-filepath", out], ["validate", out]):
            subprocess.run([sys.executable, script, *words], check=True)
    return out


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    print(pack(*sys.argv[1:]))
