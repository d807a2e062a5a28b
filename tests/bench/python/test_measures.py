# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
import todbench as tb


def test_graded_answers_of_a_known_function_give_its_threshold():
    size = np.tile(np.geomspace(1, 4, 16), 24)
    presentation = np.repeat(np.arange(24), 16)

    fit = tb.fit_graded(size, tb.psychometric(size, 2.0, 3.0), presentation, np.tile(np.arange(16), 24))

    # The likelihood is at its maximum at the function itself.
    assert fit.threshold == pytest.approx(2.0, rel=1e-6)
    assert fit.slope == pytest.approx(3.0, rel=1e-5)
    assert tb.psychometric(fit.threshold, fit.threshold, fit.slope) == pytest.approx(0.75, abs=1e-12)


def test_temporal_noise_of_white_frames_is_their_standard_deviation():
    frames = np.random.default_rng(8).normal(300, 0.05, (65, 60, 80)).astype(np.float32)

    noise = tb.temporal_noise(frames)

    # 64 x 4800 differences, successive ones correlated: the standard error is 0.16 %.
    assert noise.successive == pytest.approx(0.05, rel=0.006)
    assert noise.lags[0] == 1 and len(noise.structure) == len(noise.lags)
    assert noise.usable.shape == (60, 80)


def test_a_correction_between_segments_is_not_noise():
    frames = np.random.default_rng(8).normal(0, 0.05, (40, 60, 80)).astype(np.float32)
    frames[20:] += 1

    apart = tb.temporal_noise(frames, segment=[0] * 20 + [1] * 20)

    assert apart.successive == pytest.approx(0.05, rel=0.01)


def test_risks_by_the_normal_distribution():
    # scipy.stats.norm: P(true value above 1) of 1.1 with u 0.05 is Phi(2).
    found = tb.conformity(1.1, 0.05, at_least=1.0, rule="simple")

    assert found.decision == "pass"
    assert found.p_conformity == pytest.approx(0.9772498680518208, abs=1e-12)
    assert tb.guard_band_for_risk(0.5, 1.1, 0.05) == 0


def test_frames_of_an_emulated_camera_show_its_scene():
    try:
        laboratory = tb.Laboratory(tb.Plan("demo"))
    except tb.Error as error:
        pytest.skip(str(error))

    with tb.open_camera(laboratory.camera_id) as camera:
        frames = [frame for frame, _ in zip(camera, range(3))]

    assert camera.info.transport == "GigE Vision"
    assert all(frame.counts.shape == (240, 320) and frame.status == "complete" for frame in frames)
    assert frames[0].sequence < frames[1].sequence < frames[2].sequence
    assert np.median(frames[0].to_kelvin()) == pytest.approx(laboratory.scene.background_k, abs=0.5)
    assert laboratory.scene.distance_m == tb.Plan("demo")["target.distance_m"]
