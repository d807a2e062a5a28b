// SPDX-License-Identifier: GPL-3.0-or-later
// Evaluated comparison as JSON, as a table for spreadsheets, and as a page.
#pragma once

#include <string>
#include <vector>

#include "bench/report/document.h"
#include "bench/round_robin/comparison.h"
#include "bench/round_robin/sealed_truth.h"
#include "bench/text/json.h"

namespace todbench {

/// Returns "consistent", "outlying" (a laboratory or result is outlying) or "inconsistent" (the results scatter more
/// than their uncertainties explain, and none is outlying).
[[nodiscard]] std::string_view verdict_word(const RoundRobin& found);
/// Returns the evaluation as JSON. `truths` is empty or has one check for each item.
[[nodiscard]] Json round_robin_json(const RoundRobin& found, const std::vector<TruthCheck>& truths);
/// Returns the degrees of equivalence as CSV; texts that a spreadsheet would treat as formulas are escaped.
[[nodiscard]] std::string round_robin_csv(const RoundRobin& found);
/// Returns the page for render_html().
[[nodiscard]] Document round_robin_page(const RoundRobin& found, const std::vector<TruthCheck>& truths);

}  // namespace todbench
