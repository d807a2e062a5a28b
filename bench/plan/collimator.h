// SPDX-License-Identifier: GPL-3.0-or-later
// Collimator of a plan: transmission, budget rows, and temperatures observed through it.
#pragma once

#include "bench/plan/plan.h"
#include "sim_devices/atmosphere/band_radiance.h"

namespace todbench {

/// Returns the mean of the table of transmissions over the band, weighted with the derivative of Planck's law at 295 K;
/// without a table, the stated transmission. A loaded plan contains this value in `transmission`.
[[nodiscard]] double mean_transmission(const CollimatorPlan& collimator, const SpectralBand& band);

/// Returns the temperature (K) that a camera with a correct scale reports for a black body behind the collimator. This
/// is the temperature whose band radiance is transmission L(black body) + (1 - transmission) L(mirrors). Without a
/// collimator, returns `black_body_k`.
[[nodiscard]] double seen_through_k(const Plan& plan, const SpectralBand& band, double black_body_k);

/// Smallest accepted focal length, shorter than any collimator for a thermal camera. This limit detects a focal length
/// stated in metres: 2 instead of 2000.
inline constexpr double least_focal_length_mm = 10;

/// Names of the rows that a collimator adds to a budget.
inline constexpr std::string_view focal_length_row = "focal length of the collimator";
inline constexpr std::string_view entrance_pupil_row = "entrance pupil before the collimator";
inline constexpr std::string_view transmission_row = "transmission of the collimator";
inline constexpr std::string_view mirrors_row = "mirrors of the collimator";
inline constexpr std::string_view aberration_row = "aberration of the collimator";

/// Returns the budget of the plan with the rows of the collimator. These rows replace rows of the same names. The
/// budget is unchanged without a collimator, and if the plan has no budget. With a collimator, the position of the
/// entrance pupil has no effect, so its row is 0.
[[nodiscard]] UncertaintyPlan budget_with_collimator(const Plan& plan, const SpectralBand& band);

}  // namespace todbench
