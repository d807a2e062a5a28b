// SPDX-License-Identifier: GPL-3.0-or-later
// Adaptive placement of sizes: the Psi method for one psychometric function.
#pragma once

#include <cstdint>
#include <vector>

#include "acquisition/base/rng.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Options of PsiPlacement.
struct PsiOptions {
  PsychometricForm form = PsychometricForm::size;
  /// Lower limit of the prior of the threshold; > 0. The prior is uniform in ln threshold.
  double first_size = 1;
  /// Upper limit of the prior of the threshold.
  double last_size = 10;
  double size_step = 0.05;  ///< step of the candidate sizes, in ln
  /// Lapse of the model for the selection. This lapse prevents a single wrong answer from excluding the true threshold.
  double selection_lapse = 0.01;
  /// Share of trials at 2.5 times the threshold. At this size only a lapse causes a wrong answer.
  double lapse_probe_share = 0.05;
  double slope_probe_share = 0.1;  ///< share of trials at 45 % correct, which determine the slope
};

/// Chooses sizes one at a time. The next size is the size with the lowest expected entropy, after the answer, of the
/// marginal posterior of the threshold (Kontsevich and Tyler 1999; the slope is a nuisance parameter, Prins 2013). The
/// logarithm of the posterior is stored on a grid of ln threshold and ln slope. If the spread of the posterior is below
/// two grid steps, the grid is re-centred and its step is halved. If the posterior reaches an edge, the grid moves. In
/// both cases the posterior is recomputed from all answers. Use this class only to place trials, and fit_psychometric()
/// to compute thresholds. If answers were placed one by one, use the posterior interval of the fit, because the
/// coverage of the profile interval is up to 2.6 points below 95 % (docs/method/uncertainty.md). One thread at a time.
class PsiPlacement {
 public:
  /// Starts without answers. `stream`: random numbers that select probe trials and break ties.
  PsiPlacement(const PsiOptions& options, RandomStream stream);

  /// Returns the next size. The size does not change until observe() is called.
  [[nodiscard]] double next() const;
  /// Adds answers at a size > 0; counts as in Level. Any size is allowed.
  void observe(double size, double correct, double total);

  /// Return mean and standard deviation of the marginal posterior of ln threshold.
  [[nodiscard]] double mean_ln_threshold() const { return mean_; }
  [[nodiscard]] double sd_ln_threshold() const { return sd_; }
  /// Returns the expected reduction, by one answer at `size`, of the entropy of the marginal posterior of ln threshold,
  /// in nats; >= 0.
  [[nodiscard]] double expected_gain(double size) const;

 private:
  struct Answers {
    double size = 0, correct = 0, total = 0;
  };
  void lay_grid(double centre, double step);
  void add(const Answers& answers);
  void summarise();
  void renew_where_needed();
  [[nodiscard]] double gain(const double* right) const;
  [[nodiscard]] std::vector<double> probabilities(double ln_size) const;
  [[nodiscard]] double least_entropy_size() const;

  PsiOptions options_;
  RandomStream stream_;
  std::uint64_t asked_ = 0;
  std::vector<Answers> answers_;
  double step_ = 0;                   ///< step of ln threshold
  std::vector<double> ts_, qs_;       ///< nodes
  std::vector<double> ln_posterior_;  ///< [q][t], without a constant
  std::vector<double> posterior_;     ///< [q][t], normalised to a sum of 1
  std::vector<double> marginal_;      ///< marginal posterior of t
  double mean_ = 0, sd_ = 0, mean_q_ = 0, entropy_ = 0;
  double first_candidate_ = 0;  ///< ln size; a multiple of size_step
  std::vector<double> table_;   ///< psi [candidate][q][t]
};

}  // namespace todbench
