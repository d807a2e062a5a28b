#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# versions_test.sh SOURCE VERSION: what states a version or its date beside CMakeLists.txt states the same.
set -eu
cd "$1"
heading=$(grep -m 1 '^## ' CHANGELOG.md)
date=${heading#*(}
date=${date%)}
failed=0
expect() { grep -qx "$1" "$2" || { echo "$2: expected '$1'"; failed=1; }; }
expect "## $2 ($date)" CHANGELOG.md
expect "version: $2" docs/CITATION.cff
expect "date-released: $date" docs/CITATION.cff
exit $failed
