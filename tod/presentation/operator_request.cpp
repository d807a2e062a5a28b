// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/presentation/operator_request.h"

#include <fmt/format.h>

#include <cmath>

namespace todbench {
namespace {

const char* words(Mounting mounting) {
  switch (mounting) {
    case Mounting::identity:
      return "as drawn, front to the camera";
    case Mounting::rotated_180:
      return "front to the camera, upside down (turned by 180 degrees)";
    case Mounting::mirrored_horizontally:
      return "back to the camera, turned about its vertical axis (left and right swapped)";
    case Mounting::mirrored_vertically:
      return "back to the camera, turned about its horizontal axis (top and bottom swapped)";
  }
  return "as drawn";
}

std::string words(const PutInPlate& step) {
  return "insert plate '" + step.plate + "', " + words(step.mounting);
}

std::string words(const Remount& step) {
  return std::string("remount the plate: ") + words(step.mounting);
}

std::string words(const SetContrast& step) {
  return fmt::format("set the black body to {:+.3f} K relative to the plate and wait until it is stable",
                     step.delta_t_k);
}

std::string words(const MoveSlightly& step) {
  return fmt::format(
      "move the plate or the camera slightly, by about {:.1f} mm {} and {:.1f} mm {} as seen by the camera; the "
      "movement is measured and need not be exact",
      std::abs(step.by_mm.x), step.by_mm.x < 0 ? "left" : "right", std::abs(step.by_mm.y),
      step.by_mm.y < 0 ? "up" : "down");
}

std::string words(const MoveHotBar& step) {
  return step.in ? "bring the hot bar into the picture, beside the plate and not in front of it"
                 : "take the hot bar out of the picture";
}

std::string words(const CheckAgain& step) {
  return "the picture contradicts the last request (" + step.reason + "). Check each step again";
}

}  // namespace

OperatorRequest request_between(const std::optional<TargetState>& last, const TargetState& next) {
  OperatorRequest request;
  const bool other_plate = !last || last->plate != next.plate;
  if (other_plate) request.steps.emplace_back(PutInPlate{next.plate, next.mounting});
  if (!other_plate && last->mounting != next.mounting) request.steps.emplace_back(Remount{next.mounting});
  if (!last || last->delta_t_k != next.delta_t_k) request.steps.emplace_back(SetContrast{next.delta_t_k});
  if (last && request.steps.empty() && last->shift_mm != next.shift_mm)
    request.steps.emplace_back(MoveSlightly{next.shift_mm - last->shift_mm});
  return request;
}

std::string sentence(const OperatorStep& step) {
  return std::visit([](const auto& one) { return words(one); }, step);
}

}  // namespace todbench
