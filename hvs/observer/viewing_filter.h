// SPDX-License-Identifier: GPL-3.0-or-later
// Filter of an observer's templates: display and blur, or display and eye.
#pragma once

#include "hvs/observer/template_observer.h"
#include "hvs/shape/polygon_image.h"

namespace todbench {

/// Filter of an observer's templates, in cycles per displayed sample, with its extent.
struct ViewingFilter {
  TransferFunction transfer;
  double band_per_sample = 0;  ///< frequency above which the response of the filter is negligible
  double reach_samples = 0;    ///< distance beyond which the spatial response is nearly 0
};

/// Returns the filter. Without an eye it is sample and hold times the Gaussian blur. With an eye it is the square of
/// (display times H), because display and H act on the displayed patch and also on the shape of the template.
/// Precondition: an observer with an eye has a display.
[[nodiscard]] ViewingFilter viewing_filter(const TemplateObserverSpec& spec);

}  // namespace todbench
