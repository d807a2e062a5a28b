#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# manual_test.sh PROGRAM: a page for every command that help lists, with every option that its help lists, and no mistake of troff.
set -eu
program=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() { echo "$*"; exit 1; }

"$program" manual --out "$folder" --date 2026-11-22
commands=$("$program" complete "")
[ "$(echo "$commands" | wc -l)" -gt 15 ] || fail "few commands: $commands"
for command in $commands; do
  page="$folder/todbench-$command.1"
  [ -s "$page" ] || fail "no page of $command"
  sed 's/\\-/-/g' "$page" | grep -q "^\.TH TODBENCH-$(echo "$command" | tr '[:lower:]' '[:upper:]') 1 2026-11-22 " || fail "$command: $(head -n 1 "$page")"
  "$program" "$command" --help | sed -n 's/^  \(-[^ ]*,\)\{0,1\}\(--[a-z0-9-]*\).*/\2/p' >"$folder/options"
  [ -s "$folder/options" ] || fail "$command: no options in its help"
  while read -r option; do
    sed 's/\\-/-/g' "$page" | grep -q "^\.B .*$option" || fail "$command: $option is not in the manual"
  done <"$folder/options"
done
[ "$(ls "$folder"/*.1 | wc -l)" -eq "$(($(echo "$commands" | wc -l) + 1))" ] || fail "a page too many"
# Help lists every command once, in a group of tasks, and the main page has the same groups.
"$program" --help | awk '/^Exit codes/ { exit } /^[A-Z][A-Za-z, ]*:$/ { group = toupper(substr($0, 1, length($0) - 1)) }
                         /^  [a-z]/ { print group ": " $1 }' >"$folder/grouped"
sed 's/\\-/-/g' "$folder/todbench.1" | awk '/^\.SH / { listed = sub(/^\.SH COMMANDS: /, ""); group = $0 }
                                           /^\.B / && listed { print group ": " $2 }' >"$folder/grouped_in_manual"
cmp "$folder/grouped" "$folder/grouped_in_manual" || fail "other groups in the manual than in the help"
[ "$(sed 's/.*: //' "$folder/grouped")" = "$commands" ] || fail "commands of the help: $(cat "$folder/grouped")"
if grep -q "^SUBCOMMANDS" "$folder/grouped"; then fail "a command without a group"; fi
[ "$(cut -d: -f1 "$folder/grouped" | uniq | wc -l)" -eq 7 ] || fail "groups: $(cut -d: -f1 "$folder/grouped" | uniq)"
if command -v mandoc >/dev/null; then mandoc -Tlint -Wwarning "$folder"/*.1; fi
if "$program" manual --out "$folder" --date 'x" y' 2>"$folder/said"; then fail "took a date that is none"; fi
grep -q "expected a date" "$folder/said" || fail "$(cat "$folder/said")"
