#include "bench/gui/plan_presenter.h"

#include <utility>

#include "bench/run/experiment_inputs.h"
#include "bench/session/files.h"
#include "bench/session/plan_options.h"

namespace todbench {
namespace {

constexpr int delay_ms = 200;

QString sentence(const Error& error) {
  return QString::fromStdString(error.message);
}

/// Whether the expected thresholds of one plan hold for the other.
bool same_thresholds(const Plan& a, const Plan& b) {
  return a.target.delta_t_k == b.target.delta_t_k && a.target.plates == b.target.plates &&
         a.target.distance_m == b.target.distance_m && a.fit == b.fit && a.observer == b.observer &&
         a.simulation.sensor == b.simulation.sensor && a.simulation.microscan == b.simulation.microscan &&
         a.simulation.skip == b.simulation.skip && a.simulation.force == b.simulation.force;
}

struct LookAhead {
  std::vector<ExpectedThreshold> expected;
  QString misfit;
};

Result<LookAhead> looked_ahead(const Plan& plan, const std::stop_token& stop) {
  auto expected = expected_thresholds(plan, stop);
  if (!expected) return tl::unexpected(expected.error());
  LookAhead out{.expected = std::move(*expected), .misfit = {}};
  if (auto inputs = read_inputs(plan)) {
    if (auto fits = check_simulated_geometry(plan, *inputs); !fits) out.misfit = sentence(fits.error());
  } else {
    out.misfit = sentence(inputs.error());
  }
  return out;
}

}  // namespace

PlanPresenter::PlanPresenter(Workbench& bench, QObject* parent) : QObject(parent), bench_(bench) {
  delay_.setSingleShot(true);
  delay_.setInterval(delay_ms);
  connect(&delay_, &QTimer::timeout, this, &PlanPresenter::look_ahead);
  connect(&bench_, &Workbench::plan_changed, this, &PlanPresenter::plan_changed);
  plan_changed();
}

QString PlanPresenter::toml() const {
  return QString::fromStdString(to_toml(bench_.plan()));
}

QString PlanPresenter::apply(const Plan& plan) {
  return apply_toml(QString::fromStdString(to_toml(plan)));
}

QString PlanPresenter::apply_toml(const QString& text) {
  auto plan = parse_plan({"plan", text.toStdString()}, std::filesystem::current_path());
  if (!plan) return sentence(plan.error());
  if (*plan != bench_.plan()) bench_.set_plan(*plan);
  return {};
}

QString PlanPresenter::load(const QString& reference) {
  auto plan = load_plan(reference.toStdString());
  if (!plan) return sentence(plan.error());
  bench_.set_plan(*plan);
  return {};
}

QString PlanPresenter::save(const QString& file) const {
  auto written = write_file_atomically(file.toStdString(), to_toml(bench_.plan()));
  return written ? QString() : sentence(written.error());
}

QString PlanPresenter::set_tolerance_percent(double tolerance_percent) {
  Plan plan = bench_.plan();
  plan.simulation.tolerance_percent = tolerance_percent;
  if (expected_known()) {
    plan.target.phases = phases_for(plan, plates_, expected_, tolerance_percent);
    plan.simulation.phases = plan.target.phases;
  }
  return apply(plan);
}

void PlanPresenter::plan_changed() {
  refresh();
  if (!expected_of_ || !same_thresholds(*expected_of_, bench_.plan())) expected_.clear();
  delay_.start();
}

void PlanPresenter::refresh() {
  const Plan& plan = bench_.plan();
  if (auto plates = plates_of(plan)) plates_ = std::move(*plates);
  if (auto sensor = sensor_of(plan)) {
    effects_ = full_plan(*sensor, plan.simulation.skip, plan.simulation.force);
    frame_rate_hz_ = sensor->frame_rate_hz > 0 ? sensor->frame_rate_hz : 50;
  }
  outlook_ = todbench::outlook(plan, plates_, expected_, frame_rate_hz_);
  emit updated();
}

void PlanPresenter::look_ahead() {
  const Plan plan = bench_.plan();
  // A running measurement needs the processor and the thread more than a forecast does.
  if (bench_.activity() == Activity::measuring) return;
  jobs_.start([this, plan](const std::stop_token& stop) {
    auto seen = looked_ahead(plan, stop);
    if (!seen && seen.error().code == ErrorCode::interrupted) return;
    bench_.post([this, plan, seen = std::move(seen)] {
      if (plan != bench_.plan()) return;
      expected_of_ = plan;
      expected_ = seen ? seen->expected : std::vector<ExpectedThreshold>();
      misfit_ = seen ? seen->misfit : sentence(seen.error());
      refresh();
    });
  });
}

}  // namespace todbench
