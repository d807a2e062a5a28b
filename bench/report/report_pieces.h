// The sections of a report and the words they share.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/report/document.h"
#include "bench/report/report.h"

namespace todbench {

/// One item a sentence.
[[nodiscard]] List list_of(const std::vector<std::string>& sentences);

/// with_interval(), or why there is neither a value nor a bound.
[[nodiscard]] RichText interval_or_missing(std::optional<double> value, const Interval& interval,
                                           std::string_view reason);

/// What a verdict means, for a reader who does not know the program.
[[nodiscard]] std::string_view in_words(FitVerdict verdict);
[[nodiscard]] std::string_view in_words(ComparisonVerdict verdict);
[[nodiscard]] std::string_view in_words(Mounting mounting);
[[nodiscard]] std::string_view in_words(Effect effect);
[[nodiscard]] Mood mood_of(VerdictKind verdict);
[[nodiscard]] Mood mood_of(ComparisonVerdict verdict);

// What was found.
[[nodiscard]] VerdictBox verdict_box(const ReportData& data);
[[nodiscard]] Section limits_section(const ReportData& data);
[[nodiscard]] Section curve_section(const ReportData& data);
[[nodiscard]] std::optional<Section> psychometric_section(const ReportData& data);
[[nodiscard]] std::optional<Section> human_section(const ReportData& data);
[[nodiscard]] Section comparison_section(const ReportData& data);
[[nodiscard]] std::optional<Section> answers_section(const ReportData& data);

// How it was found.
[[nodiscard]] Section identification_section(const ReportData& data);
[[nodiscard]] Section set_up_section(const ReportData& data);
/// Part of the set-up: set, read-back and seen contrast side by side; nothing where no presentations are known.
[[nodiscard]] std::optional<Table> target_table(const ReportData& data);
[[nodiscard]] Section effects_section(const ReportData& data);
[[nodiscard]] std::optional<Section> frames_section(const ReportData& data);
[[nodiscard]] Section provenance_section(const ReportData& data);
[[nodiscard]] Section notes_section(const ReportData& data);
[[nodiscard]] Section statements_section(const ReportData& data);
[[nodiscard]] Section signature_section(const ReportData& data);

}  // namespace todbench
