// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/order.h"

#include <algorithm>
#include <array>

#include "acquisition/base/try.h"
#include "bench/plan/bench_checks.h"
#include "bench/plan/strict_toml.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr NumberRange celsius = NumberRange::between(-100, 200);  // not 295, which is in kelvin

constexpr std::array order_texts{
    OrderText{"report_number", "Report number", "Number of the report or certificate, unique in the laboratory",
              &OrderPlan::report_number},
    OrderText{"customer", "Customer", "Name of the customer", &OrderPlan::customer},
    OrderText{"customer_address", "Address of the customer", "Address of the customer", &OrderPlan::customer_address},
    OrderText{"laboratory", "Laboratory", "Name of the laboratory", &OrderPlan::laboratory},
    OrderText{"laboratory_address", "Address of the laboratory", "Address of the laboratory",
              &OrderPlan::laboratory_address},
    OrderText{"country", "Country of the laboratory", "Country of the laboratory, two capital letters (ISO 3166-1)",
              &OrderPlan::country, OrderForm::country},
    OrderText{"item", "Item", "Item under test", &OrderPlan::item},
    OrderText{"item_condition", "Condition of the item", "Condition of the item when it was received",
              &OrderPlan::item_condition},
    OrderText{"received", "Received", "Date of receipt of the item, YYYY-MM-DD", &OrderPlan::received, OrderForm::date},
    OrderText{"issued", "Issued", "Date of issue of the report, YYYY-MM-DD", &OrderPlan::issued, OrderForm::date},
    OrderText{"method", "Method", "Method of the test", &OrderPlan::method},
    OrderText{"method_reference", "Reference of the method", "Document that defines the method",
              &OrderPlan::method_reference},
    OrderText{"deviations", "Deviations from the method", "Deviations from the method", &OrderPlan::deviations},
    OrderText{"authorised_by", "Authorised by", "Person who authorises the report", &OrderPlan::authorised_by},
    OrderText{"authorised_role", "Function of that person", "Function of that person", &OrderPlan::authorised_role}};

constexpr std::array order_numbers{
    OrderNumber{"room_temperature_c", "°C", "Room temperature", "Temperature of the room", celsius,
                &OrderPlan::room_temperature_c},
    OrderNumber{"humidity_percent", "%", "Relative humidity", "Relative humidity of the room",
                NumberRange::between(0, 100), &OrderPlan::humidity_percent},
    OrderNumber{"camera_temperature_c", "°C", "Camera temperature", "Temperature of the camera", celsius,
                &OrderPlan::camera_temperature_c}};

}  // namespace

std::span<const OrderText> order_text_keys() {
  return order_texts;
}

std::span<const OrderNumber> order_number_keys() {
  return order_numbers;
}

std::optional<std::string> order_mistake(OrderForm form, std::string_view text) {
  if (text.empty() || form == OrderForm::free) return std::nullopt;
  if (form == OrderForm::date) {
    if (parse_date(text)) return std::nullopt;
    return "expected a date \"YYYY-MM-DD\", found \"" + one_line(text) + "\"";
  }
  const bool letters = std::all_of(text.begin(), text.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
  if (text.size() == 2 && letters) return std::nullopt;
  return "expected two capital letters such as \"DE\", found \"" + one_line(text) + "\"";
}

std::vector<std::pair<std::string, std::string>> order_lines(const OrderPlan& order) {
  std::vector<std::pair<std::string, std::string>> lines;
  for (const OrderText& key : order_texts) {
    if (!(order.*key.member).empty()) lines.emplace_back(key.title, order.*key.member);
  }
  for (const OrderNumber& key : order_numbers) {
    if (const auto& value = order.*key.member)
      lines.emplace_back(key.title, number_text(*value) + " " + std::string(key.unit));
  }
  return lines;
}

Result<OrderPlan> load_order(const std::filesystem::path& file) {
  TODBENCH_TRY(const std::string text, read_text_file(file));
  TODBENCH_TRY(TomlReader root, TomlReader::parse(text, file.string()));
  TomlReader table = root.section("order");
  OrderPlan order;
  for (const OrderText& key : order_texts) {
    order.*key.member = table.text(key.name, "");
    if (const auto mistake = order_mistake(key.form, order.*key.member)) table.reject(key.name, *mistake);
  }
  for (const OrderNumber& key : order_numbers) order.*key.member = table.optional_number(key.name, key.range);
  TODBENCH_TRY_VOID(root.finish());
  return order;
}

}  // namespace todbench
