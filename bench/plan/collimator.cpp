// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/collimator.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim_devices/atmosphere/mirror_radiance.h"

namespace todbench {
namespace {

constexpr double zero_celsius_k = 273.15;
constexpr double usual_scene_k = 295;

/// Linear between the points of the table, constant beyond its ends.
double transmission_at(const CollimatorPlan& collimator, double wavelength_um) {
  const std::vector<double>& at = collimator.wavelengths_um;
  const auto above = static_cast<std::size_t>(std::ranges::upper_bound(at, wavelength_um) - at.begin());
  if (above == 0) return collimator.transmissions.front();
  if (above == at.size()) return collimator.transmissions.back();
  const double share = (wavelength_um - at[above - 1]) / (at[above] - at[above - 1]);
  return std::lerp(collimator.transmissions[above - 1], collimator.transmissions[above], share);
}

double air_k(const Plan& plan) {
  return plan.target.air_temperature_c + zero_celsius_k;
}

double mirrors_k(const Plan& plan) {
  return plan.target.collimator.mirror_temperature_c.value_or(plan.target.air_temperature_c) + zero_celsius_k;
}

BudgetRow row_of(std::string_view name, double value, BudgetDistribution distribution, std::string_view unit,
                 std::string_view source, BudgetInput enters) {
  return {.name = std::string(name),
          .value = value,
          .distribution = distribution,
          .unit = std::string(unit),
          .source = std::string(source),
          .enters = enters};
}

/// Relative change of a contrast in kelvin because the camera converts it at the temperature that it sees, between
/// plate and mirrors, instead of that of the plate. The plate has the temperature of the air.
double mirror_effect(const Plan& plan, const SpectralBand& band) {
  const double seen_k = seen_through_k(plan, band, air_k(plan));
  return band_radiance_derivative(band, air_k(plan)) / band_radiance_derivative(band, seen_k) - 1;
}

/// Largest relative change of an acuity by the blur of the collimator: that of a system whose own blur is only the
/// square of a pixel, with a variance of a twelfth of its side squared.
double aberration_effect(const Plan& plan) {
  const double ifov_mrad = plan.camera.ifov_mrad;
  if (!(ifov_mrad > 0)) return 0;
  return std::sqrt(1 + 12 * std::pow(plan.target.collimator.blur_mrad / ifov_mrad, 2)) - 1;
}

}  // namespace

double mean_transmission(const CollimatorPlan& collimator, const SpectralBand& band) {
  if (collimator.wavelengths_um.empty()) return collimator.transmission;
  constexpr int steps = 400;  // trapezoids; the kinks of a table need no more for 1e-5
  double sum = 0, weights = 0;
  for (int i = 0; i <= steps; ++i) {
    const double wavelength_um = std::lerp(band.low_um, band.high_um, i / static_cast<double>(steps));
    const double weight = thermal_weight(wavelength_um, usual_scene_k) * (i == 0 || i == steps ? 0.5 : 1.0);
    sum += weight * transmission_at(collimator, wavelength_um);
    weights += weight;
  }
  return sum / weights;
}

double seen_through_k(const Plan& plan, const SpectralBand& band, double black_body_k) {
  if (!plan.target.collimator.stated()) return black_body_k;
  return seen_behind_mirrors_k(band, plan.target.collimator.transmission, mirrors_k(plan), black_body_k);
}

UncertaintyPlan budget_with_collimator(const Plan& plan, const SpectralBand& band) {
  UncertaintyPlan budget = plan.uncertainty;
  const CollimatorPlan& collimator = plan.target.collimator;
  if (!collimator.stated() || !budget.stated()) return budget;
  const auto add = [&](BudgetRow row) {
    std::erase_if(budget.rows, [&](const BudgetRow& own) { return own.name == row.name; });
    budget.rows.push_back(std::move(row));
  };
  add(row_of(focal_length_row, collimator.focal_length_u_mm, BudgetDistribution::normal, "mm", "[target.collimator]",
             BudgetInput::distance));
  add(row_of(entrance_pupil_row, 0, BudgetDistribution::normal, "mm",
             "a target at infinity has the same angle from every place", BudgetInput::entrance_pupil));
  add(row_of(transmission_row, collimator.transmission_u / collimator.transmission, BudgetDistribution::normal, "1",
             "[target.collimator]", BudgetInput::contrast));
  add(row_of(mirrors_row, std::abs(mirror_effect(plan, band)), BudgetDistribution::rectangular, "1",
             "contrast converted between the temperatures of plate and mirrors", BudgetInput::contrast));
  add(row_of(aberration_row, aberration_effect(plan), BudgetDistribution::rectangular, "1",
             "blur of the collimator against that of a pixel", BudgetInput::acuity));
  return budget;
}

}  // namespace todbench
