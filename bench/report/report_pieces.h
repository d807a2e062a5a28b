// The sections of a report and the words they share.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "bench/report/markup.h"
#include "bench/report/report.h"

namespace todbench {

/// <section><h2>title</h2>content</section>.
[[nodiscard]] Markup section(std::string_view title, const Markup& content);
[[nodiscard]] Markup paragraph(const Markup& content, std::string_view css_class = "");
[[nodiscard]] Markup figure(const Result<Markup>& picture, std::string_view caption);

/// with_interval(), or why there is neither a value nor a bound.
[[nodiscard]] Markup interval_or_missing(std::optional<double> value, const Interval& interval,
                                         std::string_view reason);

/// A coloured word that also reads in black and white.
enum class Mood { good, bad, open };
[[nodiscard]] Markup badge(std::string_view word, Mood mood);

/// What a verdict means, for a reader who does not know the program.
[[nodiscard]] std::string_view in_words(FitVerdict verdict);
[[nodiscard]] std::string_view in_words(ComparisonVerdict verdict);
[[nodiscard]] std::string_view in_words(Mounting mounting);
[[nodiscard]] std::string_view in_words(Effect effect);
[[nodiscard]] Mood mood_of(VerdictKind verdict);
[[nodiscard]] Mood mood_of(ComparisonVerdict verdict);

/// The style sheet of the page; `page_label` and the page number stand at the foot of every printed page.
[[nodiscard]] std::string report_style(std::string_view page_label);

// What was found.
[[nodiscard]] Markup verdict_box(const ReportData& data);
[[nodiscard]] Markup limits_section(const ReportData& data);
[[nodiscard]] Markup curve_section(const ReportData& data);
[[nodiscard]] Markup psychometric_section(const ReportData& data);
[[nodiscard]] Markup human_section(const ReportData& data);
[[nodiscard]] Markup comparison_section(const ReportData& data);
[[nodiscard]] Markup answers_section(const ReportData& data);

// How it was found.
[[nodiscard]] Markup identification_section(const ReportData& data);
[[nodiscard]] Markup set_up_section(const ReportData& data);
/// Part of the set-up: set, read-back and seen contrast side by side; nothing where no presentations are known.
[[nodiscard]] Markup target_table(const ReportData& data);
[[nodiscard]] Markup effects_section(const ReportData& data);
[[nodiscard]] Markup frames_section(const ReportData& data);
[[nodiscard]] Markup provenance_section(const ReportData& data);
[[nodiscard]] Markup statements_section(const ReportData& data);
[[nodiscard]] Markup signature_section(const ReportData& data);

}  // namespace todbench
