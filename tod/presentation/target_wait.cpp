// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/presentation/target_wait.h"

#include <fmt/format.h>

namespace todbench {
namespace {

std::string place_in_words(const TargetState& state) {
  return fmt::format("plate '{}' ({}) at {:.3f}, {:.3f} mm", state.plate, mounting_in_words(state.mounting),
                     state.shift_mm.x, state.shift_mm.y);
}

}  // namespace

std::string_view mounting_in_words(Mounting mounting) {
  switch (mounting) {
    case Mounting::identity:
      return "not turned";
    case Mounting::rotated_180:
      return "rotated by 180 degrees";
    case Mounting::mirrored_horizontally:
      return "mirrored left to right";
    case Mounting::mirrored_vertically:
      return "mirrored top to bottom";
  }
  return "";
}

std::string sentence(const TargetWait& wait) {
  std::string what;
  if (!wait.contrast_there) {
    what = fmt::format("waiting for the black body: asked for {:.3f} K, reached {:.3f} K", wait.asked.delta_t_k,
                       wait.reached.delta_t_k);
  }
  if (!wait.plate_there) {
    const std::string asked = place_in_words(wait.asked), reached = place_in_words(wait.reached);
    what += what.empty() ? "waiting for the stage: " : "; the stage: ";
    what += asked == reached ? asked + ", not at rest" : "asked for " + asked + ", reached " + reached;
  }
  if (what.empty()) what = "waiting for the target";
  return what + fmt::format(", {:.0f} s of at most {:.0f} s", wait.waited_s, wait.timeout_s);
}

}  // namespace todbench
