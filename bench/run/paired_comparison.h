// The comparison of a camera with its twin by the phases that both saw.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "bench/run/experiment_inputs.h"
#include "bench/run/meanwhile.h"
#include "sim_devices/prediction/paired_twin.h"
#include "tod/comparison/comparison.h"
#include "tod/measurement/measurement.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// A plan asks for it, and its answers allow it.
[[nodiscard]] bool pairs_asked(const Plan& plan, const SensorSpec& sensor);

/// What a camera answered.
struct PairedCamera {
  const TodCurve& curve;  ///< fitted with the functions of the twin
  std::span<const Trial> trials;
  std::span<const SetUpRecord> set_ups;  ///< where its plates were found
};

struct PairedOutcome {
  std::vector<std::string> notes;  ///< a sentence for each contrast that has no paired ratio
  std::optional<Error> ended_by;   ///< `interrupted`
};

/// What the twin is shown of a camera's presentations.
[[nodiscard]] PairedTwinOptions paired_options(const ExperimentInputs& inputs, std::span<const SetUpRecord> set_ups,
                                               std::uint64_t seed, std::stop_token stop);

/// Shows the twin every presentation of the camera (twin_answers()) and adds the paired ratios (paired_ratio()) to the
/// points of a comparison whose A is the camera's curve. A point without the function of the twin, with answers that
/// are not graded, or not in the comparison keeps the unpaired ratio; of a threshold that is not fit for a decision
/// the paired verdict is inconclusive as well.
[[nodiscard]] PairedOutcome add_paired_ratios(Comparison& comparison, const PairedCamera& camera,
                                              const ExperimentInputs& inputs, const PairedTwinOptions& options);

/// Paired ratios of every contrast of a curve.
struct Pairs {
  Comparison ratios;  ///< of its points only the contrast, the margin and the paired ratio are set
  PairedOutcome said;
};
/// In a thread of its own, while the camera's physical measures are taken and the twin makes its own trials; null where
/// the plan asks for none. `camera_of` is asked there, and may wait for its curve; what it refers to, plan and inputs
/// outlive it.
[[nodiscard]] std::unique_ptr<Meanwhile<Pairs>> pairs_meanwhile(std::function<PairedCamera(std::stop_token)> camera_of,
                                                                const Plan& plan, const ExperimentInputs& inputs);

}  // namespace todbench
