#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# identify_test.sh PROGRAM: targets in motion and behind a package, and pictures of the same.
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
chain="identify ./set.toml --sensor ./slow.toml --ranges 1200,2400,4800 --decisions 48 --accuracy draft --json"

# Motion: a still picture is the same with and without the option; speed costs range.
runs 0 still.json $chain
runs 0 zero-speed.json $chain --motion-mrad-s 0 0
runs 0 moving.json $chain --motion-mrad-s 150 40
check 'a == b' still.json zero-speed.json
check 'b["r75_m"] < a["r75_m"]' still.json moving.json
check 'b["motion_mrad_s"] == [150, 40] and b["frames"] == 1 and b["sequence"] == "single-frame"' still.json moving.json
check 'b["m75"]["value"] > 0' still.json moving.json
runs 0 sum.json $chain --motion-mrad-s 150 40 --sequence tracking-sum --frames 4
check 'b["r75_m"] > a["r75_m"] and b["tod"] == [] and "single frame" in " ".join(b["notes"])' moving.json sum.json
runs 2 refused $chain --motion-mrad-s nan 0
runs 2 refused $chain --motion-mrad-s 5000 0
says "5 pixels per frame"

# Package: a gain changes no answer.
runs 0 one.json $chain --package one.toml
runs 0 gain.json $chain --package gain.toml
check '[r["confusion"] for r in a["ranges"]] == [r["confusion"] for r in b["ranges"]]' one.json gain.json
check 'abs(b["ranges"][0]["judged"]["gain"] - 4) < 0.02 and b["package"] == "gain.toml" and b["m75"]["value"] is None' one.json gain.json
runs 3 refused $chain --package zero.toml
says "no contrast"
runs 2 refused $chain --package missing.toml

# Pictures: the frame behind the package, in units of its contrast; rows that are read one after the other.
pictures="picture craft-at-sea --range-m 400 --accuracy draft --json --motion-mrad-s 150 0 --tolerance-percent 0.1"
grep -v row_time_us slow.toml >at-once.toml
runs 0 at-once.json $pictures --sensor ./at-once.toml --out at-once
runs 0 rows.json $pictures --sensor ./slow.toml --out rows --package gain.toml
check 'len(a["stages"]) == 7 and len(b["stages"]) == 8 and b["stages"][6]["name"] == "7-package" and abs(b["judged_gain"] - 4) < 0.01' at-once.json rows.json
check 'abs((b["stages"][6]["max_k"] - b["stages"][6]["min_k"]) / (b["stages"][5]["max_k"] - b["stages"][5]["min_k"]) - 1) < 0.01' rows.json rows.json
check 'a["warnings"] == [] and b["warnings"] == [] and a["stages"][0] == b["stages"][0] and a["stages"][3] != b["stages"][3]' at-once.json rows.json

exit $failed
