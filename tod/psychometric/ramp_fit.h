// SPDX-License-Identifier: GPL-3.0-or-later
// Fits graded answers at many contrasts with the function of a twin. The function is stretched in size; the stretch is
// a polynomial of the contrast.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "tod/psychometric/clustered_variance.h"
#include "tod/psychometric/contrast_surface.h"

namespace todbench {

/// Direction of the contrast while a presentation was shown.
enum class RampDirection { down, up };

/// An answer with the contrast of its presentation.
struct RampAnswer {
  GradedAnswer answer;
  double delta_t_k = 0;
  RampDirection direction = RampDirection::down;
};

/// S75 at one contrast.
struct RampValue {
  double ln_s75 = 0;
  ClusteredVariance variance;  ///< variance of ln S75, over set-ups
};

/// Difference of ln S75 between ramps up and down.
struct RampDifference {
  double ln_up_over_down = 0, standard_error = 0;
  double limit = 0;  ///< critical value of |ln_up_over_down| at 1 %, two-sided
  [[nodiscard]] bool beyond() const;
};

/// Fit of the proportion correct at size S and contrast dT: P(S, dT) = F(S exp(-a(u)), dT) with a(u) = a0 + a1 u + a2
/// u^2, where F is the surface and u its contrast_bend(). Therefore ln S75(dT) = ln S75 of the surface + a(u). The fit
/// is by quasi-likelihood as in fit_twin_shape(). The stretch a(u) is constant if the values of u of the answers span
/// less than 0.05, and linear if they span less than 0.3.
class RampFit {
 public:
  /// Fits the answers. Errors: `invalid_input` (no answers, or answers that do not determine the stretch).
  [[nodiscard]] static Result<RampFit> of(std::vector<RampAnswer> answers, ContrastSurface surface);

  /// Returns ln S75 at a contrast, with its variance.
  [[nodiscard]] RampValue at(double delta_t_k) const;
  /// Returns the stretch in ln size at a contrast.
  [[nodiscard]] double stretch(double delta_t_k) const;
  /// Returns the difference of ln S75 between ramps up and down. The fit is repeated with an additional parameter,
  /// which is added to ln S75 with the factor +1/2 for ramps up and -1/2 for ramps down. Empty if the answers do not
  /// determine this parameter, for example because all ramps had one direction.
  [[nodiscard]] std::optional<RampDifference> up_against_down() const;

 private:
  enum class Directions { together, apart };
  [[nodiscard]] std::array<double, most_parameters> row(double u, RampDirection direction, double centre) const;
  [[nodiscard]] Result<void> climb(Directions directions);
  [[nodiscard]] std::vector<AnswerScore> scores(double centre) const;

  std::vector<RampAnswer> answers_;
  std::vector<double> u_;  ///< contrast_bend() of each answer
  ContrastSurface surface_;
  std::size_t powers_ = 3;      ///< number of parameters of the stretch
  std::size_t parameters_ = 3;  ///< number of parameters; the last parameter is that of the directions, if it is fitted
  std::array<double, most_parameters> value_{};
};

}  // namespace todbench
