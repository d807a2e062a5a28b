// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/report_pieces.h"

#include "bench/report/number_format.h"
#include "sim_devices/sensor/effect_row.h"

namespace todbench {

RichText interval_or_missing(std::optional<double> value, const Interval& interval, std::string_view reason) {
  return anything_known(value, interval) ? unbroken(with_interval(value, interval)) : missing(reason);
}

List list_of(const std::vector<std::string>& sentences) {
  List list;
  for (const std::string& sentence : sentences) list.items.push_back(plain(sentence));
  return list;
}

std::string_view in_words(FitVerdict verdict) {
  switch (verdict) {
    case FitVerdict::no_data:
      return "no trials";
    case FitVerdict::above_range:
      return "answers at chance level at every size: only a lower limit of the threshold";
    case FitVerdict::below_range:
      return "answers correct at every size: only an upper limit of the threshold";
    case FitVerdict::slope_unidentifiable:
      return "only one size: slope not identifiable";
    case FitVerdict::step:
      return "step from chance to certainty between two sizes";
    case FitVerdict::flat_or_decreasing:
      return "answers do not improve with size: no threshold";
    case FitVerdict::underdetermined:
      return "fewer sizes than parameters";
    case FitVerdict::extrapolated:
      return "threshold outside the sizes tested";
    case FitVerdict::ok:
      return "ok";
  }
  return "unknown";
}

std::string_view in_words(Mounting mounting) {
  switch (mounting) {
    case Mounting::identity:
      return "as drawn";
    case Mounting::rotated_180:
      return "rotated by 180°";
    case Mounting::mirrored_horizontally:
      return "mirrored left to right";
    case Mounting::mirrored_vertically:
      return "mirrored top to bottom";
  }
  return "unknown";
}

std::string_view in_words(Effect effect) {
  return row_of(effect).title;
}

Mood mood_of(VerdictKind verdict) {
  return verdict == VerdictKind::pass ? Mood::good : verdict == VerdictKind::fail ? Mood::bad : Mood::open;
}

Mood mood_of(ComparisonVerdict verdict) {
  return verdict == ComparisonVerdict::equivalent  ? Mood::good
         : verdict == ComparisonVerdict::different ? Mood::bad
                                                   : Mood::open;
}

}  // namespace todbench
