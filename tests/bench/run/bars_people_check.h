// SPDX-License-Identifier: GPL-3.0-or-later
// Simulated people before the bars that a session kept.
#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "bench/enhance/bars_questions.h"
#include "bench/session/bars_people.h"
#include "bench/text/files.h"
#include "tests/tod/measures/simulated_choices.h"

namespace todbench::testing {

/// A person of known threshold at every place, who answers all decisions of a seed.
inline BarsSitting answers_of(const KeptBars& kept, const std::vector<BarsQuestion>& questions, const std::string& code,
                              const SimulatedChooser& person, std::uint64_t seed) {
  BarsSitting sitting{.seed = seed};
  sitting.person.code = code;
  const RandomStream random(seed, "bars person");
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const KeptPicture& shown = kept.pictures[questions[i].target_picture];
    const bool right = random.uniform(i) < probability_right(person, shown.contrast_k, shown.set_up);
    sitting.answers.push_back(bars_answer(kept, questions[i], right == questions[i].target_left));
  }
  return sitting;
}

/// Power of one half of a picture at a frequency along x, in cycles per pixel of the screen, from the mean of its rows.
inline double power_along_x(const cv::Mat1b& half, double frequency) {
  std::complex<double> sum = 0;
  for (int x = 0; x < half.cols; ++x) {
    double column = 0;
    for (int y = 0; y < half.rows; ++y) column += half(y, x) - 127.5;
    sum += column * std::polar(1.0, -2 * std::numbers::pi * frequency * x);
  }
  return std::norm(sum);
}

/// Share of right answers of somebody who looks at the pictures of bars along x and answers the side with more power at
/// the frequency of four bars than at that of five.
inline double share_of_a_spectral_person(const KeptBars& kept, const std::vector<BarsQuestion>& questions,
                                         double least_contrast_k) {
  constexpr int magnification = 2;
  int shown = 0, right = 0;
  for (const BarsQuestion& question : questions) {
    const KeptPicture& picture = kept.pictures[question.target_picture];
    const KeptPlace& place = kept.places[picture.place];
    if (place.size_px > 0 || place.axis != EdgeAxis::x || std::abs(picture.contrast_k) < least_contrast_k) continue;
    const cv::Mat1b seen = bars_picture(kept, question, magnification);
    const int side = place.side_px * magnification;
    const double four = place.frequency_per_pitch / magnification, five = four * 9 / 7;
    const auto ratio = [&](const cv::Mat1b& half) { return power_along_x(half, four) / power_along_x(half, five); };
    const bool left = ratio(seen.colRange(0, side)) > ratio(seen.colRange(seen.cols - side, seen.cols));
    ++shown, right += left == question.target_left ? 1 : 0;
  }
  return shown > 0 ? 1.0 * right / shown : 0;
}

/// Enters answers into the folder of write_bars_questions().
inline void enter_answers(const std::filesystem::path& folder, const BarsSitting& sitting) {
  std::string csv = "number,answer\n";
  for (std::size_t i = 0; i < sitting.answers.size(); ++i)
    csv += std::to_string(i + 1) + (sitting.answers[i].answered_left ? ",left\n" : ",right\n");
  static_cast<void>(write_file_atomically(folder / "answers.csv", csv));
}

}  // namespace todbench::testing
