#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# examples_test.sh PROGRAM SOURCE: every command has an example in its help, every example is parsed, and those run that need neither a device
# nor a minute.
set -u
program=$1 source=$2
failed=0
fail() {
  echo "$1"
  failed=1
}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
ln -s "$source/docs" "$folder/docs"
cd "$folder" || exit 1

# Prints the commands and their subcommands, "history" and "history add".
commands_below() {
  "$program" $1 --help | awk '/^[A-Z][A-Za-z, ]*:$/ { list = !/^(Options|Positionals|Example):$/; next } list && /^  [a-z]/ { print $1 }'
}
names=$(for one in $(commands_below ""); do
  echo "$one"
  case "$("$program" "$one" --help | sed -n 's/^Usage: .* \(SUBCOMMAND\)$/\1/p')" in
  SUBCOMMAND) for two in $(commands_below "$one"); do echo "$one $two"; done ;;
  esac
done)
[ "$(echo "$names" | wc -l)" -gt 50 ] || fail "found only these commands: $names"
echo "$names" | while read -r name; do
  "$program" $name --help | sed -n '/^Example:$/,/^$/s/^  todbench //p' >lines
  [ -s lines ] || echo "$name: its help has no example"
  while read -r line; do
    eval "set -- $line"
    "$program" parse "$@" >said 2>&1 || echo "$name: todbench $line: $(cat said)"
  done <lines
done >problems
[ -s problems ] && fail "$(cat problems)"
"$program" parse fit --no-such-option >said 2>&1 && fail "a wrong option is parsed"

# Runs the example of a command and compares its exit code.
runs() {
  line=$("$program" $2 --help | sed -n '/^Example:$/,/^$/s/^  todbench //p' | head -n 1)
  eval "set -- \"$1\" $line"
  expected=$1
  shift
  "$program" "$@" >said 2>&1 </dev/null
  code=$?
  case " $expected " in *" $code "*) ;; *) fail "todbench $*: exit code $code, expected $expected: $(tail -n 3 said)" ;; esac
}
# "curve" is the session of "simulate"; a curve of a draft may be inconclusive.
runs "0 3" simulate
runs 0 render
runs 0 mtf
runs 0 plate
runs 0 report
runs 0 verify
runs 0 conformity
runs 0 fit
runs 0 pattern
runs 0 sfr
runs 0 range
runs 0 selftest
runs 0 "observer sensitivity"
runs 0 record
runs 0 noise
[ -s tcat-a.dxf ] && [ -s tcat-a.pdf ] || fail "plate wrote no drawings"
exit $failed
