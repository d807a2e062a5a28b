#!/bin/sh
# The layering check must find what it is there to find.
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/hvs" "$work/tod" "$work/bench/session" "$work/acquisition/core"
printf '#include "tod/trial.h"\n' >"$work/hvs/upward.h"
printf '#include <arv.h>\n' >"$work/tod/camera.h"
printf '#include <QWidget>\n' >"$work/bench/session/widget.h"
printf '#include "acquisition/core/result.h"\n#include <vector>\n' >"$work/tod/fine.h"
printf '#include <vector>\n#include "tod/fine.h"\n' >"$work/tod/fine.cpp"
found=$(sh "$here/check_layering.sh" "$work")
status=$?
[ $status -eq 1 ] || { echo "expected exit 1, got $status"; exit 1; }
[ "$(printf '%s\n' "$found" | wc -l)" -eq 4 ] || { echo "expected 4 violations, got: $found"; exit 1; }
printf '#include "tod/fine.h"\n#include <vector>\n' >"$work/tod/fine.cpp"
rm "$work/hvs/upward.h" "$work/tod/camera.h" "$work/bench/session/widget.h"
sh "$here/check_layering.sh" "$work" || { echo "a clean tree was refused"; exit 1; }
