// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/selftest_record.h"

#include <fmt/format.h>

#include <cstdlib>

#include "acquisition/base/try.h"
#include "bench/plan/plan.h"
#include "bench/session/provenance.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/json_fields.h"
#include "bench/text/text.h"

namespace todbench {

void selftest_fields(JsonFields& json, SelftestRecord& record) {
  json.value("utc", record.utc);
  json.value("passed", record.passed);
  json.value("failed", record.failed);
  json.value("cases_sha256", record.cases_sha256);
  json.value("program_version", record.program_version);
  json.value("git_commit", record.git_commit);
  json.value("compiler", record.compiler);
  json.value("host", record.host);
}

std::filesystem::path selftest_file() {
  const char* const state = std::getenv("XDG_STATE_HOME");
  const char* const home = std::getenv("HOME");
  const std::filesystem::path folder = state != nullptr && *state != 0
                                           ? std::filesystem::path(state)
                                           : std::filesystem::path(home != nullptr ? home : ".") / ".local" / "state";
  return folder / "todbench" / "selftest.json";
}

Result<void> keep_selftest(const std::filesystem::path& file, SelftestRecord record) {
  const Provenance now = begin_provenance(Plan{}, Side::measured);
  record.utc = now.started_utc;
  record.program_version = now.program_version;
  record.git_commit = now.git_commit;
  record.compiler = now.compiler;
  record.host = now.host;
  TODBENCH_TRY_VOID(make_folder(file.parent_path()));
  return write_json_file(file, json_of(record, selftest_fields));
}

std::optional<SelftestRecord> kept_selftest(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return std::nullopt;
  const auto record = from_json<SelftestRecord>(Json::parse(*text, nullptr, false), selftest_fields);
  const Provenance now = begin_provenance(Plan{}, Side::measured);
  const bool same = record && record->program_version == now.program_version && record->git_commit == now.git_commit &&
                    record->compiler == now.compiler && record->host == now.host;
  return same ? std::optional(*record) : std::nullopt;
}

std::string in_words(const SelftestRecord& record) {
  return fmt::format("{} of {} cases on {}; SHA-256 {}", record.passed, record.passed + record.failed, record.utc,
                     record.cases_sha256);
}

}  // namespace todbench
