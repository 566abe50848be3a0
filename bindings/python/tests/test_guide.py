"""Runs the Python code of the guide, and of the README files, in a folder with the sample files."""

import pathlib
import re
import shutil
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).parents[3]
PAGES = ["docs/guide/start.md", "docs/guide/python.md", "docs/guide/datasets.md", "README.md", "bindings/python/README.md"]
# Kind, name of the file to write or "", and content of a fenced block.
BLOCK = re.compile(r"^```(\w+)(?: (\S+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FARM = "python -m tresses.farm "


@pytest.fixture(scope="session")
def samples(tmp_path_factory, command):
    """Return the folder that `tresses sample` writes."""
    folder = tmp_path_factory.mktemp("samples")
    command("sample", folder)
    return folder


@pytest.fixture()
def folder(samples, tmp_path, monkeypatch):
    """Return a copy of the samples, which is the working directory."""
    copy = tmp_path / "page"
    shutil.copytree(samples, copy)
    monkeypatch.chdir(copy)
    return copy


def commands(text):
    """Return the commands of the farm that need neither Ray nor files of the reader."""
    lines = [line.partition("#")[0].strip() for line in text.splitlines()]
    return [line for line in lines if line.startswith(FARM) and "--ray" not in line]


def run(page, folder):
    """Run the blocks of a page in order. Return the number of Python blocks and of commands that ran."""
    text = (ROOT / page).read_text(encoding="utf-8")
    namespace = {"__name__": "__main__"}
    written, blocks, ran = set(), 0, 0
    for block in BLOCK.finditer(text):
        kind, name, content = block.groups()
        if name:
            (folder / name).write_text(content, encoding="utf-8")
            written.add(name)
        elif kind == "python":
            # Errors then name the page and its line.
            before = "\n" * (text.count("\n", 0, block.start()) + 1)
            exec(compile(before + content, page, "exec"), namespace)
            blocks += 1
        elif kind in ("sh", "console"):
            for line in commands(content):
                words = line.split()[1:]
                if words[2] not in written:
                    continue
                ended = subprocess.run([sys.executable, *words], capture_output=True, text=True, timeout=300)
                assert ended.returncode == 0, f"{page}: {line}\n{ended.stderr}"
                ran += 1
    return blocks, ran


@pytest.mark.parametrize("page", PAGES)
def test_code_of_the_page_runs(page, folder):
    blocks, ran = run(page, folder)
    assert blocks >= 1, "the page has no Python code"
    if page == "docs/guide/python.md":
        assert blocks > 5 and (folder / "bob.png").exists()
    if page == "docs/guide/datasets.md":
        assert ran == 4 and (folder / "shots" / "manifest.json").exists()


def test_wrong_code_fails(folder, monkeypatch):
    monkeypatch.setattr(sys.modules[__name__], "ROOT", folder)
    (folder / "page.md").write_text("Text.\n\n```python\nx = 1\n```\n\n```python\nx + y\n```\n")
    with pytest.raises(NameError) as caught:
        run("page.md", folder)
    assert caught.traceback[-1].lineno == 7 and str(caught.traceback[-1].path).endswith("page.md")
