#include "acquisition/core/integrity_gate.h"

#include <cstring>

namespace todbench {
namespace {

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
    case Rejection::frozen:
      return "frozen";
    case Rejection::saturated:
      return "saturated";
    case Rejection::nonuniformity_correction:
      return "nonuniformity_correction";
  }
  return "unknown";
}

IntegrityGate::IntegrityGate(IntegrityOptions options) : options_(options) {}

std::optional<Rejection> IntegrityGate::judge(const Frame& frame) {
  const auto rejected_for = [this](Rejection reason) {
    reject(reason);
    return std::optional(reason);
  };
  if (last_sequence_ && frame.sequence == *last_sequence_) return rejected_for(Rejection::repeated);
  if (last_sequence_ && frame.sequence < *last_sequence_) return rejected_for(Rejection::out_of_order);
  if (last_sequence_) lost_ += frame.sequence - *last_sequence_ - 1;
  last_sequence_ = frame.sequence;

  if (frame.status == FrameStatus::wrong_size || frame.counts.empty()) return rejected_for(Rejection::wrong_size);
  if (frame.status == FrameStatus::incomplete) return rejected_for(Rejection::incomplete);
  if ((options_.width > 0 && frame.counts.cols != options_.width) ||
      (options_.height > 0 && frame.counts.rows != options_.height)) {
    return rejected_for(Rejection::wrong_size);
  }
  const bool frozen = options_.reject_frozen && same_pixels(frame.counts, last_counts_);
  last_counts_ = frame.counts;
  if (frozen) return rejected_for(Rejection::frozen);
  if (saturated_share(frame) > options_.max_saturated_share) return rejected_for(Rejection::saturated);
  ++accepted_;
  return std::nullopt;
}

void IntegrityGate::reject(Rejection reason) {
  ++rejected_[reason];
}

std::uint64_t IntegrityGate::rejected() const {
  std::uint64_t sum = 0;
  for (const auto& [reason, count] : rejected_) sum += count;
  return sum;
}

}  // namespace todbench
