// SPDX-License-Identifier: GPL-3.0-or-later
// Range of the parameters of an observer with an eye that public data do not determine.
#pragma once

#include <optional>

#include "hvs/observer/template_observer.h"

namespace todbench {

/// An observer at both ends of the range of its open parameters together: sensitivity +-4 dB, uncertainty of 100 to
/// 3000 channels, contrast noise 0 to 0.07, sensor-noise factor 1.1 to 3.2. A parameter beyond its range stays where it
/// is. The acuity is monotone in each of them, so that these are the ends of the acuity as well.
struct OpenParameterRange {
  TemplateObserverSpec best, worst;
};

/// Empty for an observer without an eye.
[[nodiscard]] std::optional<OpenParameterRange> open_parameter_range(const TemplateObserverSpec& spec);

}  // namespace todbench
