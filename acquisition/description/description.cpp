// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/description/description.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <unordered_set>
#include <utility>

#include "acquisition/description/description_ranges.h"

namespace todbench {
namespace {

/// The requested part of a node.
enum class Aspect : std::size_t { value, bounds };

using Place = std::pair<std::size_t, Aspect>;  ///< node and aspect

/// Finds the dependencies of a node and their cost.
class Walk {
 public:
  explicit Walk(const DescriptionNodes& nodes) : nodes_(nodes), done_(2 * nodes.nodes.size()) {}

  /// Returns a cycle, a chain that is too long or a value that is too expensive, starting from this place.
  [[nodiscard]] std::optional<DescriptionFault> fault_from(Place start);

 private:
  struct Known {
    enum class State { unseen, open, known } state = State::unseen;
    std::size_t depth = 0;
    std::uint64_t evaluations = 1;
  };
  struct Step {
    Place place;
    std::vector<Place> next;
    std::size_t at = 0;
  };

  [[nodiscard]] Known& known(Place place) { return done_[2 * place.first + static_cast<std::size_t>(place.second)]; }
  [[nodiscard]] std::vector<Place> asked_by(Place place) const;
  [[nodiscard]] DescriptionFault cycle(Place again) const;
  [[nodiscard]] std::string name_of(std::size_t node) const {
    const auto& n = nodes_.nodes[node];
    return n.name.empty() ? n.element : printable_name(n.name);
  }

