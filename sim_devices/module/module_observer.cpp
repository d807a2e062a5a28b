// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/module/module_observer.h"

#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

/// The process that serves all sizes of one observer.
class ScoringProcess {
 public:
  ScoringProcess(const ModulePlan& plan, std::function<void(std::string_view line)> on_error_line)
      : plan_(plan), options_(stage_options(plan)) {
    options_.process.on_error_line = std::move(on_error_line);
  }

  std::optional<std::vector<double>> scores(const std::vector<double>& conditions, const cv::Mat1f& patch, int count) {
    const std::scoped_lock lock(mutex_);
    if (failure_) return std::nullopt;
    if (options_.restart_frames > 0 && answered_ >= options_.restart_frames) process_.reset();
    if (!process_) {
      auto started = ModuleProcess::start(options_.process);
      if (!started) return failed(started.error());
      process_.emplace(std::move(*started));
      answered_ = 0;
    }
    auto answer = process_->ask(to_message(conditions) + to_message(patch), {static_cast<std::size_t>(count)});
    ++answered_;
    if (!answer) return failed(answer.error());
    return *std::move(answer);
  }
  [[nodiscard]] std::optional<Error> failure() const {
    const std::scoped_lock lock(mutex_);
    return failure_;
  }

 private:
  std::optional<std::vector<double>> failed(const Error& error) {
    failure_ = module_error(plan_, error);
    return std::nullopt;
  }

  ModulePlan plan_;
  ModuleStageOptions options_;
  mutable std::mutex mutex_;
  std::optional<ModuleProcess> process_;
  std::optional<Error> failure_;
  int answered_ = 0;
};

class PreparedModuleObserver final : public PreparedObserver {
 public:
  PreparedModuleObserver(TemplateObserverSpec spec, std::shared_ptr<const PreparedObserver> templates,
                         std::shared_ptr<ScoringProcess> process, int alternatives, double size_samples,
                         int samples_per_pitch)
      : spec_(std::move(spec)),
        templates_(std::move(templates)),
        process_(std::move(process)),
        alternatives_(alternatives),
        size_samples_(size_samples),
        samples_per_pitch_(samples_per_pitch) {}

  [[nodiscard]] int window_samples() const override { return templates_->window_samples(); }
  [[nodiscard]] double search_samples() const override { return templates_->search_samples(); }

  [[nodiscard]] Choice choose(const Patch& patch, double contrast_k, const RandomStream& noise) const override {
    cv::Mat1f seen(patch.kelvin.size());
    std::vector<float> draws(seen.total());
    seen_patch(spec_, patch, contrast_k, noise, {seen.ptr<float>(), seen.total()}, draws);
    Choice choice;
    choice.alternatives = alternatives_;
    const auto scores = process_->scores({size_samples_, static_cast<double>(samples_per_pitch_), contrast_k,
                                          patch.phase.x, patch.phase.y, patch.noise_k},
                                         seen, alternatives_);
    if (scores) std::copy(scores->begin(), scores->end(), choice.scores.begin());
    choice.alternative = winning_alternative(choice, noise);
    return choice;
  }

  [[nodiscard]] GradedChoice judge(const Patch& patch, double contrast_k, const RandomStream& noise,
                                   int /*draws*/) const override {
    GradedChoice graded{choose(patch, contrast_k, noise), {}};
    graded.answers.probability[static_cast<std::size_t>(graded.choice.alternative)] = 1;
    return graded;
  }

 private:
  TemplateObserverSpec spec_;
  std::shared_ptr<const PreparedObserver> templates_;  ///< provides the window
  std::shared_ptr<ScoringProcess> process_;
  int alternatives_;
  double size_samples_;
  int samples_per_pitch_;
};

class ModuleObserver final : public Observer {
 public:
  ModuleObserver(const TemplateObserverSpec& spec, Alternatives alternatives, std::shared_ptr<ScoringProcess> process)
      : count_(static_cast<int>(alternatives.size())),
        templates_(spec, std::move(alternatives)),
        process_(std::move(process)) {}

  [[nodiscard]] const std::string& name() const override { return templates_.name(); }
  [[nodiscard]] Result<std::shared_ptr<const PreparedObserver>> prepare(double size_samples,
                                                                        int samples_per_pitch) override {
    TODBENCH_TRY(auto templates, templates_.prepare(size_samples, samples_per_pitch));
    return std::make_shared<const PreparedModuleObserver>(templates_.spec(), templates, process_, count_, size_samples,
                                                          samples_per_pitch);
  }
  [[nodiscard]] std::optional<Error> failure() const override { return process_->failure(); }

 private:
  int count_;
  TemplateObserver templates_;
  std::shared_ptr<ScoringProcess> process_;
};

}  // namespace

std::unique_ptr<Observer> module_observer(const TemplateObserverSpec& spec, Alternatives alternatives,
                                          const ModulePlan& module,
                                          std::function<void(std::string_view line)> on_error_line) {
  return std::make_unique<ModuleObserver>(spec, std::move(alternatives),
                                          std::make_shared<ScoringProcess>(module, std::move(on_error_line)));
}

}  // namespace todbench
