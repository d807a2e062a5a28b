// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/human_results.h"

#include <algorithm>
#include <string>
#include <vector>

#include "bench/gui/presenters/human_presenter.h"
#include "bench/gui/presenters/measure_presenter.h"
#include "bench/gui/presenters/naked_eye_presenter.h"
#include "bench/gui/presenters/person_presenter.h"
#include "bench/judgement/verdict.h"
#include "bench/report/number_format.h"
#include "bench/report/tod_figures.h"

namespace todbench {
namespace {

/// False alarms for frames without bars, over all frequencies.
QString false_alarms_in_words(const PersonResult& result) {
  int seen = 0, shown = 0;
  for (const PersonShare& share : result.false_alarms) {
    seen += share.right;
    shown += share.shown;
  }
  return result.false_alarms.empty() ? QString()
                                     : QString("<p>Bars reported in %1 of %2 empty frames</p>").arg(seen).arg(shown);
}

QString s75_text(const PsychometricFit& fit) {
  return QString::fromStdString(with_interval(identified_threshold(fit), fit.ci95));
}

}  // namespace

QString result_of_a_person(const PersonPresenter& person) {
  const PersonExperiment& experiment = *person.experiment();
  const PersonResult result = person_result(experiment, person.answers());
  QString rows;
  for (std::size_t c = 0; c < result.conditions.size(); ++c) {
    const PersonShare& share = result.conditions[c];
    if (share.shown == 0 || experiment.task() == PersonTask::bars) continue;
    rows += QString("<tr><td>%1 m&nbsp;</td><td>%2</td></tr>")
                .arg(experiment.conditions()[c].range_m)
                .arg(QString::fromStdString(with_interval(static_cast<double>(share.right) / share.shown, share.ci95)));
  }
  for (std::size_t f = 0; f < result.thresholds_k.size(); ++f) {
    const auto& of = experiment.conditions();
    const auto at = std::find_if(of.begin(), of.end(), [&](const PersonCondition& one) { return one.place == f; });
    const SetCriterion& found = result.thresholds_k[f];
    rows += QString("<tr><td>%1 /mrad&nbsp;</td><td>%2</td></tr>")
                .arg(at->frequency_per_mrad, 0, 'g', 3)
                .arg(found.value ? QString::fromStdString(with_interval(found.value, found.ci95)) + " K" : "none");
  }
  const bool set = experiment.task() == PersonTask::identify;
  QString text = "<table cellspacing=4><tr><th>" + QString(set ? "Range" : "Frequency") + "</th><th>" +
                 QString(set ? "Correct" : "75 % point") + "</th></tr>" + rows + "</table>";
  if (set && result.r75_m.value)
    text +=
        "<p>75 % correct at " + QString::fromStdString(with_interval(result.r75_m.value, result.r75_m.ci95)) + " m</p>";
  text += false_alarms_in_words(result);
  const QString where = QString::fromStdString(person.folder().filename().string());
  return text + "<p>" + (person.problem().isEmpty() ? "Saved in " + where.toHtmlEscaped() : person.problem()) + "</p>";
}

QString result_of_sources(const HumanPresenter& human) {
  const BlindResult& result = *human.blind_result();
  QString rows;
  for (std::size_t s = 0; s < result.sources.size(); ++s) {
    for (const TodPoint& point : result.records[s].curve.points) {
      QString ratio;
      for (const ComparisonPoint& compared : s == 0 ? std::vector<ComparisonPoint>() : result.ratios[s - 1].points) {
        if (compared.set_delta_t_k == point.set_delta_t_k)
          ratio = QString::fromStdString(with_interval(compared.ratio, compared.ratio_ci95));
      }
      rows += QString("<tr><td>%1, %2 K&nbsp;</td><td>%3&nbsp;</td><td>%4</td></tr>")
                  .arg(QString::fromStdString(result.sources[s]).toHtmlEscaped())
                  .arg(point.set_delta_t_k)
                  .arg(s75_text(point.fit), ratio);
    }
  }
  return "<table cellspacing=4><tr><th>Source</th><th>S75 (mrad)</th><th>acuity ratio</th></tr>" + rows +
         "</table><p>" +
         (human.problem().isEmpty()
              ? "Saved in " + QString::fromStdString(human.folder().filename().string()).toHtmlEscaped()
              : human.problem()) +
         "</p>";
}

QString result_of_naked_eye(const NakedEyePresenter& naked_eye) {
  const NakedEyeSession& session = *naked_eye.session();
  QString rows;
  for (const NakedEyeContrast& predicted : session.prediction().contrasts) {
    const TodPoint* found = point_at(session.record().curve, predicted.contrast);
    rows += QString("<tr><td>%1&nbsp;</td><td>%2&nbsp;</td><td>%3</td></tr>")
                .arg(predicted.contrast)
                .arg(found == nullptr ? QString("–") : s75_text(found->fit))
                .arg(QString::fromStdString(
                    with_interval(predicted.s75_mrad, {predicted.spread_low_mrad, predicted.spread_high_mrad})));
  }
  return "<table cellspacing=4><tr><th>Contrast</th><th>S75 (mrad)</th><th>predicted [spread]</th></tr>" + rows +
         "</table><p>Saved in " + QString::fromStdString(naked_eye.folder().filename().string()).toHtmlEscaped() +
         "</p>";
}

QString result_of_triangles(const HumanPresenter& human, const MeasurePresenter& model) {
  QString rows;
  for (const auto& point : human.record()->curve.points) {
    const TodPoint* modelled = model.measured() ? point_at(*model.measured(), point.set_delta_t_k) : nullptr;
    rows += QString("<tr><td>%1 K&nbsp;</td><td>%2&nbsp;</td><td>%3</td></tr>")
                .arg(point.set_delta_t_k)
                .arg(s75_text(point.fit))
                .arg(modelled == nullptr ? QString("–") : s75_text(modelled->fit));
  }
  QString means;
  for (const PeopleMean& mean : human.means()) {
    if (mean.people < 2 || !mean.ci95_mrad) continue;
    means += QString("<tr><td>%1 K&nbsp;</td><td>%2</td><td>%3 people</td></tr>")
                 .arg(mean.set_delta_t_k)
                 .arg(QString::fromStdString(
                     with_interval(mean.s75_mrad, Interval{mean.ci95_mrad->first, mean.ci95_mrad->second})))
                 .arg(mean.people);
  }
  if (!means.isEmpty())
    means = "<p>Mean over people, interval between people:</p><table cellspacing=4>" + means + "</table>";
  const auto& points = human.record()->curve.points;
  const bool all_found =
      std::ranges::all_of(points, [](const TodPoint& p) { return identified_threshold(p.fit).has_value(); });
  return "<p>" + human.problem() +
         "</p><table cellspacing=4><tr><th>ΔT</th><th>S75 human (mrad)</th><th>model (mrad)</th></tr>" + rows +
         "</table>" + (all_found ? "" : "<p>Limits without a value: the answers do not determine the threshold.</p>") +
         means;
}

}  // namespace todbench
