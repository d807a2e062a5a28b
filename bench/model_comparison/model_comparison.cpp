// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/model_comparison/model_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <numbers>
#include <numeric>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/enhance/decidable.h"
#include "bench/enhance/package_spread.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/plan_options.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "bench/twin/module_chain.h"
#include "hvs/eye/contrast_sensitivity.h"
#include "hvs/eye/eye_optics.h"
#include "sim_devices/prediction/module_response.h"
#include "sim_devices/sensor/sensor_key.h"
#include "sim_devices/sensor/sensor_model.h"
#include "sim_devices/sensor/transfer_functions.h"
#include "tod/presentation/largest_contrast.h"

namespace todbench {
namespace {

/// Difference of two moduli that is reported as a deviation.
constexpr double parting_modulus = 0.01;
constexpr int transfer_points = 41;

Result<ComparedModel> described(ComparedModel model, const Resource& resource) {
  model.sha256 = sha256_of(resource.text);
  if (model.kind == ModelKind::observer) {
    TODBENCH_TRY(model.observer, parse_observer_with_module(resource));
    model.name = model.observer.spec.name;
    if (model.observer.module) model.provenance.push_back(text_of(module_record(*model.observer.module)));
    return model;
  }
  TODBENCH_TRY(model.sensor, parse_sensor(resource));
  model.name = model.sensor.name;
  for (const ModulePlan& module : model.sensor.modules) model.provenance.push_back(text_of(module_record(module)));
  return model;
}

bool has_name(ResourceKind kind, const std::string& name) {
  const auto names = resource_names(kind);
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string member_text(const SensorSpec& spec, const SensorKey& key) {
  return std::visit(
      [&](auto member) {
        if constexpr (std::is_same_v<decltype(member), DisplayReconstruction SensorSpec::*>)
          return std::string(to_string(spec.*member));
        else
          return fmt::format("{:g}", static_cast<double>(spec.*member));
      },
      key.member);
}

std::vector<KeyDifference> key_differences(const ComparedModel& a, const ComparedModel& b) {
  std::vector<KeyDifference> keys;
  const auto add = [&](std::string_view key, const std::string& of_a, const std::string& of_b) {
    if (of_a != of_b) keys.push_back({std::string(key), of_a, of_b});
  };
  const auto number = [](double value) { return fmt::format("{:g}", value); };
  if (a.kind == ModelKind::sensor) {
    for (const SensorKey& key : sensor_keys()) add(key.name, member_text(a.sensor, key), member_text(b.sensor, key));
    const auto commands = [](const SensorSpec& sensor) {
      std::string all;
      for (const ModulePlan& module : sensor.modules) all += (all.empty() ? "" : " | ") + module.command;
      return all;
    };
    add("module", commands(a.sensor), commands(b.sensor));
  } else if (a.kind == ModelKind::observer) {
    const std::pair<const char*, double TemplateObserverSpec::*> members[] = {
        {"blur_sigma_samples", &TemplateObserverSpec::blur_sigma_samples},
        {"internal_noise", &TemplateObserverSpec::internal_noise},
        {"sensor_noise_factor", &TemplateObserverSpec::sensor_noise_factor},
        {"search_range_samples", &TemplateObserverSpec::search_range_samples},
        {"search_step_samples", &TemplateObserverSpec::search_step_samples},
        {"window_size_factor", &TemplateObserverSpec::window_size_factor},
        {"window_margin_pitch", &TemplateObserverSpec::window_margin_pitch}};
    for (const auto& [key, member] : members)
      add(key, number(a.observer.spec.*member), number(b.observer.spec.*member));
    const std::pair<const char*, double EyeParameters::*> eye_members[] = {
        {"eye.sensitivity", &EyeParameters::sensitivity},
        {"eye.photon_noise_td", &EyeParameters::photon_noise_td},
        {"eye.inhibition_per_degree", &EyeParameters::inhibition_per_degree},
        {"eye.uncertainty_channels", &EyeParameters::uncertainty_channels},
        {"eye.contrast_noise", &EyeParameters::contrast_noise},
        {"eye.age_years", &EyeParameters::age_years},
        {"eye.field_deg2", &EyeParameters::field_deg2}};
    const auto of_eye = [&](const ComparedModel& model, double EyeParameters::*member) {
      return model.observer.spec.eye ? number((*model.observer.spec.eye).*member) : std::string("no eye");
    };
    for (const auto& [key, member] : eye_members) add(key, of_eye(a, member), of_eye(b, member));
    const auto command = [](const ComparedModel& model) {
      return model.observer.module ? model.observer.module->command : std::string();
    };
    add("module", command(a), command(b));
  }
  return keys;
}

/// Returns the plan with one side in place of its own sensor or observer.
Result<LoadedPlan> plan_with(const LoadedPlan& base, const ComparedModel& model) {
  Plan plan = base.plan();
  PlanParts parts = base.parts();
  if (model.kind == ModelKind::sensor) {
    parts.sensor = model.sensor;
    plan.simulation.microscan = model.sensor.microscan;
  } else if (model.kind == ModelKind::observer) {
    parts.observer = model.observer.spec;
    if (model.observer.module) plan.modules = {*model.observer.module};
  }
  return LoadedPlan::of(std::move(plan), std::move(parts));
}

/// Sensor and stages of one side, for single pictures.
class Chain {
 public:
  enum class Content { flat, plate };
  Chain(const LoadedPlan& loaded, const ComparedModel& model)
      : model_(loaded.sensor(), full_plan(loaded.sensor(), {}, {}), Accuracy::normal(), loaded.plan().seed),
        stages_(module_stages(loaded.sensor().modules, {})),
        frames_(1 + memory_frames(loaded.sensor(), model.package)) {
    auto package = made_stages(model.package, {});
    std::ranges::move(package, std::back_inserter(stages_));
    scene_.plate = loaded.plates().front();
    scene_.delta_t_k = largest_contrast_k(loaded.plan().target.delta_t_k);
    scene_.background_k = model_.spec().scene_temperature_k;
    scene_.distance_m = loaded.plan().target.distance_m;
    if (sensor_module(loaded.sensor()) != nullptr) module_.emplace(loaded.sensor(), loaded.plan().seed, nullptr);
  }

  [[nodiscard]] bool staged() const { return !stages_.empty(); }
  /// Whether the sensor is a program: its noise-free signal is unknown.
  [[nodiscard]] bool programmed() const { return module_.has_value(); }
  [[nodiscard]] double samples_per_mrad() const {
    return model_.spec().samples_per_pitch() / model_.spec().ifov_mrad();
  }
  [[nodiscard]] double kelvin_per_count() const { return model_.spec().kelvin_per_count; }
  /// In kelvin, before noise and stages.
  [[nodiscard]] cv::Mat1d signal() const {
    cv::Mat1d picture;
    model_.unit_signal(scene_)->convertTo(picture, CV_64F, scene_.delta_t_k);
    return picture;
  }
  /// Returns a settled frame with noise in kelvin; counts are converted by the scale of the sensor.
  Result<cv::Mat1d> frame() { return settled(Content::plate, 0); }
  /// Returns the response of the stages to a vertical edge of 1 K on a flat picture, or on the plate with its noise:
  /// the mean over rows, in kelvin.
  Result<std::vector<double>> edge(Content content) {
    const auto without = settled(content, 0), with = settled(content, 1);
    if (!without) return tl::unexpected(without.error());
    if (!with) return tl::unexpected(with.error());
    const cv::Mat1d added = *with - *without;
    std::vector<double> profile;
    for (int column = 0; column < added.cols; ++column) profile.push_back(cv::mean(added.col(column))[0]);
    return profile;
  }

 private:
  /// Returns the picture after the memory of the stages, with a step in its centre, in kelvin.
  Result<cv::Mat1d> settled(Content content, double step_k) {
    const cv::Size size = model_.size();
    const double flat = (scene_.background_k - model_.spec().offset_k) / kelvin_per_count();
    cv::Mat1f picture;
    for (int i = 0; i < frames_; ++i) {
      if (content == Content::flat)
        picture = cv::Mat1f(size, static_cast<float>(flat));
      else if (auto counts = exposed(static_cast<std::uint64_t>(i)); !counts)
        return tl::unexpected(counts.error());
      else
        counts->convertTo(picture, CV_32F);
      picture.colRange(size.width / 2, size.width) += step_k / kelvin_per_count();
      TODBENCH_TRY_VOID(through(picture));
    }
    cv::Mat1d kelvin;
    picture.convertTo(kelvin, CV_64F, kelvin_per_count());
    return kelvin;
  }

  Result<cv::Mat1w> exposed(std::uint64_t index) {
    if (module_) return module_->expose(scene_, index);
    return model_.expose(scene_, index);
  }

  Result<void> through(cv::Mat1f& picture) {
    for (const auto& stage : stages_) {
      TODBENCH_TRY(picture, stage->process(picture));
    }
    return {};
  }

  SensorModel model_;
  std::optional<ModuleSensor> module_;
  std::vector<std::unique_ptr<ChainStage>> stages_;
  int frames_;
  PlateScene scene_;
};

PixelDifference difference_of(std::string what, const cv::Mat1d& a, const cv::Mat1d& b) {
  PixelDifference found{.what = std::move(what), .mean_k = {}, .rms_k = {}, .largest_k = {}, .reason = {}};
  if (a.size() != b.size()) {
    found.reason = fmt::format("{} x {} and {} x {} pixels", a.cols, a.rows, b.cols, b.rows);
    return found;
  }
  const cv::Mat1d difference = b - a;
  const auto count = static_cast<double>(difference.total());
  found.mean_k = cv::sum(difference)[0] / count;
  found.rms_k = std::sqrt(difference.dot(difference) / count);
  double largest = 0;
  cv::minMaxLoc(cv::abs(difference), nullptr, &largest, nullptr, &found.largest_at);
  found.largest_k = difference(found.largest_at);
  return found;
}

/// Modulus of the edge response, in frequencies of the stages' samples: for a linear stage its transfer function.
std::vector<double> edge_moduli(const std::vector<double>& profile, const std::vector<double>& cycles_per_sample) {
  std::vector<double> moduli;
  for (const double f : cycles_per_sample) {
    std::complex<double> sum = 0;
    for (std::size_t i = 1; i < profile.size(); ++i)
      sum += (profile[i] - profile[i - 1]) * std::polar(1.0, -2 * std::numbers::pi * f * static_cast<double>(i));
    moduli.push_back(std::abs(sum));
  }
  return moduli;
}

/// Moduli along x of one side at frequencies of the scene.
Result<std::vector<double>> moduli_of(const ComparedModel& model, Chain& chain, const LoadedPlan& loaded,
                                      const std::vector<double>& frequencies_per_mrad,
                                      std::vector<std::string>& notes) {
  std::vector<double> moduli, cycles;
  for (const double f : frequencies_per_mrad) cycles.push_back(f / chain.samples_per_mrad());
  if (model.kind == ModelKind::observer) {
    if (const TemplateObserverSpec& seeing = loaded.observer(); seeing.eye) {
      const EyeFilter eye(*seeing.eye, adaptation_luminance_cd_m2(*seeing.display));
      const double per_sample = 60 / arcmin_per_sample(*seeing.display);
      for (const double f : cycles) moduli.push_back(eye_mtf(f * per_sample, eye.pupil_mm()));
      notes.push_back(
          fmt::format("{}: its MTF is that of the optics of the eye, without display and sensitivity", model.name));
      return moduli;
    }
    const double sigma = model.observer.spec.blur_sigma_samples;
    for (const double f : cycles)
      moduli.push_back(std::exp(-2 * std::numbers::pi * std::numbers::pi * sigma * sigma * f * f));
    return moduli;
  }
  const SensorSpec& spec = loaded.sensor();
  const TransferFunction transfer = sensor_transfer(spec, full_plan(spec, {}, {}), Accuracy::normal().wavelengths);
  const bool programmed = model.kind == ModelKind::sensor && chain.programmed();
  for (const double f : frequencies_per_mrad) {
    if (!programmed)
      moduli.push_back(model.kind == ModelKind::sensor ? std::abs(transfer(f * spec.ifov_mrad(), 0)) : 1.0);
  }
  if (programmed) {
    ModuleSensor sensor(spec, loaded.plan().seed, nullptr);
    TODBENCH_TRY(moduli, module_transfer(sensor, spec, cycles));
  }
  if (!chain.staged()) return moduli;
  // A stage is linear if the rest of the picture does not affect its edge response.
  const auto alone = chain.edge(Chain::Content::flat), over_plate = chain.edge(Chain::Content::plate);
  if (!alone) return tl::unexpected(alone.error());
  if (!over_plate) return tl::unexpected(over_plate.error());
  const auto factors = edge_moduli(*alone, cycles), others = edge_moduli(*over_plate, cycles);
  double apart = 0;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    moduli[i] *= factors[i];
    apart = std::max(apart, std::abs(factors[i] - others[i]));
  }
  if (apart > parting_modulus) {
    notes.push_back(
        fmt::format("{}: its stages are not linear (the response to an edge of 1 K differs by {:.2g} between a flat "
                    "picture and the picture of the plate). The transfer function is that of the edge in the flat "
                    "picture",
                    model.name, apart));
  }
  return moduli;
}

/// Compares pictures and transfer functions. Errors of a module are ignored here, because its trials report them.
Result<void> compare_pictures(ModelComparison& comparison, const LoadedPlan& plan_a, const LoadedPlan& plan_b) {
  Chain a(plan_a, comparison.a), b(plan_b, comparison.b);
  if (comparison.a.kind == ModelKind::sensor && (a.programmed() || b.programmed()))
    comparison.pixels.push_back({.what = "signal before noise",
                                 .mean_k = {},
                                 .rms_k = {},
                                 .largest_k = {},
                                 .reason = "a sensor that is a module has no picture without noise"});
  else if (comparison.a.kind == ModelKind::sensor)
    comparison.pixels.push_back(difference_of("signal before noise", a.signal(), b.signal()));
  if (comparison.a.kind != ModelKind::observer) {
    const auto frame_a = a.frame(), frame_b = b.frame();
    if (!frame_a) return tl::unexpected(frame_a.error());
    if (!frame_b) return tl::unexpected(frame_b.error());
    comparison.pixels.push_back(difference_of("frame with noise", *frame_a, *frame_b));
  }
  if (comparison.a.observer.module || comparison.b.observer.module) {
    comparison.notes.emplace_back(
        "no transfer functions: an observer that is a program returns only scores and states no blur");
    return {};
  }
  const double highest = std::max(a.samples_per_mrad(), b.samples_per_mrad());
  std::vector<double> frequencies;
  for (int i = 0; i < transfer_points; ++i) frequencies.push_back(highest * i / (transfer_points - 1));
  const auto of_a = moduli_of(comparison.a, a, plan_a, frequencies, comparison.notes);
  const auto of_b = moduli_of(comparison.b, b, plan_b, frequencies, comparison.notes);
  if (!of_a) return tl::unexpected(of_a.error());
  if (!of_b) return tl::unexpected(of_b.error());
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    comparison.transfer.push_back({frequencies[i], (*of_a)[i], (*of_b)[i]});
    if (!comparison.parts_at_per_mrad && std::abs((*of_a)[i] - (*of_b)[i]) > parting_modulus)
      comparison.parts_at_per_mrad = frequencies[i];
  }
  return {};
}

/// Adds the ratios of B to A, and the spreads over the open parameters of an observer with an eye. Two observers have
/// no spread of their ratio: its ends would pair the best of both.
void add_ratios(const FitOptions& fit, ModelComparison& comparison) {
  PackageResult &of_a = comparison.result_a, &of_b = comparison.result_b;
  of_b.ratios = paired_ratios(of_b.trials, of_a.trials, fit);
  std::ranges::move(add_spreads(fit, nullptr, of_a), std::back_inserter(comparison.notes));
  std::ranges::move(add_spreads(fit, comparison.a.kind == ModelKind::observer ? nullptr : &of_a, of_b),
                    std::back_inserter(comparison.notes));
  withhold_undecided(of_b.ratios, of_b, of_a);
  comparison.ratios = of_b.ratios;
}

}  // namespace

