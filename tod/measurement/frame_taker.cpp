// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/frame_taker.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "acquisition/base/try.h"
#include "acquisition/core/count_step.h"
#include "tod/measures/temporal_noise.h"

namespace todbench {
namespace {

/// The share of rejected frames is not checked before this many.
constexpr std::uint64_t frames_before_share_counts = 100;

/// Variance of the means of rows (`dimension` 1) or columns (0) of a difference of two frames, per frame.
double variance_of_means(const cv::Mat1d& difference, int dimension) {
  cv::Mat1d means;
  cv::reduce(difference, means, dimension, cv::REDUCE_AVG);
  const auto n = static_cast<double>(means.total());
  cv::Scalar mean, sd;
  cv::meanStdDev(means, mean, sd);
  return n > 1 ? sd[0] * sd[0] * n / (n - 1) / 2 : 0;
}

double mean_square(const cv::Mat1d& difference) {
  cv::Scalar mean, sd;
  cv::meanStdDev(difference, mean, sd);
  return sd[0] * sd[0] / 2;
}

/// Differences between successive frames of one scene.
class FrameDifferences {
 public:
  FrameDifferences(int frames, FrameGain gain)
      : gain_(gain), lag_(static_cast<std::uint64_t>(std::min(8, frames / 4))) {}

  void add(const Frame& frame, const cv::Mat1d& kelvin) {
    for (const Old& old : old_) {
      const std::uint64_t apart = frame.sequence - old.sequence;
      if (apart != 1 && apart != lag_) continue;
      AtLag& at = apart == 1 ? successive_ : later_;
      at.squares += mean_square(difference_of(old.kelvin, kelvin, gain_));
      ++at.pairs;
    }
    if (!old_.empty()) {
      // If frames are missing between all of them, the next one is used.
      const cv::Mat1d difference = difference_of(old_.back().kelvin, kelvin, gain_);
      neighbours_.squares += mean_square(difference);
      ++neighbours_.pairs;
      row_means_ += variance_of_means(difference, 1);
      column_means_ += variance_of_means(difference, 0);
      size_ = difference.size();
    }
    step_.add(frame.counts);
    old_.push_back({frame.sequence, kelvin});
    if (old_.size() > std::max<std::size_t>(1, lag_)) old_.pop_front();
  }

  [[nodiscard]] double noise() const { return std::sqrt((successive_.pairs > 0 ? successive_ : neighbours_).mean()); }

  [[nodiscard]] std::optional<double> lag1_correlation() const {
    if (lag_ < 2 || later_.pairs == 0 || !(successive_.mean() > 0)) return std::nullopt;
    return first_order_correlation(later_.mean() / successive_.mean(), static_cast<int>(lag_));
  }

  [[nodiscard]] int step() const { return step_.step(); }

  /// The mean over a row contains its share of the noise of single pixels, and so does that over a column.
  [[nodiscard]] std::optional<cv::Vec2d> row_and_column_variances() const {
    if (neighbours_.pairs == 0 || size_.width < 2 || size_.height < 2) return std::nullopt;
    const double rows = row_means_ / neighbours_.pairs, columns = column_means_ / neighbours_.pairs;
    const double of_row = 1.0 / size_.width, of_column = 1.0 / size_.height;
    const double pixel = (neighbours_.mean() - rows - columns) / (1 - of_row - of_column);
    return cv::Vec2d(rows - pixel * of_row, columns - pixel * of_column);
  }

 private:
  struct Old {
    std::uint64_t sequence = 0;
    cv::Mat1d kelvin;
  };
  struct AtLag {
    double squares = 0;
    int pairs = 0;
    [[nodiscard]] double mean() const { return pairs > 0 ? squares / pairs : 0; }
  };

