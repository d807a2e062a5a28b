// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/sweep/sweep_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/report/number_format.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

/// Returns an axis that contains all values with a margin.
PlotAxis axis_for(const std::string& label, const std::vector<double>& values, double room) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  double width = *high - *low;
  if (!(width > 0)) width = std::max(std::abs(*low) * 0.1, 1e-9);
  return {.label = label, .low = *low - room * width, .high = *high + room * width, .ticks = {}};
}

std::string response_label(const ResponseEffects& effects) {
  return effects.response == "acuity_per_mrad" ? "Acuity 1/S75 (1/mrad)" : effects.response;
}

struct Swing {
  std::string key, at_low, at_high;
  double low = 0, high = 0;
};

std::vector<Swing> swings_of(const ResponseEffects& effects) {
  std::vector<Swing> swings;
  for (const auto& parameter : effects.parameters) {
    const auto& levels = parameter.ends.empty() ? parameter.levels : parameter.ends;
    if (levels.size() < 2) continue;
    const auto [low, high] =
        std::minmax_element(levels.begin(), levels.end(), [](const auto& a, const auto& b) { return a.mean < b.mean; });
    swings.push_back({parameter.key, low->value, high->value, low->mean, high->mean});
  }
  std::stable_sort(swings.begin(), swings.end(),
                   [](const Swing& a, const Swing& b) { return a.high - a.low > b.high - b.low; });
  return swings;
}

/// Values at the ends of a bar, short enough for a label next to it.
std::string end_text(const std::string& value) {
  const auto number = parse_number(value);
  return number ? significant(*number, 3) : value.substr(0, 14);
}

void draw_tornado_axis(Drawing& drawing, const PlotAxis& axis, const std::function<double(double)>& x, double bottom) {
  for (const Tick& tick : axis_ticks(axis, 8)) {
    if (tick.label.empty()) continue;
    drawing.inside.push_back({Segment{{x(tick.value), drawing.frame.y}, {x(tick.value), bottom}}, Pen::grid});
    drawing.marks.push_back({Segment{{x(tick.value), bottom}, {x(tick.value), bottom + 6}}, Pen::axis});
    drawing.labels.push_back({{x(tick.value), bottom + 20}, tick.label, LabelRole::x_tick});
  }
  drawing.labels.push_back({{drawing.frame.x + drawing.frame.width / 2, bottom + 40}, axis.label, LabelRole::x_axis});
}

std::optional<std::size_t> place_of(const std::vector<std::string>& columns, const std::string& name) {
  const auto found = std::find(columns.begin(), columns.end(), name);
  if (found == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns.begin());
}

std::optional<double> number_of(const Json& cell) {
  if (cell.is_number()) return cell.get<double>();
  return cell.is_string() ? parse_number(cell.get<std::string>()) : std::nullopt;
}

/// Sorts parameters by their share, the largest first.
std::vector<std::string> by_share(const std::vector<std::string>& names, const ResponseEffects& effects) {
  std::vector<std::pair<double, std::string>> keys;
  for (const auto& name : names) {
    for (const auto& parameter : effects.parameters) {
      if (parameter.key == name) keys.emplace_back(-parameter.first_order.value_or(0), name);
    }
  }
  std::stable_sort(keys.begin(), keys.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> sorted;
  for (const auto& [share, key] : keys) sorted.push_back(key);
  return sorted;
}

/// Keys of [grid] with two numbers or more.
std::vector<std::string> grid_keys(const Sweep& sweep, const ResponseEffects& effects) {
  std::vector<std::string> names;
  for (const auto& axis : sweep.file().grid) {
    const bool numbers = std::all_of(axis.values.begin(), axis.values.end(),
                                     [](const auto& value) { return parse_number(value).has_value(); });
    if (numbers && axis.values.size() > 1) names.push_back(axis.key);
  }
  return by_share(names, effects);
}

/// A draw in the plane of two parameters, each from 0 to 1 over its range.
struct PlacedResponse {
  double x = 0, y = 0, response = 0;
};

std::vector<PlacedResponse> placed_responses(const Sweep& sweep, const SweepTable& table,
                                             const ResponseEffects& effects, const SweepRange& of_x,
                                             const SweepRange& of_y) {
  const auto x = place_of(table.columns, of_x.key), y = place_of(table.columns, of_y.key),
             response = place_of(table.columns, effects.response), contrast = place_of(table.columns, "delta_t_k"),
             index = place_of(table.columns, "index");
  // Repeats of a draw are merged; with total = true A and B are independent, the other members repeat their places.
  std::map<std::size_t, std::pair<PlacedResponse, double>> draws;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const auto& row = table.rows[i];
    if (!x || !y || !response || !row[*response].is_number()) continue;
    if (contrast && row[*contrast].is_number() && row[*contrast].get<double>() != effects.delta_t_k) continue;
    const std::size_t combination = index ? row[*index].get<std::size_t>() / sweep.file().repeats : i;
    if (combination % sweep.members() > 1) continue;
    const auto at_x = number_of(row[*x]), at_y = number_of(row[*y]);
    if (!at_x || !at_y) continue;
    auto& [draw, repeats] = draws[combination];
    draw.x = (*at_x - of_x.low) / (of_x.high - of_x.low), draw.y = (*at_y - of_y.low) / (of_y.high - of_y.low);
    draw.response += row[*response].get<double>();
    repeats += 1;
  }
  std::vector<PlacedResponse> placed;
  for (const auto& [combination, found] : draws)
    placed.push_back({found.first.x, found.first.y, found.first.response / found.second});
  return placed;
}

