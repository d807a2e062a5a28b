// SPDX-License-Identifier: GPL-3.0-or-later
// Times of frames and latency in measures.json.
#include <fmt/format.h>

#include <string>

#include "bench/session/measure_row.h"

namespace todbench {
namespace {

void add_timing(MeasureLines& out, const TimingMeasure& timing) {
  const std::string conditions =
      fmt::format("{} frames, {}", timing.frames, timing.device_clock ? "clock of the camera" : "times of arrival");
  out.lines.push_back(measure_line("frame_rate", timing.rate_hz.value, timing.rate_hz.interval(), conditions));
  out.lines.push_back(
      measure_line("frame_jitter", timing.jitter_ms.value, timing.jitter_ms.interval(),
                   fmt::format("{}; largest deviation {:.3g} ms", conditions, timing.largest_deviation_ms)));
  const auto lost = static_cast<double>(timing.lost);
  out.lines.push_back(measure_line("lost_frames", lost, {.low = lost, .high = lost},
                                   fmt::format("{}; longest gap {} frames", conditions, timing.longest_gap)));
}

Json timing_json(const TimingMeasure& timing) {
  return {{"frames", timing.frames},
          {"device_clock", timing.device_clock},
          {"stated_rate_hz", json_number(timing.stated_rate_hz)},
          {"largest_deviation_ms", json_number(timing.largest_deviation_ms)},
          {"arrival_ms", json_number(timing.arrival_ms)},
          {"lost", timing.lost},
          {"longest_gap", timing.longest_gap}};
}

void latency_fields(JsonFields& json, LatencyMeasure& latency) {
  json.derived("speed_mm_s", latency.speed_mm_s);
  json.derived("runs_ms", latency.runs_ms);
  if (json.reading() && !json.has("frames_ms")) return;  // records of earlier versions have no frames
  json.value("frames_ms", latency.frames_ms);
  json.value("latency_ms", latency.latency_ms, estimate_fields);
}

}  // namespace

MeasureRow timing_row() {
  return {.key = "timing",
          .add =
              [](MeasureLines& out, const CameraMeasures& measures) {
                if (measures.timing) add_timing(out, *measures.timing);
              },
          .to_json =
              [](const CameraMeasures& measures) { return measures.timing ? timing_json(*measures.timing) : Json(); }};
}

MeasureRow latency_row() {
  return {.key = "latency",
          .add =
              [](MeasureLines& out, const CameraMeasures& measures) {
                if (!measures.latency) return;
                const LatencyMeasure& latency = *measures.latency;
                out.lines.push_back(measure_line("latency", latency.latency_ms.value, latency.latency_ms.interval(),
                                                 fmt::format("{} runs of the stage at {:.4g} mm/s, with the time "
                                                             "constant and half of the exposure of the detector",
                                                             latency.runs_ms.size(), latency.speed_mm_s)));
                out.latency = latency;
              },
          .fields = measure_part<&MeasureLines::latency, latency_fields>};
}

}  // namespace todbench
