#include "bench/run/simulated_responses.h"

#include "sim_devices/prediction/contrast_response.h"

namespace todbench {

Result<std::map<std::string, double>> simulated_responses(const SensorModel& model, const Plan& plan,
                                                          const std::vector<TargetPlate>& plates,
                                                          const MeasurementOptions& options, std::stop_token stop) {
  std::map<std::string, double> out;
  RegistrationOptions registration = options.registration;
  registration.expected_scale_px_per_mm =
      1 / (plan.target.distance_m * model.spec().ifov_mrad() / model.spec().samples_per_pitch());
  for (const auto& plate : plates) {
    auto response = contrast_response(model, plate, plan.target.distance_m, options.min_reference_px, registration,
                                      stop, level_estimate(options.contrast_unit));
    if (!response) return tl::unexpected(response.error());
    out[plate.name] = *response;
  }
  return out;
}

}  // namespace todbench
