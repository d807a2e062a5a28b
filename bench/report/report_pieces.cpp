#include "bench/report/report_pieces.h"

namespace todbench {

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
      return "answers at chance at every size: only a lower limit of the size";
    case FitVerdict::below_range:
      return "answers right at every size: only an upper limit of the size";
    case FitVerdict::slope_unidentifiable:
      return "one size only: slope not identifiable";
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

std::string_view in_words(ComparisonVerdict verdict) {
  switch (verdict) {
    case ComparisonVerdict::equivalent:
      return "equivalent";
    case ComparisonVerdict::different:
      return "different";
    case ComparisonVerdict::inconclusive:
      return "inconclusive";
  }
  return "unknown";
}

std::string_view in_words(LimitVerdict verdict) {
  switch (verdict) {
    case LimitVerdict::pass:
      return "pass";
    case LimitVerdict::fail:
      return "fail";
    case LimitVerdict::inconclusive:
      return "inconclusive";
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
  switch (effect) {
    case Effect::diffraction:
      return "Diffraction";
    case Effect::spectral_band:
      return "Spectral band";
    case Effect::aberration:
      return "Aberration of the lens";
    case Effect::detector:
      return "Detector footprint";
    case Effect::motion:
      return "Motion and time constant";
    case Effect::microscan:
      return "Microscan";
    case Effect::temporal_noise:
      return "Temporal noise";
    case Effect::fixed_pattern:
      return "Fixed pattern noise";
    case Effect::row_column_noise:
      return "Row and column noise";
    case Effect::dead_pixels:
      return "Dead pixels";
    case Effect::frame_averaging:
      return "Frame averaging";
    case Effect::super_resolution:
      return "Dynamic super-resolution";
    case Effect::display:
      return "Display reconstruction";
    case Effect::quantisation:
      return "Quantisation";
  }
  return "unknown";
}

Mood mood_of(LimitVerdict verdict) {
  return verdict == LimitVerdict::pass ? Mood::good : verdict == LimitVerdict::fail ? Mood::bad : Mood::open;
}

Mood mood_of(ComparisonVerdict verdict) {
  return verdict == ComparisonVerdict::equivalent  ? Mood::good
         : verdict == ComparisonVerdict::different ? Mood::bad
                                                   : Mood::open;
}

}  // namespace todbench
