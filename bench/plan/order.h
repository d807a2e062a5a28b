// SPDX-License-Identifier: GPL-3.0-or-later
// Order of a calibration or test: the entries of a report that ISO/IEC 17025:2017, 7.8.2 requires in addition to the
// results.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/base/number_range.h"
#include "acquisition/base/result.h"

namespace todbench {

/// Section [order]. Empty texts and values: not stated. Dates are "YYYY-MM-DD".
struct OrderPlan {
  std::string customer{}, customer_address{};
  std::string report_number{};  ///< number of the report, unique in the laboratory
  std::string laboratory{}, laboratory_address{};
  std::string country{};                 ///< country of the laboratory, two letters (ISO 3166-1)
  std::string item{}, item_condition{};  ///< item under test, and its state when it was received
  std::string received{}, issued{};      ///< dates of receipt of the item and of issue of the report
  std::string method{}, method_reference{};
  std::optional<double> room_temperature_c{}, humidity_percent{}, camera_temperature_c{};
  std::string deviations{};  ///< deviations from the method
  std::string authorised_by{}, authorised_role{};
  bool operator==(const OrderPlan&) const = default;
};

/// Form of a text of the order.
enum class OrderForm {
  free,
  date,     ///< "YYYY-MM-DD"
  country,  ///< two capital letters
};
/// Key of [order] with a text: name in the file, title in reports, meaning.
struct OrderText {
  std::string_view name, title, sentence;
  std::string OrderPlan::*member;
  OrderForm form = OrderForm::free;
};
/// Key of [order] with a number.
struct OrderNumber {
  std::string_view name, unit, title, sentence;
  NumberRange range;
  std::optional<double> OrderPlan::*member;
};
/// Returns the keys with texts, in the order of reports.
[[nodiscard]] std::span<const OrderText> order_text_keys();
/// Returns the keys with numbers, in the order of reports.
[[nodiscard]] std::span<const OrderNumber> order_number_keys();
/// Returns the mistake of a text; empty if the text is empty or has this form.
[[nodiscard]] std::optional<std::string> order_mistake(OrderForm form, std::string_view text);

/// Statement on every report with an order (ISO/IEC 17025:2017, 7.8.2.1 note 2).
inline constexpr std::string_view not_in_part =
    "This report shall not be reproduced except in full without the approval of the laboratory.";

/// Returns the stated entries as name and text, for reports.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> order_lines(const OrderPlan& order);

/// Reads a file with one section [order]. Errors: `invalid_input` with file and line.
[[nodiscard]] Result<OrderPlan> load_order(const std::filesystem::path& file);

}  // namespace todbench
