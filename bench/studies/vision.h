// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of an observer with an eye with all quoted results of people: detection, acuity, reading, microscan.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stop_token>

#include "acquisition/base/accuracy.h"
#include "bench/report/vision_page.h"
#include "hvs/observer/template_observer.h"

namespace todbench {

/// Options of the comparison.
struct VisionOptions {
  Accuracy accuracy;  ///< accuracy of the thresholds with a simulated sensor
  std::uint64_t seed = 1;
  std::filesystem::path figures{};  ///< further figures of people, see figures_of_people(); empty: none
  std::stop_token stop{};
};

/// Computes the comparison. Precondition: the observer has an eye. Errors: `interrupted`, those of figures_of_people(),
/// and those of its parts.
[[nodiscard]] Result<VisionComparison> vision_comparison(const TemplateObserverSpec& observer,
                                                         const VisionOptions& options);

/// Returns the acuity of people for a Landolt ring in 1/arcmin of the gap (Ikeda, Noda and Yamaguchi, quoted by
/// saecanet.com). The source does not state the people, the criterion and the valid range.
[[nodiscard]] double landolt_acuity_of_people(double luminance_cd_m2, double contrast_percent);

}  // namespace todbench
