// SPDX-License-Identifier: GPL-3.0-or-later
// JSON and records from files. write_json_file() of json_fields.h writes them.
#pragma once

#include <filesystem>

#include "acquisition/base/try.h"
#include "bench/text/json_fields.h"

namespace todbench {

/// Parses a file. Errors: those of read_text_file(); `invalid_input` with the file (not valid JSON).
[[nodiscard]] Result<Json> read_json_file(const std::filesystem::path& file);

/// Parses the record of a file. Errors: those of read_json_file() and of from_json(), with the file in front.
template <typename Record, typename Describe>
[[nodiscard]] Result<Record> read_record_file(const std::filesystem::path& file, const Describe& describe) {
  TODBENCH_TRY(const Json json, read_json_file(file));
  auto record = from_json<Record>(json, describe);
  if (!record) return fail(file.string(), record.error());
  return record;
}

}  // namespace todbench
