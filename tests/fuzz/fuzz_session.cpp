// SPDX-License-Identifier: GPL-3.0-or-later
// Any text as the JSON files of a session: provenance, fits, comparison, measures, verdict.
#include <nlohmann/json.hpp>

#include "bench/judgement/verdict_record.h"
#include "bench/session/fit_record.h"
#include "bench/session/measures_record.h"
#include "bench/session/provenance.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  const Json json = Json::parse(fuzz::text_of(data, size), nullptr, false);
  if (json.is_discarded()) return 0;
  if (const auto provenance = provenance_from(json)) (void)provenance_json(*provenance);
  if (const auto curve = curve_from(json)) (void)curve_record(*curve);
  if (const auto comparison = comparison_from(json)) (void)comparison_record(*comparison);
  (void)measures_from(json);
  if (const auto verdict = verdict_from(json)) (void)verdict_json(*verdict);
  return 0;
}
