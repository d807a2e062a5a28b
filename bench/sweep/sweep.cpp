// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/sweep/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "acquisition/base/rng.h"
#include "bench/text/files.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr std::size_t most_combinations = 10'000'000;

/// Sorts the parameters by name, so that the order in the file has no effect.
std::string canonical(std::vector<SweepParameter> parameters) {
  std::sort(parameters.begin(), parameters.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  std::string text;
  for (const auto& [key, value] : parameters) text += key + "=" + value + "\n";
  return text;
}

/// Takes 53 bits of a hash, which JSON and every plan can store.
std::uint64_t number_from(const std::string& hexadecimal) {
  return std::stoull(hexadecimal.substr(0, 13), nullptr, 16);
}

std::vector<std::vector<double>> latin_hypercube(std::size_t n, std::size_t dimensions, std::uint64_t seed) {
  std::vector<std::vector<double>> rows(n, std::vector<double>(dimensions));
  for (std::size_t d = 0; d < dimensions; ++d) {
    const RandomStream stream = RandomStream(seed, "sweep.latin-hypercube").sub(d);
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = n; i-- > 1;) std::swap(order[i], order[stream.below(i + 1, i)]);
    for (std::size_t i = 0; i < n; ++i)
      rows[i][d] = (static_cast<double>(order[i]) + stream.uniform(n + i)) / static_cast<double>(n);
  }
  return rows;
}

std::vector<std::vector<double>> sobol(std::size_t n, std::size_t dimensions, std::uint64_t seed) {
  boost::random::sobol engine(dimensions);
  const RandomStream shifts(seed, "sweep.sobol");
  std::vector<std::vector<double>> rows(n, std::vector<double>(dimensions));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t d = 0; d < dimensions; ++d) {
      // The engine omits the origin. Without it 2^m draws are not a net: one cell would be empty, another have two.
      const std::uint64_t bits = i == 0 ? 0 : engine() >> 11;
      const auto shift = static_cast<std::uint64_t>(std::ldexp(shifts.uniform(d), 53));
      rows[i][d] = std::clamp(std::ldexp(static_cast<double>(bits ^ shift), -53), 1e-16, 1 - 1e-16);
    }
  }
  return rows;
}

/// Lists the members of every draw in sequence, so that more draws are added at the end.
std::vector<std::vector<double>> total_design(std::size_t n, std::size_t dimensions, std::uint64_t seed) {
  std::vector<std::vector<double>> rows;
  rows.reserve(n * (dimensions + 2));
  for (const auto& both : sobol(n, 2 * dimensions, seed)) {
    const auto middle = both.begin() + static_cast<std::ptrdiff_t>(dimensions);
    const std::vector<double> a(both.begin(), middle), b(middle, both.end());
    rows.push_back(a);
    rows.push_back(b);
    for (std::size_t k = 0; k < dimensions; ++k) {
      rows.push_back(a);
      rows.back()[k] = b[k];
    }
  }
  return rows;
}

std::size_t product(std::size_t a, std::size_t b) {
  return b != 0 && a > most_combinations / b ? most_combinations + 1 : a * b;
}

}  // namespace

std::vector<std::vector<double>> unit_sample(SampleKind kind, std::size_t n, std::size_t dimensions,
                                             std::uint64_t seed) {
  return kind == SampleKind::sobol ? sobol(n, dimensions, seed) : latin_hypercube(n, dimensions, seed);
}

Sweep::Sweep(SweepFile file, std::string fingerprint) : file_(std::move(file)) {
  base_text_ = fmt::format("kind={}\n{}{}", static_cast<int>(file_.kind), canonical(file_.base), fingerprint);
}

void Sweep::draw() {
  if (file_.sample.empty()) return;
  sample_ = file_.sample_total
                ? total_design(file_.sample_count, file_.sample.size(), file_.sample_seed)
                : unit_sample(file_.sample_kind, file_.sample_count, file_.sample.size(), file_.sample_seed);
  for (auto& row : sample_) {
    for (std::size_t d = 0; d < row.size(); ++d) {
      const auto& [key, low, high] = file_.sample[d];
      // Ten digits: the text of a parameter identifies the task.
      row[d] = parse_number(fmt::format("{:.10g}", low + (high - low) * row[d])).value_or(low);
    }
  }
}

