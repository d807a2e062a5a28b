// How wrong a result may be. Grid sizes, phases, wavelengths and numbers of draws follow from it.
#pragma once

#include <string_view>

#include "acquisition/core/result.h"

namespace todbench {

/// Tolerances in physical terms, travelling with everything that computes (the idea of GalSim's GSParams).
struct Accuracy {
  double acuity_tolerance_percent = 1;  ///< of the 75 % acuity, all numerical causes together
  double wrap_tolerance = 1.5e-5;       ///< of the contrast: signal that periodicity folds back into a pixel
  double band_tolerance = 1e-4;         ///< of the contrast: signal beyond the highest computed frequency
  int wavelengths = 16;                 ///< Gauss-Legendre nodes over the band
  int phases_per_axis = 8;              ///< sampling phases averaged by the direct estimate, per pitch and axis
  int noise_draws = 600;                ///< draws of the direct estimate per size, shared by phases and contrasts
  double standard_error_percent = 0;    ///< of the direct estimate: draws are added until it is met; 0: no demand
  bool operator==(const Accuracy&) const = default;

  /// Draws per size that no demand exceeds: 40 MB of projected noise per size.
  static constexpr int max_noise_draws = 8000;

  /// Everything derived from the acuity tolerance alone: half of it for the standard error, the rest in proportion.
  [[nodiscard]] static Accuracy for_tolerance(double acuity_tolerance_percent);
  [[nodiscard]] static Accuracy draft();
  [[nodiscard]] static Accuracy normal();
  [[nodiscard]] static Accuracy reference();
  /// "draft", "normal", "reference", or "auto": for_tolerance() of the default tolerance; `invalid_input` otherwise.
  [[nodiscard]] static Result<Accuracy> named(std::string_view level);
};

}  // namespace todbench
