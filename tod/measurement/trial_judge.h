// SPDX-License-Identifier: GPL-3.0-or-later
// The trials of one presentation: the observer judges the window of every triangle in each frame.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/core/frame.h"
#include "hvs/observer/observer.h"
#include "tod/measurement/frame_taker.h"
#include "tod/measurement/measurement.h"
#include "tod/measurement/prepared_plate.h"
#include "tod/measurement/set_up_step.h"

namespace todbench {

/// Input of TrialJudge::answers(). References are used only during the call.
struct PresentationShown {
  const PreparedPlate& plate;
  const TargetPlate& mounted_plate;
  const Registration& registration;
  const TargetState& state;
  double point_delta_t_k = 0;  ///< set contrast of the point of the curve
  const SeenContrast& seen;
  std::int64_t presentation = 0;
  std::span<const Frame> first_frames;  ///< frames that were already taken; the remaining frames are taken from the
                                        ///< camera
  int frames = 1;                       ///< total number of frames
};

/// Answers to one presentation.
struct PresentationAnswers {
  std::vector<Trial> trials;     ///< one per triangle of the plate
  std::vector<Patch> patches;    ///< windows in the first frame, one per trial
  std::vector<GreyFrame> greys;  ///< one element per frame if contrasts are in grey levels; otherwise empty
};

/// Obtains an observer's answers to the triangles of a presentation. One thread at a time. The arguments of the
/// constructor must outlive the object.
class TrialJudge {
 public:
  TrialJudge(const MeasurementOptions& options, Observer& observer, FrameTaker& taker, SetUpStep& step)
      : options_(options), observer_(observer), taker_(taker), step_(step) {}

  /// Returns the answers to all triangles. Errors: those of the camera; `calibration` (a window is partly outside the
  /// picture); `internal` (frames whose sampling differs from the options); those of the observer.
  [[nodiscard]] Result<PresentationAnswers> answers(const PresentationShown& shown, const std::stop_token& stop);

  /// Converts the side of a window from samples of the judged picture to pixels of the camera. The result is an even
  /// number that covers the window.
  [[nodiscard]] int in_pixels(int side) const;

 private:
  Result<double> of_a_kelvin(const Frame& frame, const PresentationShown& shown, std::vector<GreyFrame>& greys);
  Result<void> judge_frame(const Frame& taken, int number, const PresentationShown& shown, PresentationAnswers& out,
                           std::vector<double>& probabilities);
  [[nodiscard]] GradedChoice judge(const PresentationShown& shown, const Patch& patch, std::size_t triangle,
                                   int frame) const;
  [[nodiscard]] Trial first_answer(std::size_t triangle, const PresentationShown& shown, const Frame& frame,
                                   const Choice& choice, cv::Point2d phase) const;

  const MeasurementOptions& options_;
  Observer& observer_;
  FrameTaker& taker_;
  SetUpStep& step_;
};

}  // namespace todbench
