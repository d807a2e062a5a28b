#include "bench/judgement/verdict.h"

#include <algorithm>
#include <cmath>

#include "bench/text/json.h"
#include "bench/text/text.h"
#include "tod/psychometric/acuity.h"

namespace todbench {

namespace {

/// For sentences: four significant digits are finer than any interval here.
std::string rounded(double value) {
  if (value == 0 || !std::isfinite(value)) return number_text(value);
  const double scale = std::pow(10.0, 3 - std::floor(std::log10(std::abs(value))));
  return number_text(std::round(value * scale) / scale);
}

std::string words(const Interval& interval) {
  if (interval.low && interval.high)
    return "95 % interval " + rounded(*interval.low) + " to " + rounded(*interval.high) + " 1/mrad";
  if (interval.low) return "one-sided 95 % limit: above " + rounded(*interval.low) + " 1/mrad";
  if (interval.high) return "one-sided 95 % limit: below " + rounded(*interval.high) + " 1/mrad";
  return "no interval";
}

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

VerdictItem judge_acuity(const AcuityLimit& limit, const TodCurve& curve) {
  VerdictItem item;
  item.demand =
      "acuity at " + rounded(limit.delta_t_k) + " K at least " + rounded(limit.least_acuity_per_mrad) + " 1/mrad";
  item.delta_t_k = limit.delta_t_k;
  item.limit = limit.least_acuity_per_mrad;
  const TodPoint* point = point_at(curve, limit.delta_t_k);
  if (!point) {
    item.reason = "this contrast was not measured";
    return item;
  }
  const Interval s75_mrad = deciding_interval(*point);
  const double largest_mrad = 1 / limit.least_acuity_per_mrad;
  item.value = acuity_per_mrad(point->fit);
  item.interval = acuity_interval(s75_mrad);
  // Compared as sizes, the quantity that was estimated: one rounding instead of two, so that "exactly on the limit"
  // exists.
  if (s75_mrad.high && *s75_mrad.high <= largest_mrad) {
    item.kind = VerdictKind::pass;
    item.reason = words(item.interval) + ": at or above the limit";
  } else if (s75_mrad.low && *s75_mrad.low > largest_mrad) {
    item.kind = VerdictKind::fail;
    item.reason = words(item.interval) + ": below the limit";
  } else if (s75_mrad.low && s75_mrad.high) {
    item.reason = words(item.interval) + ": the limit lies within";
  } else {
    item.reason = "the threshold cannot be identified from the data (" + std::string(to_string(point->fit.verdict)) +
                  ", " + words(item.interval) + ")";
  }
  if (point->lapse_warning) item.reason += "; a free lapse rate explains the data better, both fits have to agree";
  return item;
}

/// The largest deviation of a ratio from 1, in the direction that the margin is defined for.
std::optional<double> largest_deviation_percent(const Comparison& comparison) {
  std::optional<double> largest;
  for (const ComparisonPoint& point : comparison.points) {
    if (!point.ratio) return {};
    largest = std::max(largest.value_or(0), 100 * (std::max(*point.ratio, 1 / *point.ratio) - 1));
  }
  return largest;
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

VerdictItem judge_equivalence(double margin_percent, const std::optional<Comparison>& comparison) {
  VerdictItem item;
  item.demand = "acuity equivalent to the simulated twin within " + rounded(margin_percent) + " %";
  item.limit = margin_percent;
  if (!comparison) {
    item.reason = "there is no comparison with a simulated twin";
    return item;
  }
  for (const ComparisonPoint& point : comparison->points) {
    if (point.margin_percent == margin_percent) continue;
    item.reason = "the comparison was made with another margin, " + rounded(point.margin_percent) + " %";
    return item;
  }
  item.value = largest_deviation_percent(*comparison);
  const std::string margin = " (two one-sided tests at 5 %)" + span_of_ratios(*comparison);
  switch (comparison->verdict) {
    case ComparisonVerdict::equivalent:
      item.kind = VerdictKind::pass;
      item.reason = "equivalent at every contrast" + margin;
      break;
    case ComparisonVerdict::different:
      item.kind = VerdictKind::fail;
      item.reason = "different at one contrast or more" + span_of_ratios(*comparison);
      break;
    case ComparisonVerdict::inconclusive:
      item.reason = "neither equivalence nor a difference is shown by these data" + margin;
      break;
  }
  return item;
}

VerdictItem unidentified(const TodPoint& point) {
  VerdictItem item;
  item.demand = "a threshold at " + rounded(point.set_delta_t_k) + " K";
  item.delta_t_k = point.set_delta_t_k;
  item.interval = acuity_interval(point.fit.ci95);
  item.reason = "the threshold cannot be identified from the data (" + std::string(to_string(point.fit.verdict)) + ")";
  return item;
}

}  // namespace

std::string_view to_string(VerdictKind kind) {
  switch (kind) {
    case VerdictKind::pass:
      return "pass";
    case VerdictKind::fail:
      return "fail";
    case VerdictKind::inconclusive:
      return "inconclusive";
  }
  return "";
}

std::string decision_rule() {
  return "Guarded acceptance and guarded rejection with the 95 % confidence interval as guard band (after "
         "ILAC-G8:09/2019): pass when "
         "the whole interval meets the limit, fail when the whole interval misses it, inconclusive when the limit lies "
         "within the "
         "interval or the threshold cannot be identified.";
}

bool threshold_identified(const PsychometricFit& fit) {
  return fit.threshold && fit.ci95.low && fit.ci95.high && fit.verdict != FitVerdict::flat_or_decreasing &&
         fit.verdict != FitVerdict::no_data;
}

Verdict judge(const LimitsPlan& limits, const TodCurve& curve, const std::optional<Comparison>& comparison) {
  Verdict verdict;
  verdict.rule = decision_rule();
  for (const AcuityLimit& limit : limits.acuity) verdict.items.push_back(judge_acuity(limit, curve));
  for (const TodPoint& point : curve.points) {
    const bool limited = std::any_of(limits.acuity.begin(), limits.acuity.end(), [&](const AcuityLimit& limit) {
      return same_contrast(point.set_delta_t_k, limit.delta_t_k);
    });
    if (!limited && !threshold_identified(point.fit)) verdict.items.push_back(unidentified(point));
  }
  if (limits.equivalence_margin_percent) {
    verdict.items.push_back(judge_equivalence(*limits.equivalence_margin_percent, comparison));
  }
  const auto any = [&](VerdictKind kind) {
    return std::any_of(verdict.items.begin(), verdict.items.end(),
                       [&](const VerdictItem& item) { return item.kind == kind; });
  };
  if (any(VerdictKind::fail)) {
    verdict.overall = VerdictKind::fail;
  } else if (any(VerdictKind::inconclusive) || curve.points.empty()) {
    verdict.overall = VerdictKind::inconclusive;
  }
  return verdict;
}

int exit_code(VerdictKind kind) {
  switch (kind) {
    case VerdictKind::pass:
      return 0;
    case VerdictKind::fail:
      return 1;
    case VerdictKind::inconclusive:
      return 3;
  }
  return 7;
}

int exit_code(const PsychometricFit& fit) {
  return threshold_identified(fit) ? 0 : 3;
}

int exit_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::invalid_input:
      return 2;
    case ErrorCode::not_found:
      return 4;
    case ErrorCode::disconnected:
    case ErrorCode::integrity:
    case ErrorCode::timeout:
      return 5;
    case ErrorCode::not_identifiable:
      return 3;
    case ErrorCode::calibration:
      return 6;
    case ErrorCode::interrupted:
      return 130;
    case ErrorCode::io:
    case ErrorCode::internal:
      return 7;
  }
  return 7;
}

}  // namespace todbench