std::string_view to_string(ModelKind kind) {
  constexpr std::string_view names[] = {"sensor", "observer", "package"};
  return names[static_cast<std::size_t>(kind)];
}

Result<ComparedModel> read_compared_model(const std::string& reference) {
  ComparedModel model;
  model.reference = reference;
  if (reference == "none") {
    model.kind = ModelKind::package;
    model.name = model.package.name = "none";
    return model;
  }
  if (!is_file_reference(reference)) {
    const bool observer = has_name(ResourceKind::observer, reference);
    model.kind = observer ? ModelKind::observer : ModelKind::sensor;
    TODBENCH_TRY(const auto resource,
                 find_resource(observer ? ResourceKind::observer : ResourceKind::sensor, reference));
    return described(std::move(model), resource);
  }
  TODBENCH_TRY(const auto resource, find_resource(ResourceKind::sensor, reference));
  if (resource.text.find("[[stage]]") != std::string::npos) {
    TODBENCH_TRY(auto package, read_package(reference));
    model.kind = ModelKind::package;
    model.name = package.name;
    model.sha256 = package.sha256;
    model.provenance = package.provenance;
    model.package = std::move(package);
    return model;
  }
  const auto states = [&](std::string_view key) { return resource.text.find(key) != std::string::npos; };
  if (states("blur_sigma_samples") || states("[eye]")) model.kind = ModelKind::observer;
  return described(std::move(model), resource);
}

