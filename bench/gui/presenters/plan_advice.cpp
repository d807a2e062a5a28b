// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/plan_advice.h"

#include <QStringList>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/base/try.h"
#include "bench/gui/presenters/text_of.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/loaded_plan.h"
#include "bench/session/display_record.h"
#include "bench/twin/acuity_limits.h"
#include "bench/twin/experiment_inputs.h"
#include "bench/twin/module_chain.h"
#include "sim_devices/prediction/viewing_proposal.h"
#include "tod/presentation/largest_contrast.h"

namespace todbench {
namespace {

QString cells(const QStringList& texts, const char* element) {
  QString row = "<tr>";
  for (const QString& text : texts) row += QString("<%1>%2&nbsp;&nbsp;</%1>").arg(element, text);
  return row + "</tr>";
}

QString heading_of(LimitingFactor factor) {
  return text_of(to_string(factor)).replace('_', ' ');
}

/// Factors with an estimate at one contrast or more: an observer does not have all of them.
std::vector<LimitingFactor> factors_of(const std::vector<AcuityLimits>& limits) {
  std::vector<LimitingFactor> factors;
  for (const LimitingFactor factor : all_limiting_factors) {
    const auto has = [&](const AcuityLimits& at) {
      return std::ranges::find(at.costs, factor, &FactorCost::factor) != at.costs.end();
    };
    if (std::ranges::any_of(limits, has)) factors.push_back(factor);
  }
  return factors;
}

/// The factor that limits most in bold; a dash for a factor without an estimate.
QString row_of(const AcuityLimits& limits, const std::vector<LimitingFactor>& factors) {
  QStringList texts{QString("%1 K").arg(limits.delta_t_k)};
  for (const LimitingFactor factor : factors) {
    const auto found = std::ranges::find(limits.costs, factor, &FactorCost::factor);
    // Adding 0 turns a rounded -0 into 0.
    const QString cost =
        found == limits.costs.end() ? QString("–") : QString("%1 %").arg(std::round(found->percent) + 0.0);
    texts << (found != limits.costs.end() && found == limits.costs.begin() ? "<b>" + cost + "</b>" : cost);
  }
  return cells(texts, "td");
}

QString heading_of(const ExperimentInputs& inputs) {
  const auto escaped = [](const std::string& text) { return QString::fromStdString(text).toHtmlEscaped(); };
  QString viewed = ". There is no display, because the plan has no section [display]";
  if (const auto& display = inputs.observer.display) {
    viewed = QString(" at the display of the plan (zoom %1, %2 m, %3 cd/m² on average)")
                 .arg(display->zoom)
                 .arg(display->viewing_distance_m)
                 .arg(adaptation_luminance_cd_m2(*display), 0, 'g', 3);
  }
  return QString("<b>Limits of the acuity</b> of %1 for %2%3. S75 is larger by this much than without the factor:")
      .arg(escaped(inputs.sensor.name), escaped(inputs.observer.name), viewed);
}

}  // namespace

Result<QString> viewing_advice(const Plan& plan, const std::stop_token& stop) {
  if (!has_display(plan)) return fail(ErrorCode::invalid_input, no_display_sentence);
  TODBENCH_TRY(const LoadedPlan loaded, LoadedPlan::load(plan));
  TODBENCH_TRY_VOID(refuse_modules(plan, loaded.sensor()));
  TODBENCH_TRY(const auto observer, load_observer_at("hvs-2", plan.display));
  const double largest = std::abs(largest_contrast_k(plan.target.delta_t_k));
  TODBENCH_TRY(const ViewingProposal viewing,
               propose_viewing(loaded.sensor(), full_plan(loaded.sensor(), {}, {}), observer, largest, stop));
  return QString::fromStdString(in_words(viewing, plan.display));
}

Result<QString> limits_advice(const Plan& plan, const std::stop_token& stop) {
  TODBENCH_TRY(const LoadedPlan loaded, LoadedPlan::load(plan));
  EffectPlanner planner;
  TODBENCH_TRY(auto inputs, experiment_inputs(loaded, planner));
  if (has_display(plan) && !inputs.observer.eye) {
    TODBENCH_TRY(inputs.observer, load_observer_at("hvs-2", plan.display));
  }
  TODBENCH_TRY(const auto limits, acuity_limits(plan, inputs, plan.target.delta_t_k, stop));
  QStringList headings{"Contrast"}, lost;
  const std::vector<LimitingFactor> factors = factors_of(limits);
  for (const LimitingFactor factor : factors) headings << heading_of(factor);
  QString rows = cells(headings, "th");
  for (const AcuityLimits& at : limits) rows += row_of(at, factors);
  for (const double contrast : plan.target.delta_t_k) {
    if (std::ranges::find(limits, contrast, &AcuityLimits::delta_t_k) == limits.end())
      lost << QString("%1 K").arg(contrast);
  }
  QString text = heading_of(inputs) + "<table>" + rows + "</table>";
  if (!lost.isEmpty()) text += "No threshold is expected at " + lost.join(", ") + ".";
  return text;
}

PlanAdvice::PlanAdvice(Estimate estimate, QString running, QObject* parent)
    : QObject(parent), estimate_(std::move(estimate)), running_(std::move(running)) {}

void PlanAdvice::ask(const Plan& plan) {
  busy_ = true;
  words_ = running_;
  jobs_.start([this, plan, number = ++number_](const std::stop_token& stop) {
    const auto found = estimate_(plan, stop);
    const QString words = found ? *found : QString::fromStdString(found.error().message);
    QMetaObject::invokeMethod(
        this, [this, number, words] { take(number, words); }, Qt::QueuedConnection);
  });
  emit updated();
}

void PlanAdvice::stop() {
  if (!busy_) return;
  jobs_.stop();
  take(++number_, "The calculation was stopped.");
}

void PlanAdvice::take(int number, const QString& words) {
  if (number != number_) return;
  busy_ = false;
  words_ = words;
  emit updated();
}

}  // namespace todbench
