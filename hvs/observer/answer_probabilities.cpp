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

Contenders contenders(const ScoreNoise& noise, const ScoreNoiseLevels& levels, const AnswerRoom& room) {
  Contenders out;
  const double sd = levels.total();
  const auto rows = room.rows;
  out.first = static_cast<std::size_t>(std::max_element(rows.begin(), rows.end()) - rows.begin());
  if (sd > 0) {
    const auto numbers = room.numbers.first(noise.rank());
    noise.copy_factor(out.first, numbers);
    noise.weigh(levels, numbers);
    noise.weigh(levels, numbers);
    noise.scores(numbers, room.along);  // covariances with the best
  }
  // behind > reach sd sqrt(2 (variance - covariance)), squared, with the mean variance of the two scores.
  const ScoreNoise::Shares shares = noise.shares(levels);
  const float own = noise.variance(shares, out.first);
  const auto limit = static_cast<float>(2 * std::pow(reach_sd * sd, 2));
  float best_of_others = none;
  for (std::size_t t = 0; t < noise.size(); ++t) {
    const float behind = rows[out.first] - rows[t];
    if (behind > 0 && (sd == 0 || behind * behind > limit * ((own + noise.variance(shares, t)) / 2 - room.along[t])))
      continue;
    out.blocks.set(t / block);
    out.alternatives.set(t / noise.row());
    if (t / noise.row() != out.first / noise.row() && rows[t] > best_of_others) {
      best_of_others = rows[t];
      out.second = t;
    }
  }
  return out;
}

