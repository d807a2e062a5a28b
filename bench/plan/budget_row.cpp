// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/budget_row.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

namespace todbench {
namespace {

/// Alternative names of inputs.
struct InputName {
  std::string_view name;
  BudgetInput input;
};
constexpr std::array other_input_names{
    InputName{"position of the entrance pupil", BudgetInput::entrance_pupil},
    InputName{"entrance pupil position", BudgetInput::entrance_pupil},
    InputName{"cut out", BudgetInput::cut_outs},
    InputName{"cut out size", BudgetInput::cut_outs},
    InputName{"cut out sizes", BudgetInput::cut_outs},
    InputName{"black body", BudgetInput::black_body_calibration},
    InputName{"calibration", BudgetInput::black_body_calibration},
    InputName{"emissivity", BudgetInput::black_body_emissivity},
    InputName{"ambient", BudgetInput::black_body_ambient},
    InputName{"reflected ambient", BudgetInput::black_body_ambient},
    InputName{"uniformity", BudgetInput::black_body_uniformity},
    InputName{"stability", BudgetInput::black_body_stability},
    InputName{"air", BudgetInput::air_path},
    InputName{"psychometric form", BudgetInput::form},
};

/// "Air_path" becomes "air path".
std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    plain += c == '-' || c == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return plain;
}

}  // namespace

std::string_view to_string(BudgetDistribution distribution) {
  switch (distribution) {
    case BudgetDistribution::normal:
      return "normal";
    case BudgetDistribution::rectangular:
      return "rectangular";
    case BudgetDistribution::triangular:
      return "triangular";
    case BudgetDistribution::u_shaped:
      return "u-shaped";
  }
  return "";
}

std::string_view to_string(BudgetCommon common) {
  switch (common) {
    case BudgetCommon::twin:
      return "twin";
    case BudgetCommon::series:
      return "series";
    case BudgetCommon::contrasts:
      return "contrasts";
  }
  return "";
}

std::string_view to_string(BudgetInput input) {
  switch (input) {
    case BudgetInput::by_name:
      return "by-name";
    case BudgetInput::distance:
      return "distance";
    case BudgetInput::entrance_pupil:
      return "entrance-pupil";
    case BudgetInput::cut_outs:
      return "cut-outs";
    case BudgetInput::ifov:
      return "ifov";
    case BudgetInput::black_body_calibration:
      return "black-body-calibration";
    case BudgetInput::black_body_emissivity:
      return "black-body-emissivity";
    case BudgetInput::black_body_ambient:
      return "black-body-ambient";
    case BudgetInput::black_body_uniformity:
      return "black-body-uniformity";
    case BudgetInput::black_body_stability:
      return "black-body-stability";
    case BudgetInput::air_path:
      return "air-path";
    case BudgetInput::camera_scale:
      return "camera-scale";
    case BudgetInput::contrast:
      return "contrast";
    case BudgetInput::form:
      return "form";
    case BudgetInput::acuity:
      return "acuity";
  }
  return "";
}

double standard_of(const BudgetRow& row) {
  switch (row.distribution) {
    case BudgetDistribution::normal:
      return row.value / row.coverage_factor;
    case BudgetDistribution::rectangular:
      return row.value / std::numbers::sqrt3;
    case BudgetDistribution::triangular:
      return row.value / std::sqrt(6.0);
    case BudgetDistribution::u_shaped:
      return row.value / std::numbers::sqrt2;
  }
  return 0;
}

BudgetInput input_of(const BudgetRow& row) {
  if (row.enters != BudgetInput::by_name) return row.enters;
  const std::string name = plain_name(row.name);
  for (const BudgetInput input : budget_inputs) {
    if (input != BudgetInput::by_name && plain_name(to_string(input)) == name) return input;
  }
  for (const InputName& known : other_input_names) {
    if (known.name == name) return known.input;
  }
  return BudgetInput::acuity;
}

InputKind kind_of(BudgetInput input) {
  switch (input) {
    case BudgetInput::distance:
    case BudgetInput::entrance_pupil:
    case BudgetInput::cut_outs:
    case BudgetInput::ifov:
      return InputKind::geometry;
    case BudgetInput::black_body_calibration:
    case BudgetInput::black_body_emissivity:
    case BudgetInput::black_body_ambient:
    case BudgetInput::black_body_uniformity:
    case BudgetInput::black_body_stability:
    case BudgetInput::air_path:
    case BudgetInput::camera_scale:
    case BudgetInput::contrast:
      return InputKind::contrast;
    case BudgetInput::by_name:
    case BudgetInput::form:
    case BudgetInput::acuity:
      break;
  }
  return InputKind::direct;
}

std::optional<BudgetUnit> budget_unit(InputKind kind, std::string_view unit) {
  if (unit.empty() || unit == "1" || unit == "relative") return BudgetUnit{1, true};
  if (unit == "%") return BudgetUnit{0.01, true};
  if (kind == InputKind::geometry) {
    if (unit == "m") return BudgetUnit{1, false};
    if (unit == "cm") return BudgetUnit{1e-2, false};
    if (unit == "mm") return BudgetUnit{1e-3, false};
    if (unit == "um" || unit == "µm") return BudgetUnit{1e-6, false};
  }
  if (kind == InputKind::contrast) {
    if (unit == "K") return BudgetUnit{1, false};
    if (unit == "mK") return BudgetUnit{1e-3, false};
  }
  return std::nullopt;
}

std::vector<BudgetInput> not_stated(const UncertaintyPlan& plan) {
  std::vector<BudgetInput> missing;
  for (const BudgetInput input : expected_inputs) {
    if (std::none_of(plan.rows.begin(), plan.rows.end(), [&](const BudgetRow& row) { return input_of(row) == input; }))
      missing.push_back(input);
  }
  return missing;
}

}  // namespace todbench
