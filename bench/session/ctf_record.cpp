// SPDX-License-Identifier: GPL-3.0-or-later
// CTF in measures.json.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "bench/session/measure_row.h"

namespace todbench {
namespace {

void add_ctf_lines(MeasureLines& out, const CtfMeasure& ctf) {
  for (const EdgeAxis axis : {EdgeAxis::x, EdgeAxis::y}) {
    const BarsCtf* group = ctf.stated(axis);
    if (group == nullptr) continue;
    const std::string name(to_string(axis));
    const std::string frames = fmt::format(
        "four bars at {:.4g} cycles per pitch, {:.4g} per mrad, '{}', {:.2f} degrees from the axis: "
        "{} frames of plate {} at {:g} K, {} pixels, {} bars separated at the best phase",
        group->frequency_per_pitch, group->frequency_per_pitch / ctf.pitch_mrad, group->group, group->angle_deg,
        ctf.frames, ctf.plate, ctf.said_delta_t_k, group->pixels, group->bars_separated_at_best);
    const auto add = [&](const std::string& phase, const Estimate& found) {
      out.lines.push_back(measure_line("ctf_" + phase + name, found.value, found.interval(), frames));
    };
    add("", group->best), add("mean_", group->mean), add("worst_", group->worst);
    if (!group->model) continue;
    const std::string closed = fmt::format("closed form of the sensor model for four bars at {:.4g} cycles per pitch",
                                           group->frequency_per_pitch);
    out.lines.push_back(measure_line("ctf_" + name + "_model", group->model->best, {}, closed));
    out.lines.push_back(measure_line("ctf_worst_" + name + "_model", group->model->worst, {}, closed));
  }
  out.ctf = ctf;
}

void bars_model_fields(JsonFields& json, BarsModel& model) {
  json.value("best", model.best);
  json.value("mean", model.mean);
  json.value("worst", model.worst);
}

void bars_group_fields(JsonFields& json, BarsCtf& group, double pitch_mrad) {
  json.value("group", group.group);
  json.value("axis", group.axis, std::array{EdgeAxis::x, EdgeAxis::y});
  json.value("frequency_per_pitch", group.frequency_per_pitch);
  json.derived("frequency_per_mrad", group.frequency_per_pitch / pitch_mrad);
  json.value("angle_deg", group.angle_deg);
  json.derived("middle_px", Interval{group.middle_px.x, group.middle_px.y});
  json.value("pixels", group.pixels);
  json.value("noise_over_contrast", group.noise_over_contrast);
  json.value("best", group.best, estimate_fields);
  json.value("mean", group.mean, estimate_fields);
  json.value("worst", group.worst, estimate_fields);
  json.value("bars_separated_at_best", group.bars_separated_at_best);
  json.value("share_of_four", group.share_of_four);
  json.value("model", group.model, bars_model_fields);
}

void ctf_fields(JsonFields& json, CtfMeasure& ctf) {
  json.derived("plate", ctf.plate);
  json.derived("frames", ctf.frames);
  json.derived("set_delta_t_k", ctf.set_delta_t_k);
  json.derived("said_delta_t_k", ctf.said_delta_t_k);
  json.value("pitch_mrad", ctf.pitch_mrad);
  json.derived("stated_near_per_pitch", ctf.frequency_per_pitch);
  json.derived("contrast_k", ctf.bars.contrast_k);
  json.derived("far_spread", ctf.bars.far_spread);
  json.value("groups", ctf.bars.groups,
             [&](JsonFields& item, BarsCtf& group) { bars_group_fields(item, group, ctf.pitch_mrad); });
}

bool drawable(const CtfMeasure& ctf) {
  const auto& groups = ctf.bars.groups;
  return ctf.pitch_mrad > 0 &&
         std::all_of(groups.begin(), groups.end(), [](const BarsCtf& group) { return group.frequency_per_pitch > 0; });
}

}  // namespace

MeasureRow ctf_row() {
  return {.key = "ctf",
          .add =
              [](MeasureLines& out, const CameraMeasures& measures) {
                if (measures.ctf) add_ctf_lines(out, *measures.ctf);
              },
          .fields = measure_part<&MeasureLines::ctf, ctf_fields>,
          .valid = [](const MeasureLines& lines) { return !lines.ctf || drawable(*lines.ctf); },
          .mistake = "'ctf.groups': expected frequencies and a pitch above 0"};
}

}  // namespace todbench
