// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/accuracy_bill.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "acquisition/base/distributions.h"
#include "acquisition/base/median.h"
#include "acquisition/base/normal.h"
#include "bench/plan/plan_options.h"
#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"
#include "sim_devices/sensor/effect_list.h"
#include "tod/psychometric/contrast_slope.h"

namespace todbench {
namespace {

using SetUp = std::pair<std::string, Mounting>;

/// Times of the presentations of one contrast, in seconds.
struct ContrastTime {
  std::vector<double> plain, opening;  ///< opening: the first of a set-up or a contrast
  std::size_t count = 0;               ///< with the last presentation of the run, which has no time
};

struct RunTimes {
  double changes_s = 0, looking_s = 0;
  bool location_is_separate = true;          ///< if not, presentations_s contains a part of looking_s
  std::map<double, double> presentations_s;  ///< by set contrast
  std::map<double, double> shifts_s;  ///< by set contrast, part of changes_s: of presentations that only move the plate
};

/// Set contrast of the point of the curve.
double point_k(const TargetState& set) {
  return set.point_delta_t_k.value_or(set.delta_t_k);
}

/// Time of a presentation of this contrast without location: the median of those that only move the plate; if every one
/// opens a set-up or a contrast, the forecast; empty without both.
std::optional<double> usual_s(double delta_t_k, const ContrastTime& contrast, const TimeForecast* forecast) {
  if (!contrast.plain.empty()) return median(contrast.plain);
  if (forecast == nullptr) return std::nullopt;
  const auto found = forecast->parts_s.find(presentations_part(delta_t_k));
  if (found == forecast->parts_s.end()) return std::nullopt;
  return found->second / static_cast<double>(contrast.count);
}

/// Empty if a presentation has no time. `forecast`: of the plan, null if there is none.
std::optional<RunTimes> times_of(std::span<const Presentation> presentations, const TimeForecast* forecast = nullptr) {
  RunTimes times;
  std::map<double, ContrastTime> by_contrast;
  std::optional<double> last_k;  // its end is not recorded: counted as the others
  for (std::size_t i = 0; i < presentations.size(); ++i) {
    const Presentation& shown = presentations[i];
    if (!shown.host_time_ns) return std::nullopt;
    times.changes_s += shown.said.settling_s;
    const TargetState& set = shown.set;
    const TargetState* before = i > 0 ? &presentations[i - 1].set : nullptr;
    const bool opens = before == nullptr || before->plate != set.plate || before->mounting != set.mounting ||
                       point_k(*before) != point_k(set);
    if (!opens) times.shifts_s[point_k(set)] += shown.said.settling_s;
    ContrastTime& contrast = by_contrast[point_k(set)];
    ++contrast.count;
    if (i + 1 == presentations.size()) {
      last_k = point_k(set);
      continue;
    }
    const Presentation& next = presentations[i + 1];
    if (!next.host_time_ns) return std::nullopt;
    const double lasted_s = static_cast<double>(*next.host_time_ns - *shown.host_time_ns) * 1e-9 - next.said.settling_s;
    (opens ? contrast.opening : contrast.plain).push_back(std::max(0.0, lasted_s));
  }
  for (const auto& [delta_t_k, contrast] : by_contrast) {
    double& sum = times.presentations_s[delta_t_k];
    for (const double s : contrast.plain) sum += s;
    const auto usual = usual_s(delta_t_k, contrast, forecast);
    times.location_is_separate = times.location_is_separate && usual;
    for (const double s : contrast.opening) {
      const double looking = usual ? std::max(0.0, s - *usual) : 0;
      times.looking_s += looking;
      sum += s - looking;
    }
    if (last_k == delta_t_k) sum += usual.value_or(0);
  }
  return times;
}

/// In 100 times ln S75, as shares of presentations need it; shown by percent_of_ln().
std::optional<double> half_width_percent(const Interval& s75) {
  if (!s75.low || !s75.high || !(*s75.low > 0)) return std::nullopt;
  return 50 * std::log(*s75.high / *s75.low);
}

/// A difference of ln in percent of the acuity, as text.
std::string percent_of_ln(double ln_percent) {
  return significant(100 * std::expm1(ln_percent / 100), 2);
}

const TodPoint* point_of(const TodCurve& curve, double set_delta_t_k) {
  const auto found = std::ranges::find(curve.points, set_delta_t_k, &TodPoint::set_delta_t_k);
  return found == curve.points.end() ? nullptr : &*found;
}

std::size_t count_at(const BillInput& input, double set_delta_t_k) {
  return static_cast<std::size_t>(std::ranges::count_if(
      input.presentations, [&](const Presentation& shown) { return point_k(shown.set) == set_delta_t_k; }));
}

std::size_t set_ups_at(const BillInput& input, double set_delta_t_k) {
  std::set<SetUp> set_ups;
  for (const Presentation& shown : input.presentations) {
    if (point_k(shown.set) == set_delta_t_k) set_ups.emplace(shown.set.plate, shown.set.mounting);
  }
  return set_ups.size();
}

std::string presentations_bought(const BillInput& input, const TodPoint& point) {
  const std::string count = std::to_string(count_at(input, point.set_delta_t_k)) + " presentations";
  const auto half = half_width_percent(deciding_interval(point));
  return half ? fmt::format("S75 to ± {} % (95 %), {}", percent_of_ln(*half), count) : count + ", no interval of S75";
}

/// Largest relative standard error of the contrasts.
std::string contrast_bought(const TodCurve& curve) {
  double largest = 0;
  for (const TodPoint& point : curve.points) {
    if (point.delta_t_k != 0) largest = std::max(largest, std::abs(point.delta_t_se_k / point.delta_t_k));
  }
  return largest > 0 ? fmt::format("place of the plate; effective contrasts to {} % or better (standard error)",
                                   significant(100 * largest, 2))
                     : "place of the plate and effective contrasts";
}

std::string changes_bought(const BillInput& input) {
  std::set<SetUp> set_ups;
  std::set<double> contrasts;
  for (const Presentation& shown : input.presentations) {
    set_ups.emplace(shown.set.plate, shown.set.mounting);
    contrasts.insert(point_k(shown.set));
  }
  return fmt::format("{} set-ups, {} contrasts, {} places of the plate in the picture", set_ups.size(),
                     contrasts.size(), input.presentations.size());
}

/// Adds the rows of where the time went. Returns the seconds that the records of presentations account for.
double add_rows(AccuracyBill& bill, const BillInput& input) {
  const auto times = times_of(input.presentations, input.forecast);
  double known_s = 0;
  if (times) {
    bill.rows.push_back({std::string(changes_part), times->changes_s, changes_bought(input)});
    BillRow location{std::string(location_part), times->looking_s, contrast_bought(input.curve)};
    if (!times->location_is_separate) {
      location.seconds.reset();
      location.bought += "; time within the presentations, each of which opens a set-up or a contrast";
    }
    bill.rows.push_back(std::move(location));
    known_s = times->changes_s + times->looking_s;
  }
  for (const TodPoint& point : input.curve.points) {
    std::optional<double> seconds;
    if (times) {
      const auto found = times->presentations_s.find(point.set_delta_t_k);
      if (found != times->presentations_s.end()) seconds = found->second;
    }
    known_s += seconds.value_or(0);
    bill.rows.push_back({presentations_part(point.set_delta_t_k), seconds, presentations_bought(input, point)});
  }
  if (input.measures_s > 0) {
    bill.rows.push_back({std::string(measures_part), input.measures_s,
                         fmt::format("{} quantities, with their changes of the target", input.quantities)});
    known_s += input.measures_s;
  }
  const double rest_s = std::max(0.0, input.wall_s - known_s);
  bill.rows.push_back(times ? BillRow{"Rest of the run", rest_s, "computing: start, functions of the twin, fits"}
                            : BillRow{"Computing", rest_s, "all rows above without a time: the scene is simulated"});
  return known_s;
}

/// Half-width of the rows that are stated in the budget, in 100 times ln acuity: no time reduces them.
double floor_percent(const PointUncertainty& point) {
  double sum = 0;
  for (const AppliedRow& row : point.rows) {
    if (!row.from_run) sum += row.contribution * row.contribution;
  }
  return 100 * normal_z95 * std::sqrt(sum);
}

void add_floor(AccuracyBill& bill, const BillInput& input) {
  const std::vector<PointUncertainty> none;
  const auto& points = input.uncertainty == nullptr ? none : input.uncertainty->points;
  if (std::ranges::none_of(points, [](const PointUncertainty& point) { return floor_percent(point) > 0; }))
    bill.sentences.emplace_back(no_budget_sentence);
  for (const PointUncertainty& point : points) {
    const auto half = half_width_percent(point.statistical_mrad);
    const double floor = floor_percent(point);
    if (!half || !(floor > 0)) continue;
    bill.sentences.push_back(fmt::format(
        "At {} K the stated rows of the budget make ± {} %, which no presentation reduces; the trials make ± {} %.",
        stated(point.set_delta_t_k), percent_of_ln(floor), percent_of_ln(*half)));
  }
}

/// Half-width of the scatter of the measured contrast, in percent: no presentation reduces it.
double contrast_percent(const TodPoint& point) {
  return 100 * point.fit.contrast_u * distribution::quantile_above(0.025, freedom_of_contrast(point));
}

/// What the decision on a demand of acuity needs.
struct DemandNeed {
  double margin = 0, floor = 0, contrast = 0;  ///< distance from the limit and half-widths, in percent
  std::optional<double> share{};  ///< of the presentations at its contrast; empty: no number of them decides
};

/// Empty if demand or curve state no numbers.
std::optional<DemandNeed> need_of(const Demand& demand, const BillInput& input) {
  if (demand.kind != DemandKind::acuity || !demand.delta_t_k || !demand.limit || !demand.result) return std::nullopt;
  if (!(*demand.limit > 0) || !(*demand.result > 0)) return std::nullopt;
  const TodPoint* point = point_of(input.curve, *demand.delta_t_k);
  const auto half = point == nullptr ? std::nullopt : half_width_percent(deciding_interval(*point));
  if (!half) return std::nullopt;
  const PointUncertainty* stated_u =
      input.uncertainty == nullptr ? nullptr : point_at(*input.uncertainty, *demand.delta_t_k);
  DemandNeed need{.margin = 100 * std::abs(std::log(*demand.result / *demand.limit)),
                  .floor = stated_u == nullptr ? 0 : floor_percent(*stated_u),
                  .contrast = std::min(*half, contrast_percent(*point))};
  const double trials = std::sqrt(*half * *half - need.contrast * need.contrast);
  need.share = share_for_decision(trials, need.margin, std::hypot(need.floor, need.contrast));
  if (!need.share) return need;
  const auto presentations = static_cast<double>(count_at(input, *demand.delta_t_k));
  const auto set_ups = static_cast<double>(set_ups_at(input, *demand.delta_t_k));
  const double least_graded = is_quasi(point->fit.interval) ? least_graded_presentations : 1;
  const double least = std::min(presentations, std::max(set_ups, least_graded));
  need.share = std::max(*need.share, least / presentations);
  if (demand.decision != VerdictKind::inconclusive) need.share = std::min(*need.share, 1.0);
  return need;
}

/// Time of the run with the presentations that the decisions on acuity need, and with all of it.
void add_least_time(AccuracyBill& bill, const BillInput& input, const std::map<double, double>& share_needed) {
  const auto times = times_of(input.presentations, input.forecast);
  if (!times || share_needed.empty()) return;
  double needed_s = times->changes_s + times->looking_s, all_s = needed_s;
  for (const auto& [delta_t_k, seconds] : times->presentations_s) {
    const auto found = share_needed.find(delta_t_k);
    const double share = found == share_needed.end() ? 0 : found->second;
    const auto shifts = times->shifts_s.find(delta_t_k);
    needed_s += share * seconds + (share - 1) * (shifts == times->shifts_s.end() ? 0 : shifts->second);
    all_s += seconds;
  }
  bill.sentences.push_back(fmt::format(
      "In the set-ups of this run, the decisions on acuity alone would have taken about {} s of the {} s for "
      "changes, location and presentations.",
      significant(needed_s, 2), significant(all_s, 2)));
}

std::string need_in_words(const Demand& demand, const DemandNeed& need, std::size_t presentations) {
  const std::string at = stated(*demand.delta_t_k) + " K";
  if (!need.share)
    return fmt::format(
        "No number of presentations decides on the acuity at {}: it is {} % from its limit; the stated "
        "rows of the budget make ± {} %, and the measured contrast ± {} %{}.",
        at, percent_of_ln(need.margin), percent_of_ln(need.floor), percent_of_ln(need.contrast),
        need.margin > need.floor ? ", which more frames of the contrast ([measurement] contrast_frames) reduce" : "");
  const auto needed = static_cast<std::size_t>(std::ceil(*need.share * static_cast<double>(presentations) - 1e-9));
  if (demand.decision != VerdictKind::inconclusive)
    return fmt::format("The decision on the acuity at {} needs about {} of the {} presentations.", at, needed,
                       presentations);
  return fmt::format(
      "The open decision on the acuity at {} needs about {} presentations in place of {}, if the acuity "
      "stays the same.",
      at, needed, presentations);
}

void add_least(AccuracyBill& bill, const BillInput& input) {
  if (input.verdict == nullptr) return;
  const auto has_limit = [](const Demand& demand) { return demand.kind == DemandKind::acuity && demand.limit; };
  if (std::ranges::none_of(input.verdict->demands, has_limit)) {
    bill.sentences.emplace_back(no_limit_sentence);
    return;
  }
  std::map<double, double> share_needed;
  bool all_decided = true;
  for (const Demand& demand : input.verdict->demands) {
    const auto need = need_of(demand, input);
    if (!need) continue;
    bill.sentences.push_back(need_in_words(demand, *need, count_at(input, *demand.delta_t_k)));
    all_decided = all_decided && need->share && demand.decision != VerdictKind::inconclusive;
    double& most = share_needed[*demand.delta_t_k];
    most = std::max(most, need->share.value_or(0));
  }
  if (share_needed.empty())
    bill.sentences.emplace_back("No limit on an acuity has a least time: the curve has no interval there.");
  if (all_decided) add_least_time(bill, input, share_needed);
}

void add_forecast(AccuracyBill& bill, const TimeForecast& forecast) {
  bill.forecast_s = forecast.total_s;
  for (BillRow& row : bill.rows) {
    const auto found = forecast.parts_s.find(row.part);
    if (found != forecast.parts_s.end()) row.forecast_s = found->second;
  }
}

}  // namespace

AccuracyBill accuracy_bill(const BillInput& input) {
  AccuracyBill bill;
  const double known_s = add_rows(bill, input);
  // The presentations of a resumed run were taken in more than one run.
  bill.total_s = std::max(input.wall_s, known_s);
  if (input.forecast != nullptr) add_forecast(bill, *input.forecast);
  if (input.twin_s > 0)
    bill.sentences.push_back(
        fmt::format("The simulation of the twin took {} s after the run.", significant(input.twin_s, 2)));
  add_floor(bill, input);
  add_least(bill, input);
  for (std::string& sentence : left_out_sentences(input.effects)) bill.sentences.push_back(std::move(sentence));
  return bill;
}

std::vector<std::string> left_out_sentences(const SensorPlan& effects) {
  std::vector<std::string> below, requested, neutral;
  for (const EffectDecision& decision : effects.decisions) {
    if (decision.decision != Decision::skip) continue;
    const std::string name = words(to_string(decision.effect));
    const std::optional<double>& change = decision.predicted_change_percent;
    if (decision.changes_nothing())
      neutral.push_back(name);
    else if (change && !decision.on_request)
      below.push_back(fmt::format("{} (at most {} %)", name, significant(*change, 2)));
    else
      requested.push_back(change ? fmt::format("{} (predicted change {} %)", name, significant(*change, 2))
                                 : name + " (the change is not bounded)");
  }
  std::vector<std::string> sentences;
  if (below.empty() && requested.empty())
    sentences.emplace_back("The simulation leaves out no effect that changes the acuity.");
  if (!below.empty())
    sentences.push_back(
        fmt::format("The simulation leaves out, because the change of the acuity is below the tolerance: {}.",
                    fmt::join(below, ", ")));
  if (!requested.empty())
    sentences.push_back(fmt::format("The simulation leaves out on request: {}.", fmt::join(requested, ", ")));
  if (!neutral.empty())
    sentences.push_back(
        fmt::format("Not in this sensor or scene, and therefore without a change: {}.", fmt::join(neutral, ", ")));
  return sentences;
}

std::optional<double> share_for_decision(double half_width, double margin, double floor) {
  if (!(margin > floor)) return std::nullopt;
  return half_width * half_width / (margin * margin - floor * floor);
}

std::string presentations_part(double set_delta_t_k) {
  return "Presentations at " + stated(set_delta_t_k) + " K";
}

std::optional<TimeForecast> time_forecast(const AccuracyBill& forecast) {
  if (!(forecast.total_s > 0)) return std::nullopt;
  TimeForecast out{.total_s = forecast.total_s, .parts_s = {}};
  for (const BillRow& row : forecast.rows) {
    if (row.seconds) out.parts_s[row.part] = *row.seconds;
  }
  return out;
}

std::string forecast_and_outcome(const AccuracyBill& bill) {
  if (!bill.forecast_s) return "";
  std::string text = fmt::format(
      "forecast of the plan and outcome of the run: {} s without computing, and {} s ({} times)",
      significant(*bill.forecast_s, 3), significant(bill.total_s, 3), significant(bill.total_s / *bill.forecast_s, 2));
  for (const BillRow& row : bill.rows) {
    if (!row.forecast_s || !row.seconds) continue;
    text +=
        fmt::format("; {}: {} s, and {} s", row.part, significant(*row.forecast_s, 3), significant(*row.seconds, 3));
  }
  return text;
}

Json bill_json(const AccuracyBill& bill) {
  Json rows = Json::array();
  for (const BillRow& row : bill.rows) {
    rows.push_back({{"part", row.part}, {"seconds", json_number(row.seconds)}, {"bought", row.bought}});
    if (row.forecast_s) rows.back()["forecast_s"] = json_number(row.forecast_s);
  }
  Json json{{"total_s", json_number(bill.total_s)}, {"rows", rows}, {"sentences", bill.sentences}};
  if (bill.forecast_s) json["forecast_s"] = json_number(bill.forecast_s);
  return json;
}

Section bill_section(const AccuracyBill& bill) {
  Table table;
  table.caption = "Time of the run and the accuracy that it bought";
  table.header = {"Part", "Time (s)"};
  if (bill.forecast_s) table.header.emplace_back("Forecast (s)");
  table.header.emplace_back("Result");
  const auto add = [&](RichText part, RichText time, RichText forecast, const std::string& bought) {
    std::vector<RichText> row{std::move(part), std::move(time)};
    if (bill.forecast_s) row.push_back(std::move(forecast));
    row.push_back(plain(bought));
    table.rows.push_back(std::move(row));
  };
  for (const BillRow& row : bill.rows) {
    add(plain(row.part), row.seconds ? plain(shown(*row.seconds, 1)) : missing("not separate"),
        row.forecast_s ? plain(shown(*row.forecast_s, 1)) : plain(""), row.bought);
  }
  add(strong("Total"), strong(shown(bill.total_s, 1)), bill.forecast_s ? strong(shown(*bill.forecast_s, 1)) : plain(""),
      bill.forecast_s ? "forecast without computing" : "");
  Section section{"Accuracy and time", {std::move(table)}};
  section.blocks.emplace_back(list_of(bill.sentences));
  return section;
}

}  // namespace todbench
