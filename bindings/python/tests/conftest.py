"""What tests share: a small groom, and the command to compare with."""

import os
import subprocess

import pytest

import tresses

# Full detail, as arrays have it.
SETTINGS = {"style.strands": 400, "lod.mode": "off"}


@pytest.fixture(scope="session")
def groom():
    return tresses.Groom.built_in("bob", SETTINGS)


@pytest.fixture()
def sim(groom):
    return tresses.Simulation(groom)


@pytest.fixture(scope="session")
def command():
    """Runs the command `tresses`, whose program TRESSES_COMMAND names."""
    program = os.environ["TRESSES_COMMAND"]

    def run(*words):
        subprocess.run([program, *map(str, words)], check=True, capture_output=True)

    return run
