# SPDX-License-Identifier: GPL-3.0-or-later
import sys
import threading
import time

import numpy as np
import pytest
import todbench as tb


@pytest.fixture(scope="module")
def camera():
    model = tb.SensorModel(tb.load_sensor("sc2000"), accuracy="draft", seed=2)
    scene = tb.SceneHolder(tb.PlateScene(plate=tb.load_plate("tcat-a"), delta_t_k=4.0, distance_m=2.0))
    return model, scene, tb.simulated_camera(model, scene)


def test_a_frame_of_320_x_240_is_not_copied(camera):
    frame = next(iter(camera[2]))

    first, second = frame.counts, frame.counts

    assert first.shape == (240, 320) and first.dtype == np.uint16
    assert np.shares_memory(first, second)
    assert first.__array_interface__["data"][0] == second.__array_interface__["data"][0]
    assert not first.flags.writeable


def test_an_array_outlives_its_frame(camera):
    counts = next(iter(camera[2])).counts
    kept = counts.copy()

    for _ in range(20):
        next(iter(camera[2]))

    assert (counts == kept).all()


def test_frames_of_a_simulated_camera_are_those_of_its_model():
    model = tb.SensorModel(tb.load_sensor("sc2000"), accuracy="draft", seed=2)
    scene = tb.PlateScene(plate=tb.load_plate("tcat-a"), delta_t_k=4.0, distance_m=2.0)

    with tb.simulated_camera(model, tb.SceneHolder(scene)) as camera:
        frames = [frame for frame, _ in zip(camera, range(3))]

    for index, frame in enumerate(frames):
        assert (frame.counts == model.expose(scene, index)).all()
        assert frame.sequence == index
    np.testing.assert_allclose(frames[0].to_kelvin(), 250 + 0.01 * frames[0].counts.astype(float), rtol=1e-12)


def test_an_array_in_place_and_a_converted_one_give_the_same_numbers():
    frames = np.random.default_rng(3).normal(100, 2, (20, 30, 40))

    direct = tb.pixel_noise(frames)

    assert direct.sd_rms == tb.pixel_noise(list(np.asfortranarray(frames))).sd_rms
    assert direct.sd_rms == pytest.approx(np.sqrt(frames.var(axis=0, ddof=1).mean()), rel=1e-12)


def counted_by_another_thread(call):
    """Counts of another thread while `call` runs. Between bytecodes this thread never gives the lock away."""
    counted, done, interval = [0], threading.Event(), sys.getswitchinterval()

    def count():
        while not done.is_set():
            counted[0] += 1
            time.sleep(0)

    thread = threading.Thread(target=count)
    thread.start()
    sys.setswitchinterval(1000)
    try:
        before = counted[0]
        call()
        return counted[0] - before
    finally:
        sys.setswitchinterval(interval)
        done.set()
        thread.join()


def test_other_threads_run_during_a_long_call_and_only_then():
    spec, observer = tb.load_sensor("sc2000"), tb.Observer("hvs-1")

    assert counted_by_another_thread(lambda: tb.direct_estimate(spec, observer, [4.0, 1.0, 0.5])) > 0
    assert counted_by_another_thread(tb.plan_keys) == 0
