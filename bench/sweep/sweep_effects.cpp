// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/sweep/sweep_effects.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "acquisition/base/distributions.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

/// One row of the table with a response.
struct Observation {
  std::vector<std::string> values;  ///< by parameter
  std::size_t repeat = 0;
  double response = 0;
  std::size_t index = 0;  ///< of the task
};
using Observations = std::vector<Observation>;

std::optional<std::size_t> column_of(const SweepTable& table, const std::string& name) {
  const auto found = std::find(table.columns.begin(), table.columns.end(), name);
  if (found == table.columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - table.columns.begin());
}

std::string text_of(const Json& cell) {
  if (cell.is_string()) return cell.get<std::string>();
  return cell.is_number() ? number_text(cell.get<double>()) : "";
}

/// Observations by contrast.
std::map<double, Observations> observations_of(const std::vector<std::string>& keys, const SweepTable& table,
                                               std::size_t response) {
  std::vector<std::size_t> columns;
  for (const auto& key : keys) columns.push_back(column_of(table, key).value_or(0));
  const auto repeat = column_of(table, "repeat"), contrast = column_of(table, "delta_t_k"),
             index = column_of(table, "index");
  std::map<double, Observations> by_contrast;
  for (const auto& row : table.rows) {
    if (!row[response].is_number()) continue;
    Observation observation;
    for (const std::size_t column : columns) observation.values.push_back(text_of(row[column]));
    observation.repeat = repeat ? row[*repeat].get<std::size_t>() : 0;
    observation.response = row[response].get<double>();
    observation.index = index ? row[*index].get<std::size_t>() : 0;
    const double at = contrast && row[*contrast].is_number() ? row[*contrast].get<double>() : 0;
    by_contrast[at].push_back(std::move(observation));
  }
  return by_contrast;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Student's interval of the mean; open with fewer than two values.
Interval interval_of(const std::vector<double>& values) {
  if (values.size() < 2) return {};
  const double m = mean(values), n = static_cast<double>(values.size());
  double squares = 0;
  for (const double value : values) squares += (value - m) * (value - m);
  const double t = distribution::quantile(distribution::StudentsT(n - 1), 0.975);
  const double half = t * std::sqrt(squares / (n - 1) / n);
  return {m - half, m + half};
}

/// Variance of the group means, weighted by their rows, over the total variance.
template <typename Group>
std::optional<double> explained(const Observations& rows, const Group& group_of) {
  std::map<std::string, std::pair<double, double>> sums;
  double all = 0;
  for (const auto& row : rows) {
    auto& [sum, count] = sums[group_of(row)];
    sum += row.response;
    count += 1;
    all += row.response;
  }
  const double n = static_cast<double>(rows.size()), m = all / n;
  double total = 0, between = 0;
  for (const auto& row : rows) total += (row.response - m) * (row.response - m);
  for (const auto& [group, entry] : sums) between += entry.second * std::pow(entry.first / entry.second - m, 2);
  if (!(total > 0)) return std::nullopt;
  return between / total;
}

std::string others(const Observation& row, std::size_t without) {
  std::string text;
  for (std::size_t i = 0; i < row.values.size(); ++i) {
    if (i != without) text += row.values[i] + '\n';
  }
  return text;
}

/// Values of a drawn parameter in classes of equal count.
std::map<std::string, std::string> classes_of(const Observations& rows, std::size_t parameter) {
  std::set<std::pair<double, std::string>> sorted;
  for (const auto& row : rows) sorted.emplace(parse_number(row.values[parameter]).value_or(0), row.values[parameter]);
  const double classes = std::max(2.0, std::floor(std::sqrt(static_cast<double>(sorted.size()) / 2)));
  std::map<std::string, std::string> names;
  std::size_t place = 0;
  for (const auto& [number, text] : sorted)
    names[text] =
        std::to_string(static_cast<int>(static_cast<double>(place++) * classes / static_cast<double>(sorted.size())));
  return names;
}

/// Variance between repeats of the same parameters, without the effect common to all tasks of a repeat (its random
/// numbers, if tasks are paired); 0 without repeats.
double variance_of_repeats(const std::map<std::size_t, Observations>& by_repeat) {
  std::map<std::string, std::vector<double>> same;
  for (const auto& [repeat, rows] : by_repeat) {
    double sum = 0;
    for (const auto& row : rows) sum += row.response;
    for (const auto& row : rows)
      same[others(row, row.values.size())].push_back(row.response - sum / static_cast<double>(rows.size()));
  }
  double squares = 0, freedom = 1 - static_cast<double>(by_repeat.size());
  for (const auto& [values, responses] : same) {
    const double m = mean(responses);
    for (const double response : responses) squares += (response - m) * (response - m);
    freedom += static_cast<double>(responses.size()) - 1;
  }
  return freedom > 0 ? squares / freedom : 0;
}

/// Correlation ratio minus the share that this number of classes explains by chance. For independent draws that is 1 -
/// (1 - eta^2) (n - 1) / (n - classes). In a Sobol sequence all classes have the same other parameters, so that only
/// the scatter of repeats contributes by chance.
std::optional<double> sampled_first_order(const Observations& rows, std::size_t parameter, SampleKind kind,
                                          double repeat_variance) {
  const auto classes = classes_of(rows, parameter);
  std::set<std::string> used;
  for (const auto& [value, name] : classes) used.insert(name);
  const double n = static_cast<double>(rows.size()), count = static_cast<double>(used.size());
  const auto ratio = explained(rows, [&](const Observation& row) { return classes.at(row.values[parameter]); });
  if (!ratio || n <= count) return std::nullopt;
  if (kind != SampleKind::sobol) return 1 - (1 - *ratio) * (n - 1) / (n - count);
  std::vector<double> responses;
  for (const auto& row : rows) responses.push_back(row.response);
  const double m = mean(responses);
  double total = 0;
  for (const double response : responses) total += (response - m) * (response - m);
  return *ratio - repeat_variance * (count - 1) / total;
}

void add_indices(ParameterEffect& effect, const std::map<std::size_t, Observations>& by_repeat, std::size_t parameter,
                 const std::optional<SampleKind>& drawn) {
  std::vector<double> first, total;
  const double repeat_variance = variance_of_repeats(by_repeat);
  for (const auto& [repeat, rows] : by_repeat) {
    const auto s = drawn ? sampled_first_order(rows, parameter, *drawn, repeat_variance)
                         : explained(rows, [&](const Observation& row) { return row.values[parameter]; });
    if (s) first.push_back(*s);
    if (drawn) continue;
    if (const auto rest = explained(rows, [&](const Observation& row) { return others(row, parameter); }))
      total.push_back(std::max(0.0, 1 - *rest));
  }
  if (!first.empty()) effect.first_order = mean(first);
  if (!total.empty()) effect.total = mean(total);
  effect.first_order_ci95 = interval_of(first);
  effect.total_ci95 = interval_of(total);
}

/// Responses of the members of one draw in one repeat.
using Draw = std::vector<double>;

/// The complete draws of a repeat.
std::map<std::size_t, Draw> draws_of(const Observations& rows, const Sweep& sweep) {
  std::map<std::size_t, std::map<std::size_t, double>> found;
  for (const auto& row : rows) {
    const std::size_t combination = row.index / sweep.file().repeats;
    found[combination / sweep.members()][combination % sweep.members()] = row.response;
  }
  std::map<std::size_t, Draw> draws;
  for (const auto& [number, members] : found) {
    if (members.size() != sweep.members()) continue;
    for (const auto& [member, response] : members) draws[number].push_back(response);
  }
  return draws;
}

/// A ratio of means over draws, with Student's interval from its linearisation. Differences are summed in eight to
/// fifteen blocks of 2^m successive draws (single draws below sixteen): each block is a net and scatters less than
/// independent draws. Blocks of one net complete each other, so the interval is conservative.
struct RatioOfMeans {
  double value = 0;
  Interval ci95;
};
RatioOfMeans ratio_of_means(const std::vector<double>& above, const std::vector<double>& below) {
  const std::size_t n = above.size();
  std::size_t size = 1;
  while (16 * size <= n) size *= 2;
  const std::size_t blocks = n / size;
  const double value = mean(above) / mean(below);
  std::vector<double> sums(blocks);
  for (std::size_t i = 0; i < n; ++i) sums[std::min(i / size, blocks - 1)] += above[i] - value * below[i];
  double squares = 0;
  for (const double sum : sums) squares += sum * sum;
  const auto g = static_cast<double>(blocks);
  const double t = quantile(distribution::StudentsT(g - 1), 0.975);
  const double half = t * std::sqrt(squares * g / (g - 1)) / static_cast<double>(n) / mean(below);
  return {value, {value - half, value + half}};
}

/// First-order index S = <f(B) (f(AB_k) - f(A))> / V (Saltelli et al. 2010, table 2 b), total index
/// T = <(f(A) - f(AB_k))^2> / 2 V (Jansen 1999; ibid. f), V = <(f(A) - m)^2 + (f(B) - m)^2> / 2. The variance of
/// repeats is subtracted from T if every task has its own random numbers. Each draw counts once, with the means over
/// its repeats. Returns the number of draws.
std::size_t add_total_indices(std::vector<ParameterEffect>& effects,
                              const std::map<std::size_t, Observations>& by_repeat, const Sweep& sweep) {
  // Common random numbers cancel in a difference.
  const double noise = sweep.file().paired ? 0 : variance_of_repeats(by_repeat);
  const std::size_t parameters = effects.size();
  std::map<std::size_t, std::vector<std::pair<double, Draw>>> by_draw;  // with the mean of the repeat
  for (const auto& [repeat, rows] : by_repeat) {
    const auto draws = draws_of(rows, sweep);
    double sum = 0;
    for (const auto& [number, draw] : draws) sum += draw[0] + draw[1];
    for (const auto& [number, draw] : draws)
      by_draw[number].emplace_back(sum / (2 * static_cast<double>(draws.size())), draw);
  }
  if (by_draw.size() < 3) return by_draw.size();
  std::vector<double> variance;
  std::vector<std::vector<double>> first(parameters), total(parameters);
  for (const auto& [number, repeats] : by_draw) {
    const double count = static_cast<double>(repeats.size());
    double v = 0;
    std::vector<double> s(parameters), t(parameters);
    for (const auto& [m, draw] : repeats) {
      v += (std::pow(draw[0] - m, 2) + std::pow(draw[1] - m, 2)) / 2 / count;
      for (std::size_t k = 0; k < parameters; ++k) {
        s[k] += (draw[1] - m) * (draw[k + 2] - draw[0]) / count;
        t[k] += (std::pow(draw[0] - draw[k + 2], 2) / 2 - noise) / count;
      }
    }
    variance.push_back(v);
    for (std::size_t k = 0; k < parameters; ++k) first[k].push_back(s[k]), total[k].push_back(t[k]);
  }
  if (!(mean(variance) > 0)) return by_draw.size();
  for (std::size_t k = 0; k < parameters; ++k) {
    const auto s = ratio_of_means(first[k], variance), t = ratio_of_means(total[k], variance);
    effects[k].first_order = s.value, effects[k].first_order_ci95 = s.ci95;
    effects[k].total = t.value, effects[k].total_ci95 = t.ci95;
  }
  return by_draw.size();
}

/// Means at each value, with intervals over the repeats.
std::vector<EffectLevel> levels_of(const Observations& rows, std::size_t parameter) {
  std::vector<std::string> order;
  std::map<std::string, std::map<std::size_t, std::vector<double>>> by_value;
  for (const auto& row : rows) {
    const std::string& value = row.values[parameter];
    if (!by_value.contains(value)) order.push_back(value);
    by_value[value][row.repeat].push_back(row.response);
  }
  std::vector<EffectLevel> levels;
  for (const auto& value : order) {
    std::vector<double> all, of_repeats;
    for (const auto& [repeat, responses] : by_value[value]) {
      all.insert(all.end(), responses.begin(), responses.end());
      of_repeats.push_back(mean(responses));
    }
    levels.push_back({value, mean(all), interval_of(of_repeats), all.size()});
  }
  return levels;
}

/// Means over classes of equal count of a drawn parameter, each at the mean of its values.
std::vector<EffectLevel> class_levels(const Observations& rows, std::size_t parameter) {
  const auto classes = classes_of(rows, parameter);
  std::map<double, std::map<std::size_t, std::vector<double>>> responses;
  std::map<double, std::vector<double>> values;
  for (const auto& row : rows) {
    const double name = parse_number(classes.at(row.values[parameter])).value_or(0);
    responses[name][row.repeat].push_back(row.response);
    values[name].push_back(parse_number(row.values[parameter]).value_or(0));
  }
  std::vector<EffectLevel> levels;
  for (const auto& [name, by_repeat] : responses) {
    std::vector<double> all, of_repeats;
    for (const auto& [repeat, some] : by_repeat) {
      all.insert(all.end(), some.begin(), some.end());
      of_repeats.push_back(mean(some));
    }
    levels.push_back({number_text(mean(values[name])), mean(all), interval_of(of_repeats), all.size()});
  }
  return levels;
}

/// Least-squares plane of the response over drawn parameters, each scaled to -1 to 1: the mean, then half of the change
/// from end to end of each. Empty with fewer rows than unknowns.
std::optional<std::vector<double>> plane_of(const Observations& rows, const std::vector<SweepRange>& ranges,
                                            std::size_t first_parameter) {
  const auto unknowns = static_cast<Eigen::Index>(ranges.size() + 1), n = static_cast<Eigen::Index>(rows.size());
  if (n <= unknowns) return std::nullopt;
  Eigen::MatrixXd design(n, unknowns);
  Eigen::VectorXd response(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Observation& row = rows[static_cast<std::size_t>(i)];
    design(i, 0) = 1;
    response(i) = row.response;
    for (std::size_t j = 0; j < ranges.size(); ++j) {
      const double value = parse_number(row.values[first_parameter + j]).value_or(0);
      const double middle = (ranges[j].low + ranges[j].high) / 2, half = (ranges[j].high - ranges[j].low) / 2;
      design(i, static_cast<Eigen::Index>(j) + 1) = (value - middle) / half;
    }
  }
  const Eigen::VectorXd found = design.colPivHouseholderQr().solve(response);
  return std::vector<double>(found.data(), found.data() + found.size());
}

/// The ends of a drawn parameter on the planes of all repeats.
std::vector<EffectLevel> ends_of(const std::map<std::size_t, Observations>& by_repeat,
                                 const std::vector<SweepRange>& ranges, std::size_t first_parameter,
                                 std::size_t drawn) {
  std::vector<double> low, high;
  std::size_t count = 0;
  for (const auto& [repeat, rows] : by_repeat) {
    const auto plane = plane_of(rows, ranges, first_parameter);
    if (!plane) return {};
    low.push_back((*plane)[0] - (*plane)[drawn + 1]);
    high.push_back((*plane)[0] + (*plane)[drawn + 1]);
    count += rows.size();
  }
  return {{number_text(ranges[drawn].low), mean(low), interval_of(low), count},
          {number_text(ranges[drawn].high), mean(high), interval_of(high), count}};
}

Json levels_json(const std::vector<EffectLevel>& levels) {
  Json json = Json::array();
  for (const auto& level : levels)
    json.push_back({{"value", level.value},
                    {"mean", json_number(level.mean)},
                    {"ci95", json_interval(level.ci95)},
                    {"rows", level.rows}});
  return json;
}

}  // namespace

