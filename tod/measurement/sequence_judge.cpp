// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/sequence_judge.h"

#include <algorithm>
#include <cmath>

#include "acquisition/base/try.h"
#include "hvs/observer/eye_noise.h"
#include "tod/plate/test_pattern.h"
#include "tod/registration/patch_windows.h"
#include "tod/registration/super_resolution.h"

namespace todbench {
namespace {

/// Substream of a trial for the noise of the eye.
constexpr std::uint64_t eye_sub_stream = 2;
/// Samples of the finer picture for each sample of a frame and axis.
constexpr int finer = 2;

/// Side of the windows in the frames that a finer window needs: half of it, the step to the finer grid, and the rows
/// and columns at the ends that a frame displaced by a pixel does not reach.
int side_behind(int finer_window) {
  return finer_window / finer + finer_window / finer % 2 + 6;
}

cv::Mat1d seen_in(const cv::Mat1f& frame, const PatchWindow& window) {
  cv::Mat1d kelvin;
  frame(window.pixels).convertTo(kelvin, CV_64F);
  return kelvin;
}

}  // namespace

std::string_view to_string(SequenceObserver observer) {
  constexpr std::array<std::string_view, all_sequence_observers.size()> names{"single-frame", "tracking-sum",
                                                                              "static-sum", "super-resolution"};
  return names[static_cast<std::size_t>(observer)];
}

Result<SequenceJudge> SequenceJudge::prepare(TemplateObserver& observer, std::span<const double> sizes) {
  SequenceJudge judge;
  judge.spec_ = observer.spec();
  judge.steps_ = static_cast<int>(std::lround(1 / judge.spec_.search_step_samples));
  judge.reach_ = static_cast<int>(std::lround(judge.spec_.search_range_samples * judge.steps_));
  TemplateObserverSpec wider = judge.spec_;
  const int half_a_sample = (judge.steps_ + 1) / 2;
  wider.search_range_samples += static_cast<double>(half_a_sample) / judge.steps_;
  judge.wide_reach_ = judge.reach_ + half_a_sample;
  TODBENCH_TRY_VOID(validate(wider));
  for (const double size : sizes) {
    TODBENCH_TRY(auto prepared, observer.prepare(size, 1));
    TODBENCH_TRY(auto bank, TemplateBank::build(wider, triangle_alternatives(), size, 1));
    TODBENCH_TRY(auto in_finer, observer.prepare(finer * size, finer));
    judge.sizes_.push_back({prepared, in_finer, std::make_shared<const TemplateBank>(std::move(bank))});
  }
  return judge;
}

int SequenceJudge::window_samples(std::size_t size) const {
  return std::max({sizes_[size].observer->window_samples(), sizes_[size].bank->window_samples(),
                   side_behind(sizes_[size].finer->window_samples())});
}

int SequenceJudge::choose(SequenceObserver kind, std::size_t size, const SeenSequence& seen,
                          const RandomStream& noise) const {
  if (kind == SequenceObserver::tracking_sum) return tracked(sizes_[size], seen, noise);
  if (kind == SequenceObserver::static_sum) return averaged(sizes_[size], seen, noise);
  if (kind == SequenceObserver::super_resolution) return resolved(sizes_[size], seen, noise);
  const PatchWindow window = patch_window(seen.places.front(), sizes_[size].observer->window_samples());
  const Patch patch{.kelvin = seen_in(seen.frames.front(), window), .phase = window.phase, .noise_k = seen.noise_k};
  return sizes_[size].observer->choose(patch, seen.contrast_k, noise).alternative;
}

int SequenceJudge::averaged(const PreparedSize& size, const SeenSequence& seen, const RandomStream& noise) const {
  const cv::Point2d middle = seen.places.front() + (seen.places.back() - seen.places.front()) / 2;
  const PatchWindow window = patch_window(middle, size.observer->window_samples());
  Patch patch{.kelvin = cv::Mat1d::zeros(window.pixels.size()), .phase = window.phase};
  for (const cv::Mat1f& frame : seen.frames) patch.kelvin += seen_in(frame, window);
  patch.kelvin /= static_cast<double>(seen.frames.size());
  patch.noise_k = seen.noise_k / std::sqrt(static_cast<double>(seen.frames.size()));
  return size.observer->choose(patch, seen.contrast_k, noise).alternative;
}

int SequenceJudge::resolved(const PreparedSize& size, const SeenSequence& seen, const RandomStream& noise) const {
  const int side = side_behind(size.finer->window_samples());
  std::vector<cv::Mat1f> windows;
  std::vector<cv::Point2d> shifts;
  cv::Point2d place;  // of the target in the first window
  for (std::size_t k = 0; k < seen.frames.size(); ++k) {
    const PatchWindow window = patch_window(seen.places[k], side);
    const cv::Point2d inside = seen.places[k] - cv::Point2d(window.pixels.tl());
    if (k == 0) place = inside;
    windows.push_back(seen.frames[k](window.pixels));
    shifts.push_back(inside - place);
  }
  const SuperResolved picture = super_resolve(windows, shifts, finer, EmptyCells::interpolated).value();
  const PatchWindow window = patch_window((place - picture.first_px) * finer, size.finer->window_samples());
  Patch patch{.kelvin = seen_in(picture.picture, window), .phase = window.phase};
  // Of a sample that is the mean of frames / finer^2 frames. Cells without a frame repeat neighbours, which have more
  // frames: the noise of a template is then the same, or slightly less.
  patch.noise_k = seen.noise_k * finer / std::sqrt(static_cast<double>(seen.frames.size()));
  return size.finer->choose(patch, seen.contrast_k, noise).alternative;
}

/// Mean of the scores over the frames, each with the template at the target's place, plus the observer's own noise
/// once.
int SequenceJudge::tracked(const PreparedSize& size, const SeenSequence& seen, const RandomStream& noise) const {
  const TemplateBank& bank = *size.bank;
  const auto samples = static_cast<std::size_t>(bank.window_samples() * bank.window_samples());
  const std::size_t side = static_cast<std::size_t>(2 * reach_ + 1), places = side * side;
  std::vector<float> patch_values(samples), room(samples), scores(bank.padded_templates());
  std::vector<double> sums(static_cast<std::size_t>(bank.alternatives()) * places);
  TemplateObserverSpec without_noise = spec_;
  without_noise.internal_noise = 0;
  without_noise.sensor_noise_factor = 1;
  const double weight = 1.0 / static_cast<double>(seen.frames.size());
  const auto add_scores = [&](cv::Point2d phase, double share) {
    const int right = static_cast<int>(std::lround(phase.x * steps_)) + wide_reach_ - reach_;
    const int down = static_cast<int>(std::lround(phase.y * steps_)) + wide_reach_ - reach_;
    const int wide = 2 * wide_reach_ + 1;
    for (int o = 0; o < bank.alternatives(); ++o) {
      for (int i = 0; i < static_cast<int>(places); ++i) {
        const int x = i % static_cast<int>(side) + right, y = i / static_cast<int>(side) + down;
        sums[static_cast<std::size_t>(o) * places + static_cast<std::size_t>(i)] +=
            share * static_cast<double>(scores[static_cast<std::size_t>(o * bank.places() + y * wide + x)]);
      }
    }
  };
  const auto add = [&](cv::Point2d phase, double share) {
    bank.project(patch_values, scores);
    add_scores(phase, share);
  };
  for (std::size_t k = 0; k < seen.frames.size(); ++k) {
    const PatchWindow window = patch_window(seen.places[k], bank.window_samples());
    const Patch patch{.kelvin = seen_in(seen.frames[k], window), .phase = window.phase};
    seen_patch(without_noise, patch, seen.contrast_k, noise, patch_values, room);
    add(window.phase, weight);
  }
  const Patch nothing{.kelvin = cv::Mat1d::zeros(bank.window_samples(), bank.window_samples()),
                      .phase = {},
                      .noise_k = seen.noise_k * std::sqrt(weight)};
  seen_patch(spec_, nothing, seen.contrast_k, noise, patch_values, room);
  add({0, 0}, 1);
  if (const EyeNoise* eye = bank.eye(); eye != nullptr) {
    std::vector<float> numbers(eye->rank());
    noise.sub(eye_sub_stream).fill_normal(numbers);
    std::fill(scores.begin(), scores.end(), 0.0F);
    eye->add(numbers, static_cast<float>(eye->sd(seen.contrast_k)), scores);
    add_scores({0, 0}, 1);
  }
  Choice choice;
  choice.alternatives = bank.alternatives();
  for (int o = 0; o < choice.alternatives; ++o) {
    const auto begin = sums.begin() + o * static_cast<std::ptrdiff_t>(places);
    choice.scores[static_cast<std::size_t>(o)] = *std::max_element(begin, begin + static_cast<std::ptrdiff_t>(places));
  }
  return winning_alternative(choice, noise);
}

}  // namespace todbench
