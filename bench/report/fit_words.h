// SPDX-License-Identifier: GPL-3.0-or-later
// Sentences of a report about the fitted functions and the kind of answers.
#pragma once

#include <string>

#include "bench/report/report.h"

namespace todbench {

/// Returns sentences about the psychometric function and its fit. If the function of the twin was fitted, the sentences
/// also list the contrasts for which a Weibull function was fitted instead, with the reason.
[[nodiscard]] std::string form_in_words(const ReportData& data);
/// Returns sentences about the kind of answers, preceded by a space; empty if unknown. States the number of frames for
/// each contrast if the numbers differ, and describes the twin separately if its answers differ.
[[nodiscard]] std::string answers_in_words(const ReportData& data);

}  // namespace todbench
