// What is brought in front of the camera, and by whom: instruments, a simulated scene, or a hand.
#pragma once

#include <opencv2/core/types.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/plate/target_plate.h"
#include "tod/presentation/moving_target.h"
#include "tod/presentation/stepping_target.h"

namespace todbench {

/// One thing to show.
struct TargetState {
  std::string plate;  ///< name of the TargetPlate
  Mounting mounting = Mounting::identity;
  double delta_t_k = 0;        ///< set-point of triangle minus surround; the sign is the polarity
  cv::Point2d shift_mm{0, 0};  ///< of the plate in its own plane, as seen by the camera, x right, y down
  bool operator==(const TargetState&) const = default;
};

/// What an instrument says it shows, once it is stable.
struct PresentedTarget {
  TargetState state;                               ///< as reached
  std::optional<double> plate_temperature_k;       ///< of the surround, where a sensor says so
  std::optional<double> black_body_temperature_k;  ///< behind the cut-outs
  double settling_s = 0;                           ///< time spent waiting
  bool operator==(const PresentedTarget&) const = default;
};

/// What a target can do by itself.
struct TargetCapabilities {
  std::string description;  ///< instruments with their serial numbers, for the report
  bool sets_shift =
      false;  ///< false: sub-pixel phases come from small movements of the hand and are measured by registration
};

/// Brings a state in front of the camera. One thread at a time.
class Target {
 public:
  virtual ~Target() = default;
  [[nodiscard]] virtual const TargetCapabilities& capabilities() const = 0;
  /// Returns when the state is reached and stable, or when `stop` is requested (`interrupted`, within a second).
  /// Errors: `timeout` (does not settle), `disconnected`, `not_found`, `invalid_input` (a state it cannot show).
  [[nodiscard]] virtual Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) = 0;
  /// The same target where it can run; null: it cannot. Lives as long as the target.
  [[nodiscard]] virtual MovingTarget* moving() { return nullptr; }
  /// The same target where it steps at once; null: it does not. Lives as long as the target.
  [[nodiscard]] virtual SteppingTarget* stepping() { return nullptr; }
};

}  // namespace todbench
