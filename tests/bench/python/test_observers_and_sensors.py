# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
import todbench as tb

SIZE = 4.0


@pytest.fixture(scope="module")
def patches():
    """Triangles in every direction, drawn by area, in light noise."""
    prepared = tb.Observer("hvs-1").prepare(SIZE)
    side = prepared.window_samples
    truth = np.arange(64) % 4
    noise = np.random.default_rng(1).normal(0, 0.05, (64, side, side))
    for i, apex in enumerate(np.array(["up", "right", "down", "left"])[truth]):
        noise[i] += tb.pixel_coverage(tb.triangle(SIZE, apex, (side / 2, side / 2)), side, side)
    return prepared, noise, truth


def test_a_clear_triangle_is_recognised(patches):
    prepared, pictures, truth = patches

    alternative, scores = prepared.choose(pictures, 1.0, tb.RandomStream(1, "observer"))

    assert (alternative == truth).all()
    assert (scores.argmax(axis=1) == truth).all()


def test_a_batch_equals_single_decisions(patches):
    prepared, pictures, _ = patches
    stream = tb.RandomStream(1, "observer")

    together = prepared.choose(pictures, 1.0, stream)
    apart = [prepared.choose(pictures[i:i + 1], 1.0, stream, first=i) for i in range(len(pictures))]

    assert (together[1] == np.concatenate([scores for _, scores in apart])).all()


def test_probabilities_sum_to_one_and_agree_with_the_answers(patches):
    prepared, pictures, truth = patches

    alternative, _, probability = prepared.judge(pictures, 1.0, tb.RandomStream(1, "observer"))

    np.testing.assert_allclose(probability.sum(axis=1), 1, rtol=1e-9)
    assert (alternative == truth).all()
    assert probability[np.arange(len(truth)), truth].mean() > 0.9


def test_a_wrong_window_is_an_error(patches):
    with pytest.raises(tb.Error, match="the observer's window"):
        patches[0].choose(np.zeros((1, 3, 3)), 1.0, tb.RandomStream(1, "x"))


def test_frames_repeat_and_noise_has_the_stated_size():
    spec = tb.load_sensor("sc2000")
    spec.fixed_pattern_k = 0
    model = tb.SensorModel(spec, seed=5)
    scene = tb.PlateScene(plate=tb.load_plate("tcat-a"), delta_t_k=0.0, distance_m=2.0)

    pictures = np.stack([model.picture(scene, k) for k in range(16)]).astype(float)

    assert (model.expose(scene, 3) == tb.SensorModel(spec, seed=5).expose(scene, 3)).all()
    # 16 x 76800 values: the standard error of the standard deviation is 0.07 %.
    assert pictures.std(axis=0, ddof=1).mean() / 0.9836 == pytest.approx(spec.netd_k, rel=0.02)


def test_an_unknown_member_is_refused():
    with pytest.raises(AttributeError):
        tb.SensorSpec(netd=0.05)
    with pytest.raises(tb.Error, match="detector"):
        tb.SensorModel(tb.SensorSpec(name="odd", pitch_um=10.0, detector_um=12.0))


def test_planned_effects_have_reasons():
    planned = tb.plan_effects(tb.load_sensor("sc2000"), tb.Observer("hvs-1"), [4.0])

    assert [one.effect for one in planned.plan.decisions][:2] == ["turbulence", "image_dance"]
    assert all(one.reason for one in planned.plan.decisions)
    assert planned.plan.simulates("detector")


def test_a_plate_is_found_where_the_scene_has_it():
    spec = tb.load_sensor("sc2000")
    plate = tb.load_plate("tcat-a")
    scene = tb.PlateScene(plate=plate, delta_t_k=20.0, distance_m=1.0)
    picture = tb.SensorModel(spec, accuracy="draft").picture(scene, 0)

    found = tb.register_plate(picture, plate, tb.RegistrationOptions(expected_scale_px_per_mm=1 / spec.ifov_mrad))

    expected = tb.scene_pixel(scene, (0.0, 0.0), spec.ifov_mrad, spec.width, spec.height)
    np.testing.assert_allclose(found.pixel((0.0, 0.0)), expected, atol=0.05)
    # The wings of diffraction beyond two pixels have 2 wavelength f-number / (pi^2 r) = 2 % of the light at f/1.
    assert tb.effective_contrast(picture, plate, found, 8.0).value == pytest.approx(20, rel=0.02)
