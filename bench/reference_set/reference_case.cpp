// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/reference_set/reference_case.h"

#include <utility>

#include "acquisition/base/try.h"
#include "bench/plan/descriptions.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

/// Standard error of the truth in percent: a tenth of that of a result, so its effect on the tolerance is negligible.
constexpr double truth_error_percent = 0.35;

SensorSpec sc2000() {
  const auto spec = load_sensor("sc2000");
  CV_Assert(spec);  // built in
  return *spec;
}

}  // namespace

std::vector<ReferenceCase> reference_cases() {
  SensorSpec plain = sc2000();
  plain.name = "reference-plain";
  plain.description = "SC2000-class: staring, uncooled, 320 x 240";
  SensorSpec blurred = plain;
  blurred.name = "reference-blurred";
  blurred.description = "SC2000-class with optics that blur by half a pitch";
  blurred.aberration_sigma_pitch = 0.5;
  SensorSpec noisy = plain;
  noisy.name = "reference-noisy";
  noisy.description = "SC2000-class with twice the noise and a fixed pattern of 0.05 K";
  noisy.netd_k = 0.14;
  noisy.fixed_pattern_k = 0.05;
  std::vector<ReferenceCase> out{{"", plain, 16.9},   {"", plain, 1.93},  {"", plain, 0.23},
                                 {"", blurred, 16.9}, {"", blurred, 0.5}, {"", noisy, 0.8}};
  for (std::size_t i = 0; i < out.size(); ++i) out[i].name = "case-" + std::to_string(i + 1);
  return out;
}

Result<std::vector<ReferenceTruth>> reference_truths(const std::vector<ReferenceCase>& cases, std::stop_token stop) {
  TODBENCH_TRY(const auto spec, load_observer(reference_observer));
  TemplateObserver observer(spec, triangle_alternatives());
  Accuracy accuracy = Accuracy::normal();
  accuracy.standard_error_percent = truth_error_percent;
  std::vector<ReferenceTruth> out;
  for (const ReferenceCase& c : cases) {
    const auto point = direct_estimate(c.sensor, full_plan(c.sensor, {}, {}), observer, {c.delta_t_k},
                                       {.accuracy = accuracy, .background_k = reference_background_k, .stop = stop});
    if (!point) return fail(c.name, point.error());
    const double mrad = c.sensor.ifov_mrad();
    out.push_back({c.name, point->front().s75_pitch * mrad, point->front().standard_error_pitch * mrad});
  }
  return out;
}

}  // namespace todbench
