// SPDX-License-Identifier: GPL-3.0-or-later
// Answers of people to the bars and spots stored in a session, and their MRTD: people/bars.json.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/session/human_record.h"
#include "bench/text/json.h"
#include "tod/measures/forced_choice.h"
#include "tod/measures/slanted_edge.h"

namespace todbench {

/// One decision of a person between two windows of one contrast and set-up.
struct BarsAnswer {
  std::string place;  ///< group of four bars, or spot
  EdgeAxis axis = EdgeAxis::x;
  double frequency_per_pitch = 0, size_px = 0;
  double contrast_k = 0;  ///< reported by the target, signed
  int set_up = 0;
  bool target_left = false, answered_left = false;
  std::optional<double> response_s{};  ///< time from display to answer; empty: unknown
};

/// Answers of a person at one sitting.
struct BarsSitting {
  PersonFacts person{};
  std::uint64_t seed = 1;  ///< seed for the order of the decisions
  int magnification = 1;   ///< screen pixels per pixel of the camera; bicubic
  std::vector<BarsAnswer> answers{};
};

/// Threshold of a sitting for one place, which is a group of four bars or a spot.
struct BarsThreshold {
  std::string place;
  EdgeAxis axis = EdgeAxis::x;
  double frequency_per_pitch = 0, size_px = 0;
  ForcedChoiceThreshold found{};
};
/// Returns one threshold for each place of the answers: x before y, low frequencies first, spots last.
[[nodiscard]] std::vector<BarsThreshold> bars_thresholds(const BarsSitting& sitting);

/// Mean threshold of one place over people. All people judged the same frames. The set-ups therefore contribute an
/// error that is common to all people. The interval combines the scatter between people with this common variance (n V
/// - v) / (n - 1). n is the number of people, V the jackknife variance of the mean over the set-ups, and v the mean of
/// the jackknife variances of the single sittings.
struct BarsMean {
  /// Place of the mean. The threshold of the place is not set.
  BarsThreshold of{};
  MeanOverPeople over{};
  /// Number of sittings without a threshold. If above 0, there is no mean, because the mean would represent only the
  /// best observers.
  int without = 0;
  int answers = 0;  ///< number of answers in all sittings
};
/// A person and the thresholds of one sitting.
struct JudgedBars {
  std::string person;
  std::vector<BarsThreshold> thresholds;
};
/// Returns each person with the thresholds of bars_thresholds().
[[nodiscard]] std::vector<JudgedBars> judged_bars(const std::vector<BarsSitting>& sittings);
/// Returns the mean at every place of the sittings, in the order of bars_thresholds().
[[nodiscard]] std::vector<BarsMean> bars_means(const std::vector<JudgedBars>& sittings);

/// Adds a sitting to people/bars.json of a finished session and lists the file in the manifest. Earlier answers remain.
/// Errors: `io`; `invalid_input` (no manifest, or files that differ from it), in which case no file is written.
[[nodiscard]] Result<void> add_bars_sitting(const std::filesystem::path& session, const BarsSitting& sitting);
/// Reads the sittings of a session that open_session() accepted, in the order of their answers. Errors: `io`;
/// `invalid_input` with the file.
[[nodiscard]] Result<std::vector<BarsSitting>> read_bars_sittings(const std::filesystem::path& session);

/// Returns {"people": [{"person", "judged_utc", "thresholds": [...]}], "means": [...]}.
[[nodiscard]] Json bars_people_json(const std::vector<BarsSitting>& sittings);

}  // namespace todbench
