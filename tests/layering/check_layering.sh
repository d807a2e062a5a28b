#!/bin/sh
# Layering: which folder may include which, which third-party headers belong to which folder, and that a source includes its own header
# first. Usage: check_layering.sh ROOT
# Prints each violation as FILE:LINE: reason; exit 1 when there is one.
cd "$1" || exit 2
find acquisition hvs tod sim_devices bench \( -name '*.h' -o -name '*.cpp' \) 2>/dev/null | sort | xargs awk '
BEGIN {
  # library (a folder): the libraries that it may include beside itself
  core = "acquisition/core"
  may["acquisition/core"] = ""
  may["acquisition/pixel_formats"] = core
  may["acquisition/recording"] = core " acquisition/pixel_formats"
  may["acquisition/description"] = core
  may["acquisition/aravis"] = core " acquisition/pixel_formats acquisition/description"
  may["acquisition/v4l2"] = core " acquisition/pixel_formats"
  may["acquisition/usb"] = core " acquisition/pixel_formats"
  may["hvs/shape"] = core
  may["hvs/observer"] = core " hvs/shape"
  hvs = core " hvs/shape hvs/observer"
  may["tod/plate"] = hvs
  may["tod/pattern"] = hvs " tod/plate"
  may["tod/presentation"] = core " tod/plate"
  may["tod/registration"] = hvs " tod/plate"
  may["tod/psychometric"] = core " tod/presentation"
  may["tod/schedule"] = core " tod/plate tod/presentation tod/psychometric"
  may["tod/measurement"] = hvs " tod/plate tod/presentation tod/psychometric tod/registration tod/schedule tod/measures"
  may["tod/camera_measures"] = hvs " tod/plate tod/presentation tod/registration tod/schedule tod/measurement tod/measures tod/range"
  may["tod/comparison"] = core " tod/psychometric"
  may["tod/adequacy"] = core " tod/psychometric"
  may["tod/observer_fit"] = hvs " tod/plate tod/psychometric"
  may["tod/range"] = core " hvs/shape tod/psychometric"
  may["tod/measures"] = core
  may["tod/instruments"] = core " tod/plate tod/presentation"
  tod = hvs " tod/plate tod/pattern tod/presentation tod/registration tod/psychometric tod/schedule tod/measurement tod/comparison tod/adequacy tod/observer_fit tod/range tod/measures tod/camera_measures"
  may["sim_devices/scene"] = hvs " tod/plate sim_devices/atmosphere"
  may["sim_devices/atmosphere"] = core " tod/range"
  may["sim_devices/module"] = hvs
  may["sim_devices/sensor"] = hvs " tod/plate tod/presentation sim_devices/atmosphere sim_devices/scene sim_devices/module"
  may["sim_devices/prediction"] = tod " sim_devices/scene sim_devices/module sim_devices/sensor"
  may["sim_devices/lab/device_nodes"] = core
  may["sim_devices/lab/instruments"] = core " tod/plate tod/presentation tod/instruments"
  may["sim_devices/lab/genicam"] = core " acquisition/pixel_formats"
  may["sim_devices/lab/gige"] = core " acquisition/aravis acquisition/pixel_formats sim_devices/lab/genicam"
  may["sim_devices/lab/video"] = core " acquisition/v4l2 acquisition/pixel_formats sim_devices/lab/device_nodes"
  may["sim_devices/lab/usb"] = core " acquisition/usb acquisition/pixel_formats sim_devices/lab/device_nodes sim_devices/lab/genicam sim_devices/lab/video"
  lab = "sim_devices/lab/device_nodes sim_devices/lab/genicam sim_devices/lab/instruments sim_devices/lab/gige sim_devices/lab/video sim_devices/lab/usb"
  may["sim_devices/lab"] = core " acquisition/aravis acquisition/v4l2 tod/plate sim_devices/scene sim_devices/sensor " lab
  science = tod " sim_devices/scene sim_devices/module sim_devices/atmosphere sim_devices/sensor sim_devices/prediction"
  may["bench/text"] = core " tod/psychometric"
  may["bench/plan"] = science " tod/instruments bench/text"
  may["bench/judgement"] = science " bench/text bench/plan"
  may["bench/session"] = science " bench/text bench/plan bench/judgement"
  may["bench/report"] = science " bench/text bench/plan bench/judgement bench/session"
  devices = "acquisition/recording acquisition/aravis acquisition/v4l2 acquisition/usb tod/instruments sim_devices/lab"
  may["bench/reference_set"] = science " acquisition/recording bench/text bench/plan bench/judgement bench/session"
  may["bench/observer_fit"] = science " bench/text bench/plan bench/judgement bench/session bench/report"
  may["bench/run"] = science " " devices " bench/text bench/plan bench/judgement bench/session bench/report"
  may["bench/studies"] = science " sim_devices/lab bench/text bench/plan bench/judgement bench/session bench/report bench/run"
  may["bench/history"] = core " bench/text bench/plan bench/judgement bench/session"
  may["bench/serve"] = science " bench/text bench/plan bench/judgement bench/session bench/report bench/run"
  may["bench/sweep"] = science " bench/text bench/plan bench/judgement bench/session bench/report bench/run"
  may["bench/doctor"] = core " bench/text"
  may["bench/enhance"] = science " bench/text bench/plan bench/judgement bench/session bench/report bench/run"
  bench = "bench/text bench/plan bench/judgement bench/session bench/report bench/observer_fit bench/reference_set bench/run bench/serve bench/studies bench/sweep bench/enhance bench/history"
  may["bench/cli"] = science " acquisition/recording tod/instruments bench/doctor " bench
  may["bench/gui/presenters"] = science " " bench
  may["bench/gui/views"] = science " " bench " bench/gui/presenters"
  may["bench/gui"] = science " " bench " bench/gui/presenters bench/gui/views"
  # third-party header: the only folders that may include it
  home["^arv"] = "^(acquisition/aravis|sim_devices/lab/gige)/"
  home["^linux/videodev2.h"] = "^(acquisition/v4l2|sim_devices/lab/video)/"
  home["^libudev.h"] = "^acquisition/v4l2/"
  home["^umockdev.h"] = "^sim_devices/lab/(device_nodes|video|usb)/"
  home["^libusb"] = "^acquisition/(aravis|usb)/"
  home["^(Q[A-Z]|qcustomplot.h)"] = "^bench/gui/"
  home["^toml\\+\\+/"] = "^bench/(plan|sweep)/"
  home["^httplib.h"] = "^bench/serve/"
  home["^sqlite3.h"] = "^bench/(history|sweep)/"
  home["^CLI/"] = "^bench/cli/"
  home["^libxml/"] = "^acquisition/description/"
  home["^tiffio.h"] = "^(acquisition/recording|bench/text)/"
  home["^png.h"] = "^bench/text/"
  home["^fftw3.h"] = "^hvs/shape/"
}
function folder_of(path) {
  sub(/\/[^\/]*$/, "", path)
  return path
}
FNR == 1 {
  library = folder_of(FILENAME)
  if (!(library in may)) { print FILENAME ": " library " has no line in the layering check"; bad = 1 }
  allowed = split(library " " may[library], folders, " ")
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
  for (i = 1; i <= allowed; i++) if (folder_of(path) == folders[i]) ok = 1
  if (!ok) { print FILENAME ":" FNR ": " library " may not include \"" path "\""; bad = 1 }
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
