// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/module/module_observer_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "acquisition/base/try.h"
#include "hvs/shape/polygon_coverage.h"

namespace todbench {
namespace {

constexpr double contrast_k = 2;
/// Small, usual, large, and one size with microscan.
constexpr std::array<std::pair<double, int>, 4> asked_sizes{{{1.6, 1}, {2.6, 1}, {5.0, 1}, {12.0, 2}}};
constexpr int places_across = 3;

RandomStream check_noise() {
  return {1, "module.observer.check"};
}

/// A target after detectors that average over a sample, without any other effect.
Patch planted(const Polygon& shape, double size_samples, int window_samples, cv::Point2d phase) {
  const cv::Point2d middle(window_samples / 2.0, window_samples / 2.0);
  return {.kelvin = 300 + contrast_k * pixel_coverage(placed(shape, size_samples, middle + phase),
                                                      {window_samples, window_samples}),
          .phase = phase};
}

/// One question and the stream of its internal noise.
struct Question {
  std::size_t size = 0;
  int truth = 0;
  cv::Point2d phase{};
  std::uint64_t number = 0;
};

std::vector<Question> questions(int alternatives) {
  std::vector<Question> all;
  for (std::size_t size = 0; size < asked_sizes.size(); ++size) {
    for (int truth = 0; truth < alternatives; ++truth) {
      for (int place = 0; place < places_across * places_across; ++place) {
        const int row = place / places_across, column = place % places_across;
        const cv::Point2d phase((column - 1) / 3.0, (row - 1) / 3.0);
        all.push_back({size, truth, phase, all.size()});
      }
    }
  }
  return all;
}

/// Answers of a new process, in the order of the questions.
Result<std::vector<Choice>> answers_to(const std::vector<Question>& asked, const TemplateObserverSpec& spec,
                                       const Alternatives& alternatives, const ModulePlan& module) {
  const auto observer = module_observer(spec, alternatives, module, nullptr);
  std::vector<Choice> answers;
  for (const Question& question : asked) {
    const auto [size, samples_per_pitch] = asked_sizes.at(question.size);
    TODBENCH_TRY(const auto prepared, observer->prepare(size, samples_per_pitch));
    answers.push_back(prepared->choose(planted(alternatives[static_cast<std::size_t>(question.truth)], size,
                                               prepared->window_samples(), question.phase),
                                       contrast_k, check_noise().sub(question.number)));
    if (const auto failure = observer->failure())
      return fail(fmt::format("patch {} of {}, a target of {} samples", answers.size(), asked.size(), size), *failure);
  }
  return answers;
}

Result<double> patch_time_ms(const TemplateObserverSpec& spec, const Alternatives& alternatives,
                             const ModulePlan& module) {
  const auto observer = module_observer(spec, alternatives, module, nullptr);
  TODBENCH_TRY(const auto prepared, observer->prepare(5, 1));
  const Patch patch = planted(alternatives.front(), 5, prepared->window_samples(), {});
  std::vector<double> times;
  for (int i = 0; i < 21; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    (void)prepared->choose(patch, contrast_k, check_noise());
    if (const auto failure = observer->failure()) return tl::unexpected(*failure);
    times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  }
  std::nth_element(times.begin() + 1, times.begin() + 11, times.end());  // the first includes the start
  return times[11];
}

}  // namespace

Result<ObserverModuleReport> check_observer(const TemplateObserverSpec& spec, const Alternatives& alternatives,
                                            const ModulePlan& module) {
  ObserverModuleReport report;
  report.network_cut = !module.network && can_cut_network();
  const auto asked = questions(static_cast<int>(alternatives.size()));
  std::vector<Question> backwards(asked.rbegin(), asked.rend());
  const auto first = answers_to(asked, spec, alternatives, module),
             second = answers_to(asked, spec, alternatives, module),
             last = answers_to(backwards, spec, alternatives, module);
  for (const auto* answers : {&first, &second, &last}) {
    if (!*answers) return tl::unexpected(answers->error());
  }
  TemplateObserver windows(spec, alternatives);
  for (const auto& [size, samples_per_pitch] : asked_sizes) {
    TODBENCH_TRY(const auto prepared, windows.prepare(size, samples_per_pitch));
    report.sizes.push_back({size, samples_per_pitch, prepared->window_samples()});
  }
  for (std::size_t i = 0; i < asked.size(); ++i) {
    if ((*first)[i].scores != (*second)[i].scores)
      return fail(ErrorCode::integrity, "two processes of the module scored the same patches differently");
    report.order_matters = report.order_matters || (*first)[i].scores != (*last)[asked.size() - 1 - i].scores;
    JudgedSize& size = report.sizes[asked[i].size];
    ++size.asked;
    size.right += (*first)[i].alternative == asked[i].truth ? 1 : 0;
  }
  TODBENCH_TRY(report.latency_ms, patch_time_ms(spec, alternatives, module));
  return report;
}

}  // namespace todbench