/// Finds the unit direction from the second to the first template, and its product with those that can win. False if
/// the two templates are equal.
bool find_direction(const ScoreNoise& noise, const ScoreNoiseLevels& levels, const Contenders& able,
                    const AnswerRoom& room) {
  const auto numbers = room.numbers.first(noise.rank());
  noise.copy_factor(able.first, room.direction);
  noise.copy_factor(able.second, numbers);
  double square = 0;
  for (std::size_t k = 0; k < noise.rank(); ++k) room.direction[k] -= numbers[k];
  noise.weigh(levels, room.direction);
  for (const float number : room.direction) square += std::pow(static_cast<double>(number), 2);
  if (square == 0) return false;
  for (float& number : room.direction) number = static_cast<float>(static_cast<double>(number) / std::sqrt(square));
  std::copy(room.direction.begin(), room.direction.end(), numbers.begin());
  noise.weigh(levels, numbers);
  // Only blocks with templates that can win are drawn.
  for (std::size_t first = 0; first < noise.size(); first += block) {
    if (able.blocks[first / block])
      block_product(noise.factor(first), numbers.data(), noise.rank(), &room.along[first]);
  }
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

/// Some draws across the direction: as many as are multiplied together.
struct Vectors {
  std::size_t count = 0;
  std::array<Strata, products_at_once> values{};
};

/// The scores of one block under the draws.
void draw_block(const ScoreNoise& noise, const AnswerRoom& room, std::size_t first, std::size_t count,
                std::array<std::array<float, block>, products_at_once>& drawn) {
  const std::size_t rank = noise.rank();
  if (count == products_at_once) {
    std::array<const float*, products_at_once> numbers{};
    std::array<float*, products_at_once> sums{};
    for (std::size_t j = 0; j < count; ++j) {
      numbers[j] = room.numbers.data() + j * rank;
      sums[j] = drawn[j].data();
      drawn[j].fill(0.0F);
    }
    add_block_products(noise.factor(first), numbers, rank, sums);
    return;
  }
  for (std::size_t j = 0; j < count; ++j)
    block_product(noise.factor(first), room.numbers.data() + j * rank, rank, drawn[j].data());
}

/// Share of wins of each alternative under each draw across the direction, over the strata; equal scores share.
std::array<Shares, products_at_once> winners(const ScoreNoise& noise, const Contenders& able, const AnswerRoom& room,
                                             float scale, const Vectors& vectors) {
  using Tops = std::array<std::array<float, Choice::max_alternatives>, strata>;
  std::array<Tops, products_at_once> tops;
  for (Tops& of_vector : tops)
    for (auto& top : of_vector) top.fill(none);
  std::array<std::array<float, block>, products_at_once> drawn;
  for (std::size_t o = 0; o < noise.alternatives(); ++o) {
    if (!able.alternatives[o]) continue;
    std::array<Best, products_at_once> best;
    for (std::size_t j = 0; j < vectors.count; ++j)
      for (auto& lanes : best[j].lanes) std::fill(lanes, lanes + block, none);
    for (std::size_t first = o * noise.row(); first < (o + 1) * noise.row(); first += block) {
      if (!able.blocks[first / block]) continue;
      draw_block(noise, room, first, vectors.count, drawn);
      for (std::size_t j = 0; j < vectors.count; ++j)
        take_block(drawn[j].data(), &room.rows[first], &room.along[first], scale, vectors.values[j], best[j]);
    }
    for (std::size_t j = 0; j < vectors.count; ++j)
      for (std::size_t v = 0; v < strata; ++v) tops[j][v][o] = largest(best[j].lanes[v]);
  }
  std::array<Shares, products_at_once> out{};
  for (std::size_t j = 0; j < vectors.count; ++j) {
    for (const auto& top : tops[j]) {
      const float most = *std::max_element(top.begin(), top.end());
      const auto equal = static_cast<double>(std::count(top.begin(), top.end(), most));
      for (std::size_t o = 0; o < top.size(); ++o) out[j][o] += top[o] == most ? 1 / (equal * strata) : 0;
    }
  }
  return out;
}

/// Draws the numbers of some vectors, from number `first` on.
Vectors draw_vectors(const ScoreNoise& noise, const ScoreNoiseLevels& levels, const RandomStream& stream, int first,
                     int last, const AnswerRoom& room) {
  Vectors out;
  for (int vector = first; vector < last && out.count < products_at_once; ++vector, ++out.count) {
    const RandomStream own = stream.sub(static_cast<std::uint64_t>(vector));
    const auto numbers = room.numbers.subspan(out.count * noise.rank(), noise.rank());
    own.fill_normal(numbers);
    project_across(numbers, room.direction);
    noise.weigh(levels, numbers);
    out.values[out.count] = values_in_strata(own.uniform(noise.rank()));
  }
  return out;
}

}  // namespace

AnswerProbabilities answer_probabilities(const ScoreNoise& noise, std::span<const float> scores,
                                         const ScoreNoiseLevels& levels, const RandomStream& stream, int draws,
                                         const AnswerRoom& room) {
  noise.in_rows(scores, none, room.rows);
  const double sd = levels.total();
  const Contenders able = contenders(noise, levels, room);
  AnswerProbabilities out;
  if (sd == 0 || able.alternatives.count() == 1 || !find_direction(noise, levels, able, room)) {
    for (std::size_t o = 0; o < able.alternatives.size(); ++o)
      out.probability[o] = able.alternatives[o] ? 1 / static_cast<double>(able.alternatives.count()) : 0;
    return out;
  }
  const int vectors = std::max(least_vectors, (draws + static_cast<int>(strata) - 1) / static_cast<int>(strata));
  Shares sum{}, squares{};
  for (int vector = 0; vector < vectors;) {
    const Vectors drawn = draw_vectors(noise, levels, stream, vector, vectors, room);
    const auto shares = winners(noise, able, room, static_cast<float>(sd), drawn);
    for (std::size_t j = 0; j < drawn.count; ++j) {
      for (std::size_t o = 0; o < shares[j].size(); ++o) {
        sum[o] += shares[j][o];
        squares[o] += shares[j][o] * shares[j][o];
      }
    }
    vector += static_cast<int>(drawn.count);
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
