#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The shipped example of an observer as a program finds about the acuity of the built-in observer in the same frames.
# Usage: observer_module_test.sh TODBENCH EXAMPLES. Exit 0: passed, 77: there is no interpreter (said why on stdout), 1: failed.
set -eu
todbench=$1 examples=$2 python=/usr/bin/python3
"$python" -c "import numpy" 2>/dev/null || { echo "SKIPPED: numpy is not installed (apt-get install python3-numpy)"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat > "$folder/plain.toml" <<PLAN
name = "small"
[target]
kind = "scene"
distance_m = 2
plates = ["tcat-a"]
mountings = ["identity"]
delta_t_k = [16.9]
[simulation]
sensor = "sc2000"
accuracy = "draft"
phases = 6
PLAN
{ cat "$folder/plain.toml"; printf '[[module]]\ncommand = "%s %s/observer.py"\nplace = "observer"\nlimit_ms = 120000\n' "$python" "$examples"; } > "$folder/module.toml"
for name in plain module; do
  "$todbench" simulate "$folder/$name.toml" --out "$folder/$name" --json > "$folder/$name.json" || [ $? -le 3 ] || { echo "FAILED: simulate $name"; exit 1; }
done
# The same frames and the same internal noise, 120 answers each: templates without blur are at most a fifth better or worse.
"$python" - "$folder" <<'CHECK'
import csv, sys
rows = [list(csv.DictReader(open(f"{sys.argv[1]}/{name}/trials.csv"))) for name in ("plain", "module")]
right = [sum(row["truth"] == row["answer"] for row in table) / len(table) for table in rows]
same = sum(a["answer"] == b["answer"] for a, b in zip(*rows)) / len(rows[0])
print(f"right: {right[0]:.2f} and {right[1]:.2f}, the same answer: {same:.2f}")
sys.exit(0 if len(rows[0]) == len(rows[1]) == 120 and abs(right[0] - right[1]) < 0.1 and same > 0.8 else 1)
CHECK
