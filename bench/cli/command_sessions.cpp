// todbench compare, todbench report
#include <memory>

#include "bench/cli/commands.h"
#include "bench/judgement/verdict.h"
#include "bench/plan/plan_options.h"
#include "bench/report/report.h"
#include "bench/run/comparison_forecast.h"
#include "bench/run/report_data.h"
#include "bench/session/human_record.h"
#include "bench/session/manifest.h"
#include "bench/session/session_folder.h"
#include "bench/text/files.h"

namespace todbench {
namespace {

struct CompareArguments {
  std::string a, b;
  double margin_percent = 0;
};

Result<TodCurve> curve_of(const std::string& folder) {
  auto session = read_session(folder);
  if (!session) return tl::unexpected(session.error());
  if (!session->curve) return fail(ErrorCode::invalid_input, folder + ": the session holds no curve");
  return *session->curve;
}

int run_compare(Console& console, const CompareArguments& arguments) {
  auto session = read_session(arguments.a);
  if (!session) return report_error(console, session.error());
  auto a = curve_of(arguments.a);
  if (!a) return report_error(console, a.error());
  auto b = curve_of(arguments.b);
  if (!b) return report_error(console, b.error());
  ComparisonOptions options = comparison_options(session->plan);
  if (arguments.margin_percent > 0) options.margin_percent = arguments.margin_percent;
  auto comparison = compare(*a, *b, options);
  if (!comparison) return report_error(console, comparison.error());
  const std::string outlook = comparison_forecast(*a, *b, *comparison).sentence;
  if (!outlook.empty()) console.note(outlook);
  if (console.json()) {
    console.object(comparison_json(*comparison));
    return exit_code(decision_of(comparison->verdict));
  }
  std::vector<TableRow> rows;
  for (const auto& p : comparison->points) {
    rows.push_back({fixed(p.delta_t_a_k, 3), fixed(p.delta_t_b_k, 3), fixed(p.ratio, 4), range(p.ratio_ci95, 4),
                    fixed(p.p_difference, 4), fixed(p.p_equivalence, 4), std::string(to_string(p.verdict))});
  }
  console.table({"dT A [K]", "dT B [K]", "acuity A / B", "95 %", "p difference", "p equivalence", "verdict"}, rows);
  console.text("margin " + fixed(options.margin_percent, 1) +
               " %; verdict: " + std::string(to_string(comparison->verdict)));
  return exit_code(decision_of(comparison->verdict));
}

int run_report(Console& console, const std::string& folder) {
  auto session = read_session(folder);
  if (!session) return report_error(console, session.error());
  const auto path = std::filesystem::path(folder);
  auto data = report_data(*session, session_name(path));
  if (!data) return report_error(console, data.error());
  auto human = read_human(path);
  if (!human) return report_error(console, human.error());
  if (*human) data->human = (*human)->curve;
  const auto file = path / "report.html";
  if (auto written = write_file_atomically(file, render_report(*data)); !written)
    return report_error(console, written.error());
  if (!session->verdict) {
    if (auto kept = keep_verdict(path, *data->verdict); !kept) return report_error(console, kept.error());
  }
  // A run that was cut off has no manifest; there is nothing to bring up to date then.
  if (std::error_code none; std::filesystem::exists(path / "manifest.json", none)) {
    if (auto refreshed = refresh_manifest(path, {"report.html"}); !refreshed)
      return report_error(console, refreshed.error());
  }
  const bool afterwards = data->verdict->judged == JudgedWhen::afterwards;
  if (afterwards) console.note(std::string(remark_on(data->verdict->judged)));
  if (console.json()) {
    Json json{{"report", file.string()}};
    if (afterwards) json["judged"] = to_string(data->verdict->judged);
    console.object(json);
  } else {
    console.text(file.string());
  }
  return 0;
}

}  // namespace

void add_compare_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("compare", "compares two session folders: ratio, difference, equivalence per contrast");
  auto a = std::make_shared<CompareArguments>();
  command->add_option("A", a->a, "session folder")->required();
  command->add_option("B", a->b, "session folder")->required();
  command->add_option("--margin-percent", a->margin_percent, "equivalence margin; default: that of A's plan, or 10")
      ->check(number_in(0.1, 100));
  finish_command(*command, program, [a](Console& console) { return run_compare(console, *a); });
}

void add_report_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("report", "rebuilds the report from the session folder alone");
  auto folder = std::make_shared<std::string>();
  command->add_option("DIR", *folder, "session folder")->required();
  finish_command(*command, program, [folder](Console& console) { return run_report(console, *folder); });
}

}  // namespace todbench
