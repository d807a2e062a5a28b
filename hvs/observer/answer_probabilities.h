// SPDX-License-Identifier: GPL-3.0-or-later
// Probability of each answer to a patch, averaged over the white noise that an observer adds.
#pragma once

#include <array>
#include <span>

#include "acquisition/base/rng.h"
#include "hvs/observer/block_product.h"
#include "hvs/observer/observer.h"
#include "hvs/observer/score_noise.h"

namespace todbench {

/// Working memory of a call, provided by the caller.
struct AnswerRoom {
  std::span<float> rows;       ///< ScoreNoise::size() elements
  std::span<float> along;      ///< ScoreNoise::size() elements
  std::span<float> numbers;    ///< products_at_once + 1 times ScoreNoise::rank() elements
  std::span<float> direction;  ///< ScoreNoise::rank() elements
};

/// Returns the probability that each alternative has the largest score. `scores`: scores of the patch without the
/// noise, as computed by the bank; `levels`: standard deviations of the noise, in the unit of the scores.
///
/// Without noise the alternative with the largest score has probability 1; alternatives with equal scores share it.
/// With noise, a template is used only if its score is within five standard deviations of the largest score: score_best
/// - score < 5 sd sqrt(2 (1 - rho)), where rho is the correlation of the two scores. If only one alternative remains,
/// its probability is 1 (error below 3e-7 for each omitted template).
///
/// Otherwise the noise is drawn. The decision depends most on the noise component along the difference of the templates
/// of the two best alternatives. This component is drawn in eight strata of equal probability, one value in each
/// stratum. The perpendicular components are drawn at random (conditional and stratified sampling, Owen 2013, 8.7 and
/// 8.4). `draws` is rounded up to a multiple of eight, at least 32. Allocates no memory. Results are bit-identical on
/// every instruction set.
[[nodiscard]] AnswerProbabilities answer_probabilities(const ScoreNoise& noise, std::span<const float> scores,
                                                       const ScoreNoiseLevels& levels, const RandomStream& stream,
                                                       int draws, const AnswerRoom& room);

}  // namespace todbench
