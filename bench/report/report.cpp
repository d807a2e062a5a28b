// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/report.h"

#include <algorithm>

#include "bench/report/cost_figure.h"
#include "bench/report/html.h"
#include "bench/report/measures_section.h"
#include "bench/report/report_pieces.h"
#include "bench/report/uncertainty_section.h"

namespace todbench {
namespace {

std::string subtitle(const ReportData& data) {
  std::string text = data.camera ? data.camera->vendor + " " + data.camera->model : "Simulation";
  if (data.camera && !data.camera->serial.empty()) text += ", serial number " + data.camera->serial;
  if (!data.finished.empty()) text += " · " + data.finished;
  return text;
}

/// Returns the label of printed pages: report and unit.
std::string page_label(const ReportData& data) {
  std::string label;
  if (data.letterhead && !data.letterhead->foot.empty()) label = data.letterhead->foot + " · ";
  label += data.session.empty() ? data.title : data.session;
  if (data.camera && !data.camera->serial.empty()) label += ", serial number " + data.camera->serial;
  if (data.revision) label += ", revision " + std::to_string(data.revision->number);
  if (!data.manifest_sha256.empty()) label += " · SHA-256 " + data.manifest_sha256;
  return label;
}

/// Adds the texts of the laboratory around the report. The report itself stays complete.
void add_letterhead(const Letterhead& letterhead, Document& document) {
  if (!letterhead.title.empty()) document.heading = letterhead.title;
  if (!letterhead.logo_png.empty() || !letterhead.lines.empty())
    document.before_heading = {
        Imprint{letterhead.logo_png, letterhead.logo_text, letterhead.logo_height_mm, letterhead.lines}};
  std::vector<Block> introduction;
  for (const auto& text : letterhead.introduction) introduction.emplace_back(Paragraph{plain(text)});
  document.opening.insert(document.opening.begin(), introduction.begin(), introduction.end());
}

/// Returns the entries of ISO/IEC 17025:2017, 7.8.2, for the first page.
std::optional<Section> order_section(const ReportData& data) {
  if (!data.order) return {};
  ValueTable table;
  for (const auto& [name, text] : order_lines(*data.order)) table.values.push_back({name, plain(text)});
  return Section{"Order", {std::move(table), note(plain(std::string(not_in_part)))}};
}

std::optional<Section> closing_section(const ReportData& data) {
  if (!data.letterhead || data.letterhead->closing_title.empty()) return {};
  Section section{data.letterhead->closing_title, {}};
  for (const auto& text : data.letterhead->closing) section.blocks.emplace_back(Paragraph{plain(text)});
  return section;
}

/// Returns the curve whose presentations took the time of the run; null if no time is stated.
const TodCurve* timed_curve(const ReportData& data) {
  if (!(data.wall_s > 0)) return nullptr;
  if (data.measured) return &*data.measured;
  return data.simulated && !data.camera ? &*data.simulated : nullptr;
}

}  // namespace

ReportVerdict report_verdict(const ReportData& data) {
  if (!data.accepted_changes.empty()) return ReportVerdict::changed;
  if (data.verdict && data.verdict->decision == VerdictKind::fail) return ReportVerdict::fail;
  if (data.interrupted) return ReportVerdict::interrupted;
  if (!data.verdict) return ReportVerdict::not_judged;
  if (data.verdict->decision == VerdictKind::inconclusive) return ReportVerdict::inconclusive;
  return limits_asked(*data.verdict) ? ReportVerdict::pass : ReportVerdict::not_judged;
}

std::optional<AccuracyBill> bill_of(const ReportData& data) {
  const TodCurve* timed = timed_curve(data);
  if (timed == nullptr) return std::nullopt;
  return accuracy_bill({.presentations = data.presentations,
                        .curve = *timed,
                        .uncertainty = data.uncertainty ? &*data.uncertainty : nullptr,
                        .verdict = data.verdict ? &*data.verdict : nullptr,
                        .effects = data.plan,
                        .wall_s = data.wall_s,
                        .measures_s = data.measures_s,
                        .quantities = data.measures && data.measures->main ? data.measures->main->lines.size() : 0,
                        .forecast = data.forecast ? &*data.forecast : nullptr,
                        .twin_s = data.twin_s});
}

Document report_document(const ReportData& data) {
  Document document{.title = data.title + (data.session.empty() ? "" : " – " + data.session),
                    .heading = data.title,
                    .subtitle = subtitle(data),
                    .page_label = page_label(data),
                    .opening = {verdict_box(data)},
                    .sections = {}};
  const auto add = [&](std::optional<Section> section) {
    if (section) document.sections.push_back(*std::move(section));
  };
  add(order_section(data));
  add(identification_section(data));
  add(limits_section(data));
  add(signature_section(data));
  const bool curve = data.measured || data.simulated || !data.measures;
  if (curve) add(curve_section(data));
  add(uncertainty_section(data));
  add(psychometric_section(data));
  add(human_section(data));
  add(viewing_section(data));
  if (curve) add(comparison_section(data));
  add(measures_section(data));
  add(mrtd_section(data));
  add(set_up_section(data));
  add(effects_section(data));
  if (const auto bill = bill_of(data)) add(bill_section(*bill));
  if (data.cost) add(cost_section(*data.cost));
  add(frames_section(data));
  add(provenance_section(data));
  add(notes_section(data));
  add(statements_section(data));
  add(closing_section(data));
  add(answers_section(data));
  if (data.letterhead) add_letterhead(*data.letterhead, document);
  return document;
}

std::string render_report(const ReportData& data) {
  return render_html(report_document(data));
}

}  // namespace todbench
