// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/physical_measures.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/devices/camera_settings.h"
#include "bench/devices/plate_picture.h"
#include "bench/plan/collimator.h"
#include "bench/plan/plan_options.h"
#include "bench/twin/module_chain.h"
#include "bench/twin/simulated_responses.h"
#include "sim_devices/sensor/effect_row.h"
#include "sim_devices/sensor/image_chain.h"
#include "sim_devices/sensor/module_sensor.h"
#include "sim_devices/sensor/sensor_model.h"
#include "sim_devices/sensor/transfer_functions.h"
#include "tod/range/bars_sampled.h"

namespace todbench {
namespace {

constexpr double zero_celsius_k = 273.15;

/// Adds the transfer function of the sensor along the normal of each edge. Its frequencies are per detector pitch,
/// those of a picture per sample.
void add_closed_form(MtfMeasure& mtf, const SensorModel& model, const ExperimentInputs& inputs) {
  const TransferFunction transfer =
      sensor_transfer(model.spec(), model.plan(), inputs.accuracy.wavelengths, inputs.motion);
  const int samples = model.spec().samples_per_pitch();
  for (EdgeMtf& edge : mtf.edges) {
    const double angle = edge.angle_deg * std::numbers::pi / 180;
    const double along = std::cos(angle), across = std::sin(angle);
    for (const double f : edge.frequency_per_pitch) {
      const double u = f * samples * along, w = f * samples * across;
      edge.model.push_back(std::abs(edge.axis == EdgeAxis::x ? transfer(u, w) : transfer(w, u)));
    }
  }
}

/// Adds the same for the bars of each group: their spectrum through the sensor's transfer function along the normal,
/// sampled once per pitch. The pitch is that of the samples; with microscan a detector has several.
void add_closed_form(CtfMeasure& ctf, const SensorModel& model, const ExperimentInputs& inputs) {
  const TransferFunction transfer =
      sensor_transfer(model.spec(), model.plan(), inputs.accuracy.wavelengths, inputs.motion);
  const int samples = model.spec().samples_per_pitch();
  constexpr double least_transfer = 1e-6;
  constexpr double widest_band = 16, band_step = 0.5;  // cycles per sample
  for (BarsCtf& group : ctf.bars.groups) {
    const double angle = group.angle_deg * std::numbers::pi / 180;
    const double along = std::cos(angle), across = std::sin(angle);
    const auto of = [&](double f) {
      const double u = f * samples * along, w = f * samples * across;
      return std::real(group.axis == EdgeAxis::x ? transfer(u, w) : transfer(w, u));
    };
    double band = widest_band;
    while (band > 1 && std::abs(of(band)) < least_transfer && std::abs(of(band - 0.5 * band_step)) < least_transfer)
      band -= band_step;
    const BarModulation found = bar_modulation(BlurredBars(group.frequency_per_pitch, of, band));
    group.model = BarsModel{found.best, found.mean, found.worst};
  }
}

/// Adds the loss of a square source of the stated side against the reference, by image formation without noise. Sides
/// are in samples.
void add_closed_form(SourceSizeMeasure& source, const SensorModel& model, const ExperimentInputs& inputs) {
  const ImageChain chain(model.spec(), model.plan(), inputs.accuracy, inputs.motion);
  const int samples = model.spec().samples_per_pitch();
  const auto in_the_middle = [&](double side_px) {
    const double half = 0.5 * side_px / samples;
    const Polygon square{{-half, -half}, {half, -half}, {half, half}, {-half, half}};
    return chain.infinite_plane(square, {0, 0}, 1, {1, 1}).values(0, 0);
  };
  source.model_loss = 1 - in_the_middle(source.stated_px) / in_the_middle(source.effect.reference_px);
}

std::optional<PixelOptions> pixel_options(const Plan& plan) {
  const MeasuresPlan& measures = plan.measures;
  if (!measures.pixels) return std::nullopt;
  PixelOptions options{.whole_frame = measures.pixels_area == PixelArea::frame, .rules = {}, .zones = {}};
  options.rules.bad = bad_pixel_rules(measures);
  options.rules.blinking = measures.pixels_blinking;
  for (const ZoneLimit& zone : plan.limits.zones) {
    if (zone.name != whole_frame_zone)
      options.zones.push_back({zone.name, zone.area[0], zone.area[1], zone.area[2], zone.area[3]});
  }
  return options;
}

std::optional<ResponseOptions> response_options(const Plan& plan) {
  const MeasuresPlan& measures = plan.measures;
  if (!measures.response && !measures.gain_control) return std::nullopt;
  ResponseOptions options;
  options.delta_t_k = measures.response_delta_t_k;
  options.steps = measures.response_steps, options.frames = measures.response_frames;
  if (measures.response_settling_ms) options.settling_s = 1e-3 * *measures.response_settling_ms;
  return options;
}

/// Standard uncertainty of the temperature that a correct camera shows: rows of the black body in kelvin, and the
/// transmission of a collimator for the largest distance from its mirrors.
double source_u_k(const Plan& plan) {
  double variance = 0;
  for (const BudgetRow& row : plan.uncertainty.rows) {
    const BudgetInput input = input_of(row);
    const auto unit = budget_unit(InputKind::contrast, row.unit);
    const bool of_black_body =
        input == BudgetInput::black_body_calibration || input == BudgetInput::black_body_emissivity ||
        input == BudgetInput::black_body_ambient || input == BudgetInput::black_body_uniformity ||
        input == BudgetInput::black_body_stability;
    if (of_black_body && unit && !unit->relative && !row.sensitivity)
      variance += std::pow(standard_of(row) * unit->factor, 2);
  }
  const CollimatorPlan& collimator = plan.target.collimator;
  if (!collimator.stated()) return std::sqrt(variance);
  const double mirrors_k = collimator.mirror_temperature_c.value_or(plan.target.air_temperature_c) + zero_celsius_k;
  double farthest_k = 0;
  for (const double temperature_k : plan.measures.absolute_temperatures_k)
    farthest_k = std::max(farthest_k, std::abs(temperature_k - mirrors_k));
  return std::hypot(std::sqrt(variance), collimator.transmission_u * farthest_k);
}

std::optional<AbsoluteOptions> absolute_options(const Plan& plan, const ExperimentInputs& inputs) {
  const MeasuresPlan& measures = plan.measures;
  if (!measures.absolute || !inputs.open_plate) return std::nullopt;
  AbsoluteOptions options{.plate = inputs.open_plate->name,
                          .temperatures_k = measures.absolute_temperatures_k,
                          .frames = measures.absolute_frames,
                          .shift_px = measures.absolute_shift_px,
                          .pixel_mm = plan.camera.ifov_mrad * plan.target.distance_m,
                          .pixel_aspect = plan.camera.pixel_aspect,
                          .source_u_k = source_u_k(plan)};
  const SpectralBand band{inputs.sensor.wavelength_min_um, inputs.sensor.wavelength_max_um};
  if (plan.target.collimator.stated())
    options.expected_k = [plan, band](double black_body_k) { return seen_through_k(plan, band, black_body_k); };
  return options;
}

std::optional<LatencyOptions> latency_options(const Plan& plan, const ExperimentInputs& inputs) {
  if (!plan.measures.latency || inputs.plates.empty()) return std::nullopt;
  // The plate stays in the picture: it moves by a tenth of its width.
  constexpr double share_of_plate = 0.1;
  return LatencyOptions{.speed_mm_s = plan.measures.latency_mrad_s * plan.target.distance_m,
                        .travel_mm = share_of_plate * inputs.plates.front().width_mm,
                        .runs = plan.measures.latency_runs};
}

std::optional<MrtdOptions> mrtd_options(const Plan& plan, const ExperimentInputs& inputs) {
  const MeasuresPlan& measures = plan.measures;
  if (!measures.mrtd || !inputs.mrtd_plate) return std::nullopt;
  MrtdOptions options{.plate = *inputs.mrtd_plate,
                      .contrasts_k = measures.mrtd_delta_t_k,
                      .frames = measures.mrtd_frames,
                      .set_ups = measures.mrtd_set_ups,
                      .mountings = plan.target.mountings,
                      .frequency_per_pitch = measures.mrtd_frequency_per_pitch,
                      .spot_px = measures.mdtd_size_px,
                      .kept_frames = measures.mrtd_kept_frames,
                      .observer = inputs.observer,
                      .seed = plan.seed};
  return options;
}

std::vector<double> triangle_contrasts(const Plan& plan) {
  return plan.measures.triangles ? plan.target.delta_t_k : std::vector<double>{};
}

/// Temporal noise of a sample in one frame over the response of a correct scale: white noise with its correlation in
/// averaged exposures, rows, columns, rounding. Empty if a stage behind the noise changes it.
std::optional<double> closed_form_netd_k(const SensorSpec& spec, const SensorPlan& plan) {
  if (!is_neutral(spec, Effect::display) || spec.defective_pixel_share > 0) return std::nullopt;
  const double lines_k2 = std::pow(spec.row_noise_k, 2) + std::pow(spec.column_noise_k, 2);
  return std::sqrt(white_variance_k2(spec, plan, 1) + lines_k2 / spec.exposures_per_sample());
}

using MaybeMeasures = Result<std::optional<CameraMeasures>>;

/// physical_measures() without messages. Precondition: the plan requests some.
MaybeMeasures measures_of_bench(const Plan& plan, const MeasurementOptions& options, const ExperimentInputs& inputs,
                                OpenedBench& bench, std::stop_token stop) {
  TODBENCH_TRY(auto measures,
               measure_camera(*bench.camera, *bench.target,
                              {.noise = plan.measures.noise,
                               .noise_frames = plan.measures.noise_frames,
                               .pixels = pixel_options(plan),
                               .drift_s = plan.measures.drift ? std::optional(plan.measures.drift_s) : std::nullopt,
                               .response = plan.measures.response ? response_options(plan) : std::nullopt,
                               .geometry = plan.measures.geometry,
                               .transfer = plan.measures.transfer,
                               .transfer_steps_k = plan.measures.transfer_steps_k,
                               .triangles_k = triangle_contrasts(plan),
                               .mtf_plate = inputs.mtf_plate,
                               .mtf_delta_t_k = plan.measures.mtf_delta_t_k,
                               .mtf_frames = plan.measures.mtf_frames,
                               .mtf_frequency_per_pitch = plan.measures.mtf_frequency_per_pitch,
                               .ctf_plate = inputs.ctf_plate,
                               .ctf_delta_t_k = plan.measures.ctf_delta_t_k,
                               .ctf_frames = plan.measures.ctf_frames,
                               .ctf_frequency_per_pitch = plan.measures.ctf_frequency_per_pitch,
                               .source_plate = inputs.source_plate,
                               .source_delta_t_k = plan.measures.source_size_delta_t_k,
                               .source_frames = plan.measures.source_size_frames,
                               .source_size_px = plan.measures.source_size_px,
                               .absolute = absolute_options(plan, inputs),
                               .timing_frames = plan.measures.timing ? plan.measures.timing_frames : 0,
                               .latency = latency_options(plan, inputs),
                               .mrtd = mrtd_options(plan, inputs),
                               .gain_control = plan.measures.gain_control ? response_options(plan) : std::nullopt,
                               .measurement = options},
                              *bench.host, std::move(stop)));
  if (measures.geometry) {
    if (const double u = relative_u_of_distance(plan); u > 0) measures.geometry->distance_relative_u = u;
  }
  return measures;
}

/// Reports progress, waits for `make`, and reports measures that failed. Empty if the plan requests none.
template <typename Make>
MaybeMeasures with_words(const Plan& plan, const OpenSession& open, const Make& make) {
  if (!plan.measures.any()) return std::nullopt;
  phase(open.folder, open.listener, "physical measures");
  MaybeMeasures made = make();
  if (!made || !*made) return made;
  for (const auto& reason : (*made)->reasons) note(open.folder, open.listener, reason);
  return made;
}

}  // namespace

Result<std::optional<CameraMeasures>> physical_measures(const Plan& plan, const MeasurementOptions& options,
                                                        const ExperimentInputs& inputs, OpenedBench& bench,
                                                        const OpenSession& open, std::stop_token stop) {
  return with_words(plan, open, [&] {
    auto made = measures_of_bench(plan, options, inputs, bench, std::move(stop));
    if (!made || !*made) return made;
    const std::vector<ChangedSetting> changed = changed_settings(*bench.camera, bench.camera->info());
    // Counts of two scales are mixed in the numbers: none is stated.
    if (std::ranges::any_of(changed, [](const ChangedSetting& one) { return scales_counts(one.feature); }))
      **made = CameraMeasures{};
    for (const ChangedSetting& one : changed)
      (*made)->reasons.push_back("a setting changed before the end of the physical measures: " + sentence(one));
    return made;
  });
}

namespace {

std::shared_ptr<const SensorModel> whole_sensor(const LoadedPlan& loaded, const ExperimentInputs& inputs) {
  SensorSpec sensor = loaded.parts().sensor;
  sensor.microscan = loaded.plan().simulation.microscan;
  // The response to a contrast step needs the effects of motion.
  const SceneMotion motion = loaded.plan().measures.response ? any_motion : SceneMotion{};
  return std::make_shared<const SensorModel>(sensor, full_plan(sensor, {}, {}, motion), inputs.accuracy,
                                             loaded.plan().seed);
}

void compare_with(CameraMeasures& measures, const SensorModel& model, const ExperimentInputs& inputs) {
  if (!measures.view || inputs.plates.empty()) return;
  auto picture = plate_picture(*measures.view, inputs.plates.front(), model, inputs.motion);
  if (picture)
    measures.picture = *std::move(picture);
  else
    measures.reasons.push_back("picture of the plate: " + picture.error().message);
}

}  // namespace

void compare_picture(CameraMeasures& measures, const LoadedPlan& loaded, const ExperimentInputs& inputs) {
  if (loaded.plan().camera.contrast == ContrastUnit::grey_levels) return;  // the sensor model is in kelvin
  compare_with(measures, *whole_sensor(loaded, inputs), inputs);
}

namespace {

/// simulated_measures() without messages. Precondition: the plan requests some.
MaybeMeasures measures_of_sensor(const LoadedPlan& loaded, const ExperimentInputs& inputs, std::stop_token stop) {
  Plan plan = loaded.plan();
  // A scene has no absolute set-point and no clock, and the sensor no automatic gain: these measures are those of a
  // real camera.
  plan.measures.absolute = plan.measures.timing = plan.measures.latency = plan.measures.gain_control = false;
  plan.measures.mrtd_kept_frames = 0;  // people judge the camera
  const auto model = whole_sensor(loaded, inputs);
  // The sensor does not drift, so the default time is enough; a program in its place gets the shortest.
  plan.measures.drift_s =
      sensor_module(model->spec()) == nullptr ? std::min(plan.measures.drift_s, MeasuresPlan{}.drift_s) : 2;
  MeasurementOptions options = simulated_options(plan, inputs);
  TODBENCH_TRY(options.contrast_response, simulated_responses(*model, plan, inputs.plates, options, stop));
  OpenedBench bench = simulated_bench(model, loaded.shown_plates(), plan.target.distance_m, {}, inputs.motion);
  auto measures = measures_of_bench(plan, options, inputs, bench, std::move(stop));
  if (measures && *measures) compare_with(**measures, *model, inputs);
  if (measures && *measures && (*measures)->noise)
    (*measures)->netd_model_k = closed_form_netd_k(model->spec(), model->plan());
  if (measures && *measures && plan.measures.response) (*measures)->response_model_ms = model->spec().time_constant_ms;
  if (measures && *measures && (*measures)->geometry) {
    (*measures)->geometry->distance_relative_u.reset();  // the distance of the scene is exact
    (*measures)->geometry->model_ifov_mrad = model->spec().ifov_mrad() / model->spec().samples_per_pitch();
    (*measures)->geometry->model_distortion_percent =
        model->spec().distortion_percent + model->spec().distortion_r4_percent;
  }
  if (measures && *measures && (*measures)->mtf) add_closed_form(*(*measures)->mtf, *model, inputs);
  if (measures && *measures && (*measures)->ctf) add_closed_form(*(*measures)->ctf, *model, inputs);
  if (measures && *measures && (*measures)->source) add_closed_form(*(*measures)->source, *model, inputs);
  return measures;
}

}  // namespace

Result<std::optional<CameraMeasures>> simulated_measures(const LoadedPlan& loaded, const ExperimentInputs& inputs,
                                                         const OpenSession& open, std::stop_token stop) {
  return with_words(loaded.plan(), open, [&] { return measures_of_sensor(loaded, inputs, std::move(stop)); });
}

BackgroundMeasures::BackgroundMeasures(const LoadedPlan& loaded, const ExperimentInputs& inputs)
    : loaded_(loaded), inputs_(inputs) {
  if (!loaded.plan().measures.any() || has_modules(loaded.plan(), inputs.sensor)) return;
  made_.emplace([this](std::stop_token stop) { return measures_of_sensor(loaded_, inputs_, std::move(stop)); });
}

Result<std::optional<CameraMeasures>> BackgroundMeasures::take(const OpenSession& open, std::stop_token stop) {
  if (!made_) return simulated_measures(loaded_, inputs_, open, std::move(stop));
  return with_words(loaded_.plan(), open, [&] { return made_->get(std::move(stop)); });
}

}  // namespace todbench
