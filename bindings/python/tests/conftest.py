"""Shared fixtures: a small groom, and the command line to compare with."""

import os
import subprocess

import pytest

import tresses

# Full detail, so that renders match the arrays.
SETTINGS = {"style.strands": 400, "lod.mode": "off"}


@pytest.fixture(scope="session")
def groom():
    return tresses.Groom.built_in("bob", SETTINGS)


@pytest.fixture()
def sim(groom):
    return tresses.Simulation(groom)


@pytest.fixture(scope="session")
def command():
    """Return a function that runs the `tresses` program named by TRESSES_COMMAND."""
    program = os.environ["TRESSES_COMMAND"]

    def run(*words):
        subprocess.run([program, *map(str, words)], check=True, capture_output=True)

    return run
