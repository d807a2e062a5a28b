// todbench range
#include <algorithm>
#include <memory>

#include "bench/cli/commands.h"
#include "bench/cli/session_argument.h"
#include "bench/judgement/verdict.h"
#include "bench/text/text.h"
#include "tod/range/range_prediction.h"

namespace todbench {
namespace {

struct RangeArguments {
  std::string tod;
  RangeTask task;
  std::optional<double> v50;
  Opening opening{};
};

/// Where the TOD curve says something about the target at all.
bool any_probability(const RangePrediction& prediction) {
  return std::any_of(prediction.curve.begin(), prediction.curve.end(),
                     [](const RangePoint& point) { return point.probability.has_value(); });
}

Json range_json(const RangePrediction& prediction, const TodCurve& tod, const RangeTask& task) {
  Json points = Json::array();
  const std::vector<RangePoint> none;
  for (const auto& point : any_probability(prediction) ? prediction.curve : none) {
    points.push_back({{"range_m", point.range_m},
                      {"probability", json_number(point.probability)},
                      {"probability_ci95", json_interval(point.probability_ci95)},
                      {"apparent_delta_t_k", json_number(point.apparent_delta_t_k)}});
  }
  return {{"r75_m", json_number(prediction.r75_m)},
          {"r75_ci95_m", json_interval(prediction.r75_ci95_m)},
          {"reason", prediction.reason.empty() ? Json() : Json(prediction.reason)},
          {"notes", prediction.notes},
          {"observer", tod.observer},
          {"sensor", tod.sensor},
          {"size_m", task.size_m},
          {"delta_t_k", task.delta_t_k},
          {"m75", task.m75},
          {"extinction_per_km", task.extinction_per_km},
          {"curve", points}};
}

void print_range(Console& console, const RangePrediction& prediction, const TodCurve& tod, const RangeTask& task) {
  console.text("identification range, TOD of " + tod.sensor + ", observer " + tod.observer);
  console.text("target " + number_text(task.size_m) + " m, " + number_text(task.delta_t_k) + " K, M75 " +
               number_text(task.m75) + ", extinction " + number_text(task.extinction_per_km) + " per km");
  std::vector<TableRow> rows;
  for (const auto& p : prediction.curve) {
    if (!p.probability) continue;
    rows.push_back(
        {fixed(p.range_m, 0), fixed(p.apparent_delta_t_k, 3), fixed(p.probability, 3), range(p.probability_ci95, 3)});
  }
  if (!rows.empty()) {
    console.table({"range [m]", "apparent dT [K]", "P correct", "95 %"}, rows);
    console.text("");
  }
  if (prediction.r75_m || prediction.r75_ci95_m.low)
    console.text("75 % correct at " + fixed(prediction.r75_m, 1) + " m, 95 %: " + range(prediction.r75_ci95_m, 1) +
                 " m");
  if (!prediction.reason.empty()) console.text(prediction.reason);
}

int run_range(Console& console, const RangeArguments& arguments) {
  RangeTask task = arguments.task;
  if (arguments.v50) task.m75 = m75_from_v50(*arguments.v50);
  auto session = opened(console, arguments.tod, arguments.opening);
  if (!session) return report_error(console, session.error());
  if (!session->curve) {
    return report_error(console, {ErrorCode::invalid_input, arguments.tod + ": the session holds no curve"});
  }
  const ThresholdSelection selection = thresholds_of(*session->curve, task.delta_t_k);
  for (const auto& sentence : selection.notes) console.note(sentence);
  RangePrediction prediction;
  if (selection.thresholds.empty()) {
    prediction.reason = "the TOD curve has no threshold";
  } else {
    auto predicted = predict_range(selection.thresholds, task);
    if (!predicted) return report_error(console, predicted.error());
    prediction = *predicted;
  }
  for (const auto& sentence : prediction.notes) console.note(sentence);
  prediction.notes.insert(prediction.notes.begin(), selection.notes.begin(), selection.notes.end());
  if (console.json()) {
    Json json = range_json(prediction, *session->curve, task);
    add_accepted_changes(json, arguments.opening, session->accepted_changes);
    console.object(json);
  } else {
    print_range(console, prediction, *session->curve, task);
    if (const auto sentence = accepted_sentence(arguments.tod, *session); !sentence.empty()) console.text(sentence);
  }
  return exit_code(prediction.r75_m ? VerdictKind::pass : VerdictKind::inconclusive);
}

}  // namespace

void add_range_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("range", "predicts the range of identification from a TOD curve");
  auto a = std::make_shared<RangeArguments>();
  command->add_option("--tod", a->tod, "session folder with the curve")->required();
  command->add_option("--size-m", a->task.size_m, "square root of the target's projected area")
      ->required()
      ->check(number_in(1e-6, 1e6));
  command->add_option("--delta-t-k", a->task.delta_t_k, "contrast at the target")
      ->required()
      ->check(number_in(-5000, 5000));
  auto* m75 = command->add_option("--m75", a->task.m75, "criterion of the TOD model; 5.1: small craft, side view")
                  ->check(number_in(1e-6, 1e6))
                  ->capture_default_str();
  command->add_option("--v50", a->v50, "criterion of NVThermIP instead: M75 = 0.6 V50")
      ->check(number_in(1e-6, 1e6))
      ->excludes(m75);
  command->add_option("--extinction-per-km", a->task.extinction_per_km, "of the apparent contrast")
      ->check(number_in(0, 1e4))
      ->capture_default_str();
  add_accept_changed(*command, a->opening.accept_changed);
  finish_command(*command, program, [a](Console& console) { return run_range(console, *a); });
}

}  // namespace todbench
