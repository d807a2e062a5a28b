// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/answer_probabilities.h"

#include <algorithm>
#include <bitset>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "acquisition/base/multiversion.h"
#include "hvs/observer/block_product.h"

namespace todbench {
namespace {

constexpr std::size_t block = TemplateBank::block;

/// A template takes part within this many standard deviations: a normal variable exceeds them with probability 2.9e-7.
constexpr double reach_sd = 5;

/// Banks have at most 1 GiB and windows at least 4 x 4 samples, which limits the blocks; one more for each alternative.
constexpr std::size_t max_blocks = TemplateBank::max_bytes / (sizeof(float) * block * 16) + Choice::max_alternatives;

constexpr float none = -std::numeric_limits<float>::infinity();

/// Values of the noise along the difference of the two best templates, for each draw across it.
constexpr std::size_t strata = 8;
constexpr int least_vectors = 4;

using Strata = std::array<float, strata>;
using Shares = std::array<double, Choice::max_alternatives>;

/// The largest scores of one alternative so far: for each stratum, in lanes.
struct Best {
  float lanes[strata][block];
};

/// Processes one block of templates under one draw, whose noise is in `score`: for each stratum the larger of best and
/// signal + scale * (noise + value * along). Overwrites the noise.
TODBENCH_MULTIVERSION
void take_block(float* score, const float* signal, const float* along, float scale, const Strata& values, Best& best) {
  for (std::size_t t = 0; t < block; ++t) score[t] = signal[t] + scale * score[t];
  for (std::size_t v = 0; v < strata; ++v) {
    const float value = scale * values[v];
    float* lanes = best.lanes[v];
    for (std::size_t t = 0; t < block; ++t) {
      const float here = score[t] + value * along[t];
      lanes[t] = here > lanes[t] ? here : lanes[t];
    }
  }
}

/// The largest of the lanes, by halving. Overwrites them.
TODBENCH_MULTIVERSION
float largest(float* lanes) {
  for (std::size_t half = block / 2; half > 0; half /= 2) {
    for (std::size_t t = 0; t < half; ++t) lanes[t] = lanes[t + half] > lanes[t] ? lanes[t + half] : lanes[t];
  }
  return lanes[0];
}

/// Templates that can win: the blocks that contain one, and their alternatives.
struct Contenders {
  std::bitset<max_blocks> blocks;
  std::bitset<Choice::max_alternatives> alternatives;
  std::size_t first = 0;   ///< the best template
  std::size_t second = 0;  ///< the best of another alternative, if one can win
};

Contenders contenders(const ScoreNoise& noise, double sd, const AnswerRoom& room) {
  Contenders out;
  const auto rows = room.rows;
  out.first = static_cast<std::size_t>(std::max_element(rows.begin(), rows.end()) - rows.begin());
  if (sd > 0) {
    noise.copy_factor(out.first, room.numbers);
    noise.scores(room.numbers, room.along);  // correlations with the best
  }
  // behind > reach sd sqrt(2 (1 - rho)), squared.
  const auto limit = static_cast<float>(2 * std::pow(reach_sd * sd, 2));
  float best_of_others = none;
  for (std::size_t t = 0; t < noise.size(); ++t) {
    const float behind = rows[out.first] - rows[t];
    if (behind > 0 && (sd == 0 || behind * behind > limit * (1 - room.along[t]))) continue;
    out.blocks.set(t / block);
    out.alternatives.set(t / noise.row());
    if (t / noise.row() != out.first / noise.row() && rows[t] > best_of_others) {
      best_of_others = rows[t];
      out.second = t;
    }
  }
  return out;
}

/// Finds the unit direction from the second to the first template, and its product with every template. False if the
/// two templates are equal.
bool find_direction(const ScoreNoise& noise, const Contenders& able, const AnswerRoom& room) {
  noise.copy_factor(able.first, room.direction);
  noise.copy_factor(able.second, room.numbers);
  double square = 0;
  for (std::size_t k = 0; k < noise.rank(); ++k) {
    room.direction[k] -= room.numbers[k];
    square += std::pow(static_cast<double>(room.direction[k]), 2);
  }
  if (square == 0) return false;
  for (float& number : room.direction) number = static_cast<float>(static_cast<double>(number) / std::sqrt(square));
  noise.scores(room.direction, room.along);
  return true;
}

/// Removes the component along the direction from the numbers.
void project_across(std::span<float> numbers, std::span<const float> direction) {
  double along = 0;
  for (std::size_t k = 0; k < numbers.size(); ++k)
    along += static_cast<double>(numbers[k]) * static_cast<double>(direction[k]);
  for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] -= static_cast<float>(along) * direction[k];
}

/// A standard normal value in each stratum, all at the same fraction of it.
Strata values_in_strata(double share) {
  Strata out;
  for (std::size_t v = 0; v < strata; ++v) {
    const double p = (static_cast<double>(v) + share) / strata;
    out[v] = static_cast<float>(-std::numbers::sqrt2 * boost::math::erfc_inv(2 * p));
  }
  return out;
}

/// Share of wins of each alternative under one draw across the direction, over the strata; equal scores share.
Shares winners(const ScoreNoise& noise, const Contenders& able, const AnswerRoom& room, float scale,
               const Strata& values) {
  std::array<std::array<float, Choice::max_alternatives>, strata> tops;
  for (auto& top : tops) top.fill(none);
  for (std::size_t o = 0; o < noise.alternatives(); ++o) {
    if (!able.alternatives[o]) continue;
    Best best;
    for (auto& lanes : best.lanes) std::fill(lanes, lanes + block, none);
    for (std::size_t first = o * noise.row(); first < (o + 1) * noise.row(); first += block) {
      if (!able.blocks[first / block]) continue;
      float drawn[block];
      block_product(noise.factor(first), room.numbers.data(), noise.rank(), drawn);
      take_block(drawn, &room.rows[first], &room.along[first], scale, values, best);
    }
    for (std::size_t v = 0; v < strata; ++v) tops[v][o] = largest(best.lanes[v]);
  }
  Shares out{};
  for (const auto& top : tops) {
    const float most = *std::max_element(top.begin(), top.end());
    const auto equal = static_cast<double>(std::count(top.begin(), top.end(), most));
    for (std::size_t o = 0; o < top.size(); ++o) out[o] += top[o] == most ? 1 / (equal * strata) : 0;
  }
  return out;
}

}  // namespace

