// SPDX-License-Identifier: GPL-3.0-or-later
// A camera whose frames are damaged on the way: faults at chosen exposures, and a book of what was done.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "acquisition/base/rng.h"
#include "acquisition/core/byte_order.h"
#include "acquisition/core/frame_source.h"
#include "acquisition/core/integrity_gate.h"
#include "tests/support/swapped_bytes.h"

namespace todbench::test {

/// Exposure `index` is spoiled with probability `share`; the same exposures for the same seed whatever the fault.
struct FaultPlan {
  std::vector<Rejection> faults;  ///< one of them is drawn for every spoiled exposure
  double share = 0;
  std::uint64_t first = 0;  ///< exposures before it are never spoiled
  std::uint64_t seed = 1;

  [[nodiscard]] std::optional<Rejection> at(std::uint64_t index) const {
    if (faults.empty() || index < first) return std::nullopt;
    const RandomStream random(seed, "faults");
    // The first one is certain, so that no rate is without any.
    if (index > first && random.uniform(index) >= share) return std::nullopt;
    return faults[random.sub(1).below(faults.size(), index)];
  }
};

/// What a faulty camera did.
struct FaultBook {
  std::map<Rejection, std::uint64_t> injected;
  std::uint64_t lost = 0;
  std::set<std::uint64_t> spoiled;                     ///< exposures that must not be measured
  std::map<std::uint64_t, std::uint64_t> exposure_of;  ///< sequence number that was handed out -> exposure
};

/// Damages what a camera sends. Frames that are damaged replace the exposure; repeated and out-of-order ones come in
/// addition to it.
class FaultySource final : public FrameSource {
 public:
  FaultySource(std::unique_ptr<FrameSource> camera, FaultPlan plan, std::shared_ptr<FaultBook> book)
      : camera_(std::move(camera)), plan_(std::move(plan)), book_(std::move(book)) {}

  [[nodiscard]] const SourceInfo& info() const override { return camera_->info(); }
  [[nodiscard]] Result<void> start() override { return camera_->start(); }
  void stop() override { camera_->stop(); }
  [[nodiscard]] Result<std::string> get(const std::string& f) override { return camera_->get(f); }
  [[nodiscard]] Result<void> set(const std::string& f, const std::string& v) override { return camera_->set(f, v); }
  [[nodiscard]] Result<void> correct_nonuniformity() override { return camera_->correct_nonuniformity(); }

  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    if (!extra_.empty()) {
      Frame frame = extra_.back();
      extra_.pop_back();
      return frame;
    }
    auto frame = camera_->next(timeout);
    if (!frame) return frame;
    const std::uint64_t exposure = frame->sequence;
    book_->exposure_of[exposure] = exposure;
    const auto fault = plan_.at(exposure);
    if (fault == Rejection::gapped) {
      // This exposure never arrives, and the one behind the gap is kept out.
      book_->spoiled.insert({exposure, exposure + 1});
      ++book_->lost;
      auto behind = camera_->next(timeout);
      if (!behind) return behind;
      book_->exposure_of[behind->sequence] = behind->sequence;
      ++book_->injected[Rejection::gapped];
      last_ = *behind;
      return behind;
    }
    if (!fault) return last_ = *frame;
    ++book_->injected[*fault];
    const Frame out = damaged(*frame, *fault);
    if (*fault != Rejection::incomplete && *fault != Rejection::wrong_size) last_ = out;
    return out;
  }

 private:
  Frame damaged(Frame frame, Rejection fault) {
    if (fault == Rejection::repeated || fault == Rejection::out_of_order) {
      Frame extra = fault == Rejection::repeated ? frame : last_;
      extra_.push_back(extra);
      return frame;
    }
    book_->spoiled.insert(frame.sequence);
    switch (fault) {
      case Rejection::incomplete:
        frame.status = FrameStatus::incomplete;
        break;
      case Rejection::wrong_size:
        frame.counts = cv::Mat1w(frame.counts(cv::Rect(0, 0, frame.counts.cols, frame.counts.rows - 1))).clone();
        break;
      case Rejection::frozen:
        frame.counts = last_.counts;
        break;
      case Rejection::saturated:
        frame.counts = frame.counts.clone();
        frame.counts.rowRange(0, 10).setTo((1 << frame.significant_bits) - 1);
        break;
      case Rejection::byte_swapped:
        frame.counts = with_swapped_bytes(frame.counts);
        break;
      case Rejection::nonuniformity_correction:
        frame.correction = CorrectionState::running;
        break;
      default:
        break;
    }
    return frame;
  }

  std::unique_ptr<FrameSource> camera_;
  FaultPlan plan_;
  std::shared_ptr<FaultBook> book_;
  Frame last_;                ///< the last whole frame that was handed out
  std::vector<Frame> extra_;  ///< frames that come once more
};

/// A faultless camera that exposes without the given exposures: nobody sees that they are missing.
class SkippingSource final : public FrameSource {
 public:
  SkippingSource(std::unique_ptr<FrameSource> camera, std::set<std::uint64_t> skipped, std::shared_ptr<FaultBook> book)
      : camera_(std::move(camera)), skipped_(std::move(skipped)), book_(std::move(book)) {}

  [[nodiscard]] const SourceInfo& info() const override { return camera_->info(); }
  [[nodiscard]] Result<void> start() override { return camera_->start(); }
  void stop() override { camera_->stop(); }
  [[nodiscard]] Result<std::string> get(const std::string& f) override { return camera_->get(f); }
  [[nodiscard]] Result<void> set(const std::string& f, const std::string& v) override { return camera_->set(f, v); }
  [[nodiscard]] Result<void> correct_nonuniformity() override { return camera_->correct_nonuniformity(); }

  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override {
    while (true) {
      auto frame = camera_->next(timeout);
      if (!frame) return frame;
      if (skipped_.contains(frame->sequence)) continue;
      book_->exposure_of[handed_out_] = frame->sequence;
      frame->sequence = handed_out_++;
      return frame;
    }
  }

 private:
  std::unique_ptr<FrameSource> camera_;
  std::set<std::uint64_t> skipped_;
  std::shared_ptr<FaultBook> book_;
  std::uint64_t handed_out_ = 0;
};

}  // namespace todbench::test
