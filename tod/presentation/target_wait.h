// SPDX-License-Identifier: GPL-3.0-or-later
// Progress of a target on its way to a requested state.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "tod/presentation/target.h"

namespace todbench {

/// State of a wait.
struct TargetWait {
  TargetState asked;
  TargetState reached;          ///< as measured last
  bool contrast_there = false;  ///< the requested contrast is reached and settled
  bool plate_there = false;     ///< plate, mounting and place are the requested ones and at rest
  double waited_s = 0;
  double timeout_s = 0;  ///< value of waited_s at which the target reports an error
};

/// Called about twice a second while a target is on its way, and with an empty value when the wait is over. Called from
/// the thread that presents.
using OnTargetWait = std::function<void(const std::optional<TargetWait>&)>;

/// "rotated by 180 degrees", for people.
[[nodiscard]] std::string_view mounting_in_words(Mounting mounting);

/// "waiting for the black body: asked for 2.000 K, reached 1.912 K, 12 s of at most 600 s"
[[nodiscard]] std::string sentence(const TargetWait& wait);

}  // namespace todbench
