// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/range_figure.h"

#include <algorithm>
#include <array>

#include "acquisition/base/try.h"
#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"
#include "bench/report/svg.h"
#include "bench/text/spread_text.h"

namespace todbench {
namespace {

struct ModelStyle {
  std::string_view name;
  PlotTone tone;
  PlotMarker marker;
  PlotLine line;
};
constexpr std::array styles{
    ModelStyle{"tod", PlotTone::first, PlotMarker::disc, PlotLine::solid},
    ModelStyle{"acquire", PlotTone::second, PlotMarker::square, PlotLine::dashed},
    ModelStyle{"ttp", PlotTone::third, PlotMarker::bar, PlotLine::dotted},
    ModelStyle{"mtdp", PlotTone::muted, PlotMarker::square, PlotLine::solid},
};

const ModelStyle& style_of(const ModelRange& model) {
  const auto found = std::find_if(styles.begin(), styles.end(), [&](const auto& s) { return s.name == model.name; });
  return found == styles.end() ? styles.front() : *found;
}

/// Returns the limit with its numbers.
RichText limit_text(const ModelRange& model) {
  const auto limit = model.dominant();
  if (!limit) return missing("no range");
  return plain(std::string(to_string(*limit)) + " (d ln R / d ln size " + significant(model.sensitivity->to_size, 2) +
               ", / d ln contrast " + significant(model.sensitivity->to_contrast, 2) + ")");
}

Table range_table(std::span<const ModelRange> models) {
  Table table;
  table.caption = "Ranges by model. The models differ by tens of percent: do not average them";
  table.header = {"Model", "Criterion", "Form of P", "R50 (m)", "R75 (m), 95 %", "Dominant limit", "Input"};
  for (const auto& model : models) {
    table.rows.push_back(
        {plain(model.title), plain(model.criterion + " = " + stated(model.criterion_value)),
         plain(model.probability_form), model.r50_m ? plain(significant(*model.r50_m, 4)) : missing("not reached"),
         interval_or_missing(model.r75_m, model.r75_ci95_m, model.reason), limit_text(model), plain(model.reads)});
  }
  return table;
}

}  // namespace

Plot range_plot(std::span<const ModelRange> models) {
  Plot plot;
  plot.id = "range-models";
  plot.title = "Probability of the task against range";
  plot.description = "Probability of a correct answer over range, one line for each model. Marks: ranges for 75 %.";
  double farthest = 0;
  for (const auto& model : models) {
    if (model.curve.empty() && !model.r75_m) continue;
    const ModelStyle& style = style_of(model);
    PlotSeries line{.label = "", .tone = style.tone, .marker = PlotMarker::none, .line = style.line, .points = {}};
    for (const auto& point : model.curve) {
      line.points.push_back({.x = point.range_m, .y = point.probability, .x_interval = {}, .y_interval = {}});
      if (point.probability) farthest = std::max(farthest, point.range_m);
    }
    PlotSeries mark{.label = model.title,
                    .tone = style.tone,
                    .marker = style.marker,
                    .line = PlotLine::none,
                    .legend_line = style.line,
                    .points = {}};
    if (model.r75_m)
      mark.points.push_back({.x = model.r75_m, .y = 0.75, .x_interval = model.r75_ci95_m, .y_interval = {}});
    plot.series.push_back(std::move(line));
    plot.series.push_back(std::move(mark));
  }
  plot.references.push_back({.y = 0.75, .label = "75 %"});
  plot.x = {
      .label = "Range (m)", .scale = AxisScale::linear, .low = 0, .high = farthest > 0 ? farthest : 1, .ticks = {}};
  plot.y = {.label = "Probability of a correct answer", .scale = AxisScale::linear, .low = 0, .high = 1, .ticks = {}};
  return plot;
}

Result<std::string> range_svg(std::span<const ModelRange> models) {
  if (std::all_of(models.begin(), models.end(), [](const auto& model) { return model.curve.empty(); }))
    return fail(ErrorCode::not_identifiable, "no model gives a range, so there is no curve to draw");
  TODBENCH_TRY(const auto drawing, drawn(range_plot(models)));
  return svg_document(std::array{drawing});
}

Document range_page(std::span<const ModelRange> models, const RangePage& page) {
  Document document;
  document.title = "Ranges";
  document.heading = "Ranges by model";
  document.subtitle = page.target;
  document.page_label = "Ranges, " + page.target;
  Section section{"One target in one atmosphere", {}};
  section.blocks.emplace_back(Paragraph{plain("Atmosphere: " + page.air + ".")});
  section.blocks.emplace_back(Figure{drawn(range_plot(models)),
                                     "Probability of a correct answer against range by each model with its own "
                                     "criterion. Marks: range for 75 % with its 95 % interval, if known."});
  section.blocks.emplace_back(range_table(models));
  for (const auto& model : models) {
    if (model.r75_spread_m)
      section.blocks.emplace_back(
          Paragraph{plain(model.title + ", R75: " + spread_in_words(*model.r75_spread_m, "m") + ".")});
  }
  std::vector<std::string> notes = page.notes;
  for (const auto& model : models) {
    notes.push_back(model.title + ", " + model.criterion + ": " + model.criterion_origin);
    notes.push_back(model.title + ", contrast on the display: " + model.display);
  }
  for (const auto& model : models) {
    for (const auto& sentence : model.notes) notes.push_back(model.title + ": " + sentence);
  }
  if (!notes.empty()) section.blocks.emplace_back(list_of(notes));
  document.sections.push_back(std::move(section));
  return document;
}

}  // namespace todbench
