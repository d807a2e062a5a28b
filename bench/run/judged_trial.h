// SPDX-License-Identifier: GPL-3.0-or-later
// Answers with the judged patches. People can judge these patches again.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "acquisition/base/rng.h"
#include "bench/session/session_folder.h"
#include "tod/presentation/trial.h"

namespace todbench {

/// An answer with the judged patch.
struct JudgedTrial {
  SessionCurve curve = SessionCurve::main;
  Trial trial;
  cv::Mat1f patch_k;   ///< kelvin
  double noise_k = 0;  ///< temporal noise of a sample, as passed to the observer
};

/// Shuffles the items (Fisher-Yates) with reproducible random numbers.
template <typename T>
void shuffle(std::vector<T>& items, const RandomStream& stream) {
  for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[stream.below(i, i)]);
}

/// Returns the indices of a random choice of `per_size` trials (or all if there are fewer) for each contrast and size,
/// ordered by contrast and size.
[[nodiscard]] std::vector<std::size_t> balanced_choice(const std::vector<JudgedTrial>& trials, int per_size,
                                                       const RandomStream& stream);

}  // namespace todbench
