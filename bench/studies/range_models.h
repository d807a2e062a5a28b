// One target, one air, several range models side by side.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "bench/plan/atmospheres.h"
#include "sim_devices/prediction/formula_curves.h"
#include "tod/range/model_range.h"
#include "tod/range/range_prediction.h"

namespace todbench {

enum class RangeModel { tod, acquire, ttp, mtdp };
inline constexpr std::array all_range_models{RangeModel::tod, RangeModel::acquire, RangeModel::ttp, RangeModel::mtdp};
[[nodiscard]] std::string_view to_string(RangeModel model);

/// What the models are asked.
struct RangeQuestion {
  double size_m = 0;     ///< square root of the projected area, > 0
  double delta_t_k = 0;  ///< at the target, in kelvin at the scale of the NETD; only the magnitude counts
  double m75 = 5.1;
  double n50 = 6;       ///< cycles of ACQUIRE (2-D) for 50 %; 6: identification
  double mtdp_n50 = 6;  ///< cycles of the MTDP-like curve for 50 %; 6: identification
  double v50 = 8.5;
  Atmosphere air{};
  double extinction_u_percent = 0;  ///< relative standard uncertainty of the extinction
  double curve_u_percent = 0;       ///< of the thresholds of MRTD, MTDP-like curve and CTF; TOD brings its own
  /// Relative standard uncertainties of kelvin and of the angle of a pixel, from the budget of a session; of the models
  /// of formulas, TOD has them in its own curve.
  double scale_u_percent = 0, ifov_u_percent = 0;
  FormulaConditions formula{};
  std::optional<double> target_contrast{};  ///< of luminances, for TTP; else |dT| / (2 x scene contrast)
};

/// What the models read.
struct RangeSources {
  std::vector<TodThreshold> thresholds;
  std::optional<SensorSpec> sensor{};                   ///< for the curves that are not given
  std::optional<LogLinearCurve> mrtd{}, mtdp{}, ctf{};  ///< over cycles/mrad, both axes alike
};

/// Every model that is asked for, with P at ranges that all share: up to twice the longest R75. A model that cannot
/// answer says why in `reason`; nobody averages them. TOD has the numbers of predict_range(), with the air's
/// uncertainty joined to its interval. `invalid_input`: a number of the question out of its range.
[[nodiscard]] Result<std::vector<ModelRange>> range_models(std::span<const RangeModel> asked,
                                                           const RangeSources& sources, const RangeQuestion& question);

/// What a grid of targets is asked at; each at least one value above 0.
struct RangeGridAxes {
  std::vector<double> sizes_m, contrasts_k;
  std::vector<double> ranges_m;  ///< may be empty: R75 alone
};
struct RangeGrid {
  RangeModel model = RangeModel::tod;
  std::vector<std::optional<double>> r75_m;        ///< [size][contrast]
  std::vector<std::optional<double>> probability;  ///< [size][contrast][range]
};
/// Every model at every size, contrast and range; size and contrast of the question do not count. Curves are computed
/// once. `invalid_input`: values of axes or question out of range, or over 200000 probabilities.
[[nodiscard]] Result<std::vector<RangeGrid>> range_grid(std::span<const RangeModel> asked, const RangeSources& sources,
                                                        const RangeQuestion& question, const RangeGridAxes& axes);

/// Ranges by the TTP model with a named form of P.
struct TtpRanges {
  std::optional<double> r50_m{}, r75_m{};
};
[[nodiscard]] TtpRanges ttp_ranges(const RangeSources& sources, const RangeQuestion& question, ProbabilityForm form);

/// Ranges for 50 % by the MTDP-like model before the nominal target of STANAG 4347: 2.3 m x 2.3 m, 2 K, 0.2 per km,
/// with 1, 3 and 6 cycles.
struct NominalRanges {
  double size_m = 2.3, delta_t_k = 2, extinction_per_km = 0.2;
  std::optional<double> detection_m{}, recognition_m{}, identification_m{};
};
/// Nothing where there is no MTDP-like curve.
[[nodiscard]] std::optional<NominalRanges> nominal_ranges(const RangeSources& sources, const RangeQuestion& question);

}  // namespace todbench