std::size_t Sweep::combination_count() const {
  std::size_t count = 1;
  for (const auto& axis : file_.grid) count = product(count, axis.values.size());
  if (!file_.zip.empty()) count = product(count, file_.zip.front().values.size());
  if (!file_.sample.empty()) count = product(count, product(file_.sample_count, members()));
  return count;
}

std::vector<SweepParameter> Sweep::parameters_of(std::size_t combination) const {
  // From the fastest: draws, rows of [zip], then the grid from its last key.
  std::vector<SweepParameter> sampled, zipped, grid;
  if (!sample_.empty()) {
    const auto& row = sample_[combination % sample_.size()];
    combination /= sample_.size();
    for (std::size_t d = 0; d < row.size(); ++d) sampled.push_back({file_.sample[d].key, number_text(row[d])});
  }
  if (!file_.zip.empty()) {
    const std::size_t row = combination % file_.zip.front().values.size();
    combination /= file_.zip.front().values.size();
    for (const auto& axis : file_.zip) zipped.push_back({axis.key, axis.values[row]});
  }
  for (auto axis = file_.grid.rbegin(); axis != file_.grid.rend(); ++axis) {
    grid.push_back({axis->key, axis->values[combination % axis->values.size()]});
    combination /= axis->values.size();
  }
  std::reverse(grid.begin(), grid.end());
  grid.insert(grid.end(), zipped.begin(), zipped.end());
  grid.insert(grid.end(), sampled.begin(), sampled.end());
  return grid;
}

Result<Sweep> Sweep::expand(SweepFile file, std::string fingerprint, const NumberOfName& number_of) {
  Sweep sweep(std::move(file), std::move(fingerprint));
  const std::size_t count = sweep.combination_count();
  if (product(count, sweep.file_.repeats) > most_combinations)
    return fail(ErrorCode::invalid_input, fmt::format("the sweep has more than {} tasks", most_combinations));
  sweep.draw();
  const auto keys = sweep.keys();
  for (const auto& constraint : sweep.file_.where) {
    for (const auto& name : constraint.names()) {
      const bool known = std::find(keys.begin(), keys.end(), name) != keys.end() || number_of(name).has_value();
      if (!known)
        return fail(ErrorCode::invalid_input,
                    fmt::format("condition '{}': '{}' is not a known number", constraint.text(), one_line(name)));
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    bool accepted = true;
    if (!sweep.file_.where.empty()) {
      const auto parameters = sweep.parameters_of(i);
      const auto value = [&](std::string_view name) -> std::optional<double> {
        for (const auto& parameter : parameters) {
          if (parameter.key == name) return parse_number(parameter.value);
        }
        return number_of(name);
      };
      accepted = std::all_of(sweep.file_.where.begin(), sweep.file_.where.end(),
                             [&](const Constraint& constraint) { return constraint.holds(value); });
    }
    if (accepted) sweep.combinations_.push_back(i);
  }
  sweep.refused_ = count - sweep.combinations_.size();
  if (sweep.combinations_.empty()) return fail(ErrorCode::invalid_input, "the conditions reject every combination");
  sweep.hash_ = sha256_of(fmt::format("{}seed={} paired={}\n", sweep.base_text_, sweep.file_.seed, sweep.file_.paired));
  return sweep;
}

SweepTask Sweep::task(std::size_t index) const {
  SweepTask task;
  task.index = index;
  task.repeat = index % file_.repeats;
  task.parameters = parameters_of(combinations_[index / file_.repeats]);
  const std::string what = canonical(task.parameters) + base_text_;
  task.seed = number_from(sha256_of(
      fmt::format("sweep seed {} repeat {}\n{}", file_.seed, task.repeat, file_.paired ? std::string() : what)));
  task.name = fmt::format("i{:06d}-{}", index,
                          sha256_of(fmt::format("{}seed={} repeat={}", what, task.seed, task.repeat)).substr(0, 8));
  return task;
}

std::vector<std::string> Sweep::keys() const {
  std::vector<std::string> keys;
  for (const auto& axis : file_.grid) keys.push_back(axis.key);
  for (const auto& axis : file_.zip) keys.push_back(axis.key);
  for (const auto& range : file_.sample) keys.push_back(range.key);
  return keys;
}

}  // namespace todbench