/// Means over side x side squares; empty if they are too uncertain.
std::optional<ResponseGrid> square_means(const std::vector<PlacedResponse>& placed, std::size_t side,
                                         const SweepRange& of_x, const SweepRange& of_y) {
  constexpr std::size_t least_draws = 8;
  constexpr double least_range = 8;  // standard errors; 64 means of pure noise span 4.7 of them
  std::vector<std::vector<std::vector<double>>> cells(side, std::vector<std::vector<double>>(side));
  const double squares = static_cast<double>(side);
  const auto cell_of = [&](double u) {
    return static_cast<std::size_t>(std::clamp(std::floor(u * squares), 0.0, squares - 1));
  };
  for (const auto& [x, y, response] : placed) cells[cell_of(x)][cell_of(y)].push_back(response);
  ResponseGrid grid{.x_key = of_x.key, .y_key = of_y.key, .x = {}, .y = {}, .mean = {}, .least = placed.size()};
  grid.points = placed.size();
  double low = 0, high = 0, largest_error = 0;
  for (std::size_t i = 0; i < side; ++i) {
    const double middle = (static_cast<double>(i) + 0.5) / squares;
    grid.x.push_back(of_x.low + middle * (of_x.high - of_x.low));
    grid.y.push_back(of_y.low + middle * (of_y.high - of_y.low));
    grid.mean.emplace_back();
    for (const auto& cell : cells[i]) {
      if (cell.size() < least_draws) return std::nullopt;
      double sum = 0, scatter = 0;
      const double n = static_cast<double>(cell.size());
      for (const double response : cell) sum += response;
      for (const double response : cell) scatter += std::pow(response - sum / n, 2);
      largest_error = std::max(largest_error, std::sqrt(scatter / (n - 1) / n));
      grid.least = std::min(grid.least, cell.size());
      const bool first = grid.mean.size() == 1 && grid.mean.back().empty();
      low = first ? sum / n : std::min(low, sum / n), high = first ? sum / n : std::max(high, sum / n);
      grid.mean.back().push_back(sum / n);
    }
  }
  if (!(high - low > least_range * largest_error)) return std::nullopt;
  return grid;
}

Result<ResponseGrid> drawn_grid(const Sweep& sweep, const SweepTable& table, const ResponseEffects& effects) {
  std::vector<std::string> names;
  for (const auto& range : sweep.file().sample) names.push_back(range.key);
  names = by_share(names, effects);
  const auto range_of = [&](const std::string& key) {
    return *std::find_if(sweep.file().sample.begin(), sweep.file().sample.end(),
                         [&](const SweepRange& range) { return range.key == key; });
  };
  const SweepRange x = range_of(names[0]), y = range_of(names[1]);
  const auto placed = placed_responses(sweep, table, effects, x, y);
  for (std::size_t side = 8; side >= 3; --side) {
    if (auto grid = square_means(placed, side, x, y)) return *std::move(grid);
  }
  return fail(ErrorCode::not_identifiable,
              std::to_string(placed.size()) + " draws are not enough for contours over " + x.key + " and " + y.key);
}

