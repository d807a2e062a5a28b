// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/twin/simulated_set_up.h"

#include <utility>

#include "acquisition/base/try.h"
#include "bench/plan/plan_options.h"
#include "bench/twin/simulated_responses.h"
#include "bench/twin/twin_shapes.h"

namespace todbench {

Result<SimulatedSetUp> simulated_set_up(const Plan& plan, const ExperimentInputs& inputs,
                                        std::map<double, double> shown_delta_t_k, std::stop_token stop,
                                        const SimulatedSourceOptions& source, std::map<std::string, double> responses) {
  const auto model = std::make_shared<const SensorModel>(inputs.sensor, inputs.effects, inputs.accuracy, plan.seed);
  MeasurementOptions options = simulated_options(plan, inputs);
  if (responses.empty()) {
    TODBENCH_TRY(responses, simulated_responses(*model, plan, inputs.plates, options, stop));
  }
  TODBENCH_TRY(auto functions, stopping_tables(plan, inputs, std::move(stop)));
  options.contrast_response = std::move(responses);
  auto schedule = make_schedule(plan, inputs.plates, inputs.sensor.ifov_mrad(), Side::simulated,
                                RandomStream(plan.seed, "schedule.simulated"), functions);
  return SimulatedSetUp{.options = std::move(options),
                        .bench = simulated_bench(model, inputs.plates, plan.target.distance_m,
                                                 std::move(shown_delta_t_k), inputs.motion, source),
                        .schedule = std::move(schedule),
                        .functions = std::move(functions)};
}

}  // namespace todbench