  FrameGain gain_;
  std::uint64_t lag_;
  std::deque<Old> old_;
  CountStep step_;
  AtLag successive_, later_, neighbours_;
  double row_means_ = 0, column_means_ = 0;  ///< sums of variances
  cv::Size size_;
};

}  // namespace

FrameTaker::FrameTaker(FrameSource& source, FrameTakerOptions options)
    : source_(source), options_(std::move(options)), gate_(options_.integrity) {}

void FrameTaker::scene_changed(std::int64_t now_ns) {
  valid_from_ns_ = now_ns;
  watch_.scene_changed();
  to_discard_ = options_.frames_after_change;
}

Result<void> FrameTaker::correct_nonuniformity() {
  auto done = source_.correct_nonuniformity();
  if (!done) return fail("correcting the camera's non-uniformity", done.error());
  return {};
}

void FrameTaker::corrected(std::int64_t now_ns) {
  nuc_ns_ = known_nuc_ns_ = now_ns;
  watch_.scene_changed();
}

double FrameTaker::since_nuc_s(const Frame& frame) const {
  return nuc_ns_ ? static_cast<double>(frame.host_time_ns - *nuc_ns_) * 1e-9 : -1;
}

Result<void> FrameTaker::check_share() const {
  // Frames rejected because of a correction do not count; exposures that never arrived do. A frame after a gap counts
  // once for all that are missing before it. Exposures that nobody took while the program computed say nothing about
  // camera and cable.
  const std::uint64_t lost = gate_.lost() - gate_.numbering().unread;
  std::uint64_t bad = lost;
  std::string reasons = lost > 0 ? std::to_string(lost) + " lost" : "";
  for (const auto& [reason, count] : gate_.rejected_by_reason()) {
    if (reason == Rejection::nonuniformity_correction || reason == Rejection::gapped) continue;
    bad += count;
    reasons += (reasons.empty() ? "" : ", ") + std::to_string(count) + " " + std::string(to_string(reason));
  }
  bad -= std::min(bad, excused_ + cadence_.repeats());
  const std::uint64_t all = seen_ + lost;
  if (all < frames_before_share_counts ||
      static_cast<double>(bad) <= options_.max_rejected_share * static_cast<double>(all))
    return {};
  return fail(ErrorCode::integrity,
              std::to_string(bad) + " of " + std::to_string(all) + " frames are unusable (" + reasons + ")");
}

void FrameTaker::note_told_correction(const Frame& frame) {
  told_of_corrections_ = told_of_corrections_ || frame.correction != CorrectionState::unknown;
  if (frame.correction == CorrectionState::running) nuc_ns_ = known_nuc_ns_ = frame.host_time_ns;
  if (frame.since_correction_s < 0) return;
  const std::int64_t told = frame.host_time_ns - static_cast<std::int64_t>(frame.since_correction_s * 1e9);
  nuc_ns_ = std::max(nuc_ns_.value_or(told), told);
  known_nuc_ns_ = std::max(known_nuc_ns_.value_or(told), told);
}

std::optional<CorrectionSign> FrameTaker::see_correction(const Frame& frame, std::optional<Rejection> rejection,
                                                         Scene scene) {
  // A camera that reports its corrections is trusted; frames without noise are no evidence.
  if (!options_.integrity.reject_frozen || frame.correction != CorrectionState::unknown) return std::nullopt;
  if (rejection == Rejection::frozen && cadence_.in_rhythm()) return std::nullopt;
  if (rejection == Rejection::frozen) return watch_.see_frozen();
  if (rejection && rejection != Rejection::gapped) return std::nullopt;
  if (scene == Scene::moving || frame.host_time_ns < valid_from_ns_ || to_discard_ > 0) return std::nullopt;
  return watch_.see(frame);
}

std::optional<RejectedFrame> FrameTaker::judge(const Frame& frame, Scene scene) {
  const auto rejection = gate_.judge(frame);
  if (!rejection || rejection == Rejection::frozen) cadence_.see(rejection == Rejection::frozen);
  note_told_correction(frame);
  const auto seen = see_correction(frame, rejection, scene);
  if (seen) nuc_ns_ = frame.host_time_ns;
  if (rejection == Rejection::frozen && known_nuc_ns_ &&
      static_cast<double>(frame.host_time_ns - *known_nuc_ns_) * 1e-9 < options_.nuc_wait_s) {
    // Cameras repeat their last picture while the shutter is closed: for half a second after a command this is not a
    // fault.
    gate_.recount(Rejection::frozen, Rejection::nonuniformity_correction);
    return RejectedFrame{.sequence = frame.sequence, .reason = Rejection::nonuniformity_correction, .seen = seen};
  }
  if (rejection) return RejectedFrame{.sequence = frame.sequence, .reason = *rejection, .seen = seen};
  const bool settling = nuc_ns_ && since_nuc_s(frame) < options_.nuc_wait_s;
  if (!settling && !seen && frame.correction != CorrectionState::running) return std::nullopt;
  gate_.reject_accepted(Rejection::nonuniformity_correction);
  return RejectedFrame{.sequence = frame.sequence, .reason = Rejection::nonuniformity_correction, .seen = seen};
}

Result<bool> FrameTaker::accept(const Frame& frame, Scene scene) {
  ++seen_;
  const auto rejected = judge(frame, scene);
  if (rejected && options_.on_rejected) options_.on_rejected(*rejected);
  // A black body on its way may fill the picture; transport faults count at any time.
  const auto of_the_picture = {Rejection::saturated, Rejection::byte_swapped, Rejection::frozen};
  const bool repeated = rejected && rejected->reason == Rejection::frozen;
  const bool excused =
      scene == Scene::moving && rejected && !(repeated && cadence_.in_rhythm()) &&
      std::find(of_the_picture.begin(), of_the_picture.end(), rejected->reason) != of_the_picture.end();
  excused_ += excused ? 1 : 0;
  TODBENCH_TRY_VOID(check_share());
  return !rejected;
}

Result<void> FrameTaker::take_while_presenting(const std::function<bool(std::int64_t calls)>& enough) {
  // Longest delay in noticing the end of a change if no frame arrives.
  constexpr std::chrono::milliseconds look_every{100};
  for (std::int64_t calls = 0; !enough(calls); ++calls) {
    const auto frame = source_.next(std::min(look_every, options_.frame_timeout));
    if (!frame && frame.error().code == ErrorCode::timeout) continue;
    if (!frame) return tl::unexpected(frame.error());
    TODBENCH_TRY_VOID(accept(*frame, Scene::moving));
  }
  return {};
}

Result<Frame> FrameTaker::from_source(const std::stop_token& stop) {
  if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
  auto frame = source_.next(options_.frame_timeout);
  if (frame && options_.scale) frame->scale = options_.scale;
  if (frame) return frame;
  if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
  if (frame.error().code == ErrorCode::timeout) {
    return fail(ErrorCode::disconnected, "camera " + source_.info().id + " sent no frame for " +
                                             std::to_string(options_.frame_timeout.count()) + " ms");
  }
  return frame;
}

Result<Frame> FrameTaker::next_of_moving_scene(std::stop_token stop) {
  while (true) {
    auto frame = from_source(stop);
    if (!frame) return frame;
    TODBENCH_TRY(const auto accepted, accept(*frame, Scene::moving));
    if (!accepted) continue;
    ++used_;
    return frame;
  }
}

Result<Frame> FrameTaker::next(std::stop_token stop) {
  while (true) {
    auto frame = from_source(stop);
    if (!frame) return frame;
    TODBENCH_TRY(const auto accepted, accept(*frame, Scene::still));
    if (!accepted || frame->host_time_ns < valid_from_ns_) continue;
    if (to_discard_ > 0) {
      --to_discard_;
      continue;
    }
    ++used_;
    return frame;
  }
}

Result<void> FrameTaker::discard(std::stop_token stop) {
  TODBENCH_TRY_VOID(next(std::move(stop)));
  --used_;
  return {};
}

Result<AveragedPicture> FrameTaker::average(int count, std::stop_token stop, const EachFrame& each) {
  AveragedPicture out;
  FrameDifferences differences(count, options_.gain);
  for (int i = 0; i < count; ++i) {
    TODBENCH_TRY(auto frame, next(stop));
    TODBENCH_TRY(auto kelvin, to_kelvin(frame));
    if (out.kelvin.empty()) {
      out.kelvin = cv::Mat1d::zeros(kelvin.size());
      out.lowest = frame.counts.clone();
      out.highest = frame.counts.clone();
      out.significant_bits = frame.significant_bits;
    }
    out.kelvin += kelvin;
    out.lowest = cv::min(out.lowest, frame.counts);
    out.highest = cv::max(out.highest, frame.counts);
    differences.add(frame, kelvin);
    if (each) each(frame, kelvin);
  }
  out.kelvin /= count;
  if (count > 1) out.temporal_noise_k = differences.noise();
  out.lag1_correlation = differences.lag1_correlation();
  if (const auto lines = differences.row_and_column_variances()) {
    out.row_variance_k2 = (*lines)[0];
    out.column_variance_k2 = (*lines)[1];
  }
  out.count_step = differences.step();
  return out;
}

std::map<std::string, std::uint64_t> FrameTaker::rejected() const {
  std::map<std::string, std::uint64_t> out;
  for (const auto& [reason, count] : gate_.rejected_by_reason()) out[std::string(to_string(reason))] = count;
  return out;
}

double noise_of_one_frame(const AveragedPicture& picture) {
  // Below this correlation successive frames understate the noise of one by less than 3 %.
  constexpr double noticeable_correlation = 0.05;
  const double rho = picture.lag1_correlation.value_or(0);
  // Above 0.99 it changes so slowly that this few frames do not distinguish it from drift.
  if (rho < noticeable_correlation) return picture.temporal_noise_k;
  return picture.temporal_noise_k / std::sqrt(1 - std::min(rho, 0.99));
}

Result<cv::Mat1d> window_kelvin(const Frame& frame, const cv::Rect& window) {
  cv::Mat1d out(window.size());
  const LinearScale* line = frame.scale->straight_line();
  for (int row = 0; row < window.height; ++row) {
    const auto* counts = frame.counts[window.y + row] + window.x;
    double* into = out[row];
    for (int column = 0; column < window.width; ++column) {
      if (line != nullptr) {
        into[column] = line->offset_k + line->kelvin_per_count * counts[column];
        continue;
      }
      const auto kelvin = frame.scale->kelvin(counts[column]);
      if (!kelvin)
        return fail(ErrorCode::calibration, "a pixel has no temperature on the scale " + frame.scale->describe());
      into[column] = *kelvin;
    }
  }
  return out;
}

}  // namespace todbench
