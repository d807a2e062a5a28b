// A target on its way: what was asked of it and how far it has come.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "tod/presentation/target.h"

namespace todbench {

struct TargetWait {
  TargetState asked;
  TargetState reached;          ///< as measured last
  bool contrast_there = false;  ///< the contrast is the one asked for and settled
  bool plate_there = false;     ///< plate, mounting and place are those asked for and at rest
  double waited_s = 0;
  double timeout_s = 0;  ///< then the target gives up
};

/// Told about twice a second while a target takes its time, and with nothing when the wait is over. Called from the
/// thread that presents.
using OnTargetWait = std::function<void(const std::optional<TargetWait>&)>;

/// "rotated by 180 degrees", for people.
[[nodiscard]] std::string_view mounting_in_words(Mounting mounting);

/// "waiting for the black body: asked for 2.000 K, reached 1.912 K, 12 s of at most 600 s"
[[nodiscard]] std::string sentence(const TargetWait& wait);

}  // namespace todbench
