// SPDX-License-Identifier: GPL-3.0-or-later
// CTF in measures.json.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

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

Json ctf_json(const CtfMeasure& ctf) {
  Json groups = Json::array();
  for (const BarsCtf& group : ctf.bars.groups) {
    Json model;
    if (group.model) {
      model = {{"best", json_number(group.model->best)},
               {"mean", json_number(group.model->mean)},
               {"worst", json_number(group.model->worst)}};
    }
    groups.push_back({{"group", group.group},
                      {"axis", to_string(group.axis)},
                      {"frequency_per_pitch", json_number(group.frequency_per_pitch)},
                      {"frequency_per_mrad", json_number(group.frequency_per_pitch / ctf.pitch_mrad)},
                      {"angle_deg", json_number(group.angle_deg)},
                      {"middle_px", {json_number(group.middle_px.x), json_number(group.middle_px.y)}},
                      {"pixels", group.pixels},
                      {"noise_over_contrast", json_number(group.noise_over_contrast)},
                      {"best", estimate_json(group.best)},
                      {"mean", estimate_json(group.mean)},
                      {"worst", estimate_json(group.worst)},
                      {"bars_separated_at_best", group.bars_separated_at_best},
                      {"share_of_four", json_number(group.share_of_four)},
                      {"model", model}});
  }
  return {{"plate", ctf.plate},
          {"frames", ctf.frames},
          {"set_delta_t_k", ctf.set_delta_t_k},
          {"said_delta_t_k", json_number(ctf.said_delta_t_k)},
          {"pitch_mrad", ctf.pitch_mrad},
          {"stated_near_per_pitch", ctf.frequency_per_pitch},
          {"contrast_k", json_number(ctf.bars.contrast_k)},
          {"far_spread", json_number(ctf.bars.far_spread)},
          {"groups", groups}};
}

CtfMeasure ctf_from(const JsonReader& ctf) {
  CtfMeasure out;
  out.pitch_mrad = ctf.at("pitch_mrad").number();
  for (const JsonReader& group : ctf.at("groups").elements()) {
    BarsCtf one;
    one.group = group.at("group").text();
    one.axis = group.at("axis").named(std::array{EdgeAxis::x, EdgeAxis::y});
    one.frequency_per_pitch = group.at("frequency_per_pitch").number();
    one.angle_deg = group.at("angle_deg").number();
    one.pixels = static_cast<int>(group.at("pixels").whole());
    one.noise_over_contrast = group.at("noise_over_contrast").number();
    one.best = estimate_from(group.at("best"));
    one.mean = estimate_from(group.at("mean"));
    one.worst = estimate_from(group.at("worst"));
    one.bars_separated_at_best = static_cast<int>(group.at("bars_separated_at_best").whole());
    one.share_of_four = group.at("share_of_four").number();
    const JsonReader model = group.at("model");
    if (!model.is_null())
      one.model = BarsModel{model.at("best").number(), model.at("mean").number(), model.at("worst").number()};
    out.bars.groups.push_back(std::move(one));
  }
  return out;
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
          .to_json = [](const CameraMeasures& measures) { return measures.ctf ? ctf_json(*measures.ctf) : Json(); },
          .read = [](MeasureLines& out, const JsonReader& part) { out.ctf = ctf_from(part); },
          .valid = [](const MeasureLines& lines) { return !lines.ctf || drawable(*lines.ctf); },
          .mistake = "'ctf.groups': expected frequencies and a pitch above 0"};
}

}  // namespace todbench
