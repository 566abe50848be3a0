"""Checks the built wheel, named by TRESSES_WHEEL."""

import os
import re
import zipfile


def test_wheel_is_abi3_and_portable():
    wheel = os.environ["TRESSES_WHEEL"]
    tags = re.fullmatch(r"tresses-.+-cp39-abi3-(.+)\.whl", os.path.basename(wheel))
    assert tags, wheel
    assert tags[1].startswith(("manylinux", "macosx", "win")), tags[1]
    with zipfile.ZipFile(wheel) as files:
        names = set(files.namelist())
    assert {"tresses/__init__.pyi", "tresses/py.typed", "tresses/__init__.py", "tresses/farm/__main__.py"} <= names


def test_stubs_match_the_package():
    import ast
    import inspect

    import tresses

    source = inspect.getsourcefile(tresses)
    tree = ast.parse(open(source + "i").read())
    stated = {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    for name in tresses.__all__:
        assert name in stated, name
        there = getattr(tresses, name)
        assert there.__doc__, name
        if isinstance(there, type) and not issubclass(there, Exception):
            members = {node.name for node in stated[name].body if isinstance(node, ast.FunctionDef)}
            public = {member for member in vars(there) if not member.startswith("_")}
            missing = public - members
            assert not missing, f"{name}: {missing}"
            assert all(hasattr(there, member) for member in members), name
            assert all(inspect.getdoc(getattr(there, member)) for member in public - {"keys"}), name
