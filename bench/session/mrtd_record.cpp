// SPDX-License-Identifier: GPL-3.0-or-later
// MRTD and MDTD in measures.json.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "bench/session/measure_row.h"
#include "bench/text/spread_text.h"

namespace todbench {
namespace {

std::string mrtd_conditions(const MrtdMeasure& mrtd, const std::string& place) {
  return fmt::format(
      "{}: plate {}, observer {}, {} contrasts of both polarities, {} frames at each of {} set-ups in {} "
      "mounting(s)",
      place, mrtd.plate, mrtd.observer, mrtd.contrast_k.size(), mrtd.frames, mrtd.set_ups, mrtd.mountings);
}

std::string bars_words(const MrtdMeasure& mrtd, const MrtdPoint& point) {
  return fmt::format("bars at {:.4g} cycles per pitch, {:.4g} per mrad, '{}'", point.frequency_per_pitch,
                     point.frequency_per_pitch / mrtd.pitch_mrad, point.place);
}

std::string with_spread(const std::string& words, const std::optional<std::pair<double, double>>& spread_k) {
  return spread_k ? words + "; " + spread_in_words(*spread_k, "K") : words;
}

std::string with_reason(const std::string& words, const MrtdPoint& point) {
  return with_spread(point.reason.empty() ? words : words + "; " + point.reason, point.spread_k);
}

std::optional<std::pair<double, double>> spread_of_mean(const MrtdPoint& x, const MrtdPoint& y) {
  if (!x.spread_k || !y.spread_k) return std::nullopt;
  return std::pair(0.5 * (x.spread_k->first + y.spread_k->first), 0.5 * (x.spread_k->second + y.spread_k->second));
}

/// The axes have other bars at other phases, so that their errors are independent. Precondition: both have a threshold.
Interval interval_of_mean(double mean, const MrtdPoint& x, const MrtdPoint& y) {
  const auto apart = [&](std::optional<double> Interval::*end) -> std::optional<double> {
    if (!(x.ci95.*end) || !(y.ci95.*end)) return std::nullopt;
    return 0.5 * std::hypot(*(x.ci95.*end) - *x.threshold_k, *(y.ci95.*end) - *y.threshold_k);
  };
  const auto below = apart(&Interval::low), above = apart(&Interval::high);
  return {below ? std::optional(mean - *below) : std::nullopt, above ? std::optional(mean + *above) : std::nullopt};
}

void add_mrtd_lines(MeasureLines& out, const MrtdMeasure& mrtd) {
  for (const EdgeAxis axis : {EdgeAxis::x, EdgeAxis::y}) {
    const MrtdPoint* point = mrtd.stated(axis);
    if (point == nullptr) continue;
    const std::string name(to_string(axis)), words = mrtd_conditions(mrtd, bars_words(mrtd, *point));
    out.lines.push_back(measure_line("mrtd_" + name, point->threshold_k, point->ci95, with_reason(words, *point)));
    if (!point->best_phase_k) continue;
    out.lines.push_back(measure_line(
        "mrtd_best_phase_" + name, point->best_phase_k, point->best_phase_ci95,
        words + fmt::format("; middle of the bars {:.2g} pixels from a border of pixels", point->best_phase)));
  }
  const MrtdPoint *x = mrtd.stated(EdgeAxis::x), *y = mrtd.stated(EdgeAxis::y);
  if (x != nullptr && y != nullptr && x->threshold_k && y->threshold_k) {
    const double mean = 0.5 * (*x->threshold_k + *y->threshold_k);
    out.lines.push_back(
        measure_line("mrtd_mean", mean, interval_of_mean(mean, *x, *y),
                     with_spread(mrtd_conditions(mrtd, "mean of mrtd_x and mrtd_y"), spread_of_mean(*x, *y))));
  }
  if (const MrtdPoint* spot = mrtd.stated_spot()) {
    const std::string words =
        mrtd_conditions(mrtd, fmt::format("square spot of {:.3g} px, '{}'", spot->size_px, spot->place));
    out.lines.push_back(measure_line("mdtd", spot->threshold_k, spot->ci95, with_reason(words, *spot)));
  }
  out.mrtd = mrtd;
}

Json point_json(const MrtdMeasure& mrtd, const MrtdPoint& point) {
  Json shares = Json::array();
  for (std::size_t i = 0; i < std::min(point.positive_share.size(), point.negative_share.size()); ++i) {
    shares.push_back({{"delta_t_k", json_number(mrtd.contrast_k[i])},
                      {"positive", json_number(point.positive_share[i])},
                      {"negative", json_number(point.negative_share[i])}});
  }
  Json json{{"place", point.place},
            {"axis", to_string(point.axis)},
            {"frequency_per_pitch", json_number(point.frequency_per_pitch)},
            {"frequency_per_mrad", json_number(point.frequency_per_pitch / mrtd.pitch_mrad)},
            {"size_px", json_number(point.size_px)},
            {"positive_k", json_number(point.positive_k)},
            {"negative_k", json_number(point.negative_k)},
            {"threshold_k", json_number(point.threshold_k)},
            {"ci95_k", json_interval(point.ci95)},
            {"best_phase_k", json_number(point.best_phase_k)},
            {"best_phase_ci95_k", json_interval(point.best_phase_ci95)},
            {"best_phase_px", json_number(point.best_phase)},
            {"reason", point.reason.empty() ? Json() : Json(point.reason)},
            {"proportion_correct", shares}};
  add_spread(json, "threshold_spread_k", point.spread_k);
  return json;
}

Json mrtd_json(const MrtdMeasure& mrtd) {
  Json bars = Json::array(), spots = Json::array();
  for (const MrtdPoint& point : mrtd.bars) bars.push_back(point_json(mrtd, point));
  for (const MrtdPoint& point : mrtd.spots) spots.push_back(point_json(mrtd, point));
  return {{"plate", mrtd.plate},
          {"observer", mrtd.observer},
          {"frames", mrtd.frames},
          {"set_ups", mrtd.set_ups},
          {"mountings", mrtd.mountings},
          {"pitch_mrad", mrtd.pitch_mrad},
          {"stated_near_per_pitch", mrtd.frequency_per_pitch},
          {"stated_spot_px", mrtd.spot_px},
          {"bars", bars},
          {"spots", spots}};
}

Interval interval_from(const JsonReader& from) {
  const auto ends = from.elements();
  if (ends.size() != 2) return {};
  return {ends[0].optional_number(), ends[1].optional_number()};
}

MrtdPoint point_from(const JsonReader& from) {
  MrtdPoint point;
  point.place = from.at("place").text();
  point.axis = from.at("axis").named(std::array{EdgeAxis::x, EdgeAxis::y});
  point.frequency_per_pitch = from.at("frequency_per_pitch").number();
  point.size_px = from.at("size_px").number();
  point.positive_k = from.at("positive_k").optional_number();
  point.negative_k = from.at("negative_k").optional_number();
  point.threshold_k = from.at("threshold_k").optional_number();
  point.ci95 = interval_from(from.at("ci95_k"));
  point.best_phase_k = from.at("best_phase_k").optional_number();
  point.best_phase_ci95 = interval_from(from.at("best_phase_ci95_k"));
  point.best_phase = from.at("best_phase_px").number();
  if (const JsonReader ends = from.at_if_there("threshold_spread_k"); !ends.is_null()) {
    const Interval spread = interval_from(ends);
    if (spread.low && spread.high) point.spread_k = std::pair(*spread.low, *spread.high);
  }
  if (const JsonReader reason = from.at("reason"); !reason.is_null()) point.reason = reason.text();
  return point;
}

MrtdMeasure mrtd_from(const JsonReader& from) {
  MrtdMeasure out;
  out.plate = from.at("plate").text();
  out.observer = from.at("observer").text();
  out.frames = static_cast<int>(from.at("frames").whole());
  out.set_ups = static_cast<int>(from.at("set_ups").whole());
  out.mountings = static_cast<int>(from.at("mountings").whole());
  out.pitch_mrad = from.at("pitch_mrad").number();
  for (const JsonReader& one : from.at("bars").elements()) out.bars.push_back(point_from(one));
  for (const JsonReader& one : from.at("spots").elements()) out.spots.push_back(point_from(one));
  return out;
}

bool drawable(const MrtdMeasure& mrtd) {
  const auto positive = [](const std::optional<double>& value) { return !value || *value > 0; };
  return mrtd.pitch_mrad > 0 && std::ranges::all_of(mrtd.bars, [&](const MrtdPoint& one) {
           return one.frequency_per_pitch > 0 && positive(one.threshold_k) && positive(one.best_phase_k);
         });
}

}  // namespace

MeasureRow mrtd_row() {
  return {.key = "mrtd",
          .add =
              [](MeasureLines& out, const CameraMeasures& measures) {
                if (measures.mrtd) add_mrtd_lines(out, *measures.mrtd);
              },
          .to_json = [](const CameraMeasures& measures) { return measures.mrtd ? mrtd_json(*measures.mrtd) : Json(); },
          .read = [](MeasureLines& out, const JsonReader& part) { out.mrtd = mrtd_from(part); },
          .valid = [](const MeasureLines& lines) { return !lines.mrtd || drawable(*lines.mrtd); },
          .mistake = "'mrtd.bars': expected frequencies, thresholds and a pitch above 0"};
}

}  // namespace todbench
