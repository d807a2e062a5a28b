// SPDX-License-Identifier: GPL-3.0-or-later
// The target in front of the camera: instruments, a simulated scene, or a bench operated by hand.
#pragma once

#include <opencv2/core/types.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/plate/target_plate.h"
#include "tod/presentation/moving_target.h"
#include "tod/presentation/stepping_target.h"

namespace todbench {

/// State of the contrast for which a target waits before a presentation.
enum class ContrastWait {
  settled,  ///< reached and stable
  /// Reached and stable, and measured in the frames of the presentation. Used as reference for a contrast that changes.
  held,
  /// Within the settling band of the set-point and changing slowly; measured in the frames of the presentation.
  within_band,
  none,  ///< still changing; measured in the frames of the presentation
};

/// State to be shown.
struct TargetState {
  std::string plate;  ///< name of the TargetPlate
  Mounting mounting = Mounting::identity;
  double delta_t_k = 0;        ///< set-point of triangle minus surround; the sign is the polarity
  cv::Point2d shift_mm{0, 0};  ///< shift of the plate in the plane of the plate, as the camera sees it, x right, y down
  /// State of the contrast to wait for. If it is not `settled`, the contrast is measured in the frames of each
  /// presentation.
  ContrastWait wait = ContrastWait::settled;
  /// Set contrast of the point of the curve to which the answers belong; empty: `delta_t_k`.
  std::optional<double> point_delta_t_k{};
  bool operator==(const TargetState&) const = default;
};

/// State that an instrument reports once it is stable.
struct PresentedTarget {
  TargetState state;                               ///< state that was reached
  std::optional<double> plate_temperature_k;       ///< temperature of the surround, if a sensor reports it
  std::optional<double> black_body_temperature_k;  ///< temperature behind the cut-outs
  double settling_s = 0;                           ///< time spent waiting
  bool operator==(const PresentedTarget&) const = default;
};

/// Capabilities of a target.
struct TargetCapabilities {
  std::string description;  ///< instruments with their serial numbers, for the report
  /// If false, an operator moves the plate slightly, and registration measures the sub-pixel phases.
  bool sets_shift = false;
};

/// Presents states of a target to the camera. One thread at a time.
class Target {
 public:
  virtual ~Target() = default;
  [[nodiscard]] virtual const TargetCapabilities& capabilities() const = 0;
  /// Presents a state. Returns when the state is reached and stable, or when `stop` is requested (`interrupted`, within
  /// a second). Errors: `timeout` (does not settle), `disconnected`, `not_found`, `invalid_input` (a state that the
  /// target cannot show).
  [[nodiscard]] virtual Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) = 0;
  /// Called if the frames contradict the last result of present(). `reason`: description of the contradiction. Returns
  /// true if the presentation is to be repeated; present() then requests the state again. Use this for manual changes,
  /// in which the operator can make an error. Returns false if the contradiction ends the run.
  [[nodiscard]] virtual bool asks_again(const std::string& /*reason*/) { return false; }
  /// Returns the same target if it has a stage that can run, otherwise null. The pointer is valid as long as the
  /// target.
  [[nodiscard]] virtual MovingTarget* moving() { return nullptr; }
  /// Returns the same target if it can step instantly, otherwise null. The pointer is valid as long as the target.
  [[nodiscard]] virtual SteppingTarget* stepping() { return nullptr; }
};

}  // namespace todbench