AnswerProbabilities answer_probabilities(const ScoreNoise& noise, std::span<const float> scores, double sd,
                                         const RandomStream& stream, int draws, const AnswerRoom& room) {
  noise.in_rows(scores, none, room.rows);
  const Contenders able = contenders(noise, sd, room);
  AnswerProbabilities out;
  if (sd == 0 || able.alternatives.count() == 1 || !find_direction(noise, able, room)) {
    for (std::size_t o = 0; o < able.alternatives.size(); ++o)
      out.probability[o] = able.alternatives[o] ? 1 / static_cast<double>(able.alternatives.count()) : 0;
    return out;
  }
  const int vectors = std::max(least_vectors, (draws + static_cast<int>(strata) - 1) / static_cast<int>(strata));
  Shares sum{}, squares{};
  for (int vector = 0; vector < vectors; ++vector) {
    const RandomStream own = stream.sub(static_cast<std::uint64_t>(vector));
    own.fill_normal(room.numbers);
    project_across(room.numbers, room.direction);
    const Shares share =
        winners(noise, able, room, static_cast<float>(sd), values_in_strata(own.uniform(noise.rank())));
    for (std::size_t o = 0; o < share.size(); ++o) {
      sum[o] += share[o];
      squares[o] += share[o] * share[o];
    }
  }
  const double n = vectors;
  for (std::size_t o = 0; o < sum.size(); ++o) out.probability[o] = sum[o] / n;
  const auto most = static_cast<std::size_t>(std::max_element(sum.begin(), sum.end()) - sum.begin());
  const double variance = std::max(0.0, (squares[most] - sum[most] * sum[most] / n) / (n - 1));
  out.draws = vectors * static_cast<int>(strata);
  // At least one draw: draws that agree do not prove that no noise decides otherwise.
  out.standard_error = std::max(std::sqrt(variance / n), 1.0 / out.draws);
  return out;
}

}  // namespace todbench
