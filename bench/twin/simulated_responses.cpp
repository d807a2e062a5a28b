// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/twin/simulated_responses.h"

#include <cmath>
#include <functional>
#include <future>

#include "acquisition/base/try.h"
#include "sim_devices/prediction/contrast_response.h"
#include "sim_devices/prediction/module_response.h"

namespace todbench {
namespace {

double largest_contrast(const Plan& plan) {
  double largest = 0;
  for (const double contrast : plan.target.delta_t_k) {
    if (std::abs(contrast) > std::abs(largest)) largest = contrast;
  }
  return largest;
}

}  // namespace

Result<std::map<std::string, double>> simulated_responses(const SensorModel& model, const Plan& plan,
                                                          const std::vector<TargetPlate>& plates,
                                                          const MeasurementOptions& options, std::stop_token stop) {
  std::map<std::string, double> out;
  RegistrationOptions registration = options.registration;
  registration.expected_scale_px_per_mm =
      1 / (plan.target.distance_m * model.spec().ifov_mrad() / model.spec().samples_per_pitch());
  const bool by_module = sensor_module(model.spec()) != nullptr;
  const auto of_plate = [&](const TargetPlate& plate) -> Result<double> {
    if (!by_module) {
      return contrast_response(model, plate, plan.target.distance_m, options.min_reference_px, registration, stop,
                               level_estimate(options.contrast_unit));
    }
    return module_response(model.spec(), model.seed(), plate,
                           {.delta_t_k = largest_contrast(plan),
                            .distance_m = plan.target.distance_m,
                            .min_reference_px = options.min_reference_px,
                            .registration = registration,
                            .level = level_estimate(options.contrast_unit)},
                           stop);
  };
  // In parallel, because a camera waits for them. Programs in place of the sensor run one after the other.
  std::vector<std::future<Result<double>>> made;
  for (const auto& plate : plates)
    made.push_back(std::async(by_module ? std::launch::deferred : std::launch::async, of_plate, std::cref(plate)));
  for (std::size_t i = 0; i < plates.size(); ++i) {
    TODBENCH_TRY(auto response, made[i].get());
    out[plates[i].name] = response;
  }
  return out;
}

}  // namespace todbench
