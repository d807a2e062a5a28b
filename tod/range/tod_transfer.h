// SPDX-License-Identifier: GPL-3.0-or-later
// Converts a TOD curve, by an empirical function, to frequencies of four bars that have the same threshold contrast.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/range/range_prediction.h"

namespace todbench {

/// A transfer f = k A from the acuity A = 1 / S75 to the frequency f of four bars at the same contrast. k is a sigmoid
/// of ln(A / A0) between two levels. A0 is the asymptote of the curve: the acuity at the highest contrast. A published
/// parameter set is never changed; a changed set has a new name.
struct TodTransfer {
  std::string_view name;      ///< versioned name
  std::string_view observer;  ///< observer who judged triangles and bars; the transfer is valid only for this observer
  /// A phrase that states the imagers, the observer and the definition of the threshold for bars.
  std::string_view source;
  double ln_low = 0, ln_high = 0;  ///< ln k far below and far above `ln_centre`
  double ln_centre = 0;            ///< ln(A / A0) midway between the two levels
  double ln_width = 1;             ///< width of the transition, > 0
  double least = 0;                ///< lowest studied A / A0
  /// Smallest (contrast / noise per sample) at which a curve has reached its asymptote.
  double asymptote_over_noise = 0;
  double half_width_ln = 0;  ///< half-width of the 95 % interval of ln f for an imager that was not part of the study
  /// Strongest edge filter of the camera (SensorSpec::edge_boost) for which the transfers are valid.
  static constexpr double highest_edge_boost = 0.2;
};

/// Returns the transfers in their order of publication.
[[nodiscard]] std::span<const TodTransfer> tod_transfers();
/// Returns the transfer of this name. Error: `invalid_input` with the known names.
[[nodiscard]] Result<TodTransfer> tod_transfer_named(std::string_view name);

/// Returns k for A / A0 > 0.
[[nodiscard]] double transfer_factor(const TodTransfer& transfer, double acuity_over_asymptote);

/// A TOD curve as frequencies of bars.
struct TransferredCurve {
  /// Points of the curve; s75_mrad is 1 / f. Intervals combine the intervals of S75 and of A0. The error of the
  /// transfer is common to all points (TodTransfer::half_width_ln) and is not included.
  std::vector<TodThreshold> points;
  std::vector<std::string> notes;  ///< one sentence for each omitted threshold
};
/// Transfers every threshold. Thresholds whose acuity is below the studied range are omitted, so the lowest contrast of
/// the result may be higher. `noise_k`: temporal noise per sample. Errors: `invalid_input` (no threshold, noise not
/// above 0, a highest contrast that does not reach the asymptote).
[[nodiscard]] Result<TransferredCurve> transferred(std::span<const TodThreshold> thresholds,
                                                   const TodTransfer& transfer, double noise_k);

}  // namespace todbench
