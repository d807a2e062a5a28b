# SPDX-License-Identifier: GPL-3.0-or-later
# A module: a sensor without optics (numpy). Every detector averages what falls on its sensitive area, then noise is added.
# In a sensor file: [[module]] command = "python3 sensor.py", place = "sensor". todbench module check "python3 sensor.py" --place sensor
import json, sys, types, numpy as np

from_bench, to_bench = types.SimpleNamespace(read=sys.stdin.buffer.read), types.SimpleNamespace(write=sys.stdout.buffer.write)
sensor = json.loads(np.lib.format.read_array(from_bench).tobytes())["sensor"]  # every number of the sensor file
width, height, n = sensor["width"], sensor["height"], sensor["scene_samples_per_pitch"]

def weights_of(side_um, pitch_um):
    side, at = n * side_um / pitch_um, np.arange(n)  # of the sensitive area, in samples of the scene
    return np.clip(np.minimum(at + 1, (n + side) / 2) - np.maximum(at, (n - side) / 2), 0, 1) / side

along_x = weights_of(sensor["detector_um"], sensor["pitch_um"])
along_y = weights_of(sensor["detector_y_um"] or sensor["detector_um"], sensor["pitch_y_um"] or sensor["pitch_um"])

while True:
    frame, time_s = np.lib.format.read_array(from_bench)
    scene = np.lib.format.read_array(from_bench)  # kelvin above the surround, n x n samples for each detector
    along = scene.reshape(height * n, width, n) @ along_x
    seen = np.tensordot(along_y, along.reshape(height, n, width), axes=(0, 1))
    noise = np.random.default_rng([sensor["seed"], int(frame)]).normal(0, sensor["netd_k"], seen.shape)
    np.lib.format.write_array(to_bench, seen + noise)
    sys.stdout.flush()
