# SPDX-License-Identifier: GPL-3.0-or-later
# A module: sharpens with the mean of the four neighbours (numpy). todbench module check "python3 sharpen.py"
import sys, types, numpy as np
from_bench, to_bench = types.SimpleNamespace(read=sys.stdin.buffer.read), types.SimpleNamespace(write=sys.stdout.buffer.write)
header = np.lib.format.read_array(from_bench).tobytes()  # JSON: what the stage is to do
while (p := np.pad(np.lib.format.read_array(from_bench), 1, mode="edge")) is not None:
    np.lib.format.write_array(to_bench, 2 * p[1:-1, 1:-1] - (p[:-2, 1:-1] + p[2:, 1:-1] + p[1:-1, :-2] + p[1:-1, 2:]) / 4); sys.stdout.flush()
