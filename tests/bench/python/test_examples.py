# SPDX-License-Identifier: GPL-3.0-or-later
"""The examples of the guide run, and the demonstration's numbers are those of the command line."""
import importlib.util
import json
import re

import pytest
import todbench as tb


def example(source, name):
    spec = importlib.util.spec_from_file_location(name, source / f"docs/examples/{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def demonstration(source, tmp_path_factory):
    """The demonstration with recorded frames; half of the presentations."""
    module = example(source, "demonstration")
    shipped = tb.demonstration_plan
    module.tb.demonstration_plan = lambda: shipped().replaced({"measurement.record_frames": True, "target.phases": 3})
    try:
        run = module.main(str(tmp_path_factory.mktemp("demo") / "session"))
    except tb.Error as error:
        if error.code == "not_found" and "camera libraries" in str(error):
            pytest.skip(str(error))
        raise
    finally:
        module.tb.demonstration_plan = shipped
    return run


def test_the_demonstration_has_at_most_30_lines(source):
    assert len((source / "docs/examples/demonstration.py").read_text().splitlines()) <= 30


def test_the_table_of_the_demonstration_is_that_of_the_command_line(program, demonstration, tmp_path):
    """The command line measures the same frames again, with its own twin and comparison."""
    _, told = program("replay", demonstration.folder, "--out", tmp_path / "replay")

    assert told["same_trials"] and told["same_fits"]
    mine = demonstration.to_dict()
    for key in ("points", "curve", "verdict"):
        if key in told:
            assert told[key] == mine[key]
    for file in ("comparison.json", "fits.json"):
        assert (tmp_path / "replay" / file).read_bytes() == (demonstration.folder / file).read_bytes()
    assert json.loads((tmp_path / "replay" / "comparison.json").read_text())["points"]


def test_a_replay_from_python_gives_the_same_trials_and_fits(demonstration, tmp_path):
    run, same_trials, same_fits = tb.replay(demonstration.folder, tmp_path / "again")

    assert same_trials and same_fits
    assert run.comparison.to_dict() == demonstration.comparison.to_dict()


def test_the_plot_is_drawn(source, demonstration, tmp_path):
    pytest.importorskip("matplotlib")

    example(source, "plot_curves").main(demonstration.folder, tmp_path / "curves.png")

    assert (tmp_path / "curves.png").stat().st_size > 20000


def test_python_blocks_of_the_guide_name_only_what_exists(source):
    guide = (source / "docs/guide/python.md").read_text()
    names = set(re.findall(r"\btb\.(\w+)", guide))

    assert names and names <= set(tb.__all__)


def test_the_plan_and_frames_of_the_guide_work(tmp_path):
    plan = tb.Plan("demo").replaced({"seed": 2, "target.phases": 2, "target.kind": "scene"})
    with pytest.raises(tb.Error) as raised:
        tb.Plan("demo").replaced({"target.distance_m": -2})

    assert plan["target.kind"] == "scene"
    assert (raised.value.code, raised.value.key) == ("invalid_input", "target.distance_m")
