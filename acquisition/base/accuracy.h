// SPDX-License-Identifier: GPL-3.0-or-later
// Numerical accuracy of results. The accuracy determines grid sizes, phases, wavelengths and numbers of draws.
#pragma once

#include <string_view>

#include "acquisition/base/result.h"

namespace todbench {

/// Tolerances in physical terms, passed to every computation (after GSParams of GalSim).
struct Accuracy {
  double acuity_tolerance_percent = 1;  ///< limit of all numerical errors together, in percent of the 75 % acuity
  double wrap_tolerance = 1.5e-5;  ///< signal that the periodic grid folds back into a pixel, relative to the contrast
  double band_tolerance = 1e-4;    ///< signal above the highest computed frequency, relative to the contrast
  int wavelengths = 16;            ///< Gauss-Legendre nodes over the band
  int phases_per_axis = 8;         ///< sampling phases averaged by the direct estimate, per pitch and axis
  int noise_draws = 600;           ///< draws of the direct estimate per target size, for all phases and contrasts
  double standard_error_percent = 0;  ///< the direct estimate adds draws until it has this standard error; 0: no target
  bool operator==(const Accuracy&) const = default;

  /// Upper limit of the draws per target size; the projected noise then occupies 40 MB.
  static constexpr int max_noise_draws = 8000;

  /// Derives all tolerances from the acuity tolerance. The standard error is half of the acuity tolerance; the other
  /// values are scaled with it.
  [[nodiscard]] static Accuracy for_tolerance(double acuity_tolerance_percent);
  [[nodiscard]] static Accuracy draft();
  [[nodiscard]] static Accuracy normal();
  [[nodiscard]] static Accuracy reference();
  /// Returns a level by name: "draft", "normal", "reference", or "auto" (for_tolerance(1), the default tolerance).
  /// Error: `invalid_input` for any other name.
  [[nodiscard]] static Result<Accuracy> named(std::string_view level);
};

}  // namespace todbench
