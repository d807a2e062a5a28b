// SPDX-License-Identifier: GPL-3.0-or-later
// Plan keys of the order behind a test: those of the file `--order`.
#include "bench/plan/plan_sections.h"

#include <deque>
#include <string>

#include "bench/plan/key_places.h"
#include "bench/plan/order.h"

namespace todbench {
namespace {

/// Name of the widget; lives as long as the program.
std::string_view widget_of(std::string_view key) {
  static std::deque<std::string> names;
  return names.emplace_back("planOrder_" + std::string(key));
}

}  // namespace

PlanSection order_section() {
  PlanSection section{.name = "order",
                      .sentence =
                          "The order behind a test, for page 1 of the report and for `todbench certificate`: "
                          "entries that ISO/IEC 17025:2017, 7.8.2 requires. A file `--order` replaces it.",
                      .keys = {}};
  for (const OrderText& text : order_text_keys()) {
    section.keys.push_back({.name = text.name,
                            .type = TextKey{},
                            .sentence = text.sentence,
                            .place = in(&Plan::order, text.member),
                            .form = {text.title, widget_of(text.name)},
                            .check = [&text](const Plan& plan, std::size_t) -> std::vector<ValueMistake> {
                              auto mistake = order_mistake(text.form, plan.order.*text.member);
                              if (!mistake) return {};
                              return {{std::nullopt, *std::move(mistake)}};
                            },
                            .written_at_default = false});
  }
  for (const OrderNumber& number : order_number_keys()) {
    section.keys.push_back({.name = number.name,
                            .type = OptionalNumberKey{number.range},
                            .unit = number.unit,
                            .sentence = number.sentence,
                            .place = in(&Plan::order, number.member),
                            .form = {number.title, widget_of(number.name)},
                            .written_at_default = false});
  }
  return section;
}

}  // namespace todbench
