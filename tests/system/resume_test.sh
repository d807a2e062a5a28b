#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# resume_test.sh PROGRAM [KILLS]: a run is killed at several places and resumed: its first part has the trials of the killed run, the whole
# has all presentations, and its acuity is that of a run that was not interrupted.
set -u
program=$1 kills=${2:-4}
failed=0
fail() {
  echo "$1"
  failed=1
}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
cat >plan.toml <<'PLAN'
name = "resumed"
[camera]
id = "sim:sc2000"
ifov_mrad = 1.3085
[target]
kind = "scene"
distance_m = 2
plates = ["tcat-a", "tcat-b"]
mountings = ["identity", "rotated_180"]
delta_t_k = [16.9]
phases = 60
[schedule]
answers = "binary"
[fit]
estimator = "weibull"
[simulation]
accuracy = "draft"
phases = 4
[measurement]
record_frames = true
PLAN
"$program" measure plan.toml --out whole --quiet >/dev/null 2>said || fail "the whole run: $(cat said)"
rows=$(wc -l <whole/trials.csv)
# Prints problems of the resumed session $2 of the interrupted session $1.
check() {
  python3 - "$1" "$2" <<'PYTHON'
import csv, json, sys
then, now = sys.argv[1:]
rows = lambda folder: list(csv.reader(open(folder + "/trials.csv")))
old, new, whole = rows(then), rows(now), rows("whole")
if len(new) != len(whole): print(f"{now}: {len(new)} rows of trials, expected {len(whole)}")
complete = len(old) - 1 if len(old[-1]) < len(old[0]) else len(old)
if new[:complete] != old[:complete]: print(f"{now}: the trials of the first part differ")
record = json.load(open(now + "/provenance.json"))
if (record["state"], record["interrupted"], record["segments"]) != ("complete", True, 2): print(now, record["state"], record["segments"])
if not record["origin"]["resumed"] or not record["origin"]["session"].endswith(then): print(now, record["origin"])
curve = lambda folder: next(row for row in csv.DictReader(open(folder + "/curve.csv")) if row["side"] == "measured")
a, b = curve("whole"), curve(now)
low, high = float(a["s75_ci95_low_mrad"]), float(a["s75_ci95_high_mrad"])
if not low <= float(b["s75_mrad"]) <= high: print(f"{now}: S75 {b['s75_mrad']} outside of {low} to {high}")
PYTHON
}
# Waits until the session $1 has $2 rows of trials, or its process ended.
until_rows() {
  while kill -0 $process 2>/dev/null; do
    [ -e "$1/trials.csv" ] && [ "$(wc -l <"$1/trials.csv")" -ge "$2" ] && break
  done
}
k=0
while [ $k -lt "$kills" ]; do
  k=$((k + 1))
  # Killed once the file has this many rows; the last kill is near the end.
  wanted=$((1 + (rows - 1) * k / (kills + 1)))
  "$program" measure plan.toml --out cut-$k --quiet >/dev/null 2>&1 &
  process=$!
  until_rows cut-$k $wanted
  kill -9 $process 2>/dev/null
  wait $process 2>/dev/null
  if [ -e cut-$k/manifest.json ]; then
    echo "the run ended before it was killed at $wanted of $rows rows"
    continue
  fi
  "$program" measure --resume cut-$k --out whole-$k --quiet >/dev/null 2>said
  code=$?
  [ $code = 0 ] || [ $code = 3 ] || fail "resumed after $wanted rows: exit code $code: $(cat said)"
  problems=$(check cut-$k whole-$k)
  [ -z "$problems" ] || fail "$problems"
  "$program" verify whole-$k >/dev/null || fail "whole-$k is not intact"
done
# A stop request ends the first part in another way: the failure of the last frame or target is recorded.
"$program" measure plan.toml --out stopped --quiet >/dev/null 2>&1 &
process=$!
until_rows stopped $((rows / 2))
kill -TERM $process
wait $process
"$program" measure --resume stopped --out whole-stopped --quiet >/dev/null 2>said || fail "resumed after a stop request: $(cat said)"
problems=$(check stopped whole-stopped)
[ -z "$problems" ] || fail "$problems"
grep -q 'the first part is session stopped' whole-stopped/report.html || fail "the report does not name the first part"
# Refused with one sentence.
refused() {
  "$program" measure "$@" >/dev/null 2>said
  [ $? = 2 ] && [ "$(wc -l <said)" = 1 ] || fail "measure $*: $(cat said)"
}
refused --resume whole --out again
grep -q 'is complete' said || fail "a complete session: $(cat said)"
refused --resume stopped --out again --seed 3
rm -r stopped/frames
refused --resume stopped --out again --accept-changed
exit $failed
