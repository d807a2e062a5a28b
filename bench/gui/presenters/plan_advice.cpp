// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/viewing_presenter.h"

#include <cmath>
#include <string>

#include "acquisition/base/try.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/loaded_plan.h"
#include "sim_devices/prediction/viewing_proposal.h"
#include "tod/presentation/largest_contrast.h"

namespace todbench {
namespace {

Result<std::string> proposal_in_words(const Plan& plan, const std::stop_token& stop) {
  TODBENCH_TRY(const LoadedPlan loaded, LoadedPlan::load(plan));
  TODBENCH_TRY(const auto observer, load_observer_at("hvs-2", plan.display));
  const double largest = std::abs(largest_contrast_k(plan.target.delta_t_k));
  TODBENCH_TRY(const ViewingProposal viewing,
               propose_viewing(loaded.sensor(), full_plan(loaded.sensor(), {}, {}), observer, largest, stop));
  return in_words(viewing, plan.display);
}

}  // namespace

ViewingPresenter::ViewingPresenter(QObject* parent) : QObject(parent) {}

void ViewingPresenter::propose(const Plan& plan) {
  ++number_;
  busy_ = has_display(plan);
  words_ = busy_ ? QString("Zooms and distances are compared.") : QString(no_display_sentence);
  if (busy_) {
    jobs_.start([this, plan, number = number_](const std::stop_token& stop) {
      const auto found = proposal_in_words(plan, stop);
      const QString words = QString::fromStdString(found ? *found : found.error().message);
      QMetaObject::invokeMethod(
          this, [this, number, words] { take(number, words); }, Qt::QueuedConnection);
    });
  }
  emit updated();
}

void ViewingPresenter::take(int number, const QString& words) {
  if (number != number_) return;
  busy_ = false;
  words_ = words;
  emit updated();
}

}  // namespace todbench
