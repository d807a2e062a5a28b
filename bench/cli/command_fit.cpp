// SPDX-License-Identifier: GPL-3.0-or-later
// todbench fit
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include "bench/cli/commands.h"
#include "bench/cli/findings.h"
#include "bench/judgement/verdict.h"
#include "bench/report/svg.h"
#include "bench/report/tod_figures.h"
#include "bench/session/fit_record.h"
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
      {"deviance", fixed(fit.deviance, 4), "degrees of freedom: " + std::to_string(fit.degrees_of_freedom)}};
  if (fit.posterior) {
    rows.push_back({"posterior median", fixed(std::optional(fit.posterior->median), 6),
                    "95 %: " + range({fit.posterior->low, fit.posterior->high}, 6) +
                        (fit.posterior->prior_bound ? " (limited by the prior)" : "")});
  }
  console.table({"quantity", "value", ""}, rows);
}

/// Writes proportions and the fitted function to a separate file.
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

/// Sensitivity of the threshold to the fixed lapse rate.
struct LapseSensitivity {
  double free_lapse_threshold = 0, free_lapse = 0;
  double shift_in_half_widths = 0;  ///< |shift of ln threshold| over half the 95 % interval on its side; infinite: none
};

/// Empty: the lapse rate is free, or one of the two fits has no threshold.
std::optional<LapseSensitivity> lapse_sensitivity(const std::vector<Level>& levels, const PsychometricFit& fit,
                                                  FitOptions options) {
  if (!options.fixed_lapse || !fit.threshold || !(*fit.threshold > 0)) return std::nullopt;
  options.fixed_lapse.reset();
  options.with_posterior = false;
  const auto free = fit_psychometric(levels, options);
  if (!free || !free->threshold || !(*free->threshold > 0)) return std::nullopt;
  const double shift = std::log(*free->threshold / *fit.threshold);
  const auto& side = shift < 0 ? fit.ci95.low : fit.ci95.high;
  LapseSensitivity found{.free_lapse_threshold = *free->threshold, .free_lapse = free->lapse};
  // An open side contains every shift.
  if (side && *side > 0) {
    const double half = std::abs(std::log(*side / *fit.threshold));
    found.shift_in_half_widths = half > 0 ? std::abs(shift) / half : shift == 0 ? 0 : HUGE_VAL;
  }
  return found;
}

Json sensitivity_json(const std::optional<LapseSensitivity>& found) {
  if (!found) return nullptr;
  return {{"free_lapse_threshold", json_number(found->free_lapse_threshold)},
          {"shift_in_half_widths", json_number(found->shift_in_half_widths)}};
}

void print_sensitivity(const Console& console, const std::optional<LapseSensitivity>& found, double fixed_lapse) {
  constexpr double worth_saying = 0.5;
  if (!found || !(found->shift_in_half_widths > worth_saying)) return;
  console.text("A free lapse (" + fixed(found->free_lapse, 3) + " instead of " + number_text(fixed_lapse) +
               ") moves the threshold to " + fixed(found->free_lapse_threshold, 6) + ", by " +
               fixed(found->shift_in_half_widths, 1) + " half-widths of the 95 % interval.");
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
  const auto sensitivity = lapse_sensitivity(*levels, *fit, *options);
  if (console.json()) {
    Json json = fit_json(*fit);
    json["estimator"] = to_string(FitEstimator::weibull);
    json["estimator_reason"] = to_string(EstimatorReason::no_twin);
    json["adequacy"] = adequacy_json(found);
    if (options->fixed_lapse) json["sensitivity"] = sensitivity_json(sensitivity);
    console.object(json);
  } else {
    print(console, *fit);
    print_findings(console, found, "");
    if (options->fixed_lapse) print_sensitivity(console, sensitivity, *options->fixed_lapse);
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
                   "file with the columns size, correct, total and, if trials are not independent, cluster")
      ->required();
  command->add_option("--lapse", arguments->lapse, "lapse rate from 0 to 0.1; free: fitted with the threshold")
      ->capture_default_str();
  command->add_option("--form", arguments->form, "variable of the Weibull function: size or acuity")
      ->check(CLI::IsMember({"size", "acuity"}))
      ->capture_default_str();
  command->add_option("--svg", arguments->svg, "writes the answers and the fitted function to this SVG file");
  finish_command(*command, program, [arguments](Console& console) { return run_fit(console, *arguments); });
}

}  // namespace todbench
