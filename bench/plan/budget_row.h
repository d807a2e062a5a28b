// SPDX-License-Identifier: GPL-3.0-or-later
// Row of an uncertainty budget, as stated in a plan or in a file of `todbench budget`.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace todbench {

/// Meaning of the value of a row.
enum class BudgetDistribution {
  normal,       ///< standard uncertainty, or expanded uncertainty with its coverage factor
  rectangular,  ///< half-width of a rectangular distribution
  triangular,   ///< half-width of a triangular distribution
  u_shaped,     ///< amplitude of a sinusoidal variation
};
inline constexpr std::array budget_distributions{BudgetDistribution::normal, BudgetDistribution::rectangular,
                                                 BudgetDistribution::triangular, BudgetDistribution::u_shaped};
/// Returns the name in plans, for example "u-shaped".
[[nodiscard]] std::string_view to_string(BudgetDistribution distribution);

/// Results to which a row contributes the same error. The row then cancels in a ratio to the twin, in a trend over a
/// series, or between contrasts.
enum class BudgetCommon { twin, series, contrasts };
inline constexpr std::array budget_commons{BudgetCommon::twin, BudgetCommon::series, BudgetCommon::contrasts};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(BudgetCommon common);

/// Input through which a row affects the acuity.
enum class BudgetInput {
  by_name,  ///< the name of the row determines the input: "distance", "entrance pupil" ...; any other name: acuity
  distance,
  entrance_pupil,  ///< position of the entrance pupil, from which the distance is measured
  cut_outs,        ///< size of the triangles of the plate
  ifov,
  black_body_calibration,
  black_body_emissivity,
  black_body_ambient,  ///< radiation reflected by the black body
  black_body_uniformity,
  black_body_stability,
  air_path,
  camera_scale,
  contrast,  ///< any other contribution to the contrast
  form,      ///< shape of the psychometric function
  acuity,
};
inline constexpr std::array budget_inputs{BudgetInput::by_name,
                                          BudgetInput::distance,
                                          BudgetInput::entrance_pupil,
                                          BudgetInput::cut_outs,
                                          BudgetInput::ifov,
                                          BudgetInput::black_body_calibration,
                                          BudgetInput::black_body_emissivity,
                                          BudgetInput::black_body_ambient,
                                          BudgetInput::black_body_uniformity,
                                          BudgetInput::black_body_stability,
                                          BudgetInput::air_path,
                                          BudgetInput::camera_scale,
                                          BudgetInput::contrast,
                                          BudgetInput::form,
                                          BudgetInput::acuity};
/// Returns the name in a plan, for example "entrance-pupil".
[[nodiscard]] std::string_view to_string(BudgetInput input);

/// Inputs that a complete budget of an acuity states, in the order of the printed table.
inline constexpr std::array expected_inputs{BudgetInput::distance,
                                            BudgetInput::entrance_pupil,
                                            BudgetInput::cut_outs,
                                            BudgetInput::black_body_calibration,
                                            BudgetInput::black_body_emissivity,
                                            BudgetInput::black_body_ambient,
                                            BudgetInput::black_body_uniformity,
                                            BudgetInput::black_body_stability,
                                            BudgetInput::air_path,
                                            BudgetInput::camera_scale,
                                            BudgetInput::form};

/// One source of uncertainty. Rows are independent of each other.
struct BudgetRow {
  std::string name{};
  double value = 0;  ///< 0 or more, in `unit`
  BudgetDistribution distribution = BudgetDistribution::normal;
  double coverage_factor = 1;  ///< normal distribution only: value / coverage_factor is the standard uncertainty
  std::optional<double> degrees_of_freedom{};  ///< empty: infinite
  /// Change of the result for a change of 1 in `unit`; empty: 1, so the row is in the unit of the result.
  std::optional<double> sensitivity{};
  std::string unit{};
  std::string source{};       ///< origin of the value
  std::string certificate{};  ///< number of the certificate
  std::vector<BudgetCommon> common{};
  BudgetInput enters = BudgetInput::by_name;  ///< plans only
  bool operator==(const BudgetRow&) const = default;
};

/// Returns the standard uncertainty in the unit of the row.
[[nodiscard]] double standard_of(const BudgetRow& row);

/// Returns the input through which the row affects the acuity: `enters`, or the input that its name states; never
/// by_name.
[[nodiscard]] BudgetInput input_of(const BudgetRow& row);
/// Effect of a relative error of an input on the acuity.
enum class InputKind {
  geometry,  ///< the same relative error
  contrast,  ///< the same relative error times the slope of the curve
  direct,    ///< an error of the acuity itself
};
/// Returns the effect of an input on the acuity.
[[nodiscard]] InputKind kind_of(BudgetInput input);
/// Value of one unit in metres (geometry), in kelvin (contrast), or as a relative number.
struct BudgetUnit {
  double factor = 1;
  bool relative = true;
};
/// Returns the conversion of `unit`; empty if an input of this kind does not have the unit.
[[nodiscard]] std::optional<BudgetUnit> budget_unit(InputKind kind, std::string_view unit);

/// Section [uncertainty].
struct UncertaintyPlan {
  bool require = false;         ///< reject a plan whose budget lacks an expected row
  std::vector<BudgetRow> rows;  ///< [[uncertainty.component]]
  /// Returns whether the plan has a budget.
  [[nodiscard]] bool stated() const { return !rows.empty(); }
  bool operator==(const UncertaintyPlan&) const = default;
};

/// Returns the expected inputs without a row.
[[nodiscard]] std::vector<BudgetInput> not_stated(const UncertaintyPlan& plan);

/// Names of the rows that the program adds to the budget of a run.
inline constexpr std::string_view finite_trials_row = "finite trials";
inline constexpr std::string_view seen_contrast_row = "contrast as the camera saw it";
inline constexpr std::string_view contrast_lag_row = "lag of the contrast in motion";
/// Added if the plan states the air of the bench and has no row for the air path.
inline constexpr std::string_view air_path_row = "air path";
/// Added if the size-of-source effect was measured: the large triangles of the plate show less than the target's
/// contrast.
inline constexpr std::string_view source_loss_row = "size-of-source";
inline constexpr std::string_view read_back_row = "target read-back against contrast seen";

}  // namespace todbench
