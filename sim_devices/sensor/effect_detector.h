// SPDX-License-Identifier: GPL-3.0-or-later
// The footprint of a rectangular detector.
#pragma once

namespace todbench {

/// Returns sinc(u a) sinc(w b) with sinc(x) = sin(pi x) / (pi x). a and b are the sides of the detector divided by the
/// pitch; u and w are in cycles per pitch.
[[nodiscard]] double detector_mtf(double u_per_pitch, double w_per_pitch, double pitch_ratio_x, double pitch_ratio_y);

}  // namespace todbench
