// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/trial_judge.h"

#include <algorithm>

#include "acquisition/base/try.h"
#include "acquisition/core/judged_picture.h"
#include "tod/registration/patch_windows.h"

namespace todbench {
namespace {

constexpr std::uint64_t further_frames_stream = 1'000'000;

}  // namespace

RandomStream answer_noise(std::uint64_t seed, std::int64_t presentation, std::size_t triangle) {
  return RandomStream(seed, "observer").sub(static_cast<std::uint64_t>(presentation)).sub(triangle);
}

int TrialJudge::in_pixels(int side) const {
  const int finer = options_.judged_samples_per_pixel;
  return finer == 1 ? side : 2 * ((side + 2 * finer - 1) / (2 * finer) + 1);
}

/// Judged units per kelvin in this frame: 1, the gain of stages, or grey levels, which are recorded.
Result<double> TrialJudge::of_a_kelvin(const Frame& frame, const PresentationShown& shown,
                                       std::vector<GreyFrame>& greys) {
  if (options_.contrast_unit == ContrastUnit::kelvin)
    return step_.gain_of(frame, shown.mounted_plate, shown.registration, shown.seen);
  TODBENCH_TRY(auto grey,
               step_.grey_frame(as_judged(frame), shown.mounted_plate, shown.registration, shown.state, shown.seen));
  grey.presentation = shown.presentation;
  greys.push_back(std::move(grey));
  return greys.back().levels_per_k;
}

/// The answer is that to the first frame, with the same draw as without probabilities; every further frame has its own
/// stream below that of the trial.
GradedChoice TrialJudge::judge(const PresentationShown& shown, const Patch& patch, std::size_t triangle,
                               int frame) const {
  const PreparedObserver& observer = *shown.plate.observers[triangle];
  RandomStream noise = answer_noise(options_.seed, shown.presentation, triangle);
  if (options_.answers == AnswerKind::binary) return {observer.choose(patch, shown.seen.contrast_k, noise), {}};
  if (frame > 0) noise = noise.sub(further_frames_stream + static_cast<std::uint64_t>(frame));
  return observer.judge(patch, shown.seen.contrast_k, noise, MeasurementOptions::graded_draws);
}

Trial TrialJudge::first_answer(std::size_t triangle, const PresentationShown& shown, const Frame& frame,
                               const Choice& choice, cv::Point2d phase) const {
  const PlateTriangle& t = shown.mounted_plate.triangles[triangle];
  Trial trial;
  trial.presentation = shown.presentation;
  trial.plate = shown.state.plate;
  trial.mounting = shown.state.mounting;
  trial.triangle = t.name;
  trial.set_delta_t_k = shown.point_delta_t_k;
  trial.delta_t_k = shown.seen.contrast_k;
  trial.size_mm = t.size_mm;
  trial.size_mrad = t.size_mm / options_.distance_m;
  trial.size_px = shown.plate.size_px[triangle] / options_.judged_samples_per_pixel;
  trial.truth = t.apex;
  trial.answer = static_cast<Apex>(choice.alternative);
  for (std::size_t o = 0; o < trial.scores.size(); ++o) trial.scores[o] = choice.scores[o];
  trial.phase_x_px = phase.x;
  trial.phase_y_px = phase.y;
  trial.frame = frame.sequence;
  trial.device_time_ns = frame.device_time_ns;
  trial.host_time_ns = frame.host_time_ns;
  trial.since_nuc_s = taker_.since_nuc_s(frame);
  return trial;
}

Result<void> TrialJudge::judge_frame(const Frame& taken, int number, const PresentationShown& shown,
                                     PresentationAnswers& out, std::vector<double>& probabilities) {
  if (taken.judged != nullptr && taken.judged->none) return tl::unexpected(*taken.judged->none);
  if (judged_samples_per_pixel(taken) != options_.judged_samples_per_pixel)
    return fail(ErrorCode::internal,
                "the frames have another number of samples per pixel than the options of the run state");
  const Frame frame = as_judged(taken);
  TODBENCH_TRY(const auto unit_per_k, of_a_kelvin(taken, shown, out.greys));
  for (std::size_t i = 0; i < shown.mounted_plate.triangles.size(); ++i) {
    const PlateTriangle& t = shown.mounted_plate.triangles[i];
    const cv::Point2d place = shown.registration.pixel(t.position_mm);
    const int side = shown.plate.observers[i]->window_samples();
    const auto window = patch_window(judged_place(taken, place), side);
    if ((window.pixels & cv::Rect({0, 0}, frame.counts.size())) != window.pixels)
      return fail(ErrorCode::calibration, "the plate is too close to the edge of the picture: " + t.name);
    TODBENCH_TRY(auto kelvin, window_kelvin(frame, window.pixels));
    if (unit_per_k != 1) kelvin /= unit_per_k;
    Patch patch{.kelvin = std::move(kelvin), .phase = window.phase, .noise_k = shown.seen.noise_k};
    const GradedChoice judged = judge(shown, patch, i, number);
    const int saturated = std::max(step_.saturated_samples(taken, window.pixels),
                                   step_.saturated_pixels(taken, patch_window(place, in_pixels(side)).pixels));
    probabilities[i] += judged.answers.probability[static_cast<std::size_t>(t.apex)];
    if (number == 0) {
      out.trials.push_back(first_answer(i, shown, frame, judged.choice, window.phase));
      out.trials.back().centroid = PlaceInPicture{place.x, place.y};
      out.patches.push_back(std::move(patch));
    }
    out.trials[i].saturated_pixels = std::max(out.trials[i].saturated_pixels, saturated);
  }
  return {};
}

Result<PresentationAnswers> TrialJudge::answers(const PresentationShown& shown, const std::stop_token& stop) {
  PresentationAnswers out;
  std::vector<double> probabilities(shown.mounted_plate.triangles.size());
  for (int k = 0; k < shown.frames; ++k) {
    const auto at = static_cast<std::size_t>(k);
    TODBENCH_TRY(const auto taken, at < shown.first_frames.size() ? shown.first_frames[at] : taker_.next(stop));
    TODBENCH_TRY_VOID(judge_frame(taken, k, shown, out, probabilities));
  }
  if (const auto failure = observer_.failure()) return fail("the observer", *failure);
  for (std::size_t i = 0; i < out.trials.size() && options_.answers == AnswerKind::graded; ++i) {
    out.trials[i].probability_correct = std::min(1.0, probabilities[i] / shown.frames);
    out.trials[i].frames = shown.frames;
  }
  return out;
}

}  // namespace todbench
