# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
import todbench as tb


def test_progress_reaches_its_end(small_plan, tmp_path):
    seen, phases, trials = [], [], []

    outcome = tb.simulate(small_plan, tmp_path / "s", on_progress=lambda done, planned: seen.append((done, planned)),
                          on_phase=phases.append, on_trial=lambda curve, trial, patch: trials.append((trial, patch)))

    assert seen[-1][0] == seen[-1][1] > 0
    assert phases and outcome.ended_by is None
    assert len(trials) == len(tb.open_session(outcome.folder).trials)
    assert trials[0][1].dtype == np.float64 and trials[0][1].shape[0] == trials[0][1].shape[1]


def test_a_callback_that_returns_false_stops_the_run(small_plan, tmp_path):
    outcome = tb.simulate(small_plan, tmp_path / "s", on_progress=lambda done, planned: done < 3)

    assert outcome.ended_by
    session = tb.open_session(tmp_path / "s")
    assert not session.complete and 0 < len(session.trials)


def test_an_exception_of_a_callback_stops_the_run_and_comes_back(small_plan, tmp_path):
    def broken(done, planned):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        tb.simulate(small_plan, tmp_path / "s", on_progress=broken)


def test_an_unknown_callback_is_refused(small_plan, tmp_path):
    with pytest.raises(TypeError, match="on_done"):
        tb.simulate(small_plan, tmp_path / "s", on_done=print)


def test_a_folder_that_is_not_empty_is_refused(small_plan, small_outcome):
    with pytest.raises(tb.Error) as raised:
        tb.simulate(small_plan, small_outcome.folder)

    assert raised.value.code == "invalid_input"


def test_a_recording_is_iterated_to_its_end(tmp_path):
    counts = np.random.default_rng(5).integers(7000, 7100, (5, 120, 160), dtype=np.uint16)
    counts.astype("<u2").tofile(tmp_path / "five.raw")

    with tb.open_camera(f"file:{tmp_path / 'five.raw'}?width=160&height=120") as camera:
        frames = [frame.counts for frame in camera]

    assert (np.stack(frames) == counts).all()