Result<ModelComparison> compare_models(const LoadedPlan& plan, ComparedModel a, ComparedModel b,
                                       const EnhancementOptions& options, std::stop_token stop) {
  if (a.kind != b.kind) {
    return fail(ErrorCode::invalid_input,
                fmt::format("{} is of the kind {}, {} of the kind {}: both models must be of the same kind",
                            one_line(a.reference), to_string(a.kind), one_line(b.reference), to_string(b.kind)));
  }
  TODBENCH_TRY_VOID(check_paired_plan(plan.plan()));
  if (auto none = refuse_modules(plan.plan(), a.kind == ModelKind::sensor ? SensorSpec{} : plan.sensor()); !none)
    return tl::unexpected(none.error());
  const auto plan_a = plan_with(plan, a), plan_b = plan_with(plan, b);
  if (!plan_a) return fail(a.name, plan_a.error());
  if (!plan_b) return fail(b.name, plan_b.error());
  ModelComparison comparison;
  comparison.keys = key_differences(a, b);
  comparison.a = std::move(a);
  comparison.b = std::move(b);
  for (const ComparedModel* side : {&comparison.a, &comparison.b}) {
    TODBENCH_TRY_VOID(refuse_finer_pictures(side->package, "a comparison of transfer functions"));
  }
  for (const LoadedPlan* side : {&*plan_a, &*plan_b}) {
    TODBENCH_TRY_VOID(check_sensor_module(side->sensor(), side->plan().simulation.motion));
  }
  const int settle = std::max(memory_frames(plan_a->sensor(), comparison.a.package),
                              memory_frames(plan_b->sensor(), comparison.b.package));
  const std::tuple<const LoadedPlan*, const ComparedModel*, PackageResult*> sides[] = {
      {&*plan_a, &comparison.a, &comparison.result_a}, {&*plan_b, &comparison.b, &comparison.result_b}};
  for (const auto& [loaded, model, result] : sides) {
    if (options.on_package) options.on_package(model->name);
    const bool package = model->kind == ModelKind::package && !model->package.stages.empty();
    *result = simulate_package(*loaded, package ? &model->package : nullptr, settle, options, stop);
    result->name = model->name;
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "interrupted");
    const bool programs = package || has_modules(loaded->plan(), loaded->sensor());
    if (result->error && !programs) return fail(model->name, *result->error);
  }
  add_ratios(fit_options(plan.plan()), comparison);
  if (comparison.result_a.error || comparison.result_b.error) {
    comparison.notes.push_back("no pictures and no transfer functions: a module failed");
  } else if (auto compared = compare_pictures(comparison, *plan_a, *plan_b); !compared) {
    return tl::unexpected(compared.error());
  }
  return comparison;
}

std::optional<bool> parts(const PairedRatio& ratio) {
  if (!ratio.ci95.low || !ratio.ci95.high) return std::nullopt;
  return *ratio.ci95.low > 1 || *ratio.ci95.high < 1;
}

}  // namespace todbench
