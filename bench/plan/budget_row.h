// A row of an uncertainty budget, as a plan and a file of `todbench budget` state it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace todbench {

/// What a row's value means.
enum class BudgetDistribution {
  normal,       ///< a standard uncertainty, or an expanded one with its coverage factor
  rectangular,  ///< the half-width of a rectangle
  triangular,   ///< the half-width of a triangle
  u_shaped,     ///< the amplitude of something that swings like a sine
};
inline constexpr std::array budget_distributions{BudgetDistribution::normal, BudgetDistribution::rectangular,
                                                 BudgetDistribution::triangular, BudgetDistribution::u_shaped};
[[nodiscard]] std::string_view to_string(BudgetDistribution distribution);

/// With what a row is shared: it cancels in a ratio to it, or in a trend.
enum class BudgetCommon { twin, series, contrasts };
inline constexpr std::array budget_commons{BudgetCommon::twin, BudgetCommon::series, BudgetCommon::contrasts};
[[nodiscard]] std::string_view to_string(BudgetCommon common);

/// Through what a row reaches the acuity.
enum class BudgetInput {
  by_name,  ///< what its name says: "distance", "entrance pupil", ...; any other name: the acuity itself
  distance,
  entrance_pupil,  ///< its position, of which the distance is counted
  cut_outs,        ///< the size of the triangles of the plate
  ifov,
  black_body_calibration,
  black_body_emissivity,
  black_body_ambient,  ///< what the black body reflects
  black_body_uniformity,
  black_body_stability,
  air_path,
  camera_scale,
  contrast,  ///< any other part of it
  form,      ///< of the psychometric function
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
/// "entrance-pupil"
[[nodiscard]] std::string_view to_string(BudgetInput input);

/// What a complete budget of an acuity states, in the order in which it is printed.
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
  double coverage_factor = 1;                  ///< of a normal value: value / coverage_factor is standard
  std::optional<double> degrees_of_freedom{};  ///< nothing: very many
  std::optional<double> sensitivity{};  ///< of the result to this row; nothing: 1, the row is in the result's unit
  std::string unit{};
  std::string source{};       ///< what the value rests on
  std::string certificate{};  ///< its number
  std::vector<BudgetCommon> common{};
  BudgetInput enters = BudgetInput::by_name;  ///< in a plan only
  bool operator==(const BudgetRow&) const = default;
};

/// Standard uncertainty in the row's unit.
[[nodiscard]] double standard_of(const BudgetRow& row);

/// Through what the row reaches the acuity: `enters`, or what its name says; never by_name.
[[nodiscard]] BudgetInput input_of(const BudgetRow& row);
/// Kinds of input: how their relative error moves the acuity.
enum class InputKind {
  geometry,  ///< by as much
  contrast,  ///< by as much times the slope of the curve
  direct,    ///< it is an error of the acuity
};
[[nodiscard]] InputKind kind_of(BudgetInput input);
/// A value of 1 in this unit: in metres (geometry), kelvin (contrast) or relative.
struct BudgetUnit {
  double factor = 1;
  bool relative = true;
};
/// Nothing for a unit that such an input does not have.
[[nodiscard]] std::optional<BudgetUnit> budget_unit(InputKind kind, std::string_view unit);

/// [uncertainty]
struct UncertaintyPlan {
  bool require = false;         ///< a budget that leaves out an expected row refuses the plan
  std::vector<BudgetRow> rows;  ///< [[uncertainty.component]]
  /// The plan states a budget.
  [[nodiscard]] bool stated() const { return !rows.empty(); }
  bool operator==(const UncertaintyPlan&) const = default;
};

/// The expected inputs without a row.
[[nodiscard]] std::vector<BudgetInput> not_stated(const UncertaintyPlan& plan);

/// Names of the rows that a run states itself.
inline constexpr std::string_view finite_trials_row = "finite trials";
inline constexpr std::string_view seen_contrast_row = "contrast as the camera saw it";
/// Where the air of the bench is stated and the plan has no row of its own for its path.
inline constexpr std::string_view air_path_row = "air path";
inline constexpr std::string_view read_back_row = "target read-back against contrast seen";

}  // namespace todbench
