// How much less graded answers scatter than right and wrong ones, before anything is measured.
#pragma once

#include <array>

namespace todbench {

/// What a design of graded answers is.
struct GradedDesignFigures {
  double sensor_share =
      0;  ///< of the noise that decides an answer, in variance: the sensor's; the rest is the observer's
  double pattern_share = 0;  ///< of the same noise, and part of sensor_share: the sensor's fixed pattern
  double size_pitch = 4;     ///< at the threshold
  int frames = 1;            ///< per presentation
  int draws = 32;            ///< of the observer's own noise for each frame
  int set_ups = 8;           ///< plates times mountings
  int presentations = 96;    ///< of a contrast
};

/// Variance of graded answers over that of right and wrong ones: what frames leave of the noise of the sensor, draws of
/// that of the observer, and set-ups of phases, contrast and registration:
///
///   (f - g) / F + (1 - f) / (F D) + r + g n s,   f = (3/4)^2 (Phi2(z, z; share) - (2/3)^2) / (p (1 - p)),
///   p = 3/4 = 1/4 + 3/4 Phi(z)
///
/// f is the part that noise of the sensor has in an answer at the threshold, which is right by luck in a quarter of the
/// cases and else by a Gaussian decision variable (Phi2: both of two answers to the same frame are); g is that of the
/// fixed pattern, which frames do not average, and the n phases of a triangle of size S only where they move it across
/// its detectors: s = 1.5 exp(-(1.9 / S)^2), S in pitches. 1.5 is for set-ups that put triangles before the same
/// detectors (both numbers from 78 runs of `graded_coverage_study` with a pattern of 0.1 K). r is 0.048 over
/// the number of phases where the mountings cancel the phases (five set-ups or more; 138 runs of 12 phases and 11 of 3
/// of `graded_coverage_study`), at most, and with fewer set-ups, 0.15, that of single phases.
[[nodiscard]] double graded_variance_ratio(const GradedDesignFigures& design);

/// By which a fixed pattern increases the variance of right and wrong answers: 1 + g (n s - 1).
[[nodiscard]] double pattern_inflation(const GradedDesignFigures& design);

/// Frames per presentation that are chosen from and compared.
inline constexpr std::array frame_choices{1, 2, 4, 8};

/// The fewest of `frame_choices` whose variance times the time of a presentation is within 10 % of the least, with
/// `single_s` for a presentation of one frame and `frame_s` for each more. The product is flat about its least value;
/// what is left of the time buys more elsewhere.
[[nodiscard]] int cheapest_frames(GradedDesignFigures design, double single_s, double frame_s);

/// Half a 95 % interval of ln S75 over the standard error behind it (Student's t), times what 19 of 20 runs stay below:
/// a variance from so few set-ups scatters as chi square over its degrees of freedom. From five set-ups on 1.06 of it,
/// the root of what chance adds for detectors that set-ups share (clustered_variance.h).
[[nodiscard]] double graded_interval_factor(const GradedDesignFigures& design);

}  // namespace todbench
