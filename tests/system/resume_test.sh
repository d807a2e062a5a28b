#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# resume_test.sh PROGRAM [KILLS [gige]]: a run is killed at several places and resumed: its first part has the trials of the killed run, the
# whole has all presentations, and its acuity is that of a run that was not interrupted. With `gige` the camera is an emulated GigE Vision
# camera, with stage and black body in a process of their own.
set -u
program=$1 kills=${2:-4} camera=${3:-simulated}
failed=0 laboratory=
fail() {
  echo "$1"
  failed=1
}
folder=$(mktemp -d)
trap '[ -z "$laboratory" ] || kill $laboratory; rm -rf "$folder"' EXIT
cd "$folder" || exit 1
id=sim:sc2000 target='kind = "scene"' phases=60
if [ "$camera" = gige ]; then
  "$program" emulate --json --black-body-port 0 --stage-port 0 >addresses.json &
  laboratory=$!
  until [ -s addresses.json ]; do kill -0 $laboratory || exit 1; done
  target=$(python3 -c 'import json; a = json.load(open("addresses.json"))
print("kind = \"scpi\"\nblack_body = \"%s\"\nstage = \"%s\"" % (a["black_body"], a["stage"]))')
  id=gige:127.0.0.1 phases=6
fi
cat >plan.toml <<PLAN
name = "resumed"
[camera]
id = "$id"
ifov_mrad = 1.3085
[target]
$target
distance_m = 2
plates = ["tcat-a", "tcat-b"]
mountings = ["identity", "rotated_180"]
delta_t_k = [16.9]
phases = $phases
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
# Prints problems of the resumed session $2 of the interrupted session $1, which was resumed $3 times in all (1 if not given).
check() {
  python3 - "$1" "$2" "$camera" "${3:-1}" <<'PYTHON'
import csv, json, sys
then, now, camera, gaps = *sys.argv[1:4], int(sys.argv[4])
rows = lambda folder: list(csv.reader(open(folder + "/trials.csv")))
old, new, whole = rows(then), rows(now), rows("whole")
if len(new) != len(whole): print(f"{now}: {len(new)} rows of trials, expected {len(whole)}")
complete = len(old) - 1 if len(old[-1]) < len(old[0]) else len(old)
if new[:complete] != old[:complete]: print(f"{now}: the trials of the first part differ")
record = json.load(open(now + "/provenance.json"))
# A run that was killed while it fitted its trials has nothing left to measure.
segments = gaps + (complete < len(whole))
if (record["state"], record["interrupted"], record["segments"]) != ("complete", segments > 1, segments): print(now, record["state"], record["interrupted"], record["segments"])
if not record["origin"]["resumed"] or not record["origin"]["session"].endswith(then): print(now, record["origin"])
curve = lambda folder: next(row for row in csv.DictReader(open(folder + "/curve.csv")) if row["side"] == "measured")
a, b = curve("whole"), curve(now)
interval = lambda row: (float(row["s75_ci95_low_mrad"]), float(row["s75_ci95_high_mrad"]))
low, high = interval(a)
if camera == "gige":
    # The noise after the gap is new. Two intervals of 1.96 standard deviations are apart if the values differ by 3.9 of them; the
    # difference of two runs without a common frame has 1.4.
    if max(low, interval(b)[0]) > min(high, interval(b)[1]): print(f"{now}: S75 {interval(b)} apart from {low} to {high}")
elif not low <= float(b["s75_mrad"]) <= high: print(f"{now}: S75 {b['s75_mrad']} outside of {low} to {high}")
PYTHON
}
# Waits until the session $1 has $2 rows of trials, or its process ended.
until_rows() {
  while kill -0 $process 2>/dev/null; do
    [ -e "$1/trials.csv" ] && [ "$(wc -l <"$1/trials.csv")" -ge "$2" ] && break
    sleep 0.02 # without it the loop takes a processor from the run
  done
}
k=0 resumed=0
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
  resumed=$((resumed + 1))
done
echo "$resumed of $kills runs were killed and resumed, failed: $failed"
# A resumed run that is killed can be resumed in turn.
if [ ! -e cut-1/manifest.json ]; then
  "$program" measure --resume cut-1 --out twice --quiet >/dev/null 2>&1 &
  process=$!
  until_rows twice $((rows * 3 / 4))
  kill -9 $process 2>/dev/null
  wait $process 2>/dev/null
  if [ ! -e twice/manifest.json ]; then
    "$program" measure --resume twice --out whole-twice --quiet >/dev/null 2>said || [ $? = 3 ] || fail "resumed for the second time: $(cat said)"
    problems=$(check twice whole-twice 2)
    [ -z "$problems" ] || fail "$problems"
    "$program" replay whole-twice --out replayed --quiet >/dev/null 2>said || [ $? = 3 ] || fail "replay of a resumed run: $(cat said)"
    cmp -s whole-twice/trials.csv replayed/trials.csv || fail "the replay of a resumed run has other trials"
    echo "a resumed run was killed, resumed and replayed"
  fi
fi
# A stop request ends the first part in another way: the failure of the last frame or target is recorded.
# The run is held in its middle; one that ended before this is started again.
attempt=0
while
  rm -rf stopped
  "$program" measure plan.toml --out stopped --quiet >/dev/null 2>&1 &
  process=$!
  until_rows stopped $((rows / 4))
  kill -STOP $process 2>/dev/null
  attempt=$((attempt + 1))
  [ -e stopped/manifest.json ] && [ $attempt -lt 20 ]
do
  kill -CONT $process 2>/dev/null
  wait $process
done
"$program" measure --resume stopped --out too-early --quiet >/dev/null 2>said
[ $? = 2 ] && grep -q 'is under way in another program' said || fail "a run that is under way: $(cat said)"
kill -TERM $process
kill -CONT $process
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
