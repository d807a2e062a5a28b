// todbench fit
#include <array>
#include <memory>

#include "bench/cli/commands.h"
#include "bench/cli/findings.h"
#include "bench/judgement/verdict.h"
#include "bench/report/svg.h"
#include "bench/report/tod_figures.h"
#include "bench/session/trials_csv.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "tod/adequacy/adequacy.h"

namespace todbench {
namespace {

struct FitArguments {
  std::string file, lapse = "0", form = "size", svg;
};

Result<FitOptions> options_of(const FitArguments& arguments) {
  FitOptions options;
  options.form = arguments.form == "acuity" ? PsychometricForm::acuity : PsychometricForm::size;
  if (arguments.lapse == "free") {
    options.fixed_lapse.reset();
    return options;
  }
  const auto lapse = parse_number(arguments.lapse);
  if (!lapse || *lapse < 0 || *lapse > 0.1) {
    return fail(ErrorCode::invalid_input, "--lapse " + arguments.lapse + ": expected a number from 0 to 0.1, or free");
  }
  options.fixed_lapse = *lapse;
  return options;
}

void print(const Console& console, const PsychometricFit& fit) {
  std::vector<TableRow> rows{
      {"verdict", std::string(to_string(fit.verdict)), ""},
      {"function", "Weibull", std::string(in_words(EstimatorReason::no_twin))},
      {"threshold (75 % correct)", fixed(fit.threshold, 6), "95 %: " + range(fit.ci95, 6)},
      {"slope", fixed(fit.slope, 4), ""},
      {"lapse", fixed(fit.lapse, 4), ""},
      {"log likelihood", fixed(fit.log_likelihood, 4), ""},
      {"deviance", fixed(fit.deviance, 4), std::to_string(fit.degrees_of_freedom) + " degrees of freedom"}};
  if (fit.posterior) {
    rows.push_back({"posterior median", fixed(fit.posterior->median, 6),
                    "95 %: " + range({fit.posterior->low, fit.posterior->high}, 6) +
                        (fit.posterior->prior_bound ? " (bound by the prior)" : "")});
  }
  console.table({"quantity", "value", ""}, rows);
}

/// Proportions and the fitted function as a file of its own.
Result<void> write_svg(const FitArguments& arguments, const std::vector<Level>& levels, const PsychometricFit& fit,
                       PsychometricForm form) {
  TodPoint point;
  point.levels = levels;
  point.fit = fit;
  Plot plot = psychometric_figure("fit", {"answers", &point}, {"", nullptr}, form);
  plot.x.label = "Size";
  const auto drawing = drawn(plot);
  if (!drawing) return fail("--svg", drawing.error());
  return write_file_atomically(arguments.svg, svg_document(std::array{*drawing}));
}

int run_fit(Console& console, const FitArguments& arguments) {
  auto options = options_of(arguments);
  if (!options) return report_error(console, options.error());
  auto levels = read_levels(arguments.file);
  if (!levels) return report_error(console, levels.error());
  auto fit = fit_psychometric(*levels, *options);
  if (!fit) return report_error(console, with_context(arguments.file, fit.error()));
  if (!arguments.svg.empty()) {
    if (auto written = write_svg(arguments, *levels, *fit, options->form); !written)
      return report_error(console, written.error());
  }
  const Adequacy found = adequacy(*levels, *fit, *options);
  if (console.json()) {
    Json json = fit_json(*fit);
    json["estimator"] = to_string(FitEstimator::weibull);
    json["estimator_reason"] = to_string(EstimatorReason::no_twin);
    json["adequacy"] = adequacy_json(found);
    console.object(json);
  } else {
    print(console, *fit);
    print_findings(console, found, "");
  }
  return exit_code(*fit, found);
}

}  // namespace

void add_fit_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("fit", "fits one psychometric function to counts in a CSV file: size,correct,total[,cluster]");
  auto arguments = std::make_shared<FitArguments>();
  command
      ->add_option("TRIALS.csv", arguments->file,
                   "file with the columns size, correct, total and, for trials that are not independent, cluster")
      ->required();
  command->add_option("--lapse", arguments->lapse, "0 to 0.1, or free")->capture_default_str();
  command->add_option("--form", arguments->form, "Weibull in size or in acuity")
      ->check(CLI::IsMember({"size", "acuity"}))
      ->capture_default_str();
  command->add_option("--svg", arguments->svg, "writes answers and fitted function to this file");
  finish_command(*command, program, [arguments](Console& console) { return run_fit(console, *arguments); });
}

}  // namespace todbench
