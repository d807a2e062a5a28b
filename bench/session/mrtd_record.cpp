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

/// Shares of correct decisions at a contrast.
struct MrtdShares {
  double delta_t_k = 0, positive = 0, negative = 0;
};
void mrtd_shares_fields(JsonFields& json, MrtdShares& shares) {
  json.value("delta_t_k", shares.delta_t_k);
  json.value("positive", shares.positive);
  json.value("negative", shares.negative);
}

std::vector<MrtdShares> mrtd_shares(const MrtdMeasure& mrtd, const MrtdPoint& point) {
  std::vector<MrtdShares> shares;
  for (std::size_t i = 0; i < std::min(point.positive_share.size(), point.negative_share.size()); ++i)
    shares.push_back({mrtd.contrast_k[i], point.positive_share[i], point.negative_share[i]});
  return shares;
}

void mrtd_point_fields(JsonFields& json, const MrtdMeasure& mrtd, MrtdPoint& point) {
  json.value("place", point.place);
  json.value("axis", point.axis, std::array{EdgeAxis::x, EdgeAxis::y});
  json.value("frequency_per_pitch", point.frequency_per_pitch);
  json.derived("frequency_per_mrad", point.frequency_per_pitch / mrtd.pitch_mrad);
  json.value("size_px", point.size_px);
  json.value("positive_k", point.positive_k);
  json.value("negative_k", point.negative_k);
  json.value("threshold_k", point.threshold_k);
  json.value("ci95_k", point.ci95);
  json.value("best_phase_k", point.best_phase_k);
  json.value("best_phase_ci95_k", point.best_phase_ci95);
  json.value("best_phase_px", point.best_phase);
  json.text_or_null("reason", point.reason);
  json.derived("proportion_correct", mrtd_shares(mrtd, point), mrtd_shares_fields);
  spread_if_any(json, "threshold_spread_k", point.spread_k);
}

void mrtd_fields(JsonFields& json, MrtdMeasure& mrtd) {
  const auto point = [&](JsonFields& item, MrtdPoint& at) { mrtd_point_fields(item, mrtd, at); };
  json.value("plate", mrtd.plate);
  json.value("observer", mrtd.observer);
  json.value("frames", mrtd.frames);
  json.value("set_ups", mrtd.set_ups);
  json.value("mountings", mrtd.mountings);
  json.value("pitch_mrad", mrtd.pitch_mrad);
  json.derived("stated_near_per_pitch", mrtd.frequency_per_pitch);
  json.derived("stated_spot_px", mrtd.spot_px);
  json.value("bars", mrtd.bars, point);
  json.value("spots", mrtd.spots, point);
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
          .fields = measure_part<&MeasureLines::mrtd, mrtd_fields>,
          .valid = [](const MeasureLines& lines) { return !lines.mrtd || drawable(*lines.mrtd); },
          .mistake = "'mrtd.bars': expected frequencies, thresholds and a pitch above 0"};
}

}  // namespace todbench