  const DescriptionNodes& nodes_;
  std::vector<Known> done_;
  std::vector<Step> path_;
};

std::vector<Place> Walk::asked_by(Place place) const {
  const DescriptionNode& node = nodes_.nodes[place.first];
  std::vector<Place> next;
  for (const auto& reference : node.references) {
    const auto target = nodes_.by_name.find(reference.target);
    if (target == nodes_.by_name.end()) continue;
    const bool is_bound = reference.kind == ReferenceKind::bound;
    if (place.second == Aspect::value) {
      if (!is_bound && reference.kind != ReferenceKind::condition) next.emplace_back(target->second, Aspect::value);
    } else {
      // Bounds that are not stated are those of the value's node; formulas of bounds need the variables too.
      if (reference.kind == ReferenceKind::value) next.emplace_back(target->second, Aspect::bounds);
      if (is_bound || reference.kind == ReferenceKind::part || reference.kind == ReferenceKind::length) {
        next.emplace_back(target->second, Aspect::value);
      }
    }
  }
  for (const std::size_t part : node.parts) next.emplace_back(part, Aspect::value);
  if (node.inside) next.emplace_back(*node.inside, place.second);
  return next;
}

DescriptionFault Walk::cycle(Place again) const {
  const auto begin = std::find_if(path_.begin(), path_.end(), [&](const Step& step) { return step.place == again; });
  std::string sentence = "its value has a circular reference";
  if (path_.end() - begin > 1) {
    sentence += " through ";
    // The message names only the first nodes of the cycle.
    for (auto step = begin + 1; step != path_.end() && step - begin <= 4; ++step) {
      sentence += (step - begin > 1 ? ", " : "") + name_of(step->place.first);
    }
    if (path_.end() - begin > 5) sentence += ", ...";
  }
  return {DescriptionFaultKind::cycle, name_of(again.first), sentence};
}

std::optional<DescriptionFault> Walk::fault_from(Place start) {
  if (known(start).state != Known::State::unseen) return std::nullopt;
  known(start).state = Known::State::open;
  path_.push_back({start, asked_by(start)});
  while (!path_.empty()) {
    Step& step = path_.back();
    if (step.at < step.next.size()) {
      const Place next = step.next[step.at];
      Known& there = known(next);
      if (there.state == Known::State::open) return cycle(next);
      if (there.state == Known::State::unseen) {
        there.state = Known::State::open;
        path_.push_back({next, asked_by(next)});
        continue;
      }
      Known& here = known(step.place);
      here.depth = std::max(here.depth, there.depth + 1);
      here.evaluations = std::min(here.evaluations + there.evaluations, most_evaluations + 1);
      ++step.at;
      continue;
    }
    const Known& here = known(step.place);
    if (here.depth > longest_reference_chain) {
      return DescriptionFault{DescriptionFaultKind::too_deep, name_of(step.place.first),
                              "its chain of references is longer than " + std::to_string(longest_reference_chain)};
    }
    if (here.evaluations > most_evaluations) {
      return DescriptionFault{DescriptionFaultKind::too_expensive, name_of(step.place.first),
                              "its value needs more than " + std::to_string(most_evaluations) + " evaluations"};
    }
    known(step.place).state = Known::State::known;
    path_.pop_back();
  }
  return std::nullopt;
}

std::optional<DescriptionFault> length_fault(const DescriptionNode& node) {
  for (const auto& text : node.lengths) {
    const auto bytes = whole_number(text);
    if (bytes >= 1 && bytes <= longest_register_bytes) continue;
    return DescriptionFault{
        DescriptionFaultKind::register_length, node.name.empty() ? node.element : printable_name(node.name),
        "its length is " + std::to_string(bytes) + " bytes, expected 1 ... " + std::to_string(longest_register_bytes)};
  }
  return std::nullopt;
}

/// Upper limit of a formula's length after its expressions are inserted.
std::size_t full_length(const DescriptionNode& node, const std::string& formula) {
  std::size_t longest = 0;
  for (const auto& expression : node.expressions) longest = std::max(longest, expression.text.size());
  if (longest == 0) return formula.size();
  // A name has at least one letter and one character before the next.
  return formula.size() + longest * (formula.size() / 2 + 1);
}

std::optional<DescriptionFault> formula_length_fault(const DescriptionNode& node) {
  for (const auto& formula : node.formulas) {
    const bool expands = full_length(node, formula) > std::size_t{64} * longest_formula;
    if (formula.size() <= longest_formula && !expands) continue;
    return DescriptionFault{DescriptionFaultKind::formula, printable_name(node.name), "its formula is too long"};
  }
  return std::nullopt;
}

/// All nodes on which a feature depends, its bounds and conditions included; each after its own dependencies.
std::vector<std::size_t> needed_for(const DescriptionNodes& nodes, const std::string& feature) {
  std::vector<std::size_t> found;
  const auto first = nodes.by_name.find(feature);
  if (first == nodes.by_name.end()) return found;
  std::unordered_set<std::size_t> seen{first->second};
  std::vector<std::pair<std::size_t, bool>> open{{first->second, false}};
  while (!open.empty()) {
    const auto [node, visited] = open.back();
    open.pop_back();
    if (visited) {
      found.push_back(node);
      continue;
    }
    open.emplace_back(node, true);
    const auto add = [&](std::size_t next) {
      if (seen.insert(next).second) open.emplace_back(next, false);
    };
    for (const auto& reference : nodes.nodes[node].references) {
      const auto target = nodes.by_name.find(reference.target);
      if (target != nodes.by_name.end()) add(target->second);
    }
    for (const std::size_t part : nodes.nodes[node].parts) add(part);
    if (nodes.nodes[node].inside) add(*nodes.nodes[node].inside);
  }
  return found;
}

}  // namespace

Description::Description(std::string_view xml) {
  auto parsed = parse_description(xml);
  if (!parsed) {
    faults_.push_back(parsed.error());
    return;
  }
  nodes_ = std::move(*parsed);
  Walk walk(nodes_);
  for (std::size_t i = 0; i < nodes_.nodes.size(); ++i) {
    if (auto fault = length_fault(nodes_.nodes[i])) faults_.push_back(std::move(*fault));
    if (auto fault = formula_length_fault(nodes_.nodes[i])) faults_.push_back(std::move(*fault));
    for (const Aspect aspect : {Aspect::value, Aspect::bounds}) {
      auto fault = walk.fault_from({i, aspect});
      if (!fault) continue;
      faults_.push_back(std::move(*fault));
      return;  // the following checks need values without cycles
    }
  }
  if (!faults_.empty()) return;
  DescriptionRanges ranges(nodes_);
  for (const auto& node : nodes_.nodes) {
    trapping_.push_back(ranges.may_trap(node));
    for (const auto& reference : node.references) {
      if (reference.kind != ReferenceKind::length) continue;
      const IntegerRange bytes = ranges.range_of(reference.target);
      if (bytes.low < 1 || bytes.high > longest_register_bytes) unbounded_lengths_.push_back(reference.target);
    }
  }
  std::sort(unbounded_lengths_.begin(), unbounded_lengths_.end());
}

std::vector<DescriptionFault> Description::faults_of(const std::string& feature) const {
  std::vector<DescriptionFault> found;
  for (const std::size_t index : needed_for(nodes_, feature)) {
    const DescriptionNode& node = nodes_.nodes[index];
    if (index < trapping_.size() && trapping_[index]) {
      found.push_back({DescriptionFaultKind::division, printable_name(node.name),
                       "its formula can divide the smallest integer by -1, which would crash the program"});
    }
    for (const auto& reference : node.references) {
      if (nodes_.by_name.contains(reference.target)) continue;
      found.push_back({DescriptionFaultKind::dangling, printable_name(node.name),
                       "it refers to " + printable_name(reference.target) + ", which does not exist"});
    }
  }
  return found;
}

std::vector<std::string> Description::lengths_of(const std::string& feature) const {
  std::vector<std::string> found;
  if (unbounded_lengths_.empty()) return found;
  for (const std::size_t index : needed_for(nodes_, feature)) {
    for (const auto& reference : nodes_.nodes[index].references) {
      if (reference.kind == ReferenceKind::length &&
          std::binary_search(unbounded_lengths_.begin(), unbounded_lengths_.end(), reference.target)) {
        found.push_back(reference.target);
      }
    }
  }
  return found;
}

}  // namespace todbench
