"""Strands in NumPy's .npz format."""

import os
import zipfile

import numpy

from ._tresses import Strands, TressesError

_OPTIONAL = ("widths", "colors", "root_uvs")


def save_npz(file, strands):
    """Write strands to a ``.npz`` file.

    The file holds ``positions`` [all, 3] and ``offsets`` [n + 1], and if present ``widths`` [all], ``colors`` [all, 3]
    and ``root_uvs`` [n, 2]. Lengths are in meters.

    Parameters
    ----------
    file : path
        File to create or replace.
    strands : Strands
        Strands to write.
    """
    arrays = {"positions": strands.positions, "offsets": strands.offsets}
    for name in _OPTIONAL:
        values = getattr(strands, name)
        if values is not None:
            arrays[name] = values
    # With an open file, NumPy does not append ".npz" to the name.
    with open(file, "wb") as target:
        numpy.savez_compressed(target, **arrays)


def load_npz(file):
    """Read strands from a ``.npz`` file in the format of `save_npz`.

    ``positions`` may also be [n, v, 3] without ``offsets``. The strands are neither oriented nor repaired.

    Parameters
    ----------
    file : path
        File to read.

    Returns
    -------
    Strands
    """
    name = os.fspath(file)
    try:
        with numpy.load(name, allow_pickle=False) as arrays:
            if "positions" not in getattr(arrays, "files", ()):
                raise TressesError(f"{name}: the array positions is missing")
            given = {key: arrays[key] for key in ("positions", "offsets", *_OPTIONAL) if key in arrays.files}
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise TressesError(f"{name}: {error}") from error
    except AttributeError as error:
        raise TressesError(f"{name}: not an .npz file") from error
    try:
        return Strands(**given)
    except TressesError as error:
        raise TressesError(f"{name}: {error}") from error
