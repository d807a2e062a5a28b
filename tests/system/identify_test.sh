#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# identify_test.sh PROGRAM: targets in motion, behind a package, and for people; pictures of the same; the M75 of people in a range.
set -u
program=$1
failed=0
fail() {
  echo "$1"
  failed=1
}
sensors=$(cd "$(dirname "$0")/../../sim_devices/sensors" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
key() { python3 -c "import json,sys; print(eval('json.load(open(sys.argv[1]))' + sys.argv[2]))" "$1" "$2"; }
check() { # expression of python over the JSON objects a and b of two files
  python3 -c "import json,sys; a=json.load(open(sys.argv[2])); b=json.load(open(sys.argv[3])); sys.exit(0 if eval(sys.argv[1]) else 1)" "$1" "$2" "$3" ||
    fail "not so for $2 and $3: $1"
}
runs() { # expected exit code, file for standard output, arguments
  expected=$1
  out=$2
  shift 2
  "$program" "$@" >"$out" 2>said </dev/null
  code=$?
  [ $code = "$expected" ] || fail "todbench $*: exit code $code, expected $expected: $(tail -n 3 said)"
}
says() { grep -q -- "$1" said || fail "expected '$1', found: $(cat said)"; }

printf 'name = "three"\ntargets = ["craft-01", "craft-07", "craft-12"]\nazimuths_deg = [90]\nbackground_k = 288\n' >set.toml
sed 's/^name = .*/name = "slow"/;s/^width = .*/width = 96/;s/^height = .*/height = 64/' "$sensors/sc2000.toml" >slow.toml
printf 'time_constant_ms = 10\nrow_time_us = 50\n' >>slow.toml
printf 'name = "gain"\n[[stage]]\nkind = "kernel"\nvalues = [0, 0, 0, 0, 4, 0, 0, 0, 0]\n' >gain.toml
printf 'name = "none"\n[[stage]]\nkind = "kernel"\nvalues = [0, 0, 0, 0, 1, 0, 0, 0, 0]\n' >one.toml
printf 'name = "zero"\n[[stage]]\nkind = "kernel"\nvalues = [0, 0, 0, 0, 0, 0, 0, 0, 0]\n' >zero.toml
chain="identify ./set.toml --sensor ./slow.toml --ranges 1200,2400,4800 --decisions 32 --accuracy draft --json"

# Motion: a still picture is the same with and without the option; speed costs range.
runs 0 still.json $chain
runs 0 zero-speed.json $chain --motion-mrad-s 0 0
runs 0 moving.json $chain --motion-mrad-s 150 40
check 'a == b' still.json zero-speed.json
check 'b["r75_m"] < a["r75_m"]' still.json moving.json
check 'b["motion_mrad_s"] == [150, 40] and b["frames"] == 1 and b["sequence"] == "single-frame"' still.json moving.json
check 'b["m75"]["value"] > 0' still.json moving.json
runs 0 sum.json $chain --motion-mrad-s 150 40 --sequence tracking-sum --frames 3
check 'b["r75_m"] > a["r75_m"] and b["tod"] == [] and "single frame" in " ".join(b["notes"])' moving.json sum.json
runs 2 refused $chain --motion-mrad-s nan 0
runs 2 refused $chain --motion-mrad-s 5000 0
says "5 pixels per frame"

# Package: a gain changes no answer.
runs 0 one.json $chain --package one.toml
runs 0 gain.json $chain --package gain.toml
check '[r["confusion"] for r in a["ranges"]] == [r["confusion"] for r in b["ranges"]]' one.json gain.json
check 'abs(b["ranges"][0]["judged"]["gain"] - 4) < 0.02 and b["package"] == "gain.toml" and b["m75"]["value"] is None and "package" in b["m75"]["reason"]' one.json gain.json
runs 3 refused $chain --package zero.toml
says "no contrast"
runs 2 refused $chain --package missing.toml

# Pictures: the frame behind the package, in units of its contrast; rows that are read one after the other.
pictures="picture craft-at-sea --range-m 1200 --accuracy draft --json --motion-mrad-s 150 0 --tolerance-percent 0.1"
grep -v row_time_us slow.toml >at-once.toml
runs 0 at-once.json $pictures --sensor ./at-once.toml --out at-once
runs 0 rows.json $pictures --sensor ./slow.toml --out rows --package gain.toml
check 'len(a["stages"]) == 7 and len(b["stages"]) == 8 and b["stages"][6]["name"] == "7-package" and abs(b["judged_gain"] - 4) < 0.01' at-once.json rows.json
check 'abs((b["stages"][6]["max_k"] - b["stages"][6]["min_k"]) / (b["stages"][5]["max_k"] - b["stages"][5]["min_k"]) - 1) < 0.01' rows.json rows.json
check 'a["warnings"] == [] and b["warnings"] == [] and a["stages"][0] == b["stages"][0] and a["stages"][3] != b["stages"][3]' at-once.json rows.json

# People: pictures with the truth apart; simulated people who are always right near and every other time far.
people="identify ./set.toml --sensor ./slow.toml --ranges 800,1600 --accuracy draft --per-target 8"
runs 0 said.txt $people --people set
[ "$(ls set/show/*.png | wc -l)" = 48 ] || fail "48 pictures were expected"
[ "$(ls set/show/targets/*.png | wc -l)" = 3 ] || fail "3 targets were expected"
grep -q craft set/show/answers.csv && fail "the sheet for the person contains the truth"
runs 2 refused $people --people set
says "exists"
answer() { # seed of the simulated person
  python3 - "$1" <<'PYTHON'
import csv, random, sys
numbers = random.Random(int(sys.argv[1]))
truth = {row["number"]: row for row in csv.DictReader(open("set/truth/truth.csv"))}
names = sorted({row["target"] for row in truth.values()})
far = [n for n, row in truth.items() if float(row["range_m"]) > 1000]
wrong = set(numbers.sample(far, len(far) // 2))
rows = list(csv.DictReader(open("set/show/answers.csv")))
with open("person%s.csv" % sys.argv[1], "w", newline="") as out:
    writer = csv.DictWriter(out, rows[0].keys())
    writer.writeheader()
    for row in rows:
        right = truth[row["number"]]["target"]
        row["answer"] = names[(names.index(right) + 1) % 3] if row["number"] in wrong else right
        writer.writerow(row)
PYTHON
}
for person in 1 2 3; do answer $person; done
runs 0 person.json $people --answers person1.csv --json --m75-out m75.json
# From 1 to 1/2: 3/4 half way in ln range.
check 'abs(a["r75_m"] / (800 * 1600) ** 0.5 - 1) < 1e-9 and a["ranges"][0]["right"] == 24 and a["ranges"][1]["right"] == 12' person.json person.json
check 'a["m75"]["ci95"][0] < a["m75"]["value"] < a["m75"]["ci95"][1] and b["curve_of"] == "hvs-1" and b["answers_of"] == "one person"' person.json m75.json
runs 0 people.json $people --answers person1.csv person2.csv person3.csv --json
check 'len(b["persons"]) == 3 and b["ranges"][1]["shown"] == 72 and abs(b["r75_m"] / a["r75_m"] - 1) < 1e-6' person.json people.json
runs 2 refused $people --seed 2 --answers person1.csv
says "belong to experiment"
sed '3s/craft-[0-9]*$/boat/;3s/craft-[0-9]*\r$/boat/' person1.csv >unknown.csv
runs 2 refused $people --answers unknown.csv
says "unknown target"
runs 2 refused $people --answers set/show/answers.csv
says "guesses"

# The range of the same people with a TOD curve of the same observer; with that of another it is refused.
cat >plan.toml <<'PLAN'
name = "curve"
[camera]
id = "sim:sc2000"
ifov_mrad = 1.3085
[target]
kind = "scene"
distance_m = 2
plates = ["tcat-a"]
mountings = ["identity"]
delta_t_k = [16.9]
phases = 4
[simulation]
accuracy = "draft"
phases = 4
PLAN
runs 0 said.txt simulate ./plan.toml --out session --quiet
runs 0 range.json range --tod session --size-m 3 --delta-t-k 16.9 --m75-of m75.json --json
check 'abs(a["m75"] / b["m75"] - 1) < 1e-9 and "one person" in a["m75_origin"] and "hvs-1" in a["m75_origin"] and a["m75_ci95"][0] <= b["m75_ci95"][0] * 1.000001' range.json m75.json
check 'not any("criterion of people" in n for n in a["notes"])' range.json range.json
sed 's/"curve_of": "hvs-1"/"curve_of": "hvs-2"/' m75.json >other.json
runs 2 refused range --tod session --size-m 3 --delta-t-k 16.9 --m75-of other.json
says "belongs to the TOD curve of hvs-2"
printf '{"schema": "todbench-m75-1", "m75": 1e308}' >silly.json
runs 2 refused range --tod session --size-m 3 --delta-t-k 16.9 --m75-of silly.json
exit $failed
