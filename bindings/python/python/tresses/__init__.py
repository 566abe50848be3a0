"""Real-time hair: grooms as NumPy arrays, simulation step by step, pictures and labels.

Metres, seconds, right-handed, Y up, the face towards +Z. The guide is docs/python.md of the project.

>>> import tresses
>>> groom = tresses.Groom.built_in("bob", {"style.strands": 5000})
>>> sim = tresses.Simulation(groom)
>>> sim.step(1 / 60, wind=[-8, 0, 0])
>>> sim.strands().grid().shape  # strands, vertices, 3
"""

from ._tresses import (
    Finding,
    Groom,
    Import,
    Mesh,
    Motion,
    Parameter,
    Settings,
    Simulation,
    Strands,
    TressesError,
    adapter,
    formats,
    parameters,
    read,
)
from ._npz import load_npz, save_npz

__all__ = [
    "Finding",
    "Groom",
    "Import",
    "Mesh",
    "Motion",
    "Parameter",
    "Settings",
    "Simulation",
    "Strands",
    "TressesError",
    "adapter",
    "formats",
    "load_npz",
    "parameters",
    "read",
    "save_npz",
]
