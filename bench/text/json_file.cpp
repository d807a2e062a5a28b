// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/json_file.h"

#include <string>

#include "bench/text/text.h"

namespace todbench {

Result<Json> read_json_file(const std::filesystem::path& file) {
  TODBENCH_TRY(const std::string text, read_text_file(file));
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return fail(ErrorCode::invalid_input, file.string() + ": not valid JSON");
  return json;
}

}  // namespace todbench
