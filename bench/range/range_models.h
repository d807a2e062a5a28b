// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of several range models for one target and one air path.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/plan/atmospheres.h"
#include "sim_devices/prediction/formula_curves.h"
#include "tod/range/model_range.h"
#include "tod/range/range_prediction.h"
#include "tod/range/tod_transfer.h"

namespace todbench {

/// Range model.
enum class RangeModel { tod, acquire, ttp, mtdp };
inline constexpr std::array all_range_models{RangeModel::tod, RangeModel::acquire, RangeModel::ttp, RangeModel::mtdp};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(RangeModel model);

/// Source of the criteria M75 (RangeTask::m75) and V50 (value of the TTP metric for a probability of 50 %).
enum class CriterionSource {
  published,   ///< V50 = 8.5 for people and small craft (Krapels et al. 2006), M75 = 5.1 (EO-VISTA, 4.2.3)
  m75_stated,  ///< V50 is M75 / 0.6
  m75_file,    ///< M75 of an identification experiment; V50 is M75 / 0.6
  v50_stated,  ///< M75 is 0.6 V50
};

/// Inputs common to the models.
struct RangeQuestion {
  double size_m = 0;     ///< square root of the projected area, > 0
  double delta_t_k = 0;  ///< contrast at the target in kelvin on the NETD scale; the sign is ignored
  double m75 = 5.1;      ///< M75 of the TOD model
  CriterionSource criterion_source = CriterionSource::published;
  /// Relative standard uncertainty of M75 for the interval of the TOD model. 0 for the published value, whose source
  /// states no uncertainty.
  double m75_u_percent = 0;
  /// For CriterionSource::m75_file: phrase with the observer of the answers and the observer of the TOD curve of this
  /// M75.
  std::string m75_observer{};
  std::string curve_observer{};     ///< observer of the TOD curve; empty: not known
  double n50 = 6;                   ///< cycles of ACQUIRE (2-D) for a probability of 50 %; 6: identification
  double mtdp_n50 = 6;              ///< cycles of the MTDP-like curve for a probability of 50 %; 6: identification
  double v50 = 8.5;                 ///< V50 of the TTP model
  Atmosphere air{};                 ///< air between target and camera
  double extinction_u_percent = 0;  ///< relative standard uncertainty of the extinction
  /// Relative standard uncertainty of the thresholds of the MRTD, the MTDP-like curve and the CTF. TOD thresholds
  /// contain their own uncertainties.
  double curve_u_percent = 0;
  /// Relative standard uncertainties of the temperature scale and of the angle of a pixel, from the budget of a
  /// session. The models by formula use these uncertainties; the TOD curve already includes them.
  double scale_u_percent = 0, ifov_u_percent = 0;
  FormulaConditions formula{};  ///< parameters of the models by formula
  /// Luminance contrast of the target, for TTP; empty: |dT| / (2 x scene contrast).
  std::optional<double> target_contrast{};
};

/// Curves and sensor of the models.
struct RangeSources {
  std::vector<TodThreshold> thresholds;
  std::optional<SensorSpec> sensor{};                   ///< sensor for curves that are not given
  std::optional<LogLinearCurve> mrtd{}, mtdp{}, ctf{};  ///< thresholds over cycles/mrad, the same for both axes
  /// If set, the MTDP-like curve is computed from `thresholds`, which must come from the observer `curve_observer` of
  /// the question. Requires the sensor.
  std::optional<TodTransfer> transfer{};
};

/// Evaluates every requested model. The probability is stated at common ranges up to twice the longest R75 (range for
/// 75 %). A model without a result states the reason in `reason`. The results of different models are not averaged. The
/// TOD model uses predict_range() and adds the uncertainty of the air to the interval. Errors: `invalid_input` (a
/// number of the question out of range).
[[nodiscard]] Result<std::vector<ModelRange>> range_models(std::span<const RangeModel> asked,
                                                           const RangeSources& sources, const RangeQuestion& question);

/// Adds the uncertainty of M75 to an interval of the TOD range, in quadrature in ln R. The contribution is the change
/// of R75 if M75 is multiplied by exp(+-1.96 m75_u_percent / 100). A limit is open if R75 is outside the curve there.
[[nodiscard]] Interval joined_with_m75(std::span<const TodThreshold> thresholds, const RangeTask& task, double r75_m,
                                       const Interval& of_curve, double m75_u_percent);
/// Returns a phrase about the criterion M75 or V50 of a model: its observer, its targets and its source.
[[nodiscard]] std::string criterion_origin(const RangeQuestion& question, RangeModel which);
/// Returns a warning sentence if a model observer judged the curve of the question and M75 belongs to people; otherwise
/// empty.
[[nodiscard]] std::string observers_differ(const RangeQuestion& question);

/// Axes of a grid of targets; each has at least one value above 0.
struct RangeGridAxes {
  std::vector<double> sizes_m, contrasts_k;
  std::vector<double> ranges_m;  ///< may be empty: only R75 is computed
};
/// Results of one model on a grid.
struct RangeGrid {
  RangeModel model = RangeModel::tod;
  std::vector<std::optional<double>> r75_m;        ///< [size][contrast]
  std::vector<std::optional<double>> probability;  ///< [size][contrast][range]
};
/// Evaluates every model at every size, contrast and range; size and contrast of the question are ignored. Curves are
/// computed once. Errors: `invalid_input` (axes or question out of range, or over 200000 probabilities).
[[nodiscard]] Result<std::vector<RangeGrid>> range_grid(std::span<const RangeModel> asked, const RangeSources& sources,
                                                        const RangeQuestion& question, const RangeGridAxes& axes);

/// Ranges by the TTP model for one form of the probability P.
struct TtpRanges {
  std::optional<double> r50_m{}, r75_m{};
};
/// Returns the ranges for 50 % and 75 %.
[[nodiscard]] TtpRanges ttp_ranges(const RangeSources& sources, const RangeQuestion& question, ProbabilityForm form);

/// Ranges for 50 % by the MTDP-like model with the nominal target of STANAG 4347: 2.3 m x 2.3 m, 2 K, extinction 0.2
/// per km. The cycles are 1, 3 and 6 for detection, recognition and identification.
struct NominalRanges {
  double size_m = 2.3, delta_t_k = 2, extinction_per_km = 0.2;
  std::optional<double> detection_m{}, recognition_m{}, identification_m{};
};
/// Returns the nominal ranges; empty if there is no MTDP-like curve.
[[nodiscard]] std::optional<NominalRanges> nominal_ranges(const RangeSources& sources, const RangeQuestion& question);

}  // namespace todbench
