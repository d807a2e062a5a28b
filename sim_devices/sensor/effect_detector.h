// SPDX-License-Identifier: GPL-3.0-or-later
// The footprint of a square detector.
#pragma once

namespace todbench {

/// sinc(u d) sinc(w d), sinc(x) = sin(pi x) / (pi x), d = detector over pitch; u, w in cycles per pitch.
[[nodiscard]] double detector_mtf(double u_per_pitch, double w_per_pitch, double detector_pitch_ratio);

}  // namespace todbench
