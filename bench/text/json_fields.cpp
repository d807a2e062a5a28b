// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/json_fields.h"

#include <cmath>

#include "bench/text/files.h"

namespace todbench {

void JsonFields::number_or(const std::string& key, double& value, double otherwise) {
  if (reader_)
    value = reader_->at(key).optional_number().value_or(otherwise);
  else
    put(key, json_number(value));
}

void JsonFields::text_or_null(const std::string& key, std::string& value) {
  if (!reader_) return put(key, value.empty() ? Json(nullptr) : Json(value));
  const JsonReader text = reader_->at(key);
  value = text.is_null() ? std::string() : text.text();
}

void JsonFields::constant(const std::string& key, std::string_view text) {
  if (reader_)
    reader_->at(key).expect(text);
  else
    put(key, text);
}

Json JsonFields::finite(const std::string& path, double value) {
  if (!std::isfinite(value) && mistake_->empty())
    *mistake_ = "'" + path + "': expected a finite number, found " + std::to_string(value);
  return json_number(value);
}

Result<void> write_json_file(const std::filesystem::path& file, const Result<Json>& record) {
  if (!record) return fail(file.string(), record.error());
  return write_file_atomically(file, to_page(*record));
}

}  // namespace todbench
