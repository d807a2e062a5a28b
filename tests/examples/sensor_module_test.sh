#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The shipped example of a sensor as a program keeps the contract and has the acuity of the built-in sensor of the same numbers, without its diffraction.
# Usage: sensor_module_test.sh TODBENCH EXAMPLES. Exit 0: passed, 77: there is no interpreter (said why on stdout), 1: failed.
set -eu
todbench=$1 examples=$2 python=/usr/bin/python3
"$python" -c "import numpy" 2>/dev/null || { echo "SKIPPED: numpy is not installed (apt-get install python3-numpy)"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$todbench" module check "$python $examples/sensor.py" --place sensor --limit-ms 120000 --json > "$folder/check.json"
sensor='width = 320
height = 240
pitch_um = 47.5
detector_um = 47.5
focal_length_mm = 36.3
f_number = 1
wavelength_min_um = 7.5
wavelength_max_um = 13.0
netd_k = 0.07
bits = 14
kelvin_per_count = 0.01
offset_k = 250
'
printf 'name = "built-in"\n%s' "$sensor" > "$folder/built-in-sensor.toml"
printf 'name = "program"\n%s[[module]]\nplace = "sensor"\ncommand = "%s %s/sensor.py"\nlimit_ms = 120000\n' "$sensor" "$python" "$examples" > "$folder/program-sensor.toml"
for name in built-in program; do
  cat > "$folder/$name.toml" <<PLAN
name = "$name"
[target]
kind = "scene"
distance_m = 2
plates = ["tcat-a"]
mountings = ["identity"]
delta_t_k = [16.9, 1.93]
[simulation]
sensor = "$folder/$name-sensor.toml"
accuracy = "draft"
phases = 12
skip = ["diffraction"]
[fit]
estimator = "weibull"
PLAN
  "$todbench" simulate "$folder/$name.toml" --out "$folder/$name" --json > "$folder/$name.json" || [ $? -le 3 ] || { echo "FAILED: simulate $name"; exit 1; }
done
# Noise is other noise: each threshold lies within the 95 % interval of the other's.
"$python" - "$folder" <<'CHECK'
import csv, json, sys
check, a, b = (json.load(open(f"{sys.argv[1]}/{name}.json")) for name in ("check", "built-in", "program"))
fine = abs(check["response"] - 1) < 1e-6 and abs(check["noise_k"] / 0.07 - 1) < 0.05 and check["linear"] and len(a["points"]) == 2
for p, q in zip(a["points"], b["points"]):
    print(p["delta_t_k"], "K:", p["s75_mrad"], p["s75_ci95_mrad"], "and", q["s75_mrad"], q["s75_ci95_mrad"])
    for one, other in ((p, q), (q, p)):
        low, high = other["s75_ci95_mrad"]
        fine = fine and low < one["s75_mrad"] < high
for row in csv.DictReader(open(f"{sys.argv[1]}/program/trials.csv")):
    fine = fine and abs(float(row["delta_t_k"]) / float(row["set_delta_t_k"]) - 1) < 0.02
sys.exit(0 if fine else 1)
CHECK
