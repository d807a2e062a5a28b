# SPDX-License-Identifier: GPL-3.0-or-later
"""Overhead of the Python package: benchmark.py prints microseconds. The overhead of a call is that of single decisions over decisions in a batch;
a batch of N has one call. Handing a frame over is compared with copying it."""
import statistics
import time

import numpy as np
import todbench as tb


def seconds(call, repeats=7):
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return min(times), statistics.median(times)


def main():
    prepared = tb.Observer("hvs-1").prepare(1.0)
    side, count = prepared.window_samples, 2000
    patches = np.random.default_rng(1).normal(0, 1, (count, side, side))
    stream = tb.RandomStream(1, "observer")
    together = seconds(lambda: prepared.choose(patches, 1.0, stream))[0] / count
    apart = seconds(lambda: [prepared.choose(patches[i:i + 1], 1.0, stream, first=i) for i in range(count)])[0] / count
    print(f"decision in a batch of {count}: {1e6 * together:.2f} us; one call each: {1e6 * apart:.2f} us")
    print(f"overhead of a call: {1e6 * (apart - together):.2f} us; a decision in the batch: {1e6 * (apart - together) / count:.4f} us")
    model = tb.SensorModel(tb.load_sensor("sc2000"), accuracy="draft")
    frame = next(iter(tb.simulated_camera(model, tb.SceneHolder(tb.PlateScene(plate=tb.load_plate("tcat-a"))))))
    shared = seconds(lambda: [frame.counts for _ in range(10000)])[0] / 10000
    copied = seconds(lambda: [frame.counts.copy() for _ in range(1000)])[0] / 1000
    print(f"frame of 320 x 240: {1e6 * shared:.2f} us as an array, {1e6 * copied:.2f} us with a copy")


if __name__ == "__main__":
    main()
