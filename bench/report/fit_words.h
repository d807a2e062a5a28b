// What a report says in words of the fitted functions and of the answers below them.
#pragma once

#include <string>

#include "bench/report/report.h"

namespace todbench {

/// The function and how it was fitted: sentences. Contrasts with another function than the first are named with the
/// reason.
[[nodiscard]] std::string form_in_words(const ReportData& data);
/// What was counted, as sentences behind a space; empty where nobody said. The frames of each contrast where they
/// differ, the twin apart where its answers are others.
[[nodiscard]] std::string answers_in_words(const ReportData& data);

}  // namespace todbench
