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

/// No detour by long double: the values are rounded to float.
using Plain = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

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

/// The first of the largest values. Precondition: a multiple of `block` values.
std::size_t place_of_largest(std::span<const float> values) {
  float lanes[block];
  std::fill(lanes, lanes + block, none);
  for (std::size_t first = 0; first < values.size(); first += block) {
    for (std::size_t t = 0; t < block; ++t) lanes[t] = values[first + t] > lanes[t] ? values[first + t] : lanes[t];
  }
  return static_cast<std::size_t>(std::find(values.begin(), values.end(), largest(lanes)) - values.begin());
}

/// Copies the scores of the templates of a block that can win, and `none` in place of the others. Template t cannot win
/// if it is behind by more than sqrt(limit * (mean variance of the two scores - covariance[t])).
TODBENCH_MULTIVERSION
void keep_contenders(const float* scores, const float* covariance, const float* variance, float best,
                     float best_variance, float limit, float* kept) {
  for (std::size_t t = 0; t < block; ++t) {
    const float behind = best - scores[t];
    const float most = limit * ((best_variance + variance[t]) / 2 - covariance[t]);
    const bool able = static_cast<int>(behind <= 0) | static_cast<int>(behind * behind <= most);
    kept[t] = able ? scores[t] : none;
  }
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
  out.first = place_of_largest(rows);
  if (sd > 0) {
    const auto numbers = room.numbers.first(noise.rank());
    noise.copy_factor(out.first, numbers);
    noise.weigh(levels, numbers);
    noise.weigh(levels, numbers);
    noise.scores(numbers, room.along);  // covariances with the best
  } else {
    std::fill(room.along.begin(), room.along.end(), 0.0F);
  }
  const ScoreNoise::Shares shares = noise.shares(levels);
  const auto limit = static_cast<float>(2 * std::pow(reach_sd * sd, 2));
  float best_of_others = none;
  for (std::size_t first = 0; first < noise.size(); first += block) {
    float variances[block], kept[block], lanes[block];
    for (std::size_t t = 0; t < block; ++t) variances[t] = noise.variance(shares, first + t);
    keep_contenders(&rows[first], &room.along[first], variances, rows[out.first], noise.variance(shares, out.first),
                    limit, kept);
    std::copy(kept, kept + block, lanes);
    const float best = largest(lanes);
    if (best == none) continue;
    out.blocks.set(first / block);
    out.alternatives.set(first / noise.row());
    if (first / noise.row() == out.first / noise.row() || best <= best_of_others) continue;
    best_of_others = best;
    out.second = first + static_cast<std::size_t>(std::find(kept, kept + block, best) - kept);
  }
  return out;
}

/// Finds the unit direction from the second to the first template. False if the two are equal.
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
    out[v] = static_cast<float>(-std::numbers::sqrt2 * boost::math::erfc_inv(2 * p, Plain()));
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

/// Share of wins of each alternative under each draw across the direction, over the strata; equal scores share. The
/// products of the direction with the templates are found where `direction` is not empty: a block of the factor is then
/// read once for them and for the draws.
std::array<Shares, products_at_once> winners(const ScoreNoise& noise, const Contenders& able, const AnswerRoom& room,
                                             float scale, const Vectors& vectors, std::span<const float> direction) {
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
      if (!direction.empty())
        block_product(noise.factor(first), direction.data(), direction.size(), &room.along[first]);
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
  const std::span<float> weighted = room.numbers.subspan(products_at_once * noise.rank(), noise.rank());
  std::copy(room.direction.begin(), room.direction.end(), weighted.begin());
  noise.weigh(levels, weighted);
  Shares sum{}, squares{};
  for (int vector = 0; vector < vectors;) {
    const Vectors drawn = draw_vectors(noise, levels, stream, vector, vectors, room);
    const auto shares =
        winners(noise, able, room, static_cast<float>(sd), drawn, vector == 0 ? weighted : std::span<float>());
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
