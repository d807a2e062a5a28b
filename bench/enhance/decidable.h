// SPDX-License-Identifier: GPL-3.0-or-later
// Decides which results of compared chains may be used, with the same criteria as for a measurement.
#pragma once

#include <string>
#include <vector>

#include "bench/enhance/enhancement.h"

namespace todbench {

/// Returns the reason why a point may not be used, in a sentence about `name`: no threshold, no interval, or a finding
/// that makes the point unfit. Empty: the point may be used.
[[nodiscard]] std::string why_undecided(const std::string& name, const TodPoint& point);
/// Returns the reason why the point of a result at this contrast may not be used: no answers, no threshold, no
/// interval, or a finding that makes the point unfit. Empty: the point may be used.
[[nodiscard]] std::string why_undecided(const PackageResult& result, double set_delta_t_k);
/// Removes the values of ratios at contrasts at which the point of `with` or of `without` may not be used, and stores
/// the reason.
void withhold_undecided(std::vector<PairedRatio>& ratios, const PackageResult& with, const PackageResult& without);
/// Returns the exit code of a result without an error, as for a measurement: 3 if a point may not be used or there are
/// no points, otherwise 0.
[[nodiscard]] int exit_code(const PackageResult& result);
/// Returns the acuity of a point that has a threshold with an interval.
[[nodiscard]] std::optional<double> identified_acuity_per_mrad(const TodPoint& point);
/// Gain and noise of a judged point, averaged over its set-ups. Requires stages after the camera.
struct JudgedPoint {
  double gain = 0;        ///< contrast after the stages divided by the contrast before the stages
  double gain_error = 0;  ///< standard error of the gain
  double noise_k = 0;     ///< noise that is passed to the observer, referred to the contrast before the stages
};
/// Returns gain and noise at a contrast; empty without stages after the camera.
[[nodiscard]] std::optional<JudgedPoint> judged_point(const PackageResult& result, double set_delta_t_k);
/// Returns a sentence if the gains at two contrasts differ by more than 5 % and by more than four standard errors. The
/// stages are then not linear: large and small triangles have different gains. Empty: the gains do not differ.
[[nodiscard]] std::string why_not_linear(const PackageResult& result);

}  // namespace todbench
