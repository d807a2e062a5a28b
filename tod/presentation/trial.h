// SPDX-License-Identifier: GPL-3.0-or-later
// One answer to one triangle, with everything needed to evaluate or repeat it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "tod/plate/target_plate.h"

namespace todbench {

/// Recorded content of an answer.
enum class AnswerKind {
  binary,  ///< right or wrong
  graded,  ///< also the probability of the right answer for the patch
};
inline constexpr std::array all_answer_kinds{AnswerKind::binary, AnswerKind::graded};
[[nodiscard]] constexpr std::string_view to_string(AnswerKind kind) {
  return kind == AnswerKind::binary ? "binary" : "graded";
}

/// A place in the camera's picture, in pixels from the centre of the first one.
struct PlaceInPicture {
  double x_px = 0, y_px = 0;
  bool operator==(const PlaceInPicture&) const = default;
};

/// One answer of an observer.
struct Trial {
  std::int64_t presentation = 0;  ///< counts states shown; trials of one presentation share frame and phase
  std::string plate;
  Mounting mounting = Mounting::identity;
  std::string triangle;      ///< name on the plate
  double set_delta_t_k = 0;  ///< set contrast of the target
  double delta_t_k = 0;      ///< effective contrast measured by the camera
  double size_mm = 0;
  double size_mrad = 0;  ///< square root of area over distance: the abscissa of the psychometric function
  double size_px = 0;    ///< as passed to the observer
  Apex truth = Apex::up;
  Apex answer = Apex::up;
  std::array<double, 4> scores{};
  double phase_x_px = 0, phase_y_px = 0;  ///< centroid minus window centre, in [-0.5, 0.5)
  std::uint64_t frame = 0;                ///< sequence number, of the first if there are several
  std::int64_t device_time_ns = 0;
  std::int64_t host_time_ns = 0;
  double since_nuc_s = -1;   ///< since the last known non-uniformity correction; < 0: none known
  int saturated_pixels = 0;  ///< of the window, at either end of the counts, without defective ones
  /// Probability of the right answer given the patch, over the observer's own noise, averaged over the frames. Empty:
  /// the observer gives the answer only.
  std::optional<double> probability_correct{};
  int frames = 1;  ///< successive good frames for probability_correct; the answer is that to the first frame
  std::optional<PlaceInPicture> centroid{};  ///< of the triangle; empty: not stated, as in earlier versions

  [[nodiscard]] bool correct() const { return truth == answer; }
  bool operator==(const Trial&) const = default;
};

}  // namespace todbench
