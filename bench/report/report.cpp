#include "bench/report/report.h"

#include <algorithm>

#include "bench/report/cost_figure.h"
#include "bench/report/report_pieces.h"
#include "bench/report/svg_plot.h"

namespace todbench {
namespace {

Markup subtitle(const ReportData& data) {
  std::string text = data.camera ? data.camera->vendor + " " + data.camera->model : "Simulation";
  if (data.camera && !data.camera->serial.empty()) text += ", serial number " + data.camera->serial;
  if (!data.finished.empty()) text += " · " + data.finished;
  return paragraph(escaped(text), "subtitle");
}

/// What every printed page must name: the report and the item.
std::string page_label(const ReportData& data) {
  std::string label = data.session.empty() ? data.title : data.session;
  if (data.camera && !data.camera->serial.empty()) label += ", serial number " + data.camera->serial;
  return label;
}

}  // namespace

ReportVerdict report_verdict(const ReportData& data) {
  if (data.verdict && data.verdict->decision == VerdictKind::fail) return ReportVerdict::fail;
  if (data.interrupted) return ReportVerdict::interrupted;
  if (!data.verdict) return ReportVerdict::not_judged;
  if (data.verdict->decision == VerdictKind::inconclusive) return ReportVerdict::inconclusive;
  return limits_asked(*data.verdict) ? ReportVerdict::pass : ReportVerdict::not_judged;
}

std::vector<Plot> report_plots(const ReportData& data) {
  std::vector<Plot> plots;
  if (data.measured || data.simulated) plots.push_back(tod_plot(data));
  for (auto& plot : psychometric_plots(data)) plots.push_back(std::move(plot));
  for (auto& plot : human_plots(data)) plots.push_back(std::move(plot));
  if (data.cost) {
    plots.push_back(cost_result_plot(*data.cost));
    plots.push_back(cost_knob_plot(*data.cost));
  }
  return plots;
}

std::string render_report(const ReportData& data) {
  const Markup head =
      literal(
          "<meta charset=\"utf-8\"/>\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n") +
      element("title", escaped(data.title + (data.session.empty() ? "" : " – " + data.session))) + literal("\n") +
      element("style", literal(report_style(page_label(data)) + plot_style())) + literal("\n");
  Markup body = element("header", element("h1", escaped(data.title)) + literal("\n") + subtitle(data)) + literal("\n");
  body += verdict_box(data);
  body += identification_section(data) + limits_section(data) + curve_section(data) + psychometric_section(data) +
          human_section(data);
  body += comparison_section(data) + set_up_section(data) + effects_section(data);
  if (data.cost) body += cost_section(*data.cost);
  body += frames_section(data);
  body += provenance_section(data) + statements_section(data) + signature_section(data) + answers_section(data);
  return "<!DOCTYPE html>\n" +
         element("html", element("head", head) + literal("\n") + element("body", element("main", body)),
                 "lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\"")
             .text +
         "\n";
}

}  // namespace todbench
