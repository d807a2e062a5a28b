// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/round_robin/sealed_truth.h"

#include <algorithm>
#include <cmath>

#include "acquisition/base/try.h"
#include "bench/text/json_file.h"
#include "bench/text/json_reader.h"
#include "bench/text/text.h"

namespace todbench {

Result<std::vector<SealedValue>> read_sealed(const std::filesystem::path& file) {
  TODBENCH_TRY(const Json json, read_json_file(file));
  const JsonReader reader(json);
  reader.at("schema").expect(sealed_schema);
  std::vector<SealedValue> out;
  for (const JsonReader& item : reader.at("items").elements())
    out.push_back(
        {item.at("item").text(), item.at("quantity").text(), item.at("value").number(), item.at("u").number()});
  if (auto read = reader.finish(); !read)
    return fail(ErrorCode::invalid_input, file.string() + ": " + read.error().message);
  for (const SealedValue& value : out) {
    if (!(std::abs(value.value) <= 1e30) || !(value.u >= 0 && value.u <= 1e30))
      return fail(ErrorCode::invalid_input, file.string() + ": item '" + one_line(value.item) +
                                                "': expected a finite value and an uncertainty of at least 0");
  }
  return out;
}

Result<std::vector<TruthCheck>> checked_against(const RoundRobin& found, const std::vector<SealedValue>& sealed) {
  std::vector<TruthCheck> out;
  for (const ItemComparison& item : found.items) {
    const auto truth = std::ranges::find_if(
        sealed, [&](const auto& s) { return s.item == item.item.item && s.quantity == item.item.quantity; });
    if (truth == sealed.end()) {
      return fail(ErrorCode::invalid_input, "the sealed file has no item '" + item.item.item + "' with the quantity '" +
                                                item.item.quantity + "'");
    }
    TruthCheck check{.truth = *truth};
    check.difference = item.reference.value.value - truth->value;
    check.e_n = check.difference / std::hypot(item.reference.expanded_u, 2 * truth->u);
    check.held = std::abs(check.e_n) <= 1;
    out.push_back(std::move(check));
  }
  return out;
}

}  // namespace todbench
