// SPDX-License-Identifier: GPL-3.0-or-later
// Optics of the eye: pupil, retinal illuminance, modulation transfer.
#pragma once

namespace todbench {

/// Returns the diameter of the pupil in mm with both eyes open (Watson and Yellott 2012, unified formula).
/// `field_deg2`: area of the adapting field. Precondition: luminance and field above 0.
[[nodiscard]] double pupil_diameter_mm(double luminance_cd_m2, double field_deg2, double age_years);

/// Returns the effective retinal illuminance in troland. It includes the Stiles-Crawford effect, as in Barten's model.
[[nodiscard]] double retinal_illuminance_td(double luminance_cd_m2, double pupil_mm);

/// Returns the diffraction limit of an eye with this pupil at 555 nm, in cycles per degree. Above this frequency the
/// modulation transfer is 0.
[[nodiscard]] double diffraction_limit_per_degree(double pupil_mm);

/// Returns the mean radial modulation transfer of the best-corrected eye (Watson 2013, equations 3 to 5): 1 at
/// frequency 0, and 0 from the diffraction limit upwards.
[[nodiscard]] double eye_mtf(double frequency_per_degree, double pupil_mm);

}  // namespace todbench
