#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# judge_test.sh PROGRAM: a recorded session is judged again through the program: by the same observer, by another one, through a package; a
# signed session and a session without frames.
set -u
program=$1
failed=0
fail() {
  echo "$1"
  failed=1
}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
cat >plan.toml <<'PLAN'
name = "recorded"
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
[[limits.acuity]]
delta_t_k = 16.9
least_acuity_per_mrad = 0.2
PLAN
cat >display.toml <<'PLAN'
name = "display"
[display]
pixel_pitch_mm = 0.27
viewing_distance_m = 0.5
luminance_white_cd_m2 = 100
contrast = 0.5
zoom = 4
PLAN
printf 'name = "sharp"\n[[stage]]\nkind = "sharpen"\namount = 1\n' >package.toml
key() { python3 -c "import json,sys; print(eval('json.load(open(sys.argv[1]))' + sys.argv[2]))" "$1" "$2"; }
runs() { # expected exit code, arguments
  expected=$1
  shift
  "$program" "$@" --quiet >said 2>&1 </dev/null
  code=$?
  [ $code = "$expected" ] || fail "todbench $*: exit code $code, expected $expected: $(tail -n 3 said)"
}

runs 0 measure plan.toml --record-frames --out then
runs 0 judge then --out same
for file in trials.csv targets.csv curve.csv fits.json verdict.json trials_simulated.csv; do
  cmp then/$file same/$file || fail "$file differs for the same observer"
done
runs 0 verify same
runs 0 history add --index history.sqlite then same --json
[ "$(key said "['added']") $(key said "['judged_again']")" = "1 1" ] ||
  fail "frames judged again count as a check of the unit: $(cat said)"
[ "$(key same/provenance.json "['origin']['manifest_sha256']")" = "$(sha256sum <then/manifest.json | cut -c 1-64)" ] ||
  "$program" verify then --json | grep -q "$(key same/provenance.json "['origin']['manifest_sha256']")" || fail "the origin has another manifest"

runs 2 judge then --observer hvs-2 --out eye
grep -q '\[display\]' said || fail "an eye without a display: $(cat said)"
[ ! -e eye ] || fail "a refused session left a folder"
runs "0" judge then --observer hvs-2 --display display.toml --out eye
[ "$(key eye/provenance.json "['origin']['then']['observer']")" = hvs-1 ] || fail "the observer of then is not named"
[ "$(key eye/provenance.json "['origin']['now']['observer']")" = hvs-2 ] || fail "the observer of now is not named"
grep -q hvs-2 eye/report.html || fail "the report does not name the observer"

"$program" judge then --package package.toml --out sharp --json >sharp.json 2>said
code=$?
[ $code = 0 ] || [ $code = 3 ] || fail "a package: exit code $code: $(cat said)"
[ "$(key sharp/provenance.json "['origin']['now']['package']")" = sharp ] || fail "the package is not named"
key sharp.json "['points'][0]['acuity_per_mrad']" | grep -q '^0\.' || fail "no acuity through a package"

openssl genpkey -algorithm ed25519 -out key.pem 2>/dev/null && {
  cp -r then signed
  runs 0 sign signed --with openssl --key key.pem
  runs 0 judge signed --out again
  [ "$(key again/provenance.json "['origin']['signed_by']" | wc -c)" = 65 ] || fail "the signer is not named"
  head -c 20 manifest.json.sig >/dev/null 2>&1
  printf 'x' | dd of=signed/manifest.json.sig bs=1 seek=3 conv=notrunc 2>/dev/null
  runs 2 judge signed --out refused
}
echo >>then/trials.csv
runs 2 judge then --out changed
rm -r then/frames
runs 2 judge then --out none --accept-changed
grep -q 'no recorded frames' said || fail "without frames: $(cat said)"
exit $failed
