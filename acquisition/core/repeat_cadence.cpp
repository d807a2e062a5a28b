// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/repeat_cadence.h"

#include <algorithm>

namespace todbench {
namespace {

constexpr std::size_t remembered_runs = 16, least_runs = 8;
/// Tolerated runs of another length: a lost frame shortens a run.
constexpr std::size_t most_others = 1;

}  // namespace

void RepeatCadence::see(bool equals_the_last) {
  if (equals_the_last) {
    ++run_;
    if (times_ == 1)
      ++before_learnt_;
    else if (in_rhythm())
      ++repeats_;
    return;
  }
  if (run_ > 0) runs_.push_back(run_);
  if (runs_.size() > remembered_runs) runs_.pop_front();
  run_ = 1;
  learn();
}

void RepeatCadence::learn() {
  if (times_ > 1 || runs_.size() < least_runs) return;
  const int usual = runs_.back();
  const auto others =
      static_cast<std::size_t>(std::count_if(runs_.begin() + 1, runs_.end(), [&](int run) { return run != usual; }));
  if (usual < 2 || others > most_others) return;
  times_ = usual;
  repeats_ = before_learnt_;
}

std::string RepeatCadence::sentence() const {
  if (times_ == 1) return {};
  const std::string times = std::to_string(times_);
  return "The camera sends each exposure " + times + " times. The program uses each exposure once, at 1/" + times +
         " of the frame rate.";
}

}  // namespace todbench
