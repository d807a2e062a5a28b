#include "bench/run/physical_measures.h"

#include <memory>
#include <utility>

#include "bench/run/simulated_responses.h"
#include "sim_devices/sensor/sensor_model.h"

namespace todbench {

bool measures_asked(const Plan& plan) {
  return plan.measures.noise || plan.measures.transfer;
}

Result<std::optional<CameraMeasures>> physical_measures(const Plan& plan, const MeasurementOptions& options,
                                                        OpenedBench& bench, const SessionFrame& frame,
                                                        std::stop_token stop) {
  if (!measures_asked(plan)) return std::nullopt;
  phase(frame.folder, frame.listener, "physical measures");
  auto measures = measure_camera(*bench.camera, *bench.target,
                                 {.noise = plan.measures.noise,
                                  .noise_frames = plan.measures.noise_frames,
                                  .transfer = plan.measures.transfer,
                                  .transfer_steps_k = plan.measures.transfer_steps_k,
                                  .measurement = options},
                                 *bench.host, std::move(stop));
  if (!measures) return tl::unexpected(measures.error());
  for (const auto& reason : measures->reasons) note(frame.folder, frame.listener, reason);
  return *std::move(measures);
}

Result<std::optional<CameraMeasures>> simulated_measures(const LoadedPlan& loaded, const ExperimentInputs& inputs,
                                                         const SessionFrame& frame, std::stop_token stop) {
  const Plan& plan = loaded.plan();
  if (!measures_asked(plan)) return std::nullopt;
  SensorSpec sensor = loaded.parts().sensor;
  sensor.microscan = plan.simulation.microscan;
  const auto model = std::make_shared<const SensorModel>(sensor, full_plan(sensor, {}, {}), inputs.accuracy, plan.seed);
  MeasurementOptions options = simulated_options(plan, inputs);
  auto response = simulated_responses(*model, plan, inputs.plates, options, stop);
  if (!response) return tl::unexpected(response.error());
  options.contrast_response = *std::move(response);
  OpenedBench bench = simulated_bench(model, inputs.plates, plan.target.distance_m, {}, inputs.motion);
  return physical_measures(plan, options, bench, frame, std::move(stop));
}

}  // namespace todbench
