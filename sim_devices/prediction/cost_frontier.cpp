// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/cost_frontier.h"

#include <fmt/format.h>
#include <time.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "acquisition/base/try.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double reference_share = 1.0 / 3;  // of the budget
constexpr int fewest_reference_draws = 200;  // a standard error near 1 %
constexpr int paired_draws = 200;            // differences of paired estimates are finer than their standard error
constexpr double trials_share = 2;           // a run of trials fits if this multiple of its time is left
constexpr double worth_repeating_s = 1;      // shorter runs are measured twice

/// Requests a stop when the time is over or the caller requests one.
class Deadline {
 public:
  Deadline(double time_s, const std::stop_token& caller)
      : forward_(caller, [this] { source_.request_stop(); }), timer_([this, time_s](const std::stop_token& left) {
          std::unique_lock lock(mutex_);
          wake_.wait_for(lock, left, std::chrono::duration<double>(time_s), [] { return false; });
          if (!left.stop_requested()) source_.request_stop();
        }) {}
  [[nodiscard]] std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  std::stop_callback<std::function<void()>> forward_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread timer_;  // last: joined before the members that it uses are destroyed
};

/// Processor time of all threads of the program.
double processor_s() {
  timespec now{};
  (void)::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

using Estimate = std::function<Result<std::vector<ThresholdEstimate>>(std::stop_token)>;

/// One way of computing, with its reference.
struct Way {
  CostPoint point;
  Estimate estimate;
  double expected_s = 0;  ///< expected time; points that do not fit are not run; 0: unknown
};

struct Timed {
  std::vector<ThresholdEstimate> found;
  double wall_s = 0;
  /// On an idle machine: other programs lengthen the wall time of one thread, not its processor time.
  double idle_s = 0;
};

double largest_error_percent(const std::vector<ThresholdEstimate>& found,
                             const std::vector<ThresholdEstimate>& reference) {
  double largest = 0;
  for (std::size_t i = 0; i < found.size(); ++i)
    largest = std::max(largest, 100 * std::abs(reference[i].s75_pitch / found[i].s75_pitch - 1));
  return largest;
}

/// Empty if one of the estimates has no standard error.
std::optional<double> largest_standard_error_percent(const std::vector<ThresholdEstimate>& found) {
  double largest = 0;
  for (const ThresholdEstimate& point : found) {
    if (!point.standard_error_pitch) return std::nullopt;
    largest = std::max(largest, 100 * *point.standard_error_pitch / point.s75_pitch);
  }
  return largest;
}

void mark_best(std::vector<CostPoint>& points) {
  for (CostPoint& point : points) {
    if (point.paired || !point.measured()) continue;
    point.best = std::ranges::none_of(points, [&](const CostPoint& other) {
      return !other.paired && other.measured() && *other.wall_s <= *point.wall_s &&
             other.total_percent() <= point.total_percent() &&
             (*other.wall_s < *point.wall_s || other.total_percent() < point.total_percent());
    });
  }
}

/// Run of one task: results so far and remaining time.
class Frontier {
 public:
  Frontier(const CostTask& task, const CostListener& listener, std::stop_token stop)
      : task_(task), listener_(listener), stop_(std::move(stop)) {
    out_.budget_s = task.budget_s;
  }

  [[nodiscard]] Result<CostFrontier> run();

 private:
  [[nodiscard]] Estimate direct(const SensorPlan& effects, const Accuracy& accuracy) const;
  /// Predicted time, from the formula for direct estimates and the speed of the scouting run.
  [[nodiscard]] double expected_s(const Accuracy& accuracy) const;
  [[nodiscard]] double formula_s(int draws, int phases_per_axis) const;
  [[nodiscard]] double seconds_since(Clock::time_point start) const {
    return std::chrono::duration<double>(task_.now() - start).count();
  }
  [[nodiscard]] double left_s() const { return task_.budget_s - seconds_since(begin_); }
  [[nodiscard]] Result<Timed> timed(const Estimate& estimate) const;
  [[nodiscard]] Result<void> scout();
  [[nodiscard]] Result<void> measure_references();
  [[nodiscard]] std::vector<Way> choices() const;
  [[nodiscard]] std::vector<Way> knobs() const;
  void measure_trials();
  void measure(Way way);
  void measure_all(std::string_view phase, std::vector<Way> ways);
  void phase(std::string_view name) const {
    if (listener_.on_phase) listener_.on_phase(name);
  }

  const CostTask& task_;
  const CostListener& listener_;
  std::stop_token stop_;
  Clock::time_point begin_ = task_.now();
  std::vector<double> delta_t_k_;  ///< those with a threshold
  std::vector<double> scouted_pitch_;
  double speed_ = 1;  ///< measured time over that of the formula
  std::vector<ThresholdEstimate> paired_reference_;
  std::size_t planned_ = 0;
  CostFrontier out_;
};

Estimate Frontier::direct(const SensorPlan& effects, const Accuracy& accuracy) const {
  return [this, &effects, accuracy](std::stop_token stop) -> Result<std::vector<ThresholdEstimate>> {
    TemplateObserver observer(task_.observer, triangle_alternatives());  // new: its banks are part of the cost
    TODBENCH_TRY(const auto points, direct_estimate(task_.sensor, effects, observer, delta_t_k_,
                                                    {.samples_per_pitch = 0,
                                                     .motion = task_.motion,
                                                     .accuracy = accuracy,
                                                     .seed = task_.seed,
                                                     .stop = std::move(stop)}));
    std::vector<ThresholdEstimate> found;
    for (const DirectPoint& p : points) found.push_back({p.delta_t_k, p.s75_pitch, p.standard_error_pitch});
    return found;
  };
}

double Frontier::formula_s(int draws, int phases_per_axis) const {
  double sum = 0;
  for (const double size : scouted_pitch_)
    sum += predicted_direct_seconds(task_.observer, task_.sensor, size, draws, phases_per_axis);
  return sum;
}

double Frontier::expected_s(const Accuracy& accuracy) const {
  return speed_ * formula_s(accuracy.noise_draws, accuracy.phases_per_axis);
}

Result<Timed> Frontier::timed(const Estimate& estimate) const {
  const Deadline deadline(left_s(), stop_);
  const auto start = task_.now();
  const double processor_start_s = processor_s();
  TODBENCH_TRY(auto found, estimate(deadline.token()));
  const double wall_s = seconds_since(start);
  return Timed{
      .found = std::move(found), .wall_s = wall_s, .idle_s = std::min(wall_s, processor_s() - processor_start_s)};
}

/// Draft estimate at every contrast: finds the contrasts with a threshold, its size, and the speed of the machine.
Result<void> Frontier::scout() {
  phase("searching for the thresholds");
  Accuracy draft = Accuracy::draft();
  double seconds = 0;
  std::string first_reason;
  for (const double contrast : task_.delta_t_k) {
    delta_t_k_ = {contrast};
    const auto found = timed(direct(task_.full, draft));
    if (found) {
      scouted_pitch_.push_back(found->found.front().s75_pitch);
      seconds += found->wall_s;
      out_.reference.push_back(found->found.front());
    } else if (stop_.stop_requested()) {
      return tl::unexpected(found.error());
    } else if (found.error().code == ErrorCode::interrupted) {
      return fail(ErrorCode::invalid_input,
                  fmt::format("a budget of {:g} s is too short even to find the thresholds", task_.budget_s));
    } else {
      out_.notes.push_back(fmt::format("{:g} K is omitted: ", contrast) + found.error().message);
    }
  }
  delta_t_k_.clear();
  for (const auto& point : out_.reference) delta_t_k_.push_back(point.delta_t_k);
  if (delta_t_k_.empty()) return {};
  speed_ = seconds / formula_s(draft.noise_draws, draft.phases_per_axis);
  return {};
}

Result<void> Frontier::measure_references() {
  phase("computing the reference");
  Accuracy reference = Accuracy::reference();
  const double allowed_s = reference_share * task_.budget_s;
  // Time has one part for pictures and banks, and one proportional to the draws.
  Accuracy fewest = reference;
  fewest.noise_draws = fewest_reference_draws;
  const double whole_s = expected_s(reference), fewest_s = expected_s(fewest);
  if (fewest_s > allowed_s) {
    return fail(ErrorCode::invalid_input,
                fmt::format("a budget of {:g} s is too short: the reference level with {} draws takes about {:.0f} s "
                            "and may use at most a third of the budget",
                            task_.budget_s, fewest_reference_draws, std::ceil(fewest_s)));
  }
  if (whole_s > allowed_s) {
    const double share = (allowed_s - fewest_s) / (whole_s - fewest_s);
    reference.noise_draws =
        fewest_reference_draws + static_cast<int>(share * (reference.noise_draws - fewest_reference_draws));
    out_.notes.push_back(
        fmt::format("the reference has {} draws per size instead of {}, because all of them would take about {:.0f} s",
                    reference.noise_draws, Accuracy::reference().noise_draws, std::ceil(whole_s)));
  }
  auto whole = timed(direct(task_.full, reference));
  if (!whole) {
    if (stop_.stop_requested()) return tl::unexpected(whole.error());
    return fail(ErrorCode::invalid_input,
                fmt::format("a budget of {:g} s is too short for the reference level: ", task_.budget_s) +
                    whole.error().message);
  }
  speed_ = whole->wall_s / formula_s(reference.noise_draws, reference.phases_per_axis);
  out_.reference_draws = reference.noise_draws;
  out_.reference = std::move(whole->found);
  out_.reference_s = whole->idle_s;
  out_.reference_standard_error_percent = largest_standard_error_percent(out_.reference).value_or(0);
  out_.paired_draws = paired_draws;
  reference.noise_draws = paired_draws;
  auto paired = timed(direct(task_.full, reference));
  if (!paired) {
    if (stop_.stop_requested()) return tl::unexpected(paired.error());
    return fail(ErrorCode::invalid_input, fmt::format("a budget of {:g} s is too short", task_.budget_s));
  }
  paired_reference_ = std::move(paired->found);
  return {};
}

/// Measures one way, or records the reason for not doing so.
void Frontier::measure(Way way) {
  CostPoint& point = way.point;
  const auto refuse = [&](std::string why) {
    point.not_measured = std::move(why);
    out_.points.push_back(point);
  };
  const double left = left_s();
  if (left <= 0) return refuse(fmt::format("the budget of {:g} s was used up", task_.budget_s));
  if (way.expected_s > left) {
    return refuse(fmt::format("it needs about {:.1f} s, more than is left of the budget of {:g} s", way.expected_s,
                              task_.budget_s));
  }
  auto found = timed(way.estimate);
  if (!found) {
    return refuse(found.error().code == ErrorCode::interrupted
                      ? fmt::format("stopped at the end of the budget of {:g} s", task_.budget_s)
                      : found.error().message);
  }
  if (found->wall_s < worth_repeating_s && left_s() > task_.budget_s / 2) {
    if (const auto again = timed(way.estimate)) found->idle_s = std::min(found->idle_s, again->idle_s);
  }
  point.wall_s = found->idle_s;
  point.error_percent = largest_error_percent(found->found, point.paired ? paired_reference_ : out_.reference);
  point.standard_error_percent = largest_standard_error_percent(found->found);
  out_.points.push_back(point);
}

void Frontier::measure_all(std::string_view name, std::vector<Way> ways) {
  if (!ways.empty()) phase(name);
  for (Way& way : ways) {
    if (stop_.stop_requested()) return;
    measure(std::move(way));
    if (listener_.on_progress) listener_.on_progress(out_.points.size(), planned_);
  }
}

std::vector<Way> Frontier::choices() const {
  std::vector<Way> ways;
  for (const CostChoice& choice : task_.choices) {
    Way way{.point = {.knob = "planner", .setting = choice.setting, .chosen = choice.chosen},
            .estimate = direct(choice.effects, choice.accuracy),
            .expected_s = expected_s(choice.accuracy)};
    ways.insert(choice.chosen ? ways.begin() : ways.end(), std::move(way));
  }
  return ways;
}

/// Varies each knob alone with the others at the reference level, the coarsest first because it is the cheapest.
std::vector<Way> Frontier::knobs() const {
  std::vector<Way> ways;
  const auto add = [&](const char* knob, std::string setting, const Accuracy& accuracy, bool paired) {
    ways.push_back({.point = {.knob = knob, .setting = std::move(setting), .paired = paired},
                    .estimate = direct(task_.full, accuracy),
                    .expected_s = expected_s(accuracy)});
  };
  Accuracy paired = Accuracy::reference();
  paired.noise_draws = paired_draws;
  const auto vary = [&](const char* knob, auto Accuracy::*field, auto values) {
    for (const auto value : values) {
      Accuracy accuracy = paired;
      accuracy.*field = value;
      add(knob, fmt::format("{:g}", static_cast<double>(value)), accuracy, true);
    }
  };
  for (const double tolerance : {10.0, 5.0, 2.0, 1.0, 0.5})
    add("tolerance", fmt::format("{:g} %", tolerance), Accuracy::for_tolerance(tolerance), false);
  for (const int draws : {50, 100, 200, 600, 1500}) {
    if (draws >= out_.reference_draws) break;
    Accuracy accuracy = Accuracy::reference();
    accuracy.noise_draws = draws;
    add("draws", std::to_string(draws), accuracy, false);
  }
  const Accuracy draft = Accuracy::draft(), normal = Accuracy::normal(), reference = Accuracy::reference();
  vary("wavelengths", &Accuracy::wavelengths, std::vector{1, 2, 4, reference.wavelengths});
  vary("phases", &Accuracy::phases_per_axis, std::vector{2, 4, reference.phases_per_axis});
  vary("wrap", &Accuracy::wrap_tolerance,
       std::vector{1e-2, 1e-3, draft.wrap_tolerance, normal.wrap_tolerance, reference.wrap_tolerance});
  vary("band", &Accuracy::band_tolerance,
       std::vector{1e-1, draft.band_tolerance, normal.band_tolerance, reference.band_tolerance});
  return ways;
}

void Frontier::measure_trials() {
  if (!task_.trials.empty()) phase("measuring with trials");
  double per_cost_s = 0;
  for (const CostTrials& trials : task_.trials) {
    if (stop_.stop_requested()) return;
    const auto in_order = [&](std::stop_token stop) -> Result<std::vector<ThresholdEstimate>> {
      const auto found = trials.measure(std::move(stop));
      if (!found) return found;
      std::vector<ThresholdEstimate> ordered;
      for (const double contrast : delta_t_k_) {
        const auto at = std::ranges::find(*found, contrast, &ThresholdEstimate::delta_t_k);
        if (at == found->end()) {
          return fail(ErrorCode::invalid_input,
                      fmt::format("the trials are too few to identify the threshold at {:g} K", contrast));
        }
        ordered.push_back(*at);
      }
      return ordered;
    };
    measure({.point = {.knob = "trials", .setting = trials.setting},
             .estimate = in_order,
             .expected_s = trials_share * per_cost_s * trials.relative_cost});
    if (out_.points.back().measured()) per_cost_s = *out_.points.back().wall_s / trials.relative_cost;
    if (listener_.on_progress) listener_.on_progress(out_.points.size(), planned_);
  }
}

Result<CostFrontier> Frontier::run() {
  TODBENCH_TRY_VOID(scout());
  if (delta_t_k_.empty()) return std::move(out_);
  TODBENCH_TRY_VOID(measure_references());
  planned_ = task_.choices.size() + knobs().size() + task_.trials.size();
  measure_all("measuring the planner's choices", choices());
  measure_trials();
  measure_all("measuring each knob alone", knobs());
  if (stop_.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
  mark_best(out_.points);
  out_.spent_s = seconds_since(begin_);
  return std::move(out_);
}

}  // namespace

Result<CostFrontier> cost_frontier(const CostTask& task, const CostListener& listener, std::stop_token stop) {
  return Frontier(task, listener, std::move(stop)).run();
}

}  // namespace todbench
