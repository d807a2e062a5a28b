// The MRTD of a simulated camera by the observer of the triangles, beside the one by formula: numbers and page.
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

struct MrtdStudyTask {
  VirtualMrtdTask trial;      ///< the axis is one of `axes`
  std::vector<BarAxis> axes;  ///< at least one
  FormulaConditions formula{};
  Atmosphere air{};
  double range_m = 0;  ///< from the camera to the bars; 0: no air between them
};

/// One frequency of one axis.
struct MrtdStudyPoint {
  VirtualMrtdPoint found;
  Interval threshold_ci95_k;  ///< of the threshold, from the draws
  /// The MRTD: the threshold where it may be called so.
  std::optional<double> mrtd_k;
  std::string reason;               ///< why there is no MRTD; empty where there is one
  std::optional<double> formula_k;  ///< MRTD after the structure of FLIR92; nothing beyond Nyquist
};

struct MrtdAxisCurve {
  BarAxis axis = BarAxis::horizontal;
  std::vector<MrtdStudyPoint> points;
};

struct MrtdStudy {
  double transmittance = 1;  ///< of the air between camera and bars
  double nyquist_per_mrad = 0;
  std::vector<MrtdAxisCurve> curves;
};

/// Contrasts are those of the bars, of which the air leaves the camera the share of the transmittance: what the camera
/// needs over it. `invalid_input`: a range beyond the air's table, or at which nothing is left.
///
/// A threshold is no MRTD beyond Nyquist, where no phase shows four bars, and by the criterion `detection`: a machine
/// goes on telling alias patterns apart where no person sees four bars. Errors as virtual_mrtd().
[[nodiscard]] Result<MrtdStudy> study_mrtd(const MrtdStudyTask& task);

/// Kelvin over cycles/mrad: found with its interval, best phase, formula, ideal observer.
[[nodiscard]] Plot mrtd_plot(const MrtdStudyTask& task, const MrtdStudy& study);
[[nodiscard]] Document mrtd_page(const MrtdStudyTask& task, const MrtdStudy& study);

}  // namespace todbench
