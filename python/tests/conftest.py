"""What the tests have in common."""

import importlib
import os
import pathlib
import sys

import numpy as np
import pytest

import heelstrike

ROOT = pathlib.Path(__file__).parents[2]
COMMAND = [sys.executable, "-c", "import sys; from heelstrike._command import main; sys.exit(main())"]


def peer(name):
    """Another robotics package. If it is missing the test is skipped, or fails if HEELSTRIKE_REQUIRE_PEERS is set."""
    if os.environ.get("HEELSTRIKE_REQUIRE_PEERS"):
        return importlib.import_module(name)
    return pytest.importorskip(name)


@pytest.fixture(scope="session")
def ramone():
    return heelstrike.Robot(ROOT / "urdf/ramone.urdf")


@pytest.fixture(scope="session")
def walk():
    """q and v of RAMone in many poses, in the order of its coordinates."""

    def rows(count):
        random = np.random.default_rng(7)
        q, v = random.uniform(-1.2, 1.2, (2, count, 7))
        v[:, 1] -= 1.5
        return q, v

    return rows
