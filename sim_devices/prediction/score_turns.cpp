// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/score_turns.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/core.hpp>

namespace todbench {
namespace {

/// Exchanges rows and columns of a square with `side` rows.
template <typename T>
void transpose(const T* values, int side, T* out) {
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) out[row * side + column] = values[column * side + row];
}

/// Reverses the order of rows, columns or both of a square with `side` rows.
template <typename T>
void reverse(const T* values, int side, bool rows, bool columns, T* out) {
  if (rows == columns) {
    if (rows) {
      std::reverse_copy(values, values + side * side, out);
    } else {
      std::copy_n(values, side * side, out);
    }
    return;
  }
  for (int row = 0; row < side; ++row) {
    const T* from = values + (rows ? side - 1 - row : row) * side;
    if (rows) {
      std::copy_n(from, side, out + row * side);
    } else {
      std::reverse_copy(from, from + side, out + row * side);
    }
  }
}

}  // namespace

/// Template (o, p) turned by a quarter is (o + 1, p turned about the middle); a reflection exchanges right and left.
ScoreTurns::Turn ScoreTurns::turn_of(int quarters, bool mirrored) {
  Turn turn;
  for (int o = 0; o < 4; ++o) {
    const int turned = (o + quarters) % 4;
    turn.from[static_cast<std::size_t>(o)] = mirrored && turned % 2 == 1 ? 4 - turned : turned;
  }
  turn.transposed = quarters % 2 == 1;
  turn.rows_reversed = quarters == 1 || quarters == 2;
  turn.columns_reversed = quarters >= 2;
  // The reflection exchanges the columns of the turned picture, which are rows if it is transposed.
  if (mirrored && turn.transposed) turn.rows_reversed = !turn.rows_reversed;
  if (mirrored && !turn.transposed) turn.columns_reversed = !turn.columns_reversed;
  return turn;
}

/// Whether `change` of a picture exchanges the templates as `turn` states, for some of them.
template <typename Change>
bool ScoreTurns::is_symmetry(const TemplateBank& bank, const Turn& turn, Change change) const {
  const int window = bank.window_samples();
  cv::Mat1f values(window, window), changed, expected(window, window);
  std::vector<int> upright(static_cast<std::size_t>(places_)), across(upright), found(upright);
  std::iota(upright.begin(), upright.end(), 0);
  transpose(upright.data(), side_, across.data());
  reverse((turn.transposed ? across : upright).data(), side_, turn.rows_reversed, turn.columns_reversed, found.data());
  const int templates = bank.templates();
  for (int t = 0; t < templates; t += 1 + templates / 32) {
    const int other =
        turn.from[static_cast<std::size_t>(t / places_)] * places_ + found[static_cast<std::size_t>(t % places_)];
    bank.copy_template(static_cast<std::size_t>(t), std::span(values.ptr<float>(), values.total()));
    bank.copy_template(static_cast<std::size_t>(other), std::span(expected.ptr<float>(), expected.total()));
    change(values, changed);
    if (cv::norm(changed, expected, cv::NORM_INF) > 1e-4) return false;
  }
  return true;
}

ScoreTurns::ScoreTurns(const TemplateBank& bank)
    : side_(static_cast<int>(std::lround(std::sqrt(bank.places())))), places_(bank.places()), turns_{Turn{}} {
  if (bank.alternatives() != 4 || side_ * side_ != places_) return;
  const auto quarter = [](const cv::Mat1f& a, cv::Mat1f& b) { cv::rotate(a, b, cv::ROTATE_90_CLOCKWISE); };
  const auto mirror = [](const cv::Mat1f& a, cv::Mat1f& b) { cv::flip(a, b, 1); };
  if (!is_symmetry(bank, turn_of(1, false), quarter) || !is_symmetry(bank, turn_of(0, true), mirror)) return;
  turns_.clear();
  for (const bool mirrored : {false, true})
    for (int quarters = 0; quarters < 4; ++quarters) turns_.push_back(turn_of(quarters, mirrored));
}

void ScoreTurns::begin(std::span<const float> scores) {
  scores_ = scores;
  if (turns_.size() == 1) return;
  across_.resize(scores.size());
  for (std::size_t from = 0; from < 4; ++from)
    transpose(scores.data() + from * static_cast<std::size_t>(places_), side_,
              across_.data() + from * static_cast<std::size_t>(places_));
}

void ScoreTurns::turned(std::size_t turn, std::span<float> out) const {
  if (turns_.size() == 1) {
    std::ranges::copy(scores_, out.begin());
    return;
  }
  const Turn& way = turns_[turn];
  const float* from = way.transposed ? across_.data() : scores_.data();
  const auto places = static_cast<std::size_t>(places_);
  for (std::size_t o = 0; o < way.from.size(); ++o)
    reverse(from + static_cast<std::size_t>(way.from[o]) * places, side_, way.rows_reversed, way.columns_reversed,
            out.data() + o * places);
}

}  // namespace todbench
