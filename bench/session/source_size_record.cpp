// SPDX-License-Identifier: GPL-3.0-or-later
// Size-of-source effect in measures.json.

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "bench/session/measure_row.h"

namespace todbench {
namespace {

void add_source_lines(MeasureLines& out, const CameraMeasures& measures) {
  const SourceSizeMeasure& source = *measures.source;
  const SourceSize& effect = source.effect;
  const std::string of_plate = fmt::format("{} frames of plate {} at {:g} K, twice as many at 0 K", source.frames,
                                           source.plate, source.said_delta_t_k);
  const Estimate loss = effect.loss(source.stated_px);
  out.lines.push_back(measure_line(
      "source_size_loss", loss.value, loss.interval(),
      fmt::format("a square of {:g} px against one of {:.1f} px: {}{}", source.stated_px, effect.reference_px, of_plate,
                  effect.consistent ? ""
                                    : "; apertures and spots deviate from the fitted halo, the interval contains "
                                      "their largest distance")));
  const Estimate slope = source.slope();
  out.lines.push_back(measure_line("transfer_slope_extended", slope.value, slope.interval(),
                                   fmt::format("middle of a square of {:.1f} px: {}", effect.reference_px, of_plate)));
  if (const auto netd = measures.netd_extended_k())
    out.lines.push_back(measure_line("netd_extended", netd->value, netd->interval(),
                                     fmt::format("slope on a square of {:.1f} px", effect.reference_px)));
  if (source.model_loss)
    out.lines.push_back(
        measure_line("source_size_loss_model", *source.model_loss, {},
                     fmt::format("a square of {:g} px in the image of the sensor model", source.stated_px)));
  out.source = source;
}

Json source_json(const SourceSizeMeasure& source) {
  Json points = Json::array(), curve = Json::array();
  for (const SourceSizePoint& point : source.effect.points) {
    points.push_back({{"place", point.place},
                      {"method", point.spot ? "inverse" : "direct"},
                      {"size_px", json_number(point.size_px)},
                      {"ratio", estimate_json(point.ratio)},
                      {"fitted", json_number(point.fitted)}});
  }
  for (std::size_t i = 0; i < source.effect.size_px.size(); ++i)
    curve.push_back(
        {{"size_px", json_number(source.effect.size_px[i])}, {"ratio", estimate_json(source.effect.ratio[i])}});
  return {{"plate", source.plate},
          {"frames", source.frames},
          {"set_delta_t_k", source.set_delta_t_k},
          {"said_delta_t_k", json_number(source.said_delta_t_k)},
          {"stated_px", source.stated_px},
          {"reference_px", json_number(source.effect.reference_px)},
          {"reference_k", json_number(source.effect.reference_k)},
          {"reference_u_k", json_number(source.effect.reference_u_k)},
          {"chi2", json_number(source.effect.chi2)},
          {"degrees_of_freedom", source.effect.degrees_of_freedom},
          {"consistent", source.effect.consistent},
          {"points", points},
          {"curve", curve}};
}

SourceSizeMeasure source_from(const JsonReader& source) {
  SourceSizeMeasure out;
  out.stated_px = source.at("stated_px").number();
  out.effect.reference_px = source.at("reference_px").number();
  for (const JsonReader& point : source.at("points").elements()) {
    out.effect.points.push_back({.place = point.at("place").text(),
                                 .spot = point.at("method").text() == "inverse",
                                 .size_px = point.at("size_px").number(),
                                 .ratio = estimate_from(point.at("ratio")),
                                 .fitted = point.at("fitted").number()});
  }
  for (const JsonReader& place : source.at("curve").elements()) {
    out.effect.size_px.push_back(place.at("size_px").number());
    out.effect.ratio.push_back(estimate_from(place.at("ratio")));
  }
  return out;
}

}  // namespace

MeasureRow source_size_row() {
  return {.key = "source_size",
          .add =
              [](MeasureLines& out, const CameraMeasures& measures) {
                if (measures.source) add_source_lines(out, measures);
              },
          .to_json =
              [](const CameraMeasures& measures) { return measures.source ? source_json(*measures.source) : Json(); },
          .read = [](MeasureLines& out, const JsonReader& part) { out.source = source_from(part); },
          .valid =
              [](const MeasureLines& lines) {
                return !lines.source ||
                       (!lines.source->effect.size_px.empty() &&
                        std::ranges::all_of(lines.source->effect.size_px, [](double size) { return size > 0; }));
              },
          .mistake = "'source_size.curve': expected at least one size, all above 0"};
}

}  // namespace todbench
