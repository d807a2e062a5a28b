// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/comparison/paired_ratio.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"
#include "tod/psychometric/clustered_variance.h"
#include "tod/psychometric/twin_shape.h"

namespace todbench {
namespace {

/// All results that follow from the ratio and its standard error.
RatioOfPairs judged_pairs(double ln_ratio, double se, double degrees_of_freedom, double margin_percent) {
  const auto interval = [&](double tail) {
    const double half = distribution::quantile_above(tail, degrees_of_freedom) * se;
    return Interval{std::exp(ln_ratio - half), std::exp(ln_ratio + half)};
  };
  const double margin = std::log1p(margin_percent / 100);
  RatioOfPairs out{.ratio = std::exp(ln_ratio),
                   .ci95 = interval(0.025),
                   .ci90 = interval(0.05),
                   .se_ln_ratio = se,
                   .degrees_of_freedom = degrees_of_freedom};
  out.p_difference = std::min(1.0, 2 * distribution::tail_above(std::abs(ln_ratio) / se, degrees_of_freedom));
  out.p_equivalence = distribution::tail_above((margin - std::abs(ln_ratio)) / se, degrees_of_freedom);
  if (*out.ci90.low >= std::exp(-margin) && *out.ci90.high <= std::exp(margin))
    out.verdict = ComparisonVerdict::equivalent;
  else
    out.verdict = out.p_difference < 0.05 ? ComparisonVerdict::different : ComparisonVerdict::inconclusive;
  return out;
}

Result<void> check_pairs(std::span<const PairedAnswer> answers, double margin_percent) {
  const auto probable = [](double p) { return p >= 0 && p <= 1; };
  if (!(margin_percent > 0) || !std::isfinite(margin_percent))
    return fail(ErrorCode::invalid_input, "the equivalence margin must be positive");
  for (const PairedAnswer& answer : answers) {
    if (!probable(answer.camera.probability_correct) || !probable(answer.twin_probability) ||
        !(answer.twin_variance >= 0 && std::isfinite(answer.twin_variance)))
      return fail(ErrorCode::invalid_input,
                  "paired answers: a probability is outside 0 to 1, or a variance is negative or not finite");
  }
  return {};
}

}  // namespace

std::string not_cancelled_by_pairs(bool measured_once) {
  return std::string("Pairing cancels the variation that both have in common, mainly that of the phases. ") +
         (measured_once
              ? "The contrast was measured once, in one set-up: its scatter is unknown and not part of the interval. "
              : "The interval includes the scatter of the measured contrast. ") +
         "The interval does not include systematic errors of contrast, distance or plate: state those in the budget.";
}

Result<RatioOfPairs> paired_ratio(std::span<const PairedAnswer> answers, const ProportionTable& table, bool with_slope,
                                  int draws, double margin_percent, const ContrastScatter& contrast,
                                  const std::optional<OwnFunctions>& own) {
  TODBENCH_TRY_VOID(check_pairs(answers, margin_percent));
  std::vector<GradedAnswer> camera, twin;
  for (const PairedAnswer& answer : answers) {
    camera.push_back(answer.camera);
    twin.push_back(answer.camera);
    twin.back().probability_correct = answer.twin_probability;
  }
  const auto of_camera = twin_shape_estimate(camera, table, with_slope);
  if (!of_camera) return fail("the camera's answers", of_camera.error());
  const auto of_twin =
      own ? twin_shape_estimate(twin, own->twin, own->with_slope) : twin_shape_estimate(twin, table, with_slope);
  if (!of_twin) return fail("the twin's answers", of_twin.error());

  double information = 0, variance_of_draws = 0;
  for (const double direction : of_camera->direction) information += direction * direction;
  std::vector<AnswerScore> scores;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    variance_of_draws += std::pow(of_twin->weight[i], 2) * answers[i].twin_variance;
    const double direction = of_camera->direction[i];
    // On a flat part of the function an answer has no influence, and its score is 0 over 0.
    if (!(std::abs(direction) > 1e-12 * std::sqrt(information))) continue;
    const double influence = of_camera->influence[i] - of_twin->influence[i];
    scores.push_back({.direction = {direction},
                      .residual = influence * information / direction,
                      .presentation = camera[i].presentation,
                      .place = camera[i].place,
                      .set_up = camera[i].set_up});
  }
  const ClusteredVariance found = clustered_variance(scores, 1, 0);
  if (!std::isfinite(found.variance) || !(found.variance > 0))
    return fail(ErrorCode::invalid_input,
                "paired answers: there are too few set-ups, presentations or places to estimate a variance");
  // The scatter over set-ups contains that of their contrasts, but not their common part.
  const double of_contrast =
      std::pow(found.kind == IntervalKind::set_ups ? contrast.shared_se_ln_acuity : contrast.se_ln_acuity, 2);
  const double variance = found.variance + of_contrast + (own ? own->variance : 0);
  double rest = found.variance * found.variance / found.degrees_of_freedom;
  if (contrast.degrees_of_freedom) rest += of_contrast * of_contrast / *contrast.degrees_of_freedom;
  RatioOfPairs out = judged_pairs(of_twin->ln_threshold - of_camera->ln_threshold, std::sqrt(variance),
                                  variance * variance / rest, margin_percent);
  out.interval = found.kind;
  out.twin_share = std::min(1.0, variance_of_draws / variance);
  out.draws = draws;
  out.answers = static_cast<int>(answers.size());
  return out;
}

RatioOfPairs ratio_of_paired(const RatioOfPairs& a, const RatioOfPairs& b, double margin_percent) {
  const double va = a.se_ln_ratio * a.se_ln_ratio, vb = b.se_ln_ratio * b.se_ln_ratio;
  const double freedom = (va + vb) * (va + vb) / (va * va / a.degrees_of_freedom + vb * vb / b.degrees_of_freedom);
  RatioOfPairs out = judged_pairs(std::log(a.ratio / b.ratio), std::sqrt(va + vb), freedom, margin_percent);
  out.interval = a.interval == b.interval ? a.interval : IntervalKind::two_way;
  out.twin_share = (va * a.twin_share + vb * b.twin_share) / (va + vb);
  out.draws = std::min(a.draws, b.draws);
  out.answers = std::min(a.answers, b.answers);
  return out;
}

}  // namespace todbench
