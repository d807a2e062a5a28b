#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# installed_libraries_test.sh CMAKE BUILD SOURCE COMPILER: installs the libraries under a prefix, moves it, and builds an example with each
# of the two packages, CMake's and pkg-config's.
set -eu
cmake=$1 build=$2 source=$3 compiler=$4
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

"$cmake" --install "$build" --prefix "$folder/first" --component development >"$folder/log" || { cat "$folder/log"; exit 1; }
mv "$folder/first" "$folder/prefix"
# Nothing that is installed names the folders of this build.
if grep -rlIF -e "$build" -e "$source" "$folder/prefix"; then
  echo "names the folders of the build"
  exit 1
fi
config=$(dirname "$(find "$folder/prefix" -name todbench.pc)")
mkdir -p "$folder/tree/docs"
cp -r "$source/docs/examples" "$folder/tree/docs"

"$cmake" -S "$folder/tree/docs/examples" -B "$folder/build" -DCMAKE_PREFIX_PATH="$folder/prefix" -DCMAKE_CXX_COMPILER="$compiler" \
  -DCMAKE_BUILD_TYPE= >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
"$cmake" --build "$folder/build" --target simulated_sensor >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
"$folder/build/simulated_sensor" | grep -q "^160 x 120 pixels"

if command -v pkg-config >/dev/null; then
  flags=$(PKG_CONFIG_PATH="$config" pkg-config --cflags --libs todbench)
  "$compiler" -std=c++20 -I "$folder/tree" "$folder/tree/docs/examples/fit_csv.cpp" -o "$folder/fit_csv" $flags
  "$folder/fit_csv" "$source/docs/examples/trials.csv" | grep -q "^verdict ok"
fi
