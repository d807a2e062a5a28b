#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Every source, script and CMake file names its licence. Usage: check_licences.sh ROOT
# Prints each file without the line; exit 1 when there is one.
cd "$1" || exit 2
without=$(find . \( -path ./build -o -path ./.git \) -prune -o -type f \( -name '*.h' -o -name '*.cpp' -o -name '*.py' -o -name '*.sh' \
    -o -name '*.m' -o -name '*.in' -o -name '*.cmake' -o -name CMakeLists.txt -o -path ./run -o -path ./.ci/run \) -print |
  sort | xargs grep -L '^[^ ]* SPDX-License-Identifier: GPL-3.0-or-later')
[ -z "$without" ] && exit 0
printf '%s\n' "$without" | sed 's/^..//; s/$/: no line SPDX-License-Identifier: GPL-3.0-or-later/'
exit 1
