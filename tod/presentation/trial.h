// SPDX-License-Identifier: GPL-3.0-or-later
// One answer to one triangle, with all data that are needed to evaluate or repeat it.
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
  binary,  ///< only the answer, which is correct or wrong
  graded,  ///< the answer, and the probability of the correct answer to the patch
};
inline constexpr std::array all_answer_kinds{AnswerKind::binary, AnswerKind::graded};
[[nodiscard]] constexpr std::string_view to_string(AnswerKind kind) {
  return kind == AnswerKind::binary ? "binary" : "graded";
}

/// A position in the camera's picture, in pixels from the centre of the first pixel.
struct PlaceInPicture {
  double x_px = 0, y_px = 0;
  bool operator==(const PlaceInPicture&) const = default;
};

/// One answer of an observer.
struct Trial {
  std::int64_t presentation = 0;  ///< index of the presented state; trials of one presentation have the same frame and
                                  ///< phase
  std::string plate;
  Mounting mounting = Mounting::identity;
  std::string triangle;      ///< name on the plate
  double set_delta_t_k = 0;  ///< set contrast of the target
  double delta_t_k = 0;      ///< effective contrast measured by the camera
  double size_mm = 0;
  double size_mrad = 0;  ///< square root of area divided by distance: the abscissa of the psychometric function
  double size_px = 0;    ///< size passed to the observer
  Apex truth = Apex::up;
  Apex answer = Apex::up;
  std::array<double, 4> scores{};
  double phase_x_px = 0, phase_y_px = 0;  ///< centroid minus window centre, in [-0.5, 0.5)
  std::uint64_t frame = 0;                ///< sequence number of the (first) frame
  std::int64_t device_time_ns = 0;
  std::int64_t host_time_ns = 0;
  double since_nuc_s = -1;  ///< time since the last known non-uniformity correction; < 0: none known
  /// Number of pixels in the window with the lowest or the highest count, without defective pixels.
  int saturated_pixels = 0;
  /// Probability of the correct answer to the patch, averaged over the internal noise of the observer and over the
  /// frames. Empty: the observer returns only the answer.
  std::optional<double> probability_correct{};
  /// Number of successive accepted frames over which probability_correct is averaged. `answer` is the answer to the
  /// first frame.
  int frames = 1;
  std::optional<PlaceInPicture> centroid{};  ///< centroid of the triangle; empty: not stated, as in earlier versions

  [[nodiscard]] bool correct() const { return truth == answer; }
  bool operator==(const Trial&) const = default;
};

}  // namespace todbench
