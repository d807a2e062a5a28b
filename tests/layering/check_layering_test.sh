#!/bin/sh
# The layering check must find what it is there to find.
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/hvs/shape" "$work/tod/plate" "$work/tod/new" "$work/bench/session" "$work/acquisition/core"
printf '#include "tod/presentation/trial.h"\n' >"$work/hvs/shape/upward.h"
printf '#include <arv.h>\n' >"$work/tod/plate/camera.h"
printf '#include <QWidget>\n' >"$work/bench/session/widget.h"
printf '#include "acquisition/core/result.h"\n#include <vector>\n' >"$work/tod/plate/fine.h"
printf '#include <vector>\n#include "tod/plate/fine.h"\n' >"$work/tod/plate/fine.cpp"
printf '#include <vector>\n' >"$work/tod/new/room.h"
found=$(sh "$here/check_layering.sh" "$work")
status=$?
[ $status -eq 1 ] || { echo "expected exit 1, got $status"; exit 1; }
[ "$(printf '%s\n' "$found" | wc -l)" -eq 5 ] || { echo "expected 5 violations, got: $found"; exit 1; }
printf '#include "tod/plate/fine.h"\n#include <vector>\n' >"$work/tod/plate/fine.cpp"
rm "$work/tod/new/room.h" "$work/hvs/shape/upward.h" "$work/tod/plate/camera.h" "$work/bench/session/widget.h"
sh "$here/check_layering.sh" "$work" || { echo "a clean tree was refused"; exit 1; }
