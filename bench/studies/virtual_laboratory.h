// Laboratories that err as the budget of their plan says they may, before a simulated camera: what proves the budget.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <stop_token>
#include <vector>

#include "bench/run/devices.h"
#include "bench/run/experiment_inputs.h"

namespace todbench {

/// True less stated value: in parts of the stated one, and in the unit of the quantity.
struct InputError {
  double relative = 0;
  double absolute = 0;
};

/// What a laboratory does not know of its set-up.
struct LaboratoryErrors {
  InputError distance_m;                ///< with the position of the entrance pupil
  InputError cut_outs_m;                ///< side of the triangles
  std::vector<InputError> contrasts_k;  ///< black body and air, in the order of the contrasts of the plan
  InputError camera_scale;              ///< kelvin of the camera over true ones
};

/// One error for every row of the plan's budget, by its distribution: the same at every contrast, but the stability of
/// the black body, which is drawn for each. Rows of the form and of the acuity itself err by nothing, for no set-up has
/// them, nor does the IFOV, for sizes come from the plate. The same laboratory of the same seed errs the same way.
[[nodiscard]] LaboratoryErrors drawn_errors(const Plan& plan, std::uint64_t seed, std::uint64_t laboratory);

/// What is really there where a laboratory has these errors; the plan says what it believes.
struct RealSetUp {
  std::vector<TargetPlate> plates;     ///< by the names that they are believed to have
  double distance_m = 0;               ///< entrance pupil to plate
  std::map<double, double> shown_k{};  ///< by the contrast that was told
  double camera_scale = 1;             ///< kelvin that the camera states over true ones
};
[[nodiscard]] RealSetUp real_set_up(const Plan& plan, const ExperimentInputs& inputs, const LaboratoryErrors& errors);

/// The simulated sensor of the inputs as camera before a scene with these errors. The target says what it was told, and
/// the camera says what its scale says.
[[nodiscard]] OpenedBench erring_bench(const Plan& plan, const ExperimentInputs& inputs, const LaboratoryErrors& errors,
                                       std::uint64_t seed);

/// One contrast of one laboratory. Sizes in mrad; u of ln acuity.
struct LaboratoryPoint {
  std::uint64_t laboratory = 0;
  double delta_t_k = 0;                              ///< as it was told
  double seen_delta_t_k = 0;                         ///< by the camera, in its scale
  double s75_mrad = 0;                               ///< the result
  double statistical_low = 0, statistical_high = 0;  ///< 95 % of the finite trials
  double low = 0, high = 0;                          ///< 95 % of the budget
  double u = 0;                                      ///< standard
  std::optional<double> degrees_of_freedom{};        ///< of u; nothing: very many
  double contrast_slope = 0;                         ///< that the budget took
  double u_trials = 0;                               ///< standard, of the finite trials alone
  std::optional<double> trials_freedom{};            ///< degrees of freedom of it; nothing: very many
};

/// The plan with the seed of one laboratory. They are two apart, and the one between is that of its camera: camera and
/// twin share no noise, nor do two laboratories.
[[nodiscard]] Plan plan_of_laboratory(Plan of_all, std::uint64_t laboratory);

/// The trials of plan_of_laboratory() on a bench, from frames to the expanded interval; no session is written and no
/// twin is compared. Contrasts without a threshold have no point. Errors: of measure() and of the fits; `invalid_input`
/// where the plan has no budget.
[[nodiscard]] Result<std::vector<LaboratoryPoint>> measured_on_bench(OpenedBench& bench, const Plan& plan,
                                                                     const ExperimentInputs& inputs,
                                                                     std::uint64_t laboratory, std::stop_token stop);

/// One laboratory on simulated frames: erring_bench() with drawn_errors(), measured as measured_on_bench() does. Camera
/// and schedule have the seed of the plan and the number of the laboratory. Errors: those of measured_on_bench().
[[nodiscard]] Result<std::vector<LaboratoryPoint>> measured_by_laboratory(const Plan& plan,
                                                                          const ExperimentInputs& inputs,
                                                                          std::uint64_t laboratory,
                                                                          std::stop_token stop);

/// Agreement of two laboratories, as of a proficiency test (ISO 13528:2022, 9.7): difference of ln S75 over the root of
/// the sum of the squares of their expanded uncertainties, each on the side of the other. Beyond 1 they disagree.
[[nodiscard]] double normalised_error(const LaboratoryPoint& a, const LaboratoryPoint& b);

}  // namespace todbench
