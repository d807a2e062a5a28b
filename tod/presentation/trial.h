// One question, one answer, and everything needed to judge or repeat it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "tod/plate/target_plate.h"

namespace todbench {

/// What is kept of an answer.
enum class AnswerKind {
  binary,  ///< right or wrong
  graded,  ///< and how probable the right answer was for what was seen
};
inline constexpr std::array all_answer_kinds{AnswerKind::binary, AnswerKind::graded};
[[nodiscard]] constexpr std::string_view to_string(AnswerKind kind) {
  return kind == AnswerKind::binary ? "binary" : "graded";
}

/// Where something is in the picture of the camera, in pixels from the centre of the first one.
struct PlaceInPicture {
  double x_px = 0, y_px = 0;
  bool operator==(const PlaceInPicture&) const = default;
};

struct Trial {
  std::int64_t presentation = 0;  ///< counts states shown; trials of one presentation share frame and phase
  std::string plate;
  Mounting mounting = Mounting::identity;
  std::string triangle;      ///< name on the plate
  double set_delta_t_k = 0;  ///< what the target was told
  double delta_t_k = 0;      ///< effective contrast measured by the camera
  double size_mm = 0;
  double size_mrad = 0;  ///< square root of area over distance: the abscissa of the psychometric function
  double size_px = 0;    ///< what the observer was told
  Apex truth = Apex::up;
  Apex answer = Apex::up;
  std::array<double, 4> scores{};
  double phase_x_px = 0, phase_y_px = 0;  ///< centroid minus window centre, in [-0.5, 0.5)
  std::uint64_t frame = 0;                ///< sequence number; of the first, where there are several
  std::int64_t device_time_ns = 0;
  std::int64_t host_time_ns = 0;
  double since_nuc_s = -1;   ///< since the last non-uniformity correction that the program knows of; < 0: none known
  int saturated_pixels = 0;  ///< of the window, at either end of the counts; those that always read so are left out
  /// Of an observer that can say it: the probability of the right answer given the patch, over the noise that the
  /// observer adds itself, averaged over the frames. Nothing: only the answer is known.
  std::optional<double> probability_correct{};
  int frames = 1;  ///< successive good frames behind probability_correct; the answer is that to the first
  std::optional<PlaceInPicture> centroid{};  ///< of the triangle; nothing: not said, as in earlier versions

  [[nodiscard]] bool correct() const { return truth == answer; }
  bool operator==(const Trial&) const = default;
};

}  // namespace todbench
