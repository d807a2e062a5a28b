// SPDX-License-Identifier: GPL-3.0-or-later
// Progress of a target towards a requested state.
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
  TargetState reached;          ///< last measured state
  bool contrast_there = false;  ///< the requested contrast is reached and settled
  bool plate_there = false;     ///< plate, mounting and position agree with the request and are at rest
  double waited_s = 0;
  double timeout_s = 0;  ///< value of waited_s at which the target reports an error
};

/// Called about twice a second while a target approaches a state, and with an empty value when the wait ends. Called
/// from the thread that presents.
using OnTargetWait = std::function<void(const std::optional<TargetWait>&)>;

/// Returns a text for users, for example "rotated by 180 degrees".
[[nodiscard]] std::string_view mounting_in_words(Mounting mounting);

/// Returns a sentence: "waiting for the black body: asked for 2.000 K, reached 1.912 K, 12 s of at most 600 s".
[[nodiscard]] std::string sentence(const TargetWait& wait);

}  // namespace todbench
