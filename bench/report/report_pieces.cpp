#include "bench/report/report_pieces.h"

#include "bench/report/number_format.h"
#include "sim_devices/sensor/effect_row.h"

namespace todbench {

Markup section(std::string_view title, const Markup& content) {
  return element("section", element("h2", escaped(title)) + literal("\n") + content) + literal("\n");
}

Markup interval_or_missing(std::optional<double> value, const Interval& interval, std::string_view reason) {
  return anything_known(value, interval) ? unbroken(with_interval(value, interval)) : missing(reason);
}

Markup paragraph(const Markup& content, std::string_view css_class) {
  return element("p", content, css_class.empty() ? "" : "class=\"" + std::string(css_class) + "\"") + literal("\n");
}

Markup figure(const Result<Markup>& picture, std::string_view caption) {
  const Markup content = picture ? *picture : paragraph(missing("no figure: " + picture.error().message));
  return element("figure", content + element("figcaption", escaped(caption))) + literal("\n");
}

Markup badge(std::string_view word, Mood mood) {
  const std::string_view css = mood == Mood::good ? "good" : mood == Mood::bad ? "bad" : "open";
  const std::string_view sign = mood == Mood::good ? "✓ " : mood == Mood::bad ? "✗ " : "? ";
  return element("strong", literal(sign) + escaped(word), "class=\"badge " + std::string(css) + "\"");
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