/// Position of the height between two corners.
Place crossing(Place a, double at_a, Place b, double at_b, double height) {
  const double t = (height - at_a) / (at_b - at_a);
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

/// Adds the segments of one cell; the corners are in cyclic order.
void add_cell(std::vector<ContourStretch>& stretches, const std::array<Place, 4>& corner,
              const std::array<double, 4>& value, double height) {
  std::vector<Place> crossings;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t next = (i + 1) % 4;
    if ((value[i] < height) != (value[next] < height))
      crossings.push_back(crossing(corner[i], value[i], corner[next], value[next], height));
  }
  if (crossings.size() == 2) stretches.push_back({crossings[0], crossings[1]});
  if (crossings.size() != 4) return;
  // Saddle: the centre belongs to the corners on its side, so the lines cut off the others.
  const bool middle_low = (value[0] + value[1] + value[2] + value[3]) / 4 < height;
  const bool first_alone = (value[0] < height) != middle_low;
  if (first_alone) {
    stretches.push_back({crossings[3], crossings[0]});
    stretches.push_back({crossings[1], crossings[2]});
  } else {
    stretches.push_back({crossings[0], crossings[1]});
    stretches.push_back({crossings[2], crossings[3]});
  }
}

}  // namespace

Result<Drawing> tornado(const ResponseEffects& effects, const std::string& id) {
  const auto swings = swings_of(effects);
  if (swings.empty()) return fail(ErrorCode::not_identifiable, "no parameter has at least two values");
  std::vector<double> ends;
  for (const auto& swing : swings) ends.insert(ends.end(), {swing.low, swing.high});
  const PlotAxis axis = axis_for(response_label(effects), ends, 0.18);
  TODBENCH_TRY_VOID(validate(axis));
  constexpr double width = 860, left = 190, right = 845, top = 14, row = 30;
  const double bottom = top + row * static_cast<double>(swings.size()) + 8;
  const auto x = [&](double value) { return left + (value - axis.low) / (axis.high - axis.low) * (right - left); };
  Drawing drawing{.id = id,
                  .title = "Range of the mean response by parameter",
                  .description = "One bar per parameter, longest first: " + swings.front().key + ".",
                  .width = width,
                  .height = bottom + 52,
                  .frame = {left, top, right - left, bottom - top},
                  .inside = {},
                  .marks = {},
                  .labels = {}};
  draw_tornado_axis(drawing, axis, x, bottom);
  for (std::size_t i = 0; i < swings.size(); ++i) {
    const Swing& swing = swings[i];
    const double y = top + 8 + row * static_cast<double>(i);
    drawing.marks.push_back({Box{x(swing.low), y, x(swing.high) - x(swing.low), row - 10}, Pen::marker});
    drawing.labels.push_back({{left - 9, y + 14}, swing.key.substr(0, 26), LabelRole::y_tick});
    drawing.labels.push_back({{x(swing.low) - 6, y + 14}, end_text(swing.at_low), LabelRole::y_tick});
    drawing.labels.push_back({{x(swing.high) + 6, y + 14}, end_text(swing.at_high), LabelRole::legend});
  }
  return drawing;
}

Result<Drawing> response_curve(const ResponseEffects& effects, const ParameterEffect& parameter,
                               const std::string& id) {
  PlotSeries series;
  series.line = PlotLine::solid;
  std::vector<double> x, y;
  for (const auto& level : parameter.levels) {
    const auto number = parse_number(level.value);
    if (!number) return fail(ErrorCode::invalid_input, "the values of " + parameter.key + " are not numbers");
    series.points.push_back({*number, level.mean, {}, level.ci95});
    x.push_back(*number);
    y.push_back(level.mean);
    if (level.ci95.low && level.ci95.high) y.insert(y.end(), {*level.ci95.low, *level.ci95.high});
  }
  if (x.size() < 2) return fail(ErrorCode::not_identifiable, parameter.key + " has only one value");
  std::sort(series.points.begin(), series.points.end(), [](const auto& a, const auto& b) { return *a.x < *b.x; });
  Plot plot{.id = id,
            .title = "Mean response against " + parameter.key,
            .description = "Mean over all other parameters at each value.",
            .width = 430,
            .height = 300,
            .x = axis_for(parameter.key, x, 0.06),
            .y = axis_for(response_label(effects), y, 0.1),
            .bands = {},
            .references = {},
            .series = {std::move(series)}};
  return drawn(plot);
}