std::vector<ResponseEffects> sweep_effects(const Sweep& sweep, const SweepTable& table, const std::string& response) {
  const auto column = column_of(table, response);
  if (!column) return {};
  const auto keys = sweep.keys();
  const std::size_t fixed = sweep.file().grid.size() + sweep.file().zip.size();
  std::vector<ResponseEffects> effects;
  for (const auto& [contrast, rows] : observations_of(keys, table, *column)) {
    std::map<std::size_t, Observations> by_repeat;
    for (const auto& row : rows) by_repeat[row.repeat].push_back(row);
    ResponseEffects found{response, contrast, {}};
    for (std::size_t i = 0; i < keys.size(); ++i) {
      ParameterEffect effect{.key = keys[i]};
      effect.levels = i < fixed ? levels_of(rows, i) : class_levels(rows, i);
      // With a grid, the plane would have to include the grid.
      if (i >= fixed && fixed == 0) effect.ends = ends_of(by_repeat, sweep.file().sample, fixed, i - fixed);
      if (!sweep.file().sample_total)
        add_indices(effect, by_repeat, i,
                    sweep.file().sample.empty() ? std::nullopt : std::optional(sweep.file().sample_kind));
      found.parameters.push_back(std::move(effect));
    }
    if (sweep.file().sample_total) found.draws = add_total_indices(found.parameters, by_repeat, sweep);
    effects.push_back(std::move(found));
  }
  return effects;
}

Json to_json(const std::vector<ResponseEffects>& effects) {
  Json list = Json::array();
  for (const auto& response : effects) {
    Json parameters = Json::array();
    for (const auto& effect : response.parameters) {
      parameters.push_back({{"key", effect.key},
                            {"first_order", json_number(effect.first_order)},
                            {"first_order_ci95", json_interval(effect.first_order_ci95)},
                            {"total", json_number(effect.total)},
                            {"total_ci95", json_interval(effect.total_ci95)},
                            {"levels", levels_json(effect.levels)},
                            {"ends", levels_json(effect.ends)}});
    }
    list.push_back({{"response", response.response},
                    {"delta_t_k", response.delta_t_k},
                    {"draws", response.draws > 0 ? Json(response.draws) : Json()},
                    {"parameters", parameters}});
  }
  return list;
}

}  // namespace todbench
