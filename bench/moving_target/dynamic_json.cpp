// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/moving_target/dynamic_json.h"

#include <utility>

#include "bench/text/spread_text.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

Json passes_json(const std::vector<MovingPassRecord>& passes) {
  Json all = Json::array();
  for (const MovingPassRecord& pass : passes) {
    all.push_back({{"pass", pass.pass},
                   {"pair", pass.pair},
                   {"plate", pass.plate},
                   {"mounting", to_string(pass.mounting)},
                   {"set_delta_t_k", pass.set_delta_t_k},
                   {"delta_t_k", pass.delta_t_k},
                   {"speed_mrad_s", pass.speed_mrad_s},
                   {"direction", pass.along_x > 0 ? "right" : "left"},
                   {"said_px_s", pass.said_px_s},
                   {"measured_px_s", pass.measured_px_s},
                   {"residual_px", pass.residual_px},
                   {"lag_ms", pass.lag_s ? Json(1e3 * *pass.lag_s) : Json()},
                   {"triangles_left_out", pass.left_out},
                   {"dropped", pass.dropped.empty() ? Json() : Json(pass.dropped)}});
  }
  return all;
}

}  // namespace

Json speeds_json(const std::vector<DynamicAcuity>& found) {
  Json speeds = Json::array();
  for (const DynamicAcuity& at : found) {
    Json points = Json::array();
    for (const DynamicPoint& point : at.points) {
      Json row{{"observer", to_string(point.observer)},
               {"verdict", to_string(point.fit.verdict)},
               {"s75_mrad", json_number(stated_threshold(point.fit))},
               {"s75_ci95_mrad", json_interval(point.fit.ci95)},
               {"acuity_per_mrad", json_number(stated_acuity_per_mrad(point.fit))},
               {"ratio_to_static", json_number(point.ratio)},
               {"ratio_to_static_ci95", json_interval(point.ratio_ci95)}};
      add_spread(row, "s75_spread_mrad", point.s75_spread_mrad);
      add_spread(row, "ratio_to_static_spread", point.ratio_spread);
      points.push_back(std::move(row));
    }
    speeds.push_back({{"speed_mrad_s", at.speed_mrad_s},
                      {"speed_px_per_frame", at.speed_px},
                      {"smear_px", at.smear_px},
                      {"exposure_px", at.exposure_px},
                      {"lag_px", at.lag_px},
                      {"points", points}});
  }
  return speeds;
}

Json dynamic_measurement_json(const DynamicMeasurement& found, const Plan& plan) {
  Json contrasts = Json::array();
  for (const DynamicContrast& at : found.contrasts)
    contrasts.push_back(
        {{"set_delta_t_k", at.set_delta_t_k}, {"delta_t_k", at.delta_t_k}, {"speeds", speeds_json(at.speeds)}});
  Json time_constant;
  if (const auto& tau = found.time_constant)
    time_constant = {{"time_constant_ms", tau->time_constant_ms},
                     {"ci95_ms", json_interval(tau->ci95_ms)},
                     {"exposure_ms", tau->exposure_ms},
                     {"offset_px", tau->offset_px},
                     {"passes", tau->passes}};
  return {{"camera", found.camera},
          {"plan", plan.name},
          {"observer", plan.observer},
          {"frame_rate_hz", found.measured.frame_rate_hz},
          {"frames", plan.motion.frames},
          {"lead_frames", plan.motion.lead_frames},
          {"passes_per_speed", plan.motion.passes},
          {"places", to_string(plan.motion.places)},
          {"direction", "x, both ways in turn"},
          {"lag", "removed: triangles are judged at their position in the picture"},
          {"internal_noise", "per decision"},
          {"seed", plan.seed},
          {"residual_px", found.residual_px},
          {"frames_lost", found.measured.frames_lost},
          {"time_constant", time_constant},
          {"contrasts", contrasts},
          {"passes", passes_json(found.measured.passes)}};
}

}  // namespace todbench
