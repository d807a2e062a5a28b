// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/time_left.h"

namespace todbench {

void TimeLeft::begin(Time now) {
  begin_ = last_line_ = now;
  still_since_.reset();
}

void TimeLeft::stand_still(Time now) {
  if (!still_since_) still_since_ = now;
}

std::optional<double> TimeLeft::progress(Time now, double share) {
  if (still_since_) begin_ += now - *still_since_;
  still_since_.reset();
  if (!(share > 0)) return std::nullopt;
  const double elapsed_s = std::chrono::duration<double>(now - begin_).count();
  return elapsed_s / share - elapsed_s;
}

bool TimeLeft::line_is_due(Time now) {
  if (now - last_line_ < std::chrono::minutes(1)) return false;
  last_line_ = now;
  return true;
}

}  // namespace todbench
