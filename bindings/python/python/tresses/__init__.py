"""Real-time hair: grooms as NumPy arrays, step-by-step simulation, images and labels.

Coordinates are meters, right-handed, Y up, face toward +Z; times are seconds. The guide is docs/guide/python.md in the
repository.

>>> import tresses
>>> groom = tresses.Groom.built_in("bob", {"style.strands": 5000})
>>> sim = tresses.Simulation(groom)
>>> sim.step(1 / 60, wind=[-8, 0, 0])
>>> sim.strands().grid().shape  # strands, vertices, 3
"""

from ._tresses import (
    Cache,
    CardLevel,
    Cards,
    Finding,
    Groom,
    Import,
    Mesh,
    MissingFileError,
    Motion,
    Parameter,
    Rig,
    Settings,
    Simulation,
    Strands,
    TressesError,
    __version__,
    adapter,
    formats,
    parameters,
    read,
    retarget,
)
from ._labels import calibration, camera_of, gaussians, labels, orthographic
from ._npz import load_npz, save_npz

__all__ = [
    "Cache",
    "CardLevel",
    "Cards",
    "Finding",
    "Groom",
    "Import",
    "Mesh",
    "MissingFileError",
    "Motion",
    "Parameter",
    "Rig",
    "Settings",
    "Simulation",
    "Strands",
    "TressesError",
    "adapter",
    "calibration",
    "camera_of",
    "formats",
    "gaussians",
    "labels",
    "load_npz",
    "orthographic",
    "parameters",
    "read",
    "retarget",
    "save_npz",
]
