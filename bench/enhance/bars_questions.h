// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions of a person between the windows of bars stored in a session. The windows are shown in the window of the
// program, or as pictures in a folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/session/bars_people.h"
#include "tod/camera_measures/kept_bars.h"

namespace todbench {

/// Selection of decisions.
struct BarsRequest {
  /// If true, uses all bars and spots of the session. Otherwise uses the bars of each axis with the frequency nearest
  /// to `frequency_per_pitch`, and the spot with the size nearest to `spot_px`.
  bool all_places = false;
  /// Frequency in cycles per pitch, as in the plan.
  double frequency_per_pitch = 0.25;
  /// Side of the spot in pixels, as in the plan.
  double spot_px = 3;
  int times = 1;           ///< decisions at each contrast of each set-up, for each group of bars or spot
  int magnification = 12;  ///< screen pixels per pixel of the camera
  std::uint64_t seed = 1;
};

/// One decision between the two windows of a group of bars or a spot, at one contrast in one set-up. The windows come
/// from two frames if the session keeps more than one.
struct BarsQuestion {
  std::size_t target_picture = 0, other_picture = 0;  ///< indices in KeptBars::pictures
  bool target_left = false;
};

/// Returns all decisions of a request in random order. Errors: `invalid_input` (no bars or spots, or fewer than five
/// set-ups, which are not enough for a threshold).
[[nodiscard]] Result<std::vector<BarsQuestion>> bars_questions(const KeptBars& kept, const BarsRequest& request);
/// Returns both windows side by side, separated by a strip of background: 8-bit grey, enlarged by bicubic
/// interpolation. The range of the grey scale is three times the contrast, or six times the root mean square of the
/// samples of both windows if this value is larger. The grey scale is the same whether the target is on the left or on
/// the right.
[[nodiscard]] cv::Mat1b bars_picture(const KeptBars& kept, const BarsQuestion& question, int magnification);
/// Returns the answer to a decision in the form of the record.
[[nodiscard]] BarsAnswer bars_answer(const KeptBars& kept, const BarsQuestion& question, bool answered_left);

/// Writes the pictures of all decisions to a new folder (0001.png ...), answers.csv with an empty answer for each, and
/// bars.json with the request. The folder does not reveal the side of the target. Errors: `invalid_input` (folder
/// exists; as bars_questions()), `io`. Returns the number of decisions.
[[nodiscard]] Result<std::size_t> write_bars_questions(const std::filesystem::path& folder,
                                                       const std::filesystem::path& session, const KeptBars& kept,
                                                       const BarsRequest& request);
/// Reads the answers ("left" or "right"; empty: not answered) that a person entered in answers.csv. Errors:
/// `invalid_input` with the file and line (a word other than "left" or "right", a wrong number of rows, pictures of a
/// different session, no answer at all).
[[nodiscard]] Result<BarsSitting> read_bars_answers(const std::filesystem::path& folder,
                                                    const std::filesystem::path& session, const KeptBars& kept);

}  // namespace todbench
