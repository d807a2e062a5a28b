#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The checks of this folder must find what they are there to find.
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/hvs/shape" "$work/tod/plate" "$work/tod/new" "$work/bench/session" "$work/acquisition/core"
printf '#include "tod/presentation/trial.h"\n' >"$work/hvs/shape/upward.h"
printf '#include <arv.h>\n' >"$work/tod/plate/camera.h"
printf '#include <QWidget>\n' >"$work/bench/session/widget.h"
printf '#include "acquisition/base/result.h"\n#include <vector>\n' >"$work/tod/plate/fine.h"
printf '#include <vector>\n#include "tod/plate/fine.h"\n' >"$work/tod/plate/fine.cpp"
printf '#include <vector>\n' >"$work/tod/new/room.h"
found=$(sh "$here/check_layering.sh" "$work")
status=$?
[ $status -eq 1 ] || { echo "expected exit 1, got $status"; exit 1; }
[ "$(printf '%s\n' "$found" | wc -l)" -eq 5 ] || { echo "expected 5 violations, got: $found"; exit 1; }
printf '#include "tod/plate/fine.h"\n#include <vector>\n' >"$work/tod/plate/fine.cpp"
rm "$work/tod/new/room.h" "$work/hvs/shape/upward.h" "$work/tod/plate/camera.h" "$work/bench/session/widget.h"
sh "$here/check_layering.sh" "$work" || { echo "a clean tree was refused"; exit 1; }
unique() { python3 "$here/check_unique_types.py" "$work"; }
printf 'namespace a {\nstruct Twice { int x; };\n}\nnamespace {\nstruct Once {};\n}\n' >"$work/hvs/shape/one.h"
printf 'namespace a {\nclass Outer {\n struct Once {};\n};\nenum class Once { one };\n}\n' >"$work/hvs/shape/two.h"
unique || { echo "types with names of their own were refused"; exit 1; }
printf 'namespace a {\n// struct Once {\nenum class Twice : int { one };\n}\n' >"$work/tod/plate/three.h"
! unique >/dev/null || { echo "two types of one name were not found"; exit 1; }
sh "$here/check_licences.sh" "$work" >/dev/null && { echo "files without a licence were not found"; exit 1; }
find "$work" -type f -exec sed -i '1i // SPDX-License-Identifier: GPL-3.0-or-later' {} +
sh "$here/check_licences.sh" "$work" || { echo "files with a licence were refused"; exit 1; }
