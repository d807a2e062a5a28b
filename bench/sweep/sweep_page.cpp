// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/sweep/sweep_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "bench/report/number_format.h"
#include "bench/sweep/sweep_figures.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

RichText share(std::optional<double> value, const Interval& interval, std::string_view reason) {
  if (!value) return missing(reason);
  std::string text = shown(*value, 3);
  if (interval.low && interval.high) text += " [" + shown(*interval.low, 3) + ", " + shown(*interval.high, 3) + "]";
  return unbroken(text);
}

Table index_table(const ResponseEffects& effects, bool drawn) {
  const std::string over =
      effects.draws > 0 ? fmt::format("{} complete draws", effects.draws) : std::string("the repeats");
  Table table{.caption = "Shares of the variance of " + effects.response + ", with 95 % intervals over " + over,
              .header = {"Parameter", "First order", "Total"},
              .rows = {}};
  for (const auto& effect : effects.parameters) {
    table.rows.push_back({plain(effect.key), share(effect.first_order, effect.first_order_ci95, "no variance"),
                          share(effect.total, effect.total_ci95,
                                drawn && effects.draws == 0 ? "needs a sample with total = true" : "no variance")});
  }
  return table;
}

Table level_table(const ResponseEffects& effects) {
  Table table{.caption = "Mean of " + effects.response + " at each value, over all other parameters",
              .header = {"Parameter", "Value", "Mean, 95 % interval over the repeats", "Rows"},
              .rows = {}};
  for (const auto& effect : effects.parameters) {
    for (const auto& level : effect.levels) {
      const auto number = parse_number(level.value);
      table.rows.push_back({plain(effect.key), plain(number ? stated(*number) : level.value),
                            unbroken(with_interval(level.mean, level.ci95)), plain(std::to_string(level.rows))});
    }
  }
  return table;
}

Section response_section(const Sweep& sweep, const SweepTable& table, const ResponseEffects& effects,
                         std::size_t number) {
  const std::string id = fmt::format("contrast-{}", number);
  const bool drawn_sample = !sweep.file().sample.empty();
  // Sets have their own contrasts, which are a column of the table.
  Section section{sweep.file().kind == TaskKind::identify
                      ? effects.response
                      : fmt::format("{} at {} K", effects.response, stated(effects.delta_t_k)),
                  {}};
  section.blocks.emplace_back(index_table(effects, drawn_sample));
  section.blocks.emplace_back(
      Figure{tornado(effects, id + "-tornado"),
             drawn_sample ? "Main effects: the response at both ends of each range, from a linear fit to all rows"
                          : "Main effects: lowest and highest mean response, with the values of the parameter"});
  FigurePairs curves;
  for (std::size_t i = 0; i < effects.parameters.size(); ++i) {
    const auto& effect = effects.parameters[i];
    if (auto curve = response_curve(effects, effect, fmt::format("{}-curve-{}", id, i)))
      curves.figures.push_back({std::move(curve), "Mean response against " + effect.key});
  }
  if (!curves.figures.empty()) section.blocks.emplace_back(std::move(curves));
  const auto grid = response_grid(sweep, table, effects);
  section.blocks.emplace_back(Figure{
      grid ? contour_plot(*grid, effects, id + "-contours") : Result<Drawing>(tl::unexpected(grid.error())),
      grid && grid->points > 0
          ? fmt::format(
                "Contours over the two drawn parameters with the largest shares: {} draws in {} x {} squares of "
                "at least {} draws, bilinear interpolation between their means",
                grid->points, grid->x.size(), grid->y.size(), grid->least)
          : "Contours over the two parameters with the largest shares: means over all other parameters, bilinear "
            "interpolation between the combinations"});
  section.blocks.emplace_back(level_table(effects));
  return section;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// How the numbers of a sweep are computed.
std::string computation(TaskKind kind) {
  switch (kind) {
    case TaskKind::simulate:
      return "simulated trials and a fit";
    case TaskKind::estimate:
      return "direct estimate without trials";
    case TaskKind::identify:
      return "an observer identifies the targets of a set; every effect that is not neutral in the sensor is simulated";
  }
  return "";
}

Section identity_section(const Sweep& sweep, const SweepTable& table) {
  ValueTable values{.caption = "Origin of the numbers", .values = {}};
  values.values = {{"Program", plain("todbench " + table.version + " (" + table.commit + ")")},
                   {"Computation", plain(computation(sweep.file().kind))},
                   {"Sweep (SHA-256)", plain(sweep.hash())},
                   {"Tasks with a result", plain(fmt::format("{} of {}", table.tasks - table.missing, table.tasks))},
                   {"Combinations rejected by a condition", plain(std::to_string(sweep.refused()))},
                   {"Parameters", plain(joined(sweep.keys()))},
                   {"Random numbers",
                    plain(sweep.file().paired ? "the same for all tasks of a repeat" : "different for every task")}};
  return {"Record", {std::move(values)}};
}

}  // namespace

Document sweep_page(const Sweep& sweep, const SweepTable& table, const std::vector<ResponseEffects>& effects) {
  Document document{.title = "Sweep " + sweep.file().name,
                    .heading = "Sweep " + sweep.file().name,
                    .subtitle = fmt::format("{} rows of {} tasks", table.rows.size(), table.tasks - table.missing),
                    .page_label = sweep.file().name,
                    .opening = {},
                    .sections = {}};
  if (table.missing > 0)
    document.opening.emplace_back(Paragraph{
        strong(fmt::format("{} tasks have no result. Means and shares are computed from the others.", table.missing))});
  if (effects.empty()) document.opening.emplace_back(Paragraph{plain("The table has no numbers for this response.")});
  for (std::size_t i = 0; i < effects.size(); ++i)
    document.sections.push_back(response_section(sweep, table, effects[i], i));
  document.sections.push_back(identity_section(sweep, table));
  return document;
}

}  // namespace todbench
