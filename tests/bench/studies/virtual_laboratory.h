// SPDX-License-Identifier: GPL-3.0-or-later
// Simulated laboratories with errors drawn from the budget of their plan and a simulated camera: validates the budget.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <stop_token>
#include <vector>

#include "bench/devices/devices.h"
#include "bench/twin/experiment_inputs.h"

namespace todbench {

/// True minus stated value: relative to the stated one, and in the unit of the quantity.
struct InputError {
  double relative = 0;
  double absolute = 0;
};

/// Unknown errors of a laboratory's set-up.
struct LaboratoryErrors {
  InputError distance_m;                ///< including the position of the entrance pupil
  InputError cut_outs_m;                ///< side of the triangles
  std::vector<InputError> contrasts_k;  ///< black body and air, in the order of the contrasts of the plan
  InputError camera_scale;              ///< kelvin of the camera over true kelvin
};

/// Draws one error for every row of the plan's budget by its distribution. It is common to all contrasts, except the
/// stability of the black body, drawn for each. Rows of the form and of the acuity itself have no error, because no
/// set-up has them; nor has the IFOV, because sizes come from the plate. The same seed and number repeat the errors.
[[nodiscard]] LaboratoryErrors drawn_errors(const Plan& plan, std::uint64_t seed, std::uint64_t laboratory);

/// The true set-up of a laboratory with these errors; the plan contains the stated values.
struct RealSetUp {
  std::vector<TargetPlate> plates;     ///< with the names of the stated plates
  double distance_m = 0;               ///< entrance pupil to plate
  std::map<double, double> shown_k{};  ///< by set contrast
  double camera_scale = 1;             ///< kelvin of the camera over true kelvin
};
[[nodiscard]] RealSetUp real_set_up(const Plan& plan, const ExperimentInputs& inputs, const LaboratoryErrors& errors);

/// Returns a bench with the simulated sensor of the inputs as camera and these errors. The target reports the set
/// contrast, the camera the temperatures of its own scale.
[[nodiscard]] OpenedBench erring_bench(const Plan& plan, const ExperimentInputs& inputs, const LaboratoryErrors& errors,
                                       std::uint64_t seed);

/// Result at one contrast of one laboratory. Sizes in mrad; u of ln acuity.
struct LaboratoryPoint {
  std::uint64_t laboratory = 0;
  double delta_t_k = 0;                              ///< as set
  double seen_delta_t_k = 0;                         ///< effective contrast, in the scale of the camera
  double s75_mrad = 0;                               ///< the result
  double statistical_low = 0, statistical_high = 0;  ///< 95 % interval from the finite trials
  double low = 0, high = 0;                          ///< 95 % interval from the budget
  double u = 0;                                      ///< standard uncertainty
  std::optional<double> degrees_of_freedom{};        ///< of u; empty: very many
  double contrast_slope = 0;                         ///< as used by the budget
  double u_trials = 0;                               ///< standard uncertainty of the finite trials alone
  std::optional<double> trials_freedom{};            ///< its degrees of freedom; empty: very many
};

/// Returns the plan with the seed of one laboratory. Seeds are two apart, and the one in between is that of its camera:
/// camera and twin share no noise, nor do two laboratories.
[[nodiscard]] Plan plan_of_laboratory(Plan of_all, std::uint64_t laboratory);

/// Runs the trials of plan_of_laboratory() on a bench, from frames to the expanded interval, without a session and
/// without a twin. Contrasts without a threshold have no point. Errors: those of measure() and of the fits;
/// `invalid_input` if the plan has no budget.
[[nodiscard]] Result<std::vector<LaboratoryPoint>> measured_on_bench(OpenedBench& bench, const Plan& plan,
                                                                     const ExperimentInputs& inputs,
                                                                     std::uint64_t laboratory, std::stop_token stop);

/// Measures one laboratory on simulated frames: erring_bench() with drawn_errors(), evaluated by measured_on_bench().
/// Camera and schedule have the seed of the plan and the number of the laboratory. Errors: as measured_on_bench().
[[nodiscard]] Result<std::vector<LaboratoryPoint>> measured_by_laboratory(const Plan& plan,
                                                                          const ExperimentInputs& inputs,
                                                                          std::uint64_t laboratory,
                                                                          std::stop_token stop);

/// Agreement of two laboratories, as in a proficiency test (ISO 13528:2022, 9.7): difference of ln S75 over the root of
/// the sum of the squared expanded uncertainties, each on the side towards the other. Beyond 1 they disagree.
[[nodiscard]] double normalised_error(const LaboratoryPoint& a, const LaboratoryPoint& b);

}  // namespace todbench
