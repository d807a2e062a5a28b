// SPDX-License-Identifier: GPL-3.0-or-later
// Size-of-source effect in measures.json.

#include <fmt/format.h>

#include <algorithm>
#include <string>

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

void source_point_fields(JsonFields& json, SourceSizePoint& point) {
  std::string method = point.spot ? "inverse" : "direct";
  json.value("place", point.place);
  json.value("method", method);
  json.value("size_px", point.size_px);
  json.value("ratio", point.ratio, estimate_fields);
  json.value("fitted", point.fitted);
  point.spot = method == "inverse";
}

/// A point of the curve.
struct SourceRatio {
  double size_px = 0;
  Estimate ratio{};
};
void source_ratio_fields(JsonFields& json, SourceRatio& at) {
  json.value("size_px", at.size_px);
  json.value("ratio", at.ratio, estimate_fields);
}

void source_fields(JsonFields& json, SourceSizeMeasure& source) {
  SourceSize& effect = source.effect;
  std::vector<SourceRatio> curve;
  for (std::size_t i = 0; i < effect.size_px.size(); ++i) curve.push_back({effect.size_px[i], effect.ratio[i]});
  json.derived("plate", source.plate);
  json.derived("frames", source.frames);
  json.derived("set_delta_t_k", source.set_delta_t_k);
  json.derived("said_delta_t_k", source.said_delta_t_k);
  json.value("stated_px", source.stated_px);
  json.value("reference_px", effect.reference_px);
  json.derived("reference_k", effect.reference_k);
  json.derived("reference_u_k", effect.reference_u_k);
  json.derived("chi2", effect.chi2);
  json.derived("degrees_of_freedom", effect.degrees_of_freedom);
  json.derived("consistent", effect.consistent);
  json.value("points", effect.points, source_point_fields);
  json.value("curve", curve, source_ratio_fields);
  if (!json.reading()) return;
  for (const SourceRatio& at : curve) effect.size_px.push_back(at.size_px), effect.ratio.push_back(at.ratio);
}

}  // namespace

MeasureRow source_size_row() {
  return {.key = "source_size",
          .add =
              [](MeasureLines& out, const CameraMeasures& measures) {
                if (measures.source) add_source_lines(out, measures);
              },
          .fields = measure_part<&MeasureLines::source, source_fields>,
          .valid =
              [](const MeasureLines& lines) {
                return !lines.source ||
                       (!lines.source->effect.size_px.empty() &&
                        std::ranges::all_of(lines.source->effect.size_px, [](double size) { return size > 0; }));
              },
          .mistake = "'source_size.curve': expected at least one size, all above 0"};
}

}  // namespace todbench
