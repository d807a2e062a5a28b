// SPDX-License-Identifier: GPL-3.0-or-later
// Temperature that a camera reports for a black body seen via warm mirrors.
#pragma once

#include "sim_devices/atmosphere/band_radiance.h"

namespace todbench {

/// Returns the temperature (K) that a camera reports for a black body of `source_k` seen via mirrors of temperature
/// `mirrors_k`: the temperature of a black body with the radiance t L(source) + (1 - t) L(mirrors). L: band_radiance();
/// t: `transmission`, above 0 and at most 1. Precondition: temperatures above 0 K.
[[nodiscard]] inline double seen_behind_mirrors_k(const SpectralBand& band, double transmission, double mirrors_k,
                                                  double source_k) {
  if (transmission == 1) return source_k;
  const double radiance =
      transmission * band_radiance(band, source_k) + (1 - transmission) * band_radiance(band, mirrors_k);
  return radiation_temperature_k(band, radiance).value_or(source_k);
}

}  // namespace todbench
