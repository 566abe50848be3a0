"""Strands in NumPy's own files."""

import os
import zipfile

import numpy

from ._tresses import Strands, TressesError

_OPTIONAL = ("widths", "colors", "root_uvs")


def save_npz(file, strands):
    """Write strands as a ``.npz`` file: ``positions`` [all, 3] and ``offsets`` [n + 1], and where there are some
    ``widths`` [all], ``colors`` [all, 3] and ``root_uvs`` [n, 2]; metres.

    Parameters
    ----------
    file : path
    strands : Strands
    """
    arrays = {"positions": strands.positions, "offsets": strands.offsets}
    for name in _OPTIONAL:
        values = getattr(strands, name)
        if values is not None:
            arrays[name] = values
    # Through a file of our own, so that the name stays what it is.
    with open(file, "wb") as target:
        numpy.savez_compressed(target, **arrays)


def load_npz(file):
    """The strands of a ``.npz`` file as `save_npz` writes it. ``positions`` may also be [n, v, 3], without offsets. Nothing
    is oriented or repaired.

    Parameters
    ----------
    file : path

    Returns
    -------
    Strands
    """
    name = os.fspath(file)
    try:
        with numpy.load(name, allow_pickle=False) as arrays:
            if "positions" not in getattr(arrays, "files", ()):
                raise TressesError(f"{name}: there are no positions in it")
            given = {key: arrays[key] for key in ("positions", "offsets", *_OPTIONAL) if key in arrays.files}
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise TressesError(f"{name}: {error}") from error
    except AttributeError as error:
        raise TressesError(f"{name}: no .npz file") from error
    try:
        return Strands(**given)
    except TressesError as error:
        raise TressesError(f"{name}: {error}") from error
