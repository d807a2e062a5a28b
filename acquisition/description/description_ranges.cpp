// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/description/description_ranges.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace todbench {
namespace {

/// Range of a register, unsigned unless stated otherwise; all integers if it has eight bytes or more.
IntegerRange register_range(const DescriptionNode& node, bool is_signed) {
  const bool of_other_length =
      std::any_of(node.references.begin(), node.references.end(),
                  [](const NodeReference& reference) { return reference.kind == ReferenceKind::length; });
  const std::int64_t bytes = node.lengths.empty() ? 4 : whole_number(node.lengths.front());
  if (of_other_length || node.lengths.size() > 1 || bytes < 1 || bytes > 7) return {};
  const std::int64_t most = std::int64_t{1} << (8 * bytes);
  return is_signed ? IntegerRange{-most / 2, most - 1} : IntegerRange{0, most - 1};
}

FormulaMode mode_of(const DescriptionNode& node) {
  return node.kind == NodeKind::int_swiss_knife ? FormulaMode::whole : FormulaMode::real;
}

bool divides(const std::string& text) {
  return text.find_first_of("/%") != std::string::npos;
}

}  // namespace

std::int64_t whole_number(const std::string& text) {
  return std::strtoll(text.c_str(), nullptr, 0);
}

IntegerRange DescriptionRanges::range_of(const std::string& name) {
  const auto found = nodes_.by_name.find(name);
  return found == nodes_.by_name.end() ? IntegerRange{} : range_of_node(found->second);
}

IntegerRange DescriptionRanges::range_of_node(std::size_t index) {
  if (!found_[index]) found_[index] = computed(nodes_.nodes[index]);
  return *found_[index];
}

IntegerRange DescriptionRanges::computed(const DescriptionNode& node) {
  if (node.element == "IntReg" || node.element == "MaskedIntReg") return register_range(node, node.is_signed);
  if (node.kind == NodeKind::entry && node.inside) {
    return register_range(nodes_.nodes[*node.inside], node.is_signed);
  }
  if (node.kind == NodeKind::int_swiss_knife && node.formulas.size() == 1) {
    return formula_of(node, node.formulas.front()).value;
  }
  if (node.kind != NodeKind::integer && node.kind != NodeKind::enumeration) return {};
  std::optional<IntegerRange> all;
  const auto add = [&](IntegerRange more) { all = all ? hull(*all, more) : more; };
  for (const auto& text : node.values) add({whole_number(text), whole_number(text)});
  for (const auto& reference : node.references) {
    if (reference.kind == ReferenceKind::value) add(range_of(reference.target));
    // An index may select no value, which gives 0.
    if (reference.kind == ReferenceKind::part) add({0, 0});
  }
  return all.value_or(IntegerRange{0, 0});
}

IntegerRange DescriptionRanges::range_in_formula(const DescriptionNode& node, FormulaMode mode,
                                                 const std::string& name) {
  // An ambiguous name may have any of its values.
  std::optional<IntegerRange> all;
  const auto add = [&](IntegerRange more) { all = all ? hull(*all, more) : more; };
  for (const auto& constant : node.constants) {
    if (constant.name == name)
      add(range_of_formula(constant.text, mode, [](const auto&) { return IntegerRange{}; }).value);
  }
  for (const auto& expression : node.expressions) {
    // An expression does not contain other expressions.
    const auto inside = [&](const std::string& inner) {
      std::optional<IntegerRange> range;
      for (const auto& reference : node.references) {
        if (reference.name == inner)
          range = range ? hull(*range, range_of(reference.target)) : range_of(reference.target);
      }
      return range.value_or(IntegerRange{});
    };
    if (expression.name == name) add(range_of_formula(expression.text, mode, inside).value);
  }
  for (const auto& reference : node.references) {
    if (reference.name == name) add(range_of(reference.target));
  }
  return all.value_or(IntegerRange{});
}

FormulaRange DescriptionRanges::formula_of(const DescriptionNode& node, const std::string& formula) {
  const FormulaMode mode = mode_of(node);
  return range_of_formula(formula, mode, [&](const std::string& name) { return range_in_formula(node, mode, name); });
}

bool DescriptionRanges::may_trap(const DescriptionNode& node) {
  std::vector<std::string> formulas = node.formulas;
  for (const auto& expression : node.expressions) formulas.push_back(expression.text);
  // The evaluator treats the first sign of a constant as its whole text, and then a minus as an operator of the
  // formula.
  const bool all_numerals = std::all_of(node.constants.begin(), node.constants.end(), [](const NamedText& constant) {
    const auto first = constant.text.find_first_not_of(" \t\r\n");
    return first != std::string::npos && std::isdigit(static_cast<unsigned char>(constant.text[first])) != 0;
  });
  return std::any_of(formulas.begin(), formulas.end(), [&](const std::string& formula) {
    return formula_of(node, formula).may_trap || (!all_numerals && divides(formula));
  });
}

}  // namespace todbench
