#!/bin/sh
# Layering: which folder may include which, and which third-party headers belong to which folder. Usage: check_layering.sh ROOT
# Prints each violation as FILE:LINE: reason; exit 1 when there is one.
root=$1
cd "$root" || exit 2

# folder | folders of the project that it may include (itself always)
allowed() {
  case "$1" in
    acquisition/core) echo "acquisition/core" ;;
    acquisition/aravis | acquisition/v4l2 | acquisition/usb | acquisition/recording) echo "acquisition" ;;
    hvs) echo "acquisition/core" ;;
    tod) echo "acquisition/core hvs" ;;
    sim_devices) echo "acquisition/core hvs tod" ;;
    sim_devices/lab) echo "acquisition/core acquisition/aravis hvs tod sim_devices" ;;
    bench/gui) echo "acquisition hvs tod sim_devices bench" ;;
    bench) echo "acquisition hvs tod sim_devices" ;;
  esac
}

layer_of() {
  case "$1" in
    acquisition/core/*) echo acquisition/core ;;
    acquisition/*/*) echo "${1%/*}" | cut -d/ -f1,2 ;;
    sim_devices/lab/*) echo sim_devices/lab ;;
    bench/gui/*) echo bench/gui ;;
    *) echo "${1%%/*}" ;;
  esac
}

# third-party header pattern | the only folders that may include it (regex)
third_party='arv\.h|arv.*\.h:^(acquisition/aravis|sim_devices/lab)/
linux/videodev2\.h|libudev\.h:^acquisition/v4l2/
libusb\.h|libusb-1\.0/:^acquisition/usb/
Q[A-Z][A-Za-z]*|qcustomplot\.h:^bench/gui/
spdlog/:^bench/
toml\+\+/:^bench/
CLI/:^bench/cli/
fftw3\.h:^hvs/'

find acquisition hvs tod sim_devices bench \( -name '*.h' -o -name '*.cpp' \) 2>/dev/null | sort | {
  bad=0
  while read -r file; do
    layer=$(layer_of "$file")
    may="$layer $(allowed "$layer")"
    while IFS=: read -r line text; do
      [ -z "$line" ] && continue
      path=$(printf '%s' "$text" | sed 's/.*#include *["<]\([^">]*\)[">].*/\1/')
      case "$text" in
        *'"'*)
          ok=0
          for prefix in $may; do case "$path" in "$prefix"/*) ok=1 ;; esac; done
          if [ $ok = 0 ]; then echo "$file:$line: layer $layer may not include \"$path\""; bad=1; fi
          ;;
        *)
          old=$IFS
          IFS='
'
          for rule in $third_party; do
            pattern=${rule%:*}
            home=${rule##*:}
            if printf '%s' "$path" | grep -Eq "^($pattern)" && ! printf '%s' "$file" | grep -Eq "$home"; then
              echo "$file:$line: <$path> belongs to $home only"; bad=1
            fi
          done
          IFS=$old
          ;;
      esac
    done <<EOF
$(grep -nE '^[[:space:]]*#[[:space:]]*include' "$file")
EOF
  done
  exit $bad
}
