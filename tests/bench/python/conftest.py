# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the Python package share: the program, a small plan, its session."""
import json
import os
import subprocess
from pathlib import Path

import pytest
import todbench as tb

SMALL = """
name = "small"
seed = 3
[target]
kind = "scene"
distance_m = 2
plates = ["tcat-a", "tcat-b"]
mountings = ["identity", "rotated_180"]
delta_t_k = [4, 0.5]
phases = 2
[observer]
name = "hvs-1"
[simulation]
sensor = "sc2000"
accuracy = "draft"
tolerance_percent = 5
phases = 2
"""


@pytest.fixture(scope="session")
def source():
    return Path(os.environ["TODBENCH_SOURCE"])


@pytest.fixture(scope="session")
def program():
    """Runs the command line: (exit code, parsed JSON)."""

    def run(*arguments):
        done = subprocess.run([os.environ["TODBENCH_PROGRAM"], *map(str, arguments), "--json"], capture_output=True,
                              text=True, check=False)
        assert done.stdout, done.stderr
        return done.returncode, json.loads(done.stdout)

    return run


@pytest.fixture(scope="session")
def small_plan():
    return tb.Plan.from_text(SMALL)


@pytest.fixture(scope="session")
def small_outcome(small_plan, tmp_path_factory):
    return tb.simulate(small_plan, tmp_path_factory.mktemp("small") / "python")
