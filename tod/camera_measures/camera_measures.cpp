// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/camera_measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <span>

#include "acquisition/base/median.h"
#include "acquisition/base/try.h"
#include "tod/measurement/set_up_step.h"
#include "tod/measurement/target_change.h"
#include "tod/presentation/absolute_target.h"
#include "tod/presentation/largest_contrast.h"
#include "tod/presentation/target_failure.h"
#include "tod/registration/registration.h"

namespace todbench {
namespace {

constexpr int least_side_px = 8;
constexpr double found_within_px = 6;  // of the expected place of a moving plate

/// A target at an absolute temperature instead of a contrast.
class TargetAtTemperature final : public Target {
 public:
  TargetAtTemperature(Target& target, AbsoluteTarget& absolute) : target_(target), absolute_(absolute) {}
  void set(double temperature_k) { temperature_k_ = temperature_k; }
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return target_.capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    return absolute_.present_temperature(state, temperature_k_, std::move(stop));
  }

 private:
  Target& target_;
  AbsoluteTarget& absolute_;
  double temperature_k_ = 0;
};

/// A target that first finishes work on earlier frames. Frames are taken meanwhile, so that none is lost.
class TargetAfterWork final : public Target {
 public:
  TargetAfterWork(Target& target, const std::function<void()>& work) : target_(target), work_(work) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return target_.capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    work_();
    return target_.present(state, std::move(stop));
  }

 private:
  Target& target_;
  const std::function<void()>& work_;
};

class Run {
 public:
  Run(FrameSource& source, Target& target, const CameraMeasuresOptions& options, RunController& host,
      std::stop_token stop)
      : source_(source),
        target_(target),
        options_(options),
        host_(host),
        stop_(std::move(stop)),
        taker_(source, taker_options(options.measurement, source.info(), {})) {}

  Result<CameraMeasures> operator()() {
    CameraMeasures measures;
    TODBENCH_TRY_VOID(keep(measures, "physical measures", locate(measures)));
    if (!located_) return measures;
    for (const Step& step : steps()) {
      if (!step.requested(options_)) continue;
      TODBENCH_TRY_VOID(keep(measures, step.name, (this->*step.take)(measures)));
    }
    return measures;
  }

 private:
  /// A measure, with its name in reasons.
  struct Step {
    const char* name;
    bool (*requested)(const CameraMeasuresOptions& options);
    Result<void> (Run::*take)(CameraMeasures& measures);
  };

  /// All measures in their order. Those with a plate of their own come last.
  static std::span<const Step> steps() {
    using Options = CameraMeasuresOptions;
    static constexpr std::array table{
        Step{"signal transfer", [](const Options& o) { return o.transfer; }, &Run::measure_transfer},
        Step{"noise", [](const Options& o) { return o.noise; }, &Run::measure_noise},
        Step{"drift", [](const Options& o) { return o.drift_s.has_value(); }, &Run::follow_drift},
        Step{"response time", [](const Options& o) { return o.response.has_value(); }, &Run::time_response},
        Step{"gain control", [](const Options& o) { return o.gain_control.has_value(); }, &Run::describe_gain},
        Step{"smallest triangles", [](const Options& o) { return !o.triangles_k.empty(); }, &Run::show_triangles},
        Step{"MTF", [](const Options& o) { return o.mtf_plate.has_value(); }, &Run::measure_mtf},
        Step{"CTF", [](const Options& o) { return o.ctf_plate.has_value(); }, &Run::measure_ctf},
        Step{"size-of-source effect", [](const Options& o) { return o.source_plate.has_value(); },
             &Run::measure_source},
        Step{"times of frames", [](const Options& o) { return o.timing_frames > 0; }, &Run::time_frames},
        Step{"latency", [](const Options& o) { return o.latency.has_value(); }, &Run::time_latency},
        Step{"absolute temperatures", [](const Options& o) { return o.absolute.has_value(); }, &Run::show_temperatures},
        Step{"MRTD", [](const Options& o) { return o.mrtd.has_value(); }, &Run::take_mrtd}};
    return table;
  }

  /// Turns the error of a measure into a reason; returns it if the run was interrupted.
  static Result<void> keep(CameraMeasures& measures, const char* name, const Result<void>& taken) {
    if (taken) return {};
    if (taken.error().code == ErrorCode::interrupted) return tl::unexpected(taken.error());
    measures.reasons.push_back(std::string(name) + ": " + taken.error().message);
    return {};
  }

