# SPDX-License-Identifier: GPL-3.0-or-later
# A module: an observer that compares what it sees with the four triangles themselves, drawn by the part of each pixel that they cover (numpy).
# [[module]] command = "python3 observer.py", place = "observer"
import functools, sys, types, numpy as np

from_bench, to_bench = types.SimpleNamespace(read=sys.stdin.buffer.read), types.SimpleNamespace(write=sys.stdout.buffer.write)
FINE, STEP = 8, 0.125  # points per pixel and axis; how finely places are known, in pixels
SIDE = 2 / 3**0.25  # of an equilateral triangle of area 1; its height is SIDE sqrt(3) / 2, its centroid a third of that above the base


@functools.lru_cache(maxsize=4096)
def template(side, size, x, y, apex):
    at = (np.arange(side * FINE) + 0.5) / FINE - side / 2
    u, v = np.meshgrid(at - x * STEP, at - y * STEP)
    for _ in range(apex):  # up, right, down, left
        u, v = v, -u
    height = size * SIDE * 3**0.5 / 2
    inside = (v < height / 3) & (np.abs(u) < (v + height * 2 / 3) / 3**0.5)
    drawn = inside.reshape(side, FINE, side, FINE).mean(axis=(1, 3))
    drawn -= drawn.mean()
    return drawn / np.sqrt((drawn**2).sum())


header = np.lib.format.read_array(from_bench).tobytes()  # JSON: what the stage is to do
while True:
    size, samples_per_pitch, contrast_k, phase_x, phase_y, noise_k = np.lib.format.read_array(from_bench)
    patch = np.lib.format.read_array(from_bench)  # less its mean, in units of the contrast
    places = [(round(phase_x / STEP) + i, round(phase_y / STEP) + j) for i in (-4, 0, 4) for j in (-4, 0, 4)]  # half a pixel round the place
    scores = [max((template(len(patch), float(size), x, y, apex) * patch).sum() for x, y in places) for apex in range(4)]
    np.lib.format.write_array(to_bench, np.array(scores))
    sys.stdout.flush()
