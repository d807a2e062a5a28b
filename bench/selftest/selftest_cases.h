// SPDX-License-Identifier: GPL-3.0-or-later
// Groups of the self-test, and their inputs, which other tests use too.
#pragma once

#include <complex>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/selftest/selftest.h"
#include "hvs/shape/polygon.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

using SelftestCases = std::vector<SelftestCase>;

/// Counts for which the maximum of the likelihood is hard to find in double precision.
struct HardFit {
  std::string name;
  std::vector<Level> levels;
  double lapse = 0;
  double ln_threshold = 0, ln_slope = 0;  ///< coordinates of the maximum, computed with 50 digits
};
/// Returns the hard fits.
[[nodiscard]] std::vector<HardFit> hard_fits();

/// Shape and wave vector near the singular cases of the closed form.
struct HardSpectrum {
  std::string name;
  Polygon shape;
  double u = 0, w = 0;            ///< cycles per unit of the shape
  std::complex<double> spectrum;  ///< computed with 50 digits
};
/// Returns the hard spectra.
[[nodiscard]] std::vector<HardSpectrum> hard_spectra();

/// Computes numbers with all parts of the program and returns them by name: fits, posteriors, placement, spectra,
/// optics, pixels, orthant probability, thresholds, a frame.
[[nodiscard]] std::map<std::string, double> numbers_of_every_part();
/// Returns the same numbers as computed with GCC 12.
[[nodiscard]] const std::map<std::string, double>& golden_numbers();

/// Add the cases of a group.
void add_closed_forms(SelftestCases& cases);
void add_fifty_digits(SelftestCases& cases);
void add_hard_cases(SelftestCases& cases);
void add_every_part(SelftestCases& cases);
void add_same_bits(SelftestCases& cases);
/// Adds the first case of the reference set. Errors: `interrupted`.
[[nodiscard]] Result<void> add_reference_case(SelftestCases& cases, std::stop_token stop);

}  // namespace todbench
