// SPDX-License-Identifier: GPL-3.0-or-later
// Repeated use of one draw of white noise: rotated and mirrored pictures of noise are equally probable.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "hvs/observer/template_bank.h"

namespace todbench {

/// Rotates and mirrors noise after its projection on the templates. Rotated noise has the same scores, exchanged
/// between templates. The four triangles at a square of positions allow eight turns (rotations with and without
/// mirroring). A bank without this symmetry allows only the unchanged noise. One thread at a time.
class ScoreTurns {
 public:
  /// Tests the symmetry on templates of the bank.
  explicit ScoreTurns(const TemplateBank& bank);

  /// Returns the number of turns, 8 or 1. Turns 0 to 3 rotate by 0 to 3 quarters; turns 4 to 7 also mirror.
  [[nodiscard]] std::size_t size() const { return turns_.size(); }
  /// Sets the scores of a draw, in the order of the templates; they must outlive the calls of turned().
  void begin(std::span<const float> scores);
  /// Writes the scores after turn number `turn` to `out`, which has the same number of elements.
  void turned(std::size_t turn, std::span<float> out) const;

 private:
  /// Template (orientation o, position p) gets the score of template (from[o], p after the three changes).
  struct Turn {
    std::array<int, 4> from{0, 1, 2, 3};
    bool transposed = false, rows_reversed = false, columns_reversed = false;  ///< changes of p, in this order
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