  [[nodiscard]] double transmittance() const { return options_.measurement.air_transmittance.value_or(1); }

  [[nodiscard]] const TargetPlate& plate() const { return options_.measurement.plates.front(); }

  /// Shows the first plate at a contrast; returns the state that the target reported.
  Result<PresentedTarget> show(double delta_t_k) { return show(plate().name, delta_t_k); }

  Result<PresentedTarget> show(const std::string& plate_name, double delta_t_k) {
    return show_state({plate_name, Mounting::identity, delta_t_k, {0, 0}});
  }

  Result<PresentedTarget> show_state(const TargetState& state) {
    if (stop_.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    return present(target_, taker_, state);
  }

  /// Locates the plate at the contrast that shows it best.
  Result<void> locate(CameraMeasures& measures) {
    const double largest = largest_contrast_k(options_.transfer_steps_k);
    if (largest == 0)
      return fail(ErrorCode::invalid_input, "the plate cannot be located, because all contrasts of the steps are 0 K");
    TODBENCH_TRY(const auto shown, show(largest));
    TODBENCH_TRY(auto picture, taker_.average(options_.measurement.registration_frames, stop_));
    auto found = register_plate(picture.kelvin, plate(), registration());
    if (!found) return fail("finding the plate", found.error());
    where_ = *found;
    learn_response(picture.kelvin, shown.state.delta_t_k);
    keep_view(measures, picture, largest);
    if (options_.geometry) tell_geometry(measures, picture, largest);
    located_ = true;
    return {};
  }

  [[nodiscard]] RegistrationOptions registration() const {
    RegistrationOptions out = options_.measurement.registration;
    out.expected_scale_px_per_mm = 1 / (options_.measurement.distance_m * options_.measurement.ifov_mrad);
    return out;
  }

  /// Response of the camera to a contrast of the target; stays 1 if the triangles are too small.
  void learn_response(const cv::Mat1d& picture, double said_k) {
    const auto seen = effective_contrast(picture, plate(), where_, options_.measurement.min_reference_px);
    if (seen && std::isfinite(seen->value / said_k) && seen->value != 0) response_ = seen->value / said_k;
  }

  void tell_geometry(CameraMeasures& measures, const AveragedPicture& picture, double delta_t_k) {
    auto found = plate_geometry(picture.kelvin, plate(), where_);
    if (!found) {
      measures.reasons.push_back("IFOV and distortion: " + found.error().message);
      return;
    }
    measures.geometry = GeometryMeasure{.plate = plate().name,
                                        .frames = options_.measurement.registration_frames,
                                        .set_delta_t_k = delta_t_k,
                                        .distance_m = options_.measurement.distance_m,
                                        .stated_ifov_mrad = options_.measurement.ifov_mrad,
                                        .pixel_aspect = where_.pixel_aspect,
                                        .picture = picture.kelvin.size(),
                                        .geometry = *std::move(found)};
  }

  void keep_view(CameraMeasures& measures, const AveragedPicture& picture, double delta_t_k) {
    const auto where = field();
    if (!where) return;
    measures.view = PlateView{.frames = options_.measurement.registration_frames,
                              .set_delta_t_k = delta_t_k,
                              .where = where_,
                              .picture = picture.kelvin.size(),
                              .field = *where,
                              .kelvin = picture.kelvin(*where).clone(),
                              .temporal_noise_k = picture.temporal_noise_k};
  }

  Result<void> measure_transfer(CameraMeasures& measures) {
    TransferMeasure transfer;
    transfer.frames_each = options_.measurement.contrast_frames;
    const auto response = options_.measurement.contrast_response.find(plate().name);
    const double divisor = response == options_.measurement.contrast_response.end() ? 1 : response->second;
    for (const double set_k : options_.transfer_steps_k) {
      TODBENCH_TRY(const auto shown, show(set_k));
      TODBENCH_TRY(auto picture, taker_.average(options_.measurement.contrast_frames, stop_));
      TODBENCH_TRY(const auto seen,
                   effective_contrast(picture.kelvin, plate(), where_, options_.measurement.min_reference_px));
      if (options_.pixels) step_pictures_.push_back({shown.state.delta_t_k, picture.kelvin.clone()});
      transfer.steps.push_back({set_k, shown.state.delta_t_k, seen.value / divisor, seen.standard_error / divisor});
    }
    std::vector<TemperatureStep> steps;
    const bool known = std::all_of(transfer.steps.begin(), transfer.steps.end(),
                                   [](const TransferStep& step) { return step.seen_u_k > 0; });
    for (const TransferStep& step : transfer.steps)
      steps.push_back({step.said_delta_t_k, step.seen_delta_t_k, known ? std::optional(step.seen_u_k) : std::nullopt});
    TODBENCH_TRY(transfer.line, signal_transfer(steps));
    measures.transfer = std::move(transfer);
    return {};
  }

  /// The mean picture round the smallest triangles at a contrast.
  Result<TriangleStrip> triangles_at(double contrast_k) {
    constexpr int shown_triangles = 6;
    TODBENCH_TRY_VOID(show(contrast_k));
    TODBENCH_TRY(const auto picture, taker_.average(options_.measurement.contrast_frames, stop_));
    TriangleStrip strip = smallest_triangles(picture.kelvin, plate(), where_, shown_triangles);
    strip.set_delta_t_k = contrast_k, strip.frames = options_.measurement.contrast_frames;
    return strip;
  }

  /// A contrast that fails adds a reason.
  Result<void> show_triangles(CameraMeasures& measures) {
    for (const double contrast_k : options_.triangles_k) {
      auto strip = triangles_at(contrast_k);
      if (strip)
        measures.triangles.push_back(*std::move(strip));
      else if (auto kept = keep(measures, "smallest triangles", tl::unexpected(strip.error())); !kept)
        return kept;
    }
    return {};
  }

  /// Sides that could not be measured add reasons.
  Result<void> measure_mtf(CameraMeasures& measures) {
    const TargetPlate& edge_plate = *options_.mtf_plate;
    TODBENCH_TRY(const auto shown, show(edge_plate.name, options_.mtf_delta_t_k));
    TODBENCH_TRY(const auto picture, taker_.average(options_.mtf_frames, stop_));
    TODBENCH_TRY(auto found, plate_edges(picture.kelvin, edge_plate, where_));
    MtfMeasure mtf;
    mtf.plate = edge_plate.name;
    mtf.frames = options_.mtf_frames;
    mtf.set_delta_t_k = options_.mtf_delta_t_k, mtf.said_delta_t_k = shown.state.delta_t_k;
    mtf.pitch_mrad = options_.measurement.ifov_mrad;
    mtf.frequency_per_pitch = options_.mtf_frequency_per_pitch;
    mtf.edges = std::move(found.edges);
    measures.reasons.insert(measures.reasons.end(), found.reasons.begin(), found.reasons.end());
    if (mtf.edges.empty()) return fail(ErrorCode::calibration, "no edge of the plate could be measured");
    measures.mtf = std::move(mtf);
    return {};
  }

  /// Groups that could not be measured add reasons.
  Result<void> measure_ctf(CameraMeasures& measures) {
    const TargetPlate& bars_plate = *options_.ctf_plate;
    TODBENCH_TRY(const auto shown, show(bars_plate.name, options_.ctf_delta_t_k));
    TODBENCH_TRY(const auto picture, taker_.average(options_.ctf_frames, stop_));
    TODBENCH_TRY(auto found, plate_bars_ctf(picture.kelvin, bars_plate, where_));
    measures.reasons.insert(measures.reasons.end(), found.reasons.begin(), found.reasons.end());
    if (found.groups.empty()) return fail(ErrorCode::calibration, "no group of bars could be measured");
    CtfMeasure ctf;
    ctf.plate = bars_plate.name;
    ctf.frames = options_.ctf_frames;
    ctf.set_delta_t_k = options_.ctf_delta_t_k, ctf.said_delta_t_k = shown.state.delta_t_k;
    ctf.pitch_mrad = options_.measurement.ifov_mrad;
    ctf.frequency_per_pitch = options_.ctf_frequency_per_pitch;
    ctf.bars = std::move(found);
    measures.ctf = std::move(ctf);
    return {};
  }

  /// The source plate at a contrast: the target's report and the mean picture.
  struct Shown {
    double said_delta_t_k = 0;
    std::optional<double> plate_k{};  ///< of the plate, if a sensor reports it
    cv::Mat1d picture;
  };
  Result<Shown> source_at(double delta_t_k) {
    TODBENCH_TRY(const PresentedTarget shown, show(options_.source_plate->name, delta_t_k));
    TODBENCH_TRY(const AveragedPicture picture, taker_.average(options_.source_frames, stop_));
    return Shown{shown.state.delta_t_k, shown.plate_temperature_k, picture.kelvin.clone()};
  }

  Result<void> measure_source(CameraMeasures& measures) {
    TODBENCH_TRY(const Shown before, source_at(0));
    TODBENCH_TRY(const Shown lit, source_at(options_.source_delta_t_k));
    TODBENCH_TRY(const Shown after, source_at(0));
    const double said_k = lit.said_delta_t_k - 0.5 * (before.said_delta_t_k + after.said_delta_t_k);
    SourcePictures pictures{before.picture, lit.picture, after.picture};
    if (before.plate_k && lit.plate_k && after.plate_k && said_k != 0)
      pictures.plate_rise = transmittance() * (*lit.plate_k - 0.5 * (*before.plate_k + *after.plate_k)) / said_k;
    TODBENCH_TRY(SourceSize effect, source_size(pictures, *options_.source_plate, where_));
    measures.source = SourceSizeMeasure{.plate = options_.source_plate->name,
                                        .frames = options_.source_frames,
                                        .set_delta_t_k = options_.source_delta_t_k,
                                        .said_delta_t_k = said_k,
                                        .stated_px = options_.source_size_px,
                                        .effect = std::move(effect)};
    return {};
  }

  Result<void> time_frames(CameraMeasures& measures) {
    TODBENCH_TRY_VOID(show(0));
    TODBENCH_TRY(measures.timing, measure_timing(taker_, options_.timing_frames, stop_));
    if (source_.info().frame_rate_hz > 0) measures.timing->stated_rate_hz = source_.info().frame_rate_hz;
    return {};
  }

  /// Presents a state of `target`, in which a target may stand for that of the run. The returned contrast is that
  /// behind air and collimator, if their transmittance is stated.
  Result<PresentedTarget> present(Target& target, FrameTaker& taker, const TargetState& state) {
    TODBENCH_TRY(const TargetChange change, change_target(target, taker, host_, state, stop_));
    if (!change.frames) return tl::unexpected(change.frames.error());
    if (!change.presented) return target_failure("presenting the target", change.presented.error());
    TODBENCH_TRY(const std::int64_t there_ns, host_.now_ns(Moment::scene_changed));
    taker.scene_changed(there_ns);
    PresentedTarget shown = *change.presented;
    shown.state.delta_t_k *= transmittance();
    return shown;
  }

  Result<void> time_latency(CameraMeasures& measures) {
    const double contrast_k = largest_contrast_k(options_.transfer_steps_k);
    const auto put = [&](double x_mm) -> Result<void> {
      const auto shown = present(target_, taker_, {plate().name, Mounting::identity, contrast_k, {x_mm, 0}});
      return shown ? Result<void>() : tl::unexpected(shown.error());
    };
    const auto place = [&](const Frame& frame, double expected_mm) -> std::optional<double> {
      const auto kelvin = to_kelvin(frame);
      if (!kelvin) return std::nullopt;
      const Registration expected = where_.shifted({expected_mm, 0});
      const auto off_px = measure_shift(*kelvin, plate(), expected, registration(), found_within_px);
      if (!off_px) return std::nullopt;
      const cv::Point2d mm_px = where_.pixel({1, 0}) - where_.pixel({0, 0});
      return expected_mm + off_px->dot(mm_px) / mm_px.dot(mm_px);
    };
    TODBENCH_TRY(measures.latency, measure_latency(taker_, target_.moving(), put, place, *options_.latency, stop_));
    return {};
  }

  Result<void> show_temperatures(CameraMeasures& measures) {
    AbsoluteTarget* const absolute = absolute_target(target_);
    if (absolute == nullptr)
      return fail(ErrorCode::invalid_input, "the target has no black body with an absolute set-point");
    TargetAtTemperature at(target_, *absolute);
    FrameTakerOptions taking = taker_options(options_.measurement, source_.info(), {});
    taking.integrity.max_saturated_share = 1;  // saturation is a result
    taking.integrity.reject_frozen = false;    // a saturated picture does not change
    FrameTaker taker(source_, taking);
    const ShowTemperature show_at = [&](double temperature_k, cv::Point2d shift_mm) {
      at.set(temperature_k);
      return present(at, taker, {options_.absolute->plate, Mounting::identity, 0, shift_mm});
    };
    AbsoluteOptions options = *options_.absolute;
    options.camera_temperature_c = [this] { return camera_temperature_c(); };
    TODBENCH_TRY(measures.absolute, measure_absolute(taker, show_at, options, stop_));
    measures.reasons.insert(measures.reasons.end(), measures.absolute->reasons.begin(),
                            measures.absolute->reasons.end());
    return {};
  }

  /// By the camera's own sensor; empty: it has none.
  [[nodiscard]] std::optional<double> camera_temperature_c() {
    const auto text = source_.get("DeviceTemperature");  // SFNC
    if (!text) return std::nullopt;
    double value = 0;
    const auto read = std::from_chars(text->data(), text->data() + text->size(), value);
    return read.ec == std::errc() && std::isfinite(value) ? std::optional(value) : std::nullopt;
  }

  Result<GainLevel> gain_level(double set_k) {
    TODBENCH_TRY(const PresentedTarget shown, show(set_k));
    TODBENCH_TRY_VOID(taken_to_settle());
    TODBENCH_TRY(const AveragedPicture picture, taker_.average(options_.measurement.contrast_frames, stop_));
    TODBENCH_TRY(const cv::Rect where, field());
    TODBENCH_TRY(const EffectiveContrast seen,
                 effective_contrast(picture.kelvin, plate(), where_, options_.measurement.min_reference_px));
    const cv::Mat1d part = picture.kelvin(where).clone();
    GainLevel level{.set_delta_t_k = set_k,
                    .said_delta_t_k = shown.state.delta_t_k,
                    .surround = median(std::vector<double>(part.begin(), part.end())),
                    .contrast = seen.value,
                    .contrast_u = seen.standard_error,
                    .triangles = seen.triangles};
    cv::minMaxLoc(part, &level.lowest, &level.highest);
    return level;
  }

  /// Takes as many frames as are recorded after a step, so that the gain settles.
  Result<void> taken_to_settle() {
    for (int k = 0; k < options_.gain_control->frames; ++k) {
      TODBENCH_TRY_VOID(taker_.next_of_moving_scene(stop_));
    }
    return {};
  }

  Result<void> describe_gain(CameraMeasures& measures) {
    GainControlMeasure gain{.unit = options_.measurement.contrast_unit == ContrastUnit::grey_levels ? "count" : "K",
                            .frames = options_.measurement.contrast_frames};
    for (const double set_k : options_.transfer_steps_k) {
      TODBENCH_TRY(const GainLevel level, gain_level(set_k));
      gain.levels.push_back(level);
    }
    TODBENCH_TRY(const cv::Rect where, field());
    ResponseOptions steps = *options_.gain_control;
    steps.plate = plate().name;
    steps.contrast_frames = options_.measurement.contrast_frames;
    steps.signal = StepSignal::surround;
    auto settling = measure_response(taker_, target_, host_, where, steps, source_.info().frame_rate_hz, stop_);
    if (settling)
      gain.settling = *std::move(settling);
    else if (auto kept = keep(measures, "settling of the gain", tl::unexpected(settling.error())); !kept)
      return kept;
    measures.gain_control = std::move(gain);
    return {};
  }

  Result<void> take_mrtd(CameraMeasures& measures) {
    MrtdOptions mrtd = *options_.mrtd;
    mrtd.pitch_mrad = options_.measurement.ifov_mrad;
    mrtd.registration_frames = options_.measurement.registration_frames;
    mrtd.response = response_;
    mrtd.locating_k = largest_contrast_k(options_.transfer_steps_k);
    const ShowState show = [this](const TargetState& state, const std::function<void()>& work) {
      TargetAfterWork target(target_, work);
      return present(target, taker_, state);
    };
    TODBENCH_TRY(MrtdMeasure found, measure_mrtd(taker_, show, where_, mrtd, stop_));
    measures.reasons.insert(measures.reasons.end(), found.reasons.begin(), found.reasons.end());
    measures.mrtd = std::move(found);
    return {};
  }

  /// The upright rectangle of the picture that the plate covers, without its rim.
  [[nodiscard]] Result<cv::Rect> field() const {
    const double w = plate().width_mm / 2, h = plate().height_mm / 2;
    const cv::Point2d corners[] = {where_.pixel({-w, -h}), where_.pixel({w, -h}), where_.pixel({-w, h}),
                                   where_.pixel({w, h})};
    constexpr double rim_px = 2;
    const double left = std::max(corners[0].x, corners[2].x) + rim_px;
    const double right = std::min(corners[1].x, corners[3].x) - rim_px;
    const double top = std::max(corners[0].y, corners[1].y) + rim_px;
    const double bottom = std::min(corners[2].y, corners[3].y) - rim_px;
    const int x0 = std::max(0, static_cast<int>(std::ceil(left))), y0 = std::max(0, static_cast<int>(std::ceil(top)));
    const int x1 = std::min(source_.info().width, static_cast<int>(std::floor(right)));
    const int y1 = std::min(source_.info().height, static_cast<int>(std::floor(bottom)));
    if (x1 - x0 < least_side_px || y1 - y0 < least_side_px)
      return fail(ErrorCode::invalid_input,
                  fmt::format("the plate covers less than {0} x {0} pixels of the picture", least_side_px));
    return cv::Rect(x0, y0, x1 - x0, y1 - y0);
  }

  /// Commands a correction if the camera takes commands; returns whether it did.
  Result<bool> correct() {
    if (options_.measurement.nuc_interval_s <= 0) return false;
    if (auto corrected = taker_.correct_nonuniformity(); !corrected) {
      // A camera that takes no command corrects itself; its frames report that.
      if (corrected.error().code == ErrorCode::invalid_input) return false;
      return tl::unexpected(corrected.error());
    }
    TODBENCH_TRY(const auto corrected_ns, host_.now_ns(Moment::corrected));
    taker_.corrected(corrected_ns);
    return true;
  }

  Result<void> follow_drift(CameraMeasures& measures) {
    TODBENCH_TRY(const auto where, field());
    TODBENCH_TRY_VOID(show(0));
    const bool simulated = !options_.measurement.free_running;
    TODBENCH_TRY(const auto commanded, simulated ? Result<bool>(false) : correct());
    TODBENCH_TRY(measures.drift, measure_drift(taker_, where,
                                               {.drift_s = *options_.drift_s,
                                                .frame_rate_hz = source_.info().frame_rate_hz,
                                                .commanded = commanded,
                                                .simulated = simulated},
                                               stop_));
    return {};
  }

  Result<void> time_response(CameraMeasures& measures) {
    TODBENCH_TRY(const auto where, field());
    ResponseOptions response = *options_.response;
    response.plate = plate().name;
    response.contrast_frames = options_.measurement.contrast_frames;
    TODBENCH_TRY(measures.response,
                 measure_response(taker_, target_, host_, where, response, source_.info().frame_rate_hz, stop_));
    return {};
  }

  /// Window in which pixels are examined.
  [[nodiscard]] cv::Rect pixel_window(const cv::Rect& field) const {
    return options_.pixels->whole_frame ? cv::Rect(0, 0, source_.info().width, source_.info().height) : field;
  }

  Result<void> measure_noise(CameraMeasures& measures) {
    TODBENCH_TRY(const cv::Rect where, field());
    TODBENCH_TRY_VOID(show(0));
    TODBENCH_TRY_VOID(correct());
    NoiseOptions noise{.frames = options_.noise_frames, .field = where};
    if (options_.pixels) noise.pixel_window = pixel_window(where);
    TODBENCH_TRY(NoiseSeries series, measure_series_noise(taker_, source_.info().scale, noise, stop_));
    if (options_.pixels) tell_pixels(measures, series, where);
    measures.noise = std::move(series.noise);
    return {};
  }

  void tell_pixels(CameraMeasures& measures, const NoiseSeries& series, const cv::Rect& field) {
    const cv::Rect window = pixel_window(field);
    PixelScene scene{.shading = {}, .responsivity = {}, .unit_per_count = series.kelvin_per_step};
    if (step_pictures_.size() > 2)
      scene.responsivity = responsivity_in_triangles(step_pictures_, plate(), where_, window, field);
    auto found = measure_pixels(series.pixel_frames, {source_.info().width, source_.info().height}, window,
                                std::move(scene), *options_.pixels);
    if (found)
      measures.pixels = *std::move(found);
    else
      measures.reasons.push_back("pixels: " + found.error().message);
  }

  FrameSource& source_;
  Target& target_;
  const CameraMeasuresOptions& options_;
  RunController& host_;
  std::stop_token stop_;
  FrameTaker taker_;
  Registration where_;
  bool located_ = false;
  double response_ = 1;                         ///< observed contrast over that of the target
  std::vector<ContrastPicture> step_pictures_;  ///< of the signal transfer
};

}  // namespace

Result<CameraMeasures> measure_camera(FrameSource& source, Target& target, const CameraMeasuresOptions& options,
                                      RunController& host, std::stop_token stop) {
  if (options.measurement.plates.empty()) return fail(ErrorCode::invalid_input, "no plate is given");
  if (auto started = source.start(); !started) {
    CameraMeasures none;
    none.reasons.push_back("physical measures: " + started.error().message);
    return none;
  }
  auto measures = Run(source, target, options, host, std::move(stop))();
  source.stop();
  return measures;
}

}  // namespace todbench