Result<ResponseGrid> response_grid(const Sweep& sweep, const SweepTable& table, const ResponseEffects& effects) {
  const auto keys = grid_keys(sweep, effects);
  if (keys.size() < 2 && sweep.file().sample.size() > 1) return drawn_grid(sweep, table, effects);
  if (keys.size() < 2)
    return fail(ErrorCode::not_identifiable,
                "contours need two parameters of [grid] with at least two numbers each, or two parameters of [sample]");
  ResponseGrid grid{.x_key = keys[0], .y_key = keys[1], .x = {}, .y = {}, .mean = {}};
  const auto x = place_of(table.columns, grid.x_key), y = place_of(table.columns, grid.y_key),
             response = place_of(table.columns, effects.response), contrast = place_of(table.columns, "delta_t_k");
  std::map<std::pair<double, double>, std::pair<double, double>> cells;
  std::set<double> xs, ys;
  for (const auto& row : table.rows) {
    if (!x || !y || !response || !row[*response].is_number()) continue;
    if (contrast && row[*contrast].is_number() && row[*contrast].get<double>() != effects.delta_t_k) continue;
    const auto at_x = number_of(row[*x]), at_y = number_of(row[*y]);
    if (!at_x || !at_y) continue;
    auto& [sum, count] = cells[{*at_x, *at_y}];
    sum += row[*response].get<double>();
    count += 1;
    xs.insert(*at_x);
    ys.insert(*at_y);
  }
  grid.x.assign(xs.begin(), xs.end());
  grid.y.assign(ys.begin(), ys.end());
  if (xs.size() < 2 || ys.size() < 2 || cells.size() != xs.size() * ys.size())
    return fail(ErrorCode::not_identifiable, "the grid of " + grid.x_key + " and " + grid.y_key + " has gaps");
  for (const double at_x : grid.x) {
    grid.mean.emplace_back();
    for (const double at_y : grid.y) {
      const auto& [sum, count] = cells.at({at_x, at_y});
      grid.mean.back().push_back(sum / count);
    }
  }
  return grid;
}

std::vector<ContourStretch> contour(const ResponseGrid& grid, double height) {
  std::vector<ContourStretch> stretches;
  for (std::size_t i = 0; i + 1 < grid.x.size(); ++i) {
    for (std::size_t j = 0; j + 1 < grid.y.size(); ++j) {
      add_cell(stretches,
               {Place{grid.x[i], grid.y[j]}, Place{grid.x[i + 1], grid.y[j]}, Place{grid.x[i + 1], grid.y[j + 1]},
                Place{grid.x[i], grid.y[j + 1]}},
               {grid.mean[i][j], grid.mean[i + 1][j], grid.mean[i + 1][j + 1], grid.mean[i][j + 1]}, height);
    }
  }
  return stretches;
}

Result<Drawing> contour_plot(const ResponseGrid& grid, const ResponseEffects& effects, const std::string& id) {
  double low = grid.mean[0][0], high = low;
  for (const auto& column : grid.mean) {
    low = std::min(low, *std::min_element(column.begin(), column.end()));
    high = std::max(high, *std::max_element(column.begin(), column.end()));
  }
  if (!(high > low)) return fail(ErrorCode::not_identifiable, "the response is the same everywhere");
  Plot plot{.id = id,
            .title = "Contours of the response over " + grid.x_key + " and " + grid.y_key,
            .description = grid.points > 0
                               ? "Lines of equal mean response. Each square marks the centre of the averaged draws."
                               : "Lines of equal mean response. Each square marks a computed combination.",
            .x = axis_for(grid.x_key, grid.x, 0.04),
            .y = axis_for(grid.y_key, grid.y, 0.06),
            .bands = {},
            .references = {},
            .series = {}};
  const std::array tones{PlotTone::first, PlotTone::second, PlotTone::third};
  const std::array lines{PlotLine::solid, PlotLine::dashed, PlotLine::dotted};
  std::size_t number = 0;
  for (const Tick& tick : axis_ticks({.label = "", .low = low, .high = high, .ticks = {}}, 8)) {
    if (tick.label.empty()) continue;
    PlotSeries series{.label = tick.label,
                      .tone = tones[number % 3],
                      .marker = PlotMarker::none,
                      .line = lines[number / 3 % 3],
                      .points = {}};
    for (const auto& [from, to] : contour(grid, tick.value)) {
      series.points.push_back({from.x, from.y, {}, {}});
      series.points.push_back({to.x, to.y, {}, {}});
      series.points.push_back({});
    }
    if (series.points.empty()) continue;
    ++number;
    plot.series.push_back(std::move(series));
  }
  PlotSeries computed{
      .label = response_label(effects) + (grid.points > 0 ? " on the lines; mean" : " on the lines; computed"),
      .tone = PlotTone::muted,
      .marker = PlotMarker::square,
      .points = {}};
  for (const double x : grid.x) {
    for (const double y : grid.y) computed.points.push_back({x, y, {}, {}});
  }
  plot.series.push_back(std::move(computed));
  return drawn(plot);
}

}  // namespace todbench
