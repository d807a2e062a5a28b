// SPDX-License-Identifier: GPL-3.0-or-later
// Steps by which an operator sets the target to a state, with their values. The user interface converts the steps to
// sentences.
#pragma once

#include <functional>
#include <opencv2/core/types.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/presentation/target.h"

namespace todbench {

/// Step: put a plate into the holder.
struct PutInPlate {
  std::string plate;
  Mounting mounting = Mounting::identity;
  bool operator==(const PutInPlate&) const = default;
};

/// Step: change the mounting of the plate in the holder.
struct Remount {
  Mounting mounting = Mounting::identity;
  bool operator==(const Remount&) const = default;
};

/// Step: set the contrast of the black body.
struct SetContrast {
  double delta_t_k = 0;  ///< black body minus plate
  bool operator==(const SetContrast&) const = default;
};

/// Step: move the plate by about this distance. The actual distance is measured.
struct MoveSlightly {
  cv::Point2d by_mm;  ///< shift as the camera sees the plate, x right, y down
  bool operator==(const MoveSlightly&) const = default;
};

/// Step: bring an object much warmer than the plate into the picture, next to the plate, or remove this object.
struct MoveHotBar {
  bool in = true;
  bool operator==(const MoveHotBar&) const = default;
};

/// Notice that the picture contradicts the last request. The steps of the last request follow again.
struct CheckAgain {
  std::string reason;
  bool operator==(const CheckAgain&) const = default;
};

/// One step of a request.
using OperatorStep = std::variant<PutInPlate, Remount, SetContrast, MoveSlightly, MoveHotBar, CheckAgain>;

/// One request to the operator, with steps to be carried out in order.
struct OperatorRequest {
  std::vector<OperatorStep> steps;  ///< empty: no action needed
  bool operator==(const OperatorRequest&) const = default;
};

/// Answer of the operator.
enum class OperatorAnswer { done, stop };

/// Shows a request to the operator and waits for the answer. Called from the thread of the run. Errors: `interrupted`
/// (immediately when stop is requested), `disconnected` (the operator can no longer answer).
using AskOperator = std::function<Result<OperatorAnswer>(const OperatorRequest& request, const std::stop_token& stop)>;

/// Returns the steps from one state to the next. Without a last state, plate and contrast are requested. A move is
/// requested only if no other step is needed, because the other steps also move the plate.
[[nodiscard]] OperatorRequest request_between(const std::optional<TargetState>& last, const TargetState& next);

/// Returns the step as a request, without initial capital and full stop: "set the black body to +2.000 K against the
/// plate ...".
[[nodiscard]] std::string sentence(const OperatorStep& step);

}  // namespace todbench
