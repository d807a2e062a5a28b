// What a hand has to do to bring a state in front of the camera: steps with their values. Words are made of them where
// they are shown.
#pragma once

#include <functional>
#include <opencv2/core/types.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/presentation/target.h"

namespace todbench {

struct PutInPlate {
  std::string plate;
  Mounting mounting = Mounting::identity;
  bool operator==(const PutInPlate&) const = default;
};

/// The plate that is in stays.
struct Remount {
  Mounting mounting = Mounting::identity;
  bool operator==(const Remount&) const = default;
};

struct SetContrast {
  double delta_t_k = 0;  ///< black body against plate
  bool operator==(const SetContrast&) const = default;
};

/// How far it really went is measured.
struct MoveSlightly {
  cv::Point2d by_mm;  ///< as the camera sees the plate, x right, y down
  bool operator==(const MoveSlightly&) const = default;
};

/// Something much warmer than the plate, beside it in the picture.
struct MoveHotBar {
  bool in = true;
  bool operator==(const MoveHotBar&) const = default;
};

using OperatorStep = std::variant<PutInPlate, Remount, SetContrast, MoveSlightly, MoveHotBar>;

/// One request to the operator, to be done in the order of its steps.
struct OperatorRequest {
  std::vector<OperatorStep> steps;  ///< none: nothing is to be done
  bool operator==(const OperatorRequest&) const = default;
};

enum class OperatorAnswer { done, stop };

/// Puts a request before the operator and waits for the answer. Called from the thread of the run. Errors:
/// `interrupted` (at once when stop is requested), `disconnected` (nobody answers any more).
using AskOperator = std::function<Result<OperatorAnswer>(const OperatorRequest& request, const std::stop_token& stop)>;

/// What differs between two states; everything where the last one is not known. A move is asked for only where nothing
/// else changes: a plate that is touched has moved.
[[nodiscard]] OperatorRequest request_between(const std::optional<TargetState>& last, const TargetState& next);

/// The step as a request, without a capital and a full stop: "set the black body to +2.000 K against the plate ...".
[[nodiscard]] std::string sentence(const OperatorStep& step);

}  // namespace todbench
