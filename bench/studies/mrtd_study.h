// SPDX-License-Identifier: GPL-3.0-or-later
// MRTD of a simulated camera, judged by the observer of the triangles and compared with the MRTD from a formula:
// numbers and page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/plan/atmospheres.h"
#include "bench/report/document.h"
#include "bench/report/plot.h"
#include "sim_devices/prediction/formula_curves.h"
#include "sim_devices/prediction/virtual_mrtd.h"

namespace todbench {

/// MRTD to simulate.
struct MrtdStudyTask {
  VirtualMrtdTask trial;      ///< experiment; its axis is one of `axes`
  std::vector<BarAxis> axes;  ///< axes to test, at least one
  FormulaConditions formula{};
  Atmosphere air{};
  double range_m = 0;  ///< from the camera to the bars; 0: no air
};

/// Result at one frequency of one axis.
struct MrtdStudyPoint {
  VirtualMrtdPoint found;
  Interval threshold_ci95_k;  ///< 95 % interval of the threshold, from the draws
  /// The threshold as MRTD; empty if the threshold is not an MRTD (see study_mrtd()).
  std::optional<double> mrtd_k;
  std::string reason;               ///< reason for a missing MRTD; empty if there is one
  std::optional<double> formula_k;  ///< MRTD by a formula with the structure of FLIR92; empty beyond Nyquist
};

/// Results of one axis.
struct MrtdAxisCurve {
  BarAxis axis = BarAxis::horizontal;
  std::vector<MrtdStudyPoint> points;
};

/// Result of the study.
struct MrtdStudy {
  double transmittance = 1;  ///< transmittance of the air between camera and bars
  double nyquist_per_mrad = 0;
  std::vector<MrtdAxisCurve> curves;
};

/// Runs the study. Contrasts are stated at the bars: the contrast that the camera needs, divided by the transmittance.
/// Errors: `invalid_input` (a range beyond the table of the air, or with a transmittance of 0), those of
/// virtual_mrtd().
///
/// A threshold beyond Nyquist is not an MRTD, because no phase results in a picture with four bars. A threshold by the
/// criterion `detection` is not an MRTD either, because an algorithm still discriminates alias patterns in which people
/// do not see four bars.
[[nodiscard]] Result<MrtdStudy> study_mrtd(const MrtdStudyTask& task);

/// Returns the plot of kelvin over cycles/mrad: the threshold with its interval, best phase, formula, ideal observer.
[[nodiscard]] Plot mrtd_plot(const MrtdStudyTask& task, const MrtdStudy& study);
/// Returns the page for render_html().
[[nodiscard]] Document mrtd_page(const MrtdStudyTask& task, const MrtdStudy& study);

}  // namespace todbench
