// SPDX-License-Identifier: GPL-3.0-or-later
// Probability of each answer to a patch, over the white noise that an observer adds.
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

/// Returns the share of the noise for which each alternative has the largest score. `scores` are those of the patch
/// without the noise, as its bank gives them; `levels` are the standard deviations of the noise, in the same unit.
///
/// Without noise the best alternative has probability 1 (equal ones share it). With noise a template takes part only if
/// it can come within five standard deviations of the best one: score_best - score < 5 sd sqrt(2 (1 - rho)) with rho
/// the correlation of the two scores. An alternative that is the only one left has probability 1 (error below 3e-7 for
/// each omitted template).
///
/// Otherwise the noise is drawn in the directions across the difference of the two best alternatives' templates. Along
/// it, where the decision varies most, it is drawn in eight strata of equal probability, one value in each (conditional
/// and stratified sampling, Owen 2013, 8.7 and 8.4). `draws` is rounded up to a multiple of eight, at least 32.
/// Allocates no memory. Results are the same bits on every instruction set.
[[nodiscard]] AnswerProbabilities answer_probabilities(const ScoreNoise& noise, std::span<const float> scores,
                                                       const ScoreNoiseLevels& levels, const RandomStream& stream,
                                                       int draws, const AnswerRoom& room);

}  // namespace todbench
