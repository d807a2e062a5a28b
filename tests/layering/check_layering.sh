#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Layering: which folder may include which, which third-party headers belong to which folder, and that a source includes its own header
# first. Usage: check_layering.sh ROOT
# Prints each violation as FILE:LINE: reason; exit 1 when there is one.
cd "$1" || exit 2
find acquisition hvs tod sim_devices bench \( -name '*.h' -o -name '*.cpp' \) 2>/dev/null | sort | xargs awk '
BEGIN {
  # library (a folder): the libraries that it may include beside itself
  base = "acquisition/base"
  may["acquisition/base"] = ""
  core = base " acquisition/core"
  may["acquisition/core"] = base
  may["acquisition/pixel_formats"] = base
  may["acquisition/compression"] = base
  may["acquisition/recording"] = core " acquisition/pixel_formats acquisition/compression"
  may["acquisition/description"] = base
  may["acquisition/aravis"] = core " acquisition/pixel_formats acquisition/description"
  may["acquisition/v4l2"] = core " acquisition/pixel_formats"
  may["acquisition/usb"] = core " acquisition/pixel_formats"
  may["hvs/shape"] = base
  may["hvs/eye"] = base
  may["hvs/observer"] = base " hvs/shape hvs/eye"
  hvs = base " hvs/shape hvs/eye hvs/observer"
  may["tod/plate"] = hvs
  may["tod/pattern"] = hvs " tod/plate"
  may["tod/presentation"] = base " tod/plate"
  may["tod/registration"] = hvs " tod/plate"
  may["tod/psychometric"] = base " tod/presentation"
  may["tod/schedule"] = base " tod/plate tod/presentation tod/psychometric"
  may["tod/measurement"] = core " " hvs " tod/plate tod/presentation tod/psychometric tod/registration tod/schedule tod/measures"
  may["tod/camera_measures"] = core " " hvs " tod/plate tod/presentation tod/registration tod/schedule tod/measurement tod/measures tod/range"
  may["tod/comparison"] = base " tod/psychometric"
  may["tod/adequacy"] = base " tod/psychometric tod/presentation"
  may["tod/observer_fit"] = hvs " tod/plate tod/psychometric"
  may["tod/range"] = base " hvs/shape hvs/observer tod/psychometric"
  may["tod/measures"] = base
  may["tod/instruments"] = base " tod/plate tod/presentation"
  tod = hvs " tod/plate tod/pattern tod/presentation tod/registration tod/psychometric tod/schedule tod/measurement tod/comparison tod/adequacy tod/observer_fit tod/range tod/measures tod/camera_measures"
  may["sim_devices/scene"] = hvs " tod/plate sim_devices/atmosphere"
  may["sim_devices/atmosphere"] = base " tod/range"
  may["sim_devices/module"] = hvs
  may["sim_devices/sensor"] = core " " hvs " tod/plate tod/presentation tod/registration sim_devices/atmosphere sim_devices/scene sim_devices/module"
  may["sim_devices/prediction"] = core " " tod " sim_devices/scene sim_devices/module sim_devices/sensor"
  may["sim_devices/lab/device_nodes"] = base
  may["sim_devices/lab/instruments"] = base " tod/plate tod/presentation tod/instruments"
  may["sim_devices/lab/genicam"] = core " acquisition/pixel_formats"
  may["sim_devices/lab/gige"] = core " acquisition/aravis acquisition/pixel_formats sim_devices/lab/genicam"
  may["sim_devices/lab/video"] = base " acquisition/v4l2 acquisition/pixel_formats sim_devices/lab/device_nodes"
  may["sim_devices/lab/usb"] = core " acquisition/usb acquisition/pixel_formats sim_devices/lab/device_nodes sim_devices/lab/genicam sim_devices/lab/video"
  lab = "sim_devices/lab/device_nodes sim_devices/lab/genicam sim_devices/lab/instruments sim_devices/lab/gige sim_devices/lab/video sim_devices/lab/usb"
  may["sim_devices/lab"] = core " acquisition/aravis acquisition/v4l2 tod/plate sim_devices/atmosphere sim_devices/scene sim_devices/sensor " lab
  science = tod " sim_devices/scene sim_devices/module sim_devices/atmosphere sim_devices/sensor sim_devices/prediction"
  may["bench/text"] = base " tod/psychometric"
  may["bench/picture_files"] = base
  may["bench/plan"] = core " " science " tod/instruments bench/text"
  may["bench/range"] = core " " science " bench/text bench/plan"
  may["bench/judgement"] = science " bench/text bench/plan"
  may["bench/session"] = core " " science " bench/text bench/picture_files bench/plan bench/judgement"
  may["bench/report"] = core " " science " bench/text bench/plan bench/judgement bench/session"
  may["bench/plate_drawing"] = hvs " tod/plate"
  devices = "acquisition/recording acquisition/aravis acquisition/v4l2 acquisition/usb tod/instruments sim_devices/lab"
  may["bench/round_robin"] = core " " science " acquisition/recording bench/text bench/plan bench/judgement bench/session bench/report bench/reference_set bench/history"
  may["bench/reference_set"] = science " acquisition/recording bench/text bench/plan bench/judgement bench/session"
  may["bench/selftest"] = science " bench/judgement bench/reference_set"
  may["bench/observer_fit"] = science " bench/text bench/plan bench/judgement bench/session bench/report"
  may["bench/naked_eye"] = science " bench/text bench/plan bench/judgement bench/session bench/report bench/observer_fit"
  may["bench/certificate"] = base " tod/psychometric bench/text bench/plan bench/judgement bench/session bench/report"
  may["bench/devices"] = core " " science " " devices " bench/text bench/plan bench/judgement bench/session"
  may["bench/twin"] = core " " science " bench/text bench/plan bench/judgement bench/session bench/devices"
  may["bench/forecast"] = core " " science " bench/text bench/plan bench/judgement bench/session bench/report bench/devices bench/twin"
  may["bench/run"] = core " " science " acquisition/recording bench/text bench/plan bench/judgement bench/session bench/report bench/devices bench/twin bench/forecast"
  may["bench/studies"] = core " " science " acquisition/recording sim_devices/lab bench/text bench/plan bench/range bench/judgement bench/session bench/report bench/devices bench/twin bench/forecast bench/run"
  may["bench/history"] = core " bench/text bench/plan bench/judgement bench/session"
  may["bench/serve"] = core " " science " bench/text bench/picture_files bench/plan bench/judgement bench/session bench/report bench/devices bench/twin bench/forecast bench/run"
  may["bench/run_control"] = core " " science " bench/text bench/plan bench/judgement bench/session bench/report bench/devices bench/twin bench/forecast bench/run bench/serve"
  may["bench/sweep"] = science " bench/text bench/plan bench/judgement bench/session bench/report bench/devices bench/twin bench/forecast bench/run bench/studies"
  may["bench/doctor"] = base " bench/text"
  may["bench/enhance"] = core " " science " bench/text bench/picture_files bench/plan bench/judgement bench/session bench/report bench/devices bench/twin bench/forecast bench/run"
  may["bench/moving_target"] = core " " science " bench/text bench/plan bench/judgement bench/session bench/report bench/devices bench/twin bench/forecast bench/run bench/enhance"
  may["bench/scene_dependence"] = core " " science " bench/text bench/plan bench/judgement bench/session bench/report bench/devices bench/twin bench/forecast bench/run bench/enhance"
  may["bench/model_comparison"] = core " " science " bench/text bench/plan bench/judgement bench/session bench/report bench/devices bench/twin bench/forecast bench/run bench/enhance"
  bench = "bench/text bench/picture_files bench/plan bench/range bench/judgement bench/session bench/report bench/certificate bench/observer_fit bench/naked_eye bench/reference_set bench/selftest bench/plate_drawing bench/devices bench/twin bench/forecast bench/run bench/serve bench/run_control bench/studies bench/sweep bench/enhance bench/moving_target bench/scene_dependence bench/model_comparison bench/history bench/round_robin"
  may["bench/cli"] = core " " science " acquisition/recording tod/instruments bench/doctor " bench
  may["bench/python"] = core " " science " acquisition/recording " bench
  may["bench/gui/presenters"] = core " " science " acquisition/recording " bench
  may["bench/gui/views"] = science " " bench " bench/gui/presenters"
  may["bench/gui"] = science " " bench " bench/gui/presenters bench/gui/views"
  # third-party header: the only folders that may include it
  home["^arv"] = "^(acquisition/aravis|sim_devices/lab/gige)/"
  home["^linux/videodev2.h"] = "^(acquisition/v4l2|sim_devices/lab/video)/"
  home["^libudev.h"] = "^acquisition/v4l2/"
  home["^umockdev.h"] = "^sim_devices/lab/(device_nodes|video|usb)/"
  home["^libusb"] = "^acquisition/(aravis|usb)/"
  home["^(Q[A-Z]|qcustomplot.h)"] = "^bench/gui/"
  home["^(pybind11/|Python.h|numpy/)"] = "^bench/python/"
  home["^toml\\+\\+/"] = "^bench/(plan|sweep)/"
  home["^httplib.h"] = "^bench/(serve|run_control)/"
  home["^sqlite3.h"] = "^bench/(history|sweep)/"
  home["^CLI/"] = "^bench/cli/"
  home["^libxml/"] = "^acquisition/description/"
  home["^tiffio.h"] = "^(acquisition/recording|bench/picture_files)/"
  home["^png.h"] = "^(acquisition/compression|bench/picture_files)/"
  home["^charls/"] = "^acquisition/compression/"
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
