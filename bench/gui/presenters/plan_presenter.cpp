// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/plan_presenter.h"

#include <algorithm>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/text/files.h"
#include "bench/twin/experiment_inputs.h"

namespace todbench {
namespace {

constexpr int delay_ms = 200;
constexpr std::size_t most_changes = 200;

QString sentence(const Error& error) {
  return QString::fromStdString(error.message);
}

QString why_not(const Result<void>& done) {
  return done ? QString() : sentence(done.error());
}

/// Whether the expected thresholds of one plan are valid for the other.
bool same_thresholds(const Plan& a, const Plan& b) {
  return a.target.delta_t_k == b.target.delta_t_k && a.target.plates == b.target.plates &&
         a.target.distance_m == b.target.distance_m && a.fit == b.fit && a.observer == b.observer &&
         a.simulation.sensor == b.simulation.sensor && a.simulation.microscan == b.simulation.microscan &&
         a.simulation.skip == b.simulation.skip && a.simulation.force == b.simulation.force &&
         a.simulation.motion == b.simulation.motion && a.display == b.display;
}

/// Returns the plan without the settings of a tolerance: plans that are then equal have equal prices.
Plan without_tolerance(Plan plan) {
  plan.simulation.tolerance_percent = 1;
  plan.schedule.half_width_percent = 10;
  plan.target.phases = plan.simulation.phases = 1;
  return plan;
}

struct LookAhead {
  std::vector<ExpectedThreshold> expected;
  QString misfit;
};

/// `expected`: the thresholds of the plan if they are known, otherwise empty.
Result<LookAhead> looked_ahead(const LoadedPlan& loaded, std::vector<ExpectedThreshold> expected,
                               EffectPlanner& planner, const std::stop_token& stop) {
  LookAhead out{.expected = std::move(expected), .misfit = {}};
  auto inputs = experiment_inputs(loaded, planner);
  if (!inputs) {
    out.misfit = sentence(inputs.error());
    return out;
  }
  if (auto fits = check_simulated_geometry(loaded.plan(), *inputs); !fits) out.misfit = sentence(fits.error());
  if (out.expected.empty()) {
    TODBENCH_TRY(out.expected, expected_thresholds(loaded.plan(), *std::move(inputs), stop));
  }
  return out;
}

double frame_rate_hz(const LoadedPlan& loaded) {
  constexpr double usual_hz = 50;
  return loaded.sensor().frame_rate_hz > 0 ? loaded.sensor().frame_rate_hz : usual_hz;
}

}  // namespace

PlanPresenter::PlanPresenter(Workbench& bench, QObject* parent) : QObject(parent), bench_(bench) {
  delay_.setSingleShot(true);
  delay_.setInterval(delay_ms);
  connect(&delay_, &QTimer::timeout, this, &PlanPresenter::look_ahead);
  last_ = bench_.plan();
  connect(&bench_, &Workbench::plan_changed, this, &PlanPresenter::plan_changed);
  // A plan names its device: older plans of the undo list belong to another.
  connect(&bench_, &Workbench::device_selected, this, [this] {
    undone_to_.clear();
    redone_to_.clear();
    emit updated();
  });
  // Runs the forecasts that were postponed during a measurement.
  connect(&bench_, &Workbench::activity_changed, this, [this] {
    if (bench_.activity() != Activity::idle) return;
    if (expected_.empty()) delay_.start();
    if (prices_.empty()) foresee();
  });
  plan_changed();
}

QString PlanPresenter::toml() const {
  return QString::fromStdString(to_toml(bench_.plan()));
}

Result<void> PlanPresenter::take(const Result<LoadedPlan>& loaded, Change change) {
  if (!loaded) return tl::unexpected(loaded.error());
  loaded_ = *loaded;
  if (loaded->plan() == bench_.plan()) return {};
  change_ = change;
  bench_.set_plan(loaded->plan());
  change_ = Change::single;
  return {};
}

Result<void> PlanPresenter::use(const Plan& plan) {
  Plan absolute = with_absolute_references(plan, std::filesystem::current_path());
  return take(loaded_ ? loaded_->with(std::move(absolute)) : LoadedPlan::load(std::move(absolute)));
}

QString PlanPresenter::apply(const Plan& plan) {
  return why_not(use(plan));
}

QString PlanPresenter::apply_toml(const QString& text) {
  return why_not(take(read_plan({"plan", text.toStdString()}, std::filesystem::current_path())));
}

QString PlanPresenter::load(const QString& reference) {
  return why_not(take(read_plan(reference.toStdString())));
}

void PlanPresenter::keep_last() {
  if (bench_.plan() == last_) return;
  const bool goes_on = change_ == Change::sliding && last_change_ == Change::sliding;
  if (change_ != Change::travel && !goes_on) {
    undone_to_.push_back(last_);
    if (undone_to_.size() > most_changes) undone_to_.erase(undone_to_.begin());
    redone_to_.clear();
  }
  last_change_ = change_;
  last_ = bench_.plan();
}

void PlanPresenter::travel(std::vector<Plan>& to, std::vector<Plan>& from) {
  if (to.empty()) return;
  const Plan plan = std::move(to.back());
  to.pop_back();
  from.push_back(bench_.plan());
  change_ = Change::travel;
  bench_.set_plan(plan);
  change_ = Change::single;
}

void PlanPresenter::undo() {
  travel(undone_to_, redone_to_);
}

void PlanPresenter::redo() {
  travel(redone_to_, undone_to_);
}

QString PlanPresenter::save(const QString& file) const {
  auto written = write_file_atomically(file.toStdString(), to_toml(bench_.plan()));
  return written ? QString() : sentence(written.error());
}

QString PlanPresenter::set_tolerance_percent(double tolerance_percent) {
  Plan plan = with_tolerance(bench_.plan(), forecast_ ? &*forecast_ : nullptr, tolerance_percent);
  return why_not(take(loaded_ ? loaded_->with(std::move(plan)) : LoadedPlan::load(std::move(plan)), Change::sliding));
}

QString PlanPresenter::choose(Effect effect, EffectChoice choice) {
  Plan plan = bench_.plan();
  std::erase(plan.simulation.skip, effect);
  std::erase(plan.simulation.force, effect);
  if (choice == EffectChoice::skip) plan.simulation.skip.push_back(effect);
  if (choice == EffectChoice::simulate) plan.simulation.force.push_back(effect);
  return apply(plan);
}

EffectChoice PlanPresenter::choice(Effect effect) const {
  const auto among = [effect](const std::vector<Effect>& effects) {
    return std::find(effects.begin(), effects.end(), effect) != effects.end();
  };
  const SimulationPlan& simulation = bench_.plan().simulation;
  return among(simulation.skip)    ? EffectChoice::skip
         : among(simulation.force) ? EffectChoice::simulate
                                   : EffectChoice::planner;
}

QString PlanPresenter::misfit() const {
  if (!misfit_.isEmpty()) return misfit_;
  if (!trouble_.isEmpty()) return trouble_;
  return forecast_ ? QString::fromStdString(forecast_->problem) : QString();
}

QStringList PlanPresenter::warnings() const {
  QStringList out;
  if (!forecast_) return out;
  for (const auto& warning : forecast_->warnings) out << QString::fromStdString(warning);
  return out;
}

void PlanPresenter::plan_changed() {
  keep_last();
  if (!loaded_ || loaded_->plan() != bench_.plan()) {
    auto loaded = loaded_ ? loaded_->with(bench_.plan()) : LoadedPlan::load(bench_.plan());
    trouble_ = loaded ? QString() : sentence(loaded.error());
    loaded_ = loaded ? std::optional(*std::move(loaded)) : std::nullopt;
  }
  if (!expected_of_ || !same_thresholds(*expected_of_, bench_.plan())) expected_.clear();
  if (!prices_of_ || without_tolerance(bench_.plan()) != *prices_of_) prices_.clear();
  // The contrasts, plate or sensor changed: the forecast is no longer valid.
  if (forecast_ && without_tolerance(forecast_->plan) != without_tolerance(bench_.plan())) forecast_.reset();
  refresh();
  foresee();
  delay_.start();
}

void PlanPresenter::refresh() {
  outlook_ = {};
  if (loaded_) {
    outlook_ = todbench::outlook(loaded_->plan(), loaded_->plates(), forecast_ ? &*forecast_ : nullptr,
                                 frame_rate_hz(*loaded_));
    // Until the direct estimates are known, the forecast has thresholds of the planner that may be 6 % low.
    for (PlannedContrast& contrast : outlook_.contrasts) {
      const auto known = std::ranges::find(expected_, contrast.delta_t_k, &ExpectedThreshold::delta_t_k);
      contrast.s75_mrad = known == expected_.end() ? std::nullopt : known->s75_mrad;
    }
  }
  emit updated();
}

void PlanPresenter::foresee() {
  if (!loaded_) return;
  const bool priced = !prices_.empty();
  const bool measuring = bench_.activity() == Activity::measuring || bench_.activity() == Activity::replaying;
  forecasts_.start([this, loaded = *loaded_, known = expected_, priced, measuring](const std::stop_token& stop) {
    const Plan& plan = loaded.plan();
    auto seen = todbench::forecast(loaded, known, planner_);
    // Posted even if a newer plan waits, so that the table follows a moving slider plan by plan.
    bench_.post([this, plan, seen] {
      if (without_tolerance(plan) != without_tolerance(bench_.plan())) return;
      trouble_ = seen ? QString() : sentence(seen.error());
      if (seen) forecast_ = *seen;
      refresh();
    });
    // Prices are of the direct estimates: foresee() runs again when these are known.
    if (!seen || known.empty() || priced || measuring) return;
    auto prices = accuracy_prices(loaded, *seen, known, frame_rate_hz(loaded), planner_, stop);
    if (stop.stop_requested()) return;
    bench_.post([this, plan, prices = std::move(prices)] {
      if (without_tolerance(plan) != without_tolerance(bench_.plan())) return;
      prices_of_ = without_tolerance(plan);
      prices_ = prices;
      refresh();
    });
  });
}

void PlanPresenter::look_ahead() {
  if (!loaded_) return;
  // A running measurement has priority over a forecast.
  if (bench_.activity() == Activity::measuring || bench_.activity() == Activity::replaying) return;
  jobs_.start([this, loaded = *loaded_, known = expected_](const std::stop_token& stop) {
    const Plan& plan = loaded.plan();
    auto seen = looked_ahead(loaded, known, planner_, stop);
    if (!seen && seen.error().code == ErrorCode::interrupted) return;
    bench_.post([this, plan, known, seen = std::move(seen)] {
      if (plan != bench_.plan()) return;
      expected_of_ = plan;
      expected_ = seen ? seen->expected : std::vector<ExpectedThreshold>();
      misfit_ = seen ? seen->misfit : sentence(seen.error());
      refresh();
      if (expected_ != known) foresee();
    });
  });
}

}  // namespace todbench
