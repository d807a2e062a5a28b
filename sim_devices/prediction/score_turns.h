// SPDX-License-Identifier: GPL-3.0-or-later
// Ways of using one draw of white noise: turned and mirrored pictures of noise are equally probable.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "hvs/observer/template_bank.h"

namespace todbench {

/// Scores of noise as they would be if the noise were turned by quarters and mirrored: the same scores with exchanged
/// templates. Eight ways for the four triangles at a square of places; only the identity for a bank without this
/// symmetry. One thread at a time.
class ScoreTurns {
 public:
  /// Tests the symmetry on templates of the bank.
  explicit ScoreTurns(const TemplateBank& bank);

  /// Number of ways, the identity first: turns by 0 to 3 quarters, then their mirrored ones.
  [[nodiscard]] std::size_t size() const { return turns_.size(); }
  /// Begins with the scores of another draw, which must stay until the last turned().
  void begin(std::span<const float> scores);
  /// Writes the scores in way `turn` to `out`, which has as many elements.
  void turned(std::size_t turn, std::span<float> out) const;

 private:
  /// For each template, the template whose score it gets: that of alternative from[o] at the turned place.
  struct Turn {
    std::array<int, 4> from{0, 1, 2, 3};
    bool transposed = false, rows_reversed = false, columns_reversed = false;  ///< in this order
  };
  [[nodiscard]] static Turn turn_of(int quarters, bool mirrored);
  template <typename Change>
  [[nodiscard]] bool is_symmetry(const TemplateBank& bank, const Turn& turn, Change change) const;

  int side_ = 0, places_ = 0;
  std::vector<Turn> turns_;
  std::span<const float> scores_;
  std::vector<float> across_;  ///< transposed scores
};

}  // namespace todbench
