#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# round_robin_test.sh PROGRAM: a comparison by the command line, from blind recordings to degrees of equivalence, and results that are refused.
set -u
program=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 2
failed=0
wrong() {
  echo "$*"
  failed=1
}
ends() {
  expected=$1
  shift
  "$@" >out 2>err
  code=$?
  [ $code -eq "$expected" ] || wrong "$*: exit code $code instead of $expected: $(cat err)"
}
# A refusal: exit code 2, one line on standard error with these words, nothing on standard output.
refused() {
  words=$1
  shift
  ends 2 "$@"
  [ "$(wc -l <err)" -eq 1 ] || wrong "$*: more than one line: $(cat err)"
  grep -qF -- "$words" err || wrong "$*: '$words' is not in: $(cat err)"
  [ -s out ] && wrong "$*: standard output: $(cat out)"
}

ends 0 "$program" round-robin prepare --out c --laboratories 3 --items 2 --seed 77 --quiet
grep -q '"schema": "todbench-round-robin-1"' c/sealed.json || wrong "sealed.json: $(head -c 200 c/sealed.json)"
grep -q "$(sha256sum c/sealed.json | cut -d' ' -f1)" c/laboratory-3/protocol.html || wrong "the protocol does not state the digest of sealed.json"
(cd c/laboratory-2 && sha256sum --quiet -c SHA256SUMS) || wrong "SHA256SUMS"
refused "expected a new or an empty folder" "$program" round-robin prepare --out c
for n in 1 2 3; do
  ends 0 "$program" round-robin judge c/laboratory-$n --laboratory "lab $n" --out results-$n.csv --quiet
done
# Correct laboratories: 0, or with a small probability 1 or 3. With this seed they are consistent.
ends 0 "$program" round-robin evaluate results-1.csv results-2.csv results-3.csv --sealed c/sealed.json --out page --json
grep -q '"verdict": *"consistent"' out || wrong "verdict: $(cat out)"
grep -q '"reference_holds_truth": *\(true\|false\)' out || wrong "no comparison with the truth: $(cat out)"
for file in page/round-robin.html page/round-robin.json page/degrees.csv; do [ -s "$file" ] || wrong "$file is missing"; done

# A fourth laboratory with a bias of 30 % in both items is named.
sed 's/^lab 1/lab 4/' results-1.csv | awk -F, -v OFS=, 'NR > 1 { $5 *= 1.3 } { print }' >results-4.csv
ends 1 "$program" round-robin evaluate results-1.csv results-2.csv results-3.csv results-4.csv
grep -q "outlying: lab 4" out || wrong "lab 4 is not named: $(cat out)"

# Sessions: the place is the laboratory, the unit the item. The error of a distance is common to the units of one bench, not to two laboratories.
for n in 1 2; do
  cat >plan$n.toml <<PLAN
name = "compared"
place = "bench $n"
unit = "camera 7"
[camera]
id = "sim:sc2000"
ifov_mrad = 1.3085
[target]
kind = "scene"
distance_m = 2
plates = ["tcat-a", "tcat-b"]
mountings = ["identity"]
delta_t_k = [16.9]
phases = 4
[simulation]
accuracy = "draft"
phases = 4
PLAN
done
cat >>plan2.toml <<PLAN
[[uncertainty.component]]
name = "distance"
value = 60
unit = "mm"
source = "estimate"
common = ["series"]
PLAN
for n in 1 2; do ends 0 "$program" simulate ./plan$n.toml --seed 4 --out session-$n --quiet; done
ends 0 "$program" round-robin evaluate session-1 session-2 --out sessions
# 60 mm of 2 m: u^2 of the two differ by 0.03^2, the second order of the distance by 0.1 % of it.
awk -F, 'NR > 1 { u[$4] = $6 / $5 } END { more = u["bench 2"] ^ 2 - u["bench 1"] ^ 2; exit !(more > 0.0299 ^ 2 && more < 0.0301 ^ 2) }' sessions/degrees.csv ||
  wrong "uncertainties of sessions: $(cat sessions/degrees.csv)"
refused "has a second result" "$program" round-robin evaluate session-1 session-1
# The acuity of another observer is another quantity, which no other laboratory has.
sed 's/bench 1/bench 3/' plan1.toml >plan3.toml
printf '[observer]\nname = "human-like-1"\n' >>plan3.toml
ends 0 "$program" simulate ./plan3.toml --seed 4 --out session-3 --quiet
refused "observer human-like-1" "$program" round-robin evaluate session-1 session-2 session-3

head="laboratory,item,quantity,value,u"
printf '%s\nA,i,q,1,0\nB,i,q,1,1\n' $head >zero.csv
printf '%s\nA,i,q,1,-1\nB,i,q,1,1\n' $head >negative.csv
printf '%s\nA,i,q,nan,1\nB,i,q,1,1\n' $head >nan.csv
printf '%s\nA,i,q,1e308,1\nB,i,q,1,1\n' $head >huge.csv
printf '%s\nA,i,q,1,\nB,i,q,1,1\n' $head >missing.csv
printf '%s\nA,i,q,1,1\nA,i,q,1,1\n' $head >twice.csv
printf '%s\nA,i,q,1,1\n' $head >alone.csv
printf '%s,unit\nA,i,q,1,1,mrad\nB,i,q,1,1,px\n' $head >units.csv
printf '%s\nA,i,q,1,1\nB,i,q,1,1\n' $head >good.csv
refused "column u: expected a number above 0" "$program" round-robin evaluate zero.csv
refused "column u: expected a number above 0" "$program" round-robin evaluate negative.csv
refused "column value: expected a number" "$program" round-robin evaluate nan.csv
refused "column value: expected a number" "$program" round-robin evaluate huge.csv
refused "missing uncertainty" "$program" round-robin evaluate missing.csv
refused "has a second result" "$program" round-robin evaluate twice.csv
refused "has a second result" "$program" round-robin evaluate good.csv good.csv
refused "at least two laboratories" "$program" round-robin evaluate alone.csv
refused "differs from" "$program" round-robin evaluate units.csv
refused "has no item 'i'" "$program" round-robin evaluate good.csv --sealed c/sealed.json
refused "contains no session" "$program" round-robin evaluate c
refused "none.csv" "$program" round-robin evaluate none.csv
exit $failed
