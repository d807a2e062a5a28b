// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/integrity_gate.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "acquisition/core/byte_order.h"

namespace todbench {
namespace {

/// Frames compared with each new one: a transfer that repeats an old buffer repeats one of its own few. Two pictures of
/// a camera with noise differ within their first pixels, so the comparison is cheap.
constexpr std::size_t remembered_frames = 8;

bool same_pixels(const cv::Mat1w& a, const cv::Mat1w& b) {
  if (a.size() != b.size()) return false;
  for (int row = 0; row < a.rows; ++row) {
    if (std::memcmp(a.ptr(row), b.ptr(row), static_cast<std::size_t>(a.cols) * sizeof(std::uint16_t)) != 0)
      return false;
  }
  return true;
}

double saturated_share(const Frame& frame) {
  const auto full_scale = static_cast<std::uint16_t>((1u << frame.significant_bits) - 1u);
  std::size_t saturated = 0;
  for (int row = 0; row < frame.counts.rows; ++row) {
    const std::uint16_t* pixels = frame.counts.ptr<std::uint16_t>(row);
    for (int column = 0; column < frame.counts.cols; ++column) {
      saturated += pixels[column] == 0 || pixels[column] >= full_scale ? 1 : 0;
    }
  }
  return static_cast<double>(saturated) / static_cast<double>(frame.counts.total());
}

}  // namespace

std::string_view to_string(Rejection reason) {
  switch (reason) {
    case Rejection::incomplete:
      return "incomplete";
    case Rejection::wrong_size:
      return "wrong_size";
    case Rejection::repeated:
      return "repeated";
    case Rejection::out_of_order:
      return "out_of_order";
    case Rejection::gapped:
      return "gapped";
    case Rejection::frozen:
      return "frozen";
    case Rejection::saturated:
      return "saturated";
    case Rejection::byte_swapped:
      return "byte_swapped";
    case Rejection::nonuniformity_correction:
      return "nonuniformity_correction";
  }
  return "unknown";
}

std::string describe(const NumberingFaults& faults) {
  std::string text;
  if (faults.restarts + faults.silent_gaps > 0) {
    text = "The frame numbers of the camera do not agree with the elapsed time. Restarts of the numbers: " +
           std::to_string(faults.restarts) + ". Pauses without missing numbers: " + std::to_string(faults.silent_gaps) +
           ". Lost frames estimated from the time: " + std::to_string(faults.estimated_lost) + ".";
  }
  if (faults.unread > 0) {
    text += (text.empty() ? "" : " ") + std::to_string(faults.unread) +
            " of the lost frames arrived while the program was busy and found its buffers full.";
  }
  return text;
}

IntegrityGate::IntegrityGate(IntegrityOptions options) : options_(options) {}

std::optional<Rejection> IntegrityGate::judge_sequence(const Frame& frame) {
  const auto last = last_sequence_;
  numbering_.restarts += frame.numbering == Numbering::restarted ? 1 : 0;
  numbering_.silent_gaps += frame.numbering == Numbering::timed ? 1 : 0;
  if (last && frame.sequence == *last) return Rejection::repeated;
  if (last && frame.sequence < *last) return Rejection::out_of_order;
  last_sequence_ = frame.sequence;
  if (!last || frame.sequence == *last + 1) return std::nullopt;
  const std::uint64_t missing = frame.sequence - *last - 1;
  lost_ += missing;
  const bool estimated = frame.numbering == Numbering::restarted || frame.numbering == Numbering::timed;
  if (estimated) numbering_.estimated_lost += missing;
  if (frame.numbering == Numbering::unread) numbering_.unread += missing;
  return Rejection::gapped;
}

std::optional<Rejection> IntegrityGate::judge_pixels(const Frame& frame) {
  if (options_.reject_frozen) {
    const auto twin = std::find_if(recent_.begin(), recent_.end(),
                                   [&](const cv::Mat1w& old) { return same_pixels(frame.counts, old); });
    const bool newest = twin == recent_.begin(), found = twin != recent_.end();
    if (found) return newest ? Rejection::frozen : Rejection::repeated;
    recent_.push_front(frame.counts);
    if (recent_.size() > remembered_frames) recent_.pop_back();
  }
  if (frame.significant_bits > 8 && byte_order_evidence(frame.counts, {}).verdict == ByteOrderVerdict::swapped) {
    return Rejection::byte_swapped;
  }
  if (saturated_share(frame) > options_.max_saturated_share) return Rejection::saturated;
  return std::nullopt;
}

std::optional<Rejection> IntegrityGate::judge(const Frame& frame) {
  std::optional<Rejection> reason = judge_sequence(frame);
  // A damaged frame after a gap counts as damaged, because the gap is in lost().
  if (!reason || reason == Rejection::gapped) {
    const bool wrong_size = frame.status == FrameStatus::wrong_size || frame.counts.empty() ||
                            (options_.width > 0 && frame.counts.cols != options_.width) ||
                            (options_.height > 0 && frame.counts.rows != options_.height);
    if (frame.status == FrameStatus::incomplete) {
      reason = Rejection::incomplete;
    } else if (wrong_size) {
      reason = Rejection::wrong_size;
    } else if (const auto pixels = judge_pixels(frame)) {
      reason = pixels;
    }
  }
  if (reason) {
    ++rejected_[*reason];
  } else {
    ++accepted_;
  }
  return reason;
}

void IntegrityGate::recount(Rejection from, Rejection to) {
  const auto found = rejected_.find(from);
  assert(found != rejected_.end() && found->second > 0);
  if (--found->second == 0) rejected_.erase(found);
  ++rejected_[to];
}

void IntegrityGate::reject_accepted(Rejection reason) {
  --accepted_;
  ++rejected_[reason];
}

std::uint64_t IntegrityGate::rejected() const {
  std::uint64_t sum = 0;
  for (const auto& [reason, count] : rejected_) sum += count;
  return sum;
}

}  // namespace todbench
