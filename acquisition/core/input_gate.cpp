// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/input_gate.h"

#include <array>

namespace todbench {
namespace {

/// Share of all frames; a smaller share is left out and reported.
constexpr double most_damaged_share = 0.01;

constexpr std::array all_damages{Rejection::incomplete, Rejection::wrong_size, Rejection::repeated,
                                 Rejection::out_of_order, Rejection::byte_swapped};

std::string sentence_of(Rejection reason, const std::string& frames) {
  switch (reason) {
    case Rejection::incomplete:
      return frames + " are incomplete";
    case Rejection::wrong_size:
      return frames + " have another size than the recording states";
    case Rejection::repeated:
      return frames + " repeat an earlier frame bit for bit, so they are not separate exposures";
    case Rejection::out_of_order:
      return frames + " are out of order";
    case Rejection::byte_swapped:
      return frames + " have the two bytes of their pixels swapped";
    default:
      return frames + " are " + std::string(to_string(reason));
  }
}

bool many(std::uint64_t count, std::uint64_t frames) {
  return static_cast<double>(count) > most_damaged_share * static_cast<double>(frames);
}

std::string of_all(std::uint64_t count, std::uint64_t frames) {
  return std::to_string(count) + " of " + std::to_string(frames) + " frames";
}

}  // namespace

Result<void> judge_damages(const std::map<Rejection, std::uint64_t>& rejected, std::uint64_t frames,
                           std::span<const Rejection> damages) {
  for (const Rejection reason : damages) {
    const auto found = rejected.find(reason);
    if (found != rejected.end() && many(found->second, frames))
      return fail(ErrorCode::integrity, sentence_of(reason, of_all(found->second, frames)));
  }
  return {};
}

bool InputGate::takes(const Frame& frame) {
  ++frames_;
  const auto reason = gate_.judge(frame);
  cadence_.see(reason == Rejection::frozen);
  if (reason == Rejection::frozen) return true;
  for (const Rejection damage : all_damages) {
    if (reason != damage) continue;
    ++damaged_[damage];
    return false;
  }
  byte_order_.see(frame.counts, frame.significant_bits);
  if (frame.correction == CorrectionState::running) return true;
  const auto moved = moved_.see(frame.counts);
  if (!moved) return true;
  if (how_moved_.empty()) how_moved_ = *moved;
  ++moved_frames_;
  return false;
}

Result<void> InputGate::verdict() const {
  if (auto sound = judge_damages(damaged_, frames_, all_damages); !sound) return sound;
  if (!many(moved_frames_, frames_)) return {};
  return fail(ErrorCode::integrity,
              of_all(moved_frames_, frames_) +
                  " are oriented or shifted differently from the frames before them; the first of them: " + how_moved_ +
                  ". Record a scene without motion");
}

std::string InputGate::note() const {
  std::uint64_t all = moved_frames_;
  for (const auto& [reason, count] : damaged_) all += count;
  return all == 0 ? ""
                  : std::to_string(all) + " of " + std::to_string(frames_) + " frames are damaged and were left out";
}

}  // namespace todbench
