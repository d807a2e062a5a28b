#include "bench/judgement/demand_kinds.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cctype>
#include <cmath>

#include "bench/text/text.h"
#include "tod/psychometric/acuity.h"

namespace todbench {

namespace {

/// For sentences: four significant digits are finer than any interval here.
std::string rounded(double value) {
  if (value == 0) return "0";
  if (!std::isfinite(value)) return "(no number)";
  const double scale = std::pow(10.0, 3 - std::floor(std::log10(std::abs(value))));
  return number_text(std::round(value * scale) / scale);
}

std::string rounded(const std::optional<double>& value) {
  return value ? rounded(*value) : "(no number)";
}

std::string words_of(const Interval& acuity_per_mrad) {
  const auto& [low, high] = acuity_per_mrad;
  if (low && high) return "95 % interval " + rounded(*low) + " to " + rounded(*high) + " 1/mrad";
  if (low) return "one-sided 95 % limit: above " + rounded(*low) + " 1/mrad";
  if (high) return "one-sided 95 % limit: below " + rounded(*high) + " 1/mrad";
  return "no interval";
}

/// A demand on a number that is not fit for a decision stays open, whatever its interval says.
void withhold(Demand& demand, const std::optional<Adequacy>& adequacy) {
  if (!adequacy || adequacy->adequate()) return;
  demand.decision = VerdictKind::inconclusive;
  demand.reason =
      "not fit for a decision: " + reasons_unfit(*adequacy) + (demand.reason.empty() ? "" : "; ") + demand.reason;
}

// acuity

/// The smallest interval that contains both; an open side stays open.
Interval hull(const Interval& a, const Interval& b) {
  Interval both;
  if (a.low && b.low) both.low = std::min(*a.low, *b.low);
  if (a.high && b.high) both.high = std::max(*a.high, *b.high);
  return both;
}

/// The interval of S75 in mrad that decides. A slope at its lower bound makes any threshold number meaningless: no
/// interval then.
Interval deciding_interval(const TodPoint& point) {
  const auto usable = [](const PsychometricFit& fit) {
    return fit.verdict == FitVerdict::flat_or_decreasing || fit.verdict == FitVerdict::no_data ? Interval{} : fit.ci95;
  };
  const Interval interval = usable(point.fit);
  return point.lapse_warning && point.free_lapse_fit ? hull(interval, usable(*point.free_lapse_fit)) : interval;
}

/// Passes when the whole 95 % interval is at or above the limit (exactly on it passes), fails when the whole interval
/// is below it; a one-sided limit of the fit decides in its direction. Where a free lapse explains the data
/// significantly better, both fits have to agree: the union of their intervals counts.
Demand judged_acuity(const AcuityLimit& limit, const TodCurve& curve) {
  Demand demand{.kind = DemandKind::acuity, .delta_t_k = limit.delta_t_k, .limit = limit.least_acuity_per_mrad};
  const TodPoint* point = point_at(curve, limit.delta_t_k);
  if (point == nullptr) {
    demand.reason = "this contrast was not measured";
    return demand;
  }
  const Interval s75_mrad = deciding_interval(*point);
  const double largest_mrad = 1 / limit.least_acuity_per_mrad;
  demand.result = acuity_per_mrad(point->fit);
  demand.interval = acuity_interval(s75_mrad);
  // Compared as sizes, the quantity that was estimated: one rounding instead of two, so that "exactly on the limit"
  // exists.
  if (s75_mrad.high && *s75_mrad.high <= largest_mrad) {
    demand.decision = VerdictKind::pass;
    demand.reason = words_of(demand.interval) + ": at or above the limit";
  } else if (s75_mrad.low && *s75_mrad.low > largest_mrad) {
    demand.decision = VerdictKind::fail;
    demand.reason = words_of(demand.interval) + ": below the limit";
  } else if (s75_mrad.low && s75_mrad.high) {
    demand.reason = words_of(demand.interval) + ": the limit lies within";
  } else {
    demand.reason = "the threshold cannot be identified from the data (" + std::string(to_string(point->fit.verdict)) +
                    ", " + words_of(demand.interval) + ")";
  }
  if (point->lapse_warning) demand.reason += "; a free lapse rate explains the data better, both fits have to agree";
  withhold(demand, point->adequacy);
  return demand;
}

std::vector<Demand> judge_acuity(const Evidence& evidence) {
  std::vector<Demand> demands;
  for (const AcuityLimit& limit : evidence.limits.acuity) demands.push_back(judged_acuity(limit, evidence.curve));
  return demands;
}

std::string acuity_in_words(const Demand& demand) {
  return "acuity at " + rounded(demand.delta_t_k) + " K at least " + rounded(demand.limit) + " 1/mrad";
}

// identified

Demand judged_identified(const TodPoint& point) {
  Demand demand{.kind = DemandKind::identified, .delta_t_k = point.set_delta_t_k};
  demand.interval = acuity_interval(point.fit.ci95);
  if (threshold_identified(point.fit)) {
    demand.result = acuity_per_mrad(point.fit);
    demand.decision = VerdictKind::pass;
    demand.reason = words_of(demand.interval);
  } else {
    demand.reason =
        "the threshold cannot be identified from the data (" + std::string(to_string(point.fit.verdict)) + ")";
  }
  withhold(demand, point.adequacy);
  return demand;
}

std::vector<Demand> judge_identified(const Evidence& evidence) {
  std::vector<Demand> demands;
  for (const TodPoint& point : evidence.curve.points) {
    const auto& limits = evidence.limits.acuity;
    if (std::any_of(limits.begin(), limits.end(),
                    [&](const auto& limit) { return same_contrast(point.set_delta_t_k, limit.delta_t_k); }))
      continue;
    demands.push_back(judged_identified(point));
  }
  return demands;
}

std::string identified_in_words(const Demand& demand) {
  return "a threshold at " + rounded(demand.delta_t_k) + " K";
}

// equivalence

/// How far a ratio is from 1, in the direction that the margin is defined for.
double deviation_percent(double ratio) {
  return 100 * (std::max(ratio, 1 / ratio) - 1);
}

/// The largest deviation of a ratio from 1.
std::optional<double> largest_deviation_percent(const Comparison& comparison) {
  std::optional<double> largest;
  for (const ComparisonPoint& point : comparison.points) {
    if (!point.ratio) return {};
    largest = std::max(largest.value_or(0), deviation_percent(*point.ratio));
  }
  return largest;
}

/// The interval of the largest deviation, from the 90 % intervals of the ratios: two one-sided tests at 5 % show
/// equivalence where its upper end is within the margin. A side that a ratio leaves open is open.
Interval deviation_interval_percent(const Comparison& comparison) {
  double low = 0, high = 0;
  for (const ComparisonPoint& point : comparison.points) {
    const auto& [ratio_low, ratio_high] = point.ratio_ci90;
    if (!ratio_low || !ratio_high) return {};
    const bool holds_one = *ratio_low <= 1 && *ratio_high >= 1;
    const double a = deviation_percent(*ratio_low), b = deviation_percent(*ratio_high);
    if (!holds_one) low = std::max(low, std::min(a, b));
    high = std::max({high, a, b});
  }
  if (comparison.points.empty()) return {};
  return {low, high};
}

/// "; ratios with their 90 % intervals between 0.951 and 1.063", or nothing where a side is open.
std::string span_of_ratios(const Comparison& comparison) {
  std::optional<double> low, high;
  for (const ComparisonPoint& point : comparison.points) {
    if (!point.ratio_ci90.low || !point.ratio_ci90.high) return {};
    low = std::min(low.value_or(*point.ratio_ci90.low), *point.ratio_ci90.low);
    high = std::max(high.value_or(*point.ratio_ci90.high), *point.ratio_ci90.high);
  }
  if (!low) return {};
  return "; 90 % intervals of the ratios between " + rounded(*low) + " and " + rounded(*high);
}

std::string reason_of(const Comparison& comparison) {
  const std::string span = span_of_ratios(comparison);
  switch (comparison.verdict) {
    case ComparisonVerdict::equivalent:
      return "equivalent at every contrast (two one-sided tests at 5 %)" + span;
    case ComparisonVerdict::different:
      return "different at one contrast or more" + span;
    case ComparisonVerdict::inconclusive:
      return "neither equivalence nor a difference is shown by these data (two one-sided tests at 5 %)" + span;
  }
  return "";
}

/// Passes, fails or stays open as the comparison says, where it was made with the margin that is demanded.
std::vector<Demand> judge_equivalence(const Evidence& evidence) {
  if (!evidence.limits.equivalence_margin_percent) return {};
  const double margin_percent = *evidence.limits.equivalence_margin_percent;
  Demand demand{.kind = DemandKind::equivalence, .limit = margin_percent, .interval_percent = 90};
  if (!evidence.comparison) {
    demand.reason = "there is no comparison with a simulated twin";
    return {demand};
  }
  for (const ComparisonPoint& point : evidence.comparison->points) {
    if (point.margin_percent == margin_percent) continue;
    demand.reason = "the comparison was made with another margin, " + rounded(point.margin_percent) + " %";
    return {demand};
  }
  demand.result = largest_deviation_percent(*evidence.comparison);
  demand.interval = deviation_interval_percent(*evidence.comparison);
  demand.decision = decision_of(evidence.comparison->verdict);
  demand.reason = reason_of(*evidence.comparison);
  if (const auto& found = evidence.comparison->adequacy; found && !found->adequate())
    demand.reason += "; not fit for a decision: " + reasons_unfit(*found);
  return {demand};
}

std::string equivalence_in_words(const Demand& demand) {
  return "acuity equivalent to the simulated twin within " + rounded(demand.limit) + " %";
}

constexpr std::array rows{
    DemandKindRow{DemandKind::acuity, "acuity", "1/mrad", LimitSide::at_least, judge_acuity, acuity_in_words},
    DemandKindRow{DemandKind::identified, "identified", "1/mrad", LimitSide::none, judge_identified,
                  identified_in_words},
    DemandKindRow{DemandKind::equivalence, "equivalence", "%", LimitSide::at_most, judge_equivalence,
                  equivalence_in_words},
};

}  // namespace

std::span<const DemandKindRow> demand_kinds() {
  return rows;
}

const DemandKindRow& row_of(DemandKind kind) {
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const DemandKindRow& r) { return r.kind == kind; });
  assert(row != rows.end());
  return *row;
}

std::string_view to_string(DemandKind kind) {
  return row_of(kind).name;
}

std::string in_words(const Demand& demand) {
  return row_of(demand.kind).in_words(demand);
}

std::string title(const Demand& demand) {
  std::string words = in_words(demand);
  if (!words.empty()) words.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(words.front())));
  return words;
}

}  // namespace todbench
