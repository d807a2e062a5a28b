// SPDX-License-Identifier: GPL-3.0-or-later
// Section of a person's answers to the camera's frames, compared with the model.
#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"
#include "bench/report/tod_figures.h"

namespace todbench {
namespace {

RichText threshold_cell(const PsychometricFit& fit) {
  return interval_or_missing(fit.threshold, fit.ci95, "not identified");
}

/// Returns the curve of the model observer for the same frames: of the camera, or of a simulated one.
const std::optional<TodCurve>& model_curve(const ReportData& data) {
  return data.measured ? data.measured : data.simulated;
}

}  // namespace

std::vector<Plot> human_plots(const ReportData& data) {
  std::vector<Plot> plots;
  if (!data.human) return plots;
  const auto& model = model_curve(data);
  for (const TodPoint& point : data.human->points) {
    plots.push_back(psychometric_figure("human-" + std::to_string(plots.size() + 1), {"human", &point},
                                        {"model", model ? point_at(*model, point.set_delta_t_k) : nullptr},
                                        data.fit.form));
  }
  return plots;
}

std::optional<Section> human_section(const ReportData& data) {
  if (!data.human) return {};
  const auto& model = model_curve(data);
  Table rows;
  rows.caption = "Person and model observer on the same frames; brackets: 95 % interval";
  rows.header = {"Set ΔT (K)", "Human S₇₅ (mrad)", "Human slope", "Human trials", "Human fit", "Model S₇₅ (mrad)"};
  for (const TodPoint& point : data.human->points) {
    const TodPoint* judged = model ? point_at(*model, point.set_delta_t_k) : nullptr;
    rows.rows.push_back({plain(stated(point.set_delta_t_k)), threshold_cell(point.fit),
                         point.fit.slope ? plain(significant(*point.fit.slope, 3)) : missing("not identified"),
                         plain(shown(point.fit.trials, 0)), plain(in_words(point.fit.verdict)),
                         judged == nullptr ? missing("not measured") : threshold_cell(judged->fit)});
  }
  FigurePairs figures;
  const std::vector<Plot> plots = human_plots(data);
  for (std::size_t i = 0; i < plots.size(); ++i)
    figures.figures.push_back(
        {drawn(plots[i]), "Set contrast ΔT = " + stated(data.human->points[i].set_delta_t_k) + " K"});
  return Section{"Human observer",
                 {std::move(rows), std::move(figures),
                  note(plain("Task: four alternatives, no feedback, patches in random order. The answers of the model "
                             "were not shown."))}};
}

}  // namespace todbench
