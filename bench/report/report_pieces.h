// SPDX-License-Identifier: GPL-3.0-or-later
// Sections of a report, and texts that several sections use.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/report/document.h"
#include "bench/report/report.h"

namespace todbench {

inline constexpr std::string_view one_sided_note =
    "A single bound in brackets (≥ or ≤) is a one-sided 95 % limit: the data do not bound the other side.";

/// Returns a list with one item per sentence.
[[nodiscard]] List list_of(const std::vector<std::string>& sentences);

/// Returns with_interval(), or the reason if there is neither a value nor a bound.
[[nodiscard]] RichText interval_or_missing(std::optional<double> value, const Interval& interval,
                                           std::string_view reason);

/// Return the meaning of a value in words, for readers who do not know the program.
[[nodiscard]] std::string_view in_words(FitVerdict verdict);
[[nodiscard]] std::string_view in_words(Mounting mounting);
[[nodiscard]] std::string_view in_words(Effect effect);
/// Return whether a verdict is presented as good, as bad or as undecided.
[[nodiscard]] Mood mood_of(VerdictKind verdict);
[[nodiscard]] Mood mood_of(ComparisonVerdict verdict);

/// Return the sections with results. If a function returns empty, the report lacks this section.
[[nodiscard]] VerdictBox verdict_box(const ReportData& data);
[[nodiscard]] Section limits_section(const ReportData& data);
[[nodiscard]] Section curve_section(const ReportData& data);
[[nodiscard]] std::optional<Section> psychometric_section(const ReportData& data);
[[nodiscard]] std::optional<Section> human_section(const ReportData& data);
/// Returns MRTD and MDTD of the model and of people with their conditions, and the differences from STANAG 4349; empty
/// if they were not measured.
[[nodiscard]] std::optional<Section> mrtd_section(const ReportData& data);
/// Returns the factors that limit the acuity, and the thresholds of an operator at the display.
[[nodiscard]] std::optional<Section> viewing_section(const ReportData& data);
[[nodiscard]] Section comparison_section(const ReportData& data);
[[nodiscard]] std::optional<Section> answers_section(const ReportData& data);

/// Return the sections of conditions and provenance.
[[nodiscard]] Section identification_section(const ReportData& data);
[[nodiscard]] Section set_up_section(const ReportData& data);
/// Returns a table of the set-up section: set contrast, read-back and effective contrast side by side; empty if no
/// presentations are known.
[[nodiscard]] std::optional<Table> target_table(const ReportData& data);
[[nodiscard]] Section effects_section(const ReportData& data);
[[nodiscard]] std::optional<Section> frames_section(const ReportData& data);
[[nodiscard]] Section provenance_section(const ReportData& data);
[[nodiscard]] Section notes_section(const ReportData& data);
[[nodiscard]] Section statements_section(const ReportData& data);
[[nodiscard]] Section signature_section(const ReportData& data);

}  // namespace todbench
