#!/bin/sh
# Layering: which folder may include which, which third-party headers belong to which folder, and that a source includes its own header
# first. Usage: check_layering.sh ROOT
# Prints each violation as FILE:LINE: reason; exit 1 when there is one.
cd "$1" || exit 2
find acquisition hvs tod sim_devices bench \( -name '*.h' -o -name '*.cpp' \) 2>/dev/null | sort | xargs awk '
BEGIN {
  # layer: folders of the project that it may include beside itself
  may["acquisition/core"] = ""
  may["acquisition/*"] = "acquisition/"
  may["hvs"] = "acquisition/core/"
  may["tod"] = "acquisition/core/ hvs/"
  may["sim_devices"] = "acquisition/core/ hvs/ tod/"
  may["sim_devices/lab"] = "acquisition/core/ acquisition/aravis/ acquisition/usb/ acquisition/v4l2/ hvs/ tod/ sim_devices/"
  may["bench"] = "acquisition/ hvs/ tod/ sim_devices/"
  may["bench/gui"] = "acquisition/ hvs/ tod/ sim_devices/ bench/"
  # third-party header: the only folders that may include it
  home["^arv"] = "^(acquisition/aravis|sim_devices/lab)/"
  home["^linux/videodev2.h"] = "^(acquisition/v4l2|sim_devices/lab)/"
  home["^libudev.h"] = "^acquisition/v4l2/"
  home["^umockdev.h"] = "^sim_devices/lab/"
  home["^libusb"] = "^acquisition/usb/"
  home["^(Q[A-Z]|qcustomplot.h)"] = "^bench/gui/"
  home["^toml\\+\\+/"] = "^bench/"
  home["^CLI/"] = "^bench/cli/"
  home["^tiffio.h"] = "^acquisition/recording/"
  home["^fftw3.h"] = "^hvs/"
}
function layer_of(file,   parts) {
  split(file, parts, "/")
  if (parts[1] == "acquisition") return parts[2] == "core" ? "acquisition/core" : "acquisition/*"
  if (file ~ /^sim_devices\/lab\//) return "sim_devices/lab"
  if (file ~ /^bench\/gui\//) return "bench/gui"
  return parts[1]
}
FNR == 1 {
  layer = layer_of(FILENAME)
  own = layer == "acquisition/*" ? "acquisition/" : layer "/"
  allowed = split(own " " may[layer], prefixes, " ")
  header = FILENAME
  owed = sub(/\.cpp$/, ".h", header) && (getline line < header) >= 0
  close(header)
}
owed && /^[ \t]*#[ \t]*include/ {
  if (index($0, "\"" header "\"") == 0) { print FILENAME ":" FNR ": the first include is not \"" header "\""; bad = 1 }
  owed = 0
}
/^[ \t]*#[ \t]*include[ \t]*"/ {
  path = $0; sub(/^[^"]*"/, "", path); sub(/".*/, "", path)
  ok = 0
  for (i = 1; i <= allowed; i++) if (index(path, prefixes[i]) == 1) ok = 1
  if (!ok) { print FILENAME ":" FNR ": layer " layer " may not include \"" path "\""; bad = 1 }
}
/^[ \t]*#[ \t]*include[ \t]*</ {
  path = $0; sub(/^[^<]*</, "", path); sub(/>.*/, "", path)
  for (pattern in home) if (path ~ pattern && FILENAME !~ home[pattern]) {
    print FILENAME ":" FNR ": <" path "> belongs to " home[pattern] " only"; bad = 1
  }
}
END { exit bad }'
status=$?
# xargs reports 123 when awk found a violation
[ $status -eq 0 ] || exit 1
