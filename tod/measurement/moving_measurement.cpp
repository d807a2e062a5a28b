// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/moving_measurement.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "acquisition/base/try.h"
#include "hvs/observer/open_parameters.h"
#include "tod/measurement/frame_taker.h"
#include "tod/measurement/place_watch.h"
#include "tod/measurement/set_up_step.h"
#include "tod/measurement/target_change.h"
#include "tod/plate/test_pattern.h"
#include "tod/presentation/target_failure.h"
#include "tod/registration/patch_windows.h"

namespace todbench {
namespace {

constexpr double fastest_px = 5;    ///< a frame
constexpr int spare_frames = 10;    ///< of a run, for frames in flight when it began
constexpr double found_within = 2;  ///< pixels round the expected place of the plate

/// A frame of a pass, and the displacement of the large triangles from their places at rest.
struct LocatedFrame {
  std::uint64_t sequence = 0;
  double time_s = 0;  ///< of the camera's clock
  cv::Mat1d kelvin;
  cv::Point2d moved_px;
};

/// A plate in a mounting.
struct MovingSetUp {
  TargetPlate plate;  ///< mounted
  std::string name;
  Mounting mounting = Mounting::identity;
  Registration base;  ///< of the plate at shift 0
};

/// Distance of the centre of mass of the large triangles from their registered places: in a picture with a tail the
/// mean lags the edges, and a lag moves the mean. Windows are those of the observer, a pixel wider.
cv::Point2d mass_from_place(const cv::Mat1d& kelvin, const TargetPlate& plate, const Registration& registration,
                            double smallest_px) {
  double mass = 0;
  cv::Point2d moment(0, 0);
  for (const PlateTriangle& triangle : plate.triangles) {
    const double size_px = triangle.size_mm * registration.scale_at(triangle.position_mm);
    if (size_px < smallest_px) continue;
    const cv::Point2d place = registration.pixel(triangle.position_mm);
    const int side = 2 * static_cast<int>(std::ceil(1.05 * size_px + 3));
    const cv::Rect window = patch_window(place, side).pixels;
    if ((window & cv::Rect({0, 0}, kelvin.size())) != window) continue;
    std::vector<double> border;
    const auto values = kelvin(window);
    for (int i = 0; i < side; ++i) {
      for (const double value : {values(0, i), values(side - 1, i), values(i, 0), values(i, side - 1)})
        border.push_back(value);
    }
    std::nth_element(border.begin(), border.begin() + std::ssize(border) / 2, border.end());
    const double surround = border[border.size() / 2];
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        const double above = values(j, i) - surround;
        mass += above;
        moment += above * (cv::Point2d(window.x + i, window.y + j) - place);
      }
    }
  }
  return mass == 0 ? cv::Point2d(0, 0) : moment / mass;
}

class MovingRun {
 public:
  MovingRun(FrameSource& source, Target& target, TemplateObserver& observer, const MovingMeasurementOptions& options,
            RunController& host, const MovingListener& listener, std::stop_token stop)
      : source_(source),
        target_(target),
        observer_(observer),
        options_(options),
        host_(host),
        listener_(listener),
        stop_(std::move(stop)),
        taker_(source, taker_options(options.measurement, source.info())),
        step_(options_.measurement, source, taker_, [this](const std::string& sentence) { note(sentence); }),
        phases_(options.measurement.seed, "moving.phase"),
        answers_(options.measurement.seed, "moving.answers") {
    options_.measurement.registration.expected_scale_px_per_mm =
        1 / (options.measurement.distance_m * options.measurement.ifov_mrad);
    places_ = PlaceWatch({.max_shift_error_px = options.measurement.max_shift_error_px,
                          .registration = options_.measurement.registration});
    result_.frame_rate_hz = source.info().frame_rate_hz;
    for (const TemplateObserverSpec& end : open_ends(observer.spec()))
      ends_.push_back(std::make_unique<TemplateObserver>(end, triangle_alternatives()));
  }

  Result<MovingMeasurement> operator()() {
    TODBENCH_TRY_VOID(check_moving(source_.info(), target_, observer_, options_));
    const std::stop_callback wake(stop_, [this] { source_.stop(); });
    TODBENCH_TRY_VOID(source_.start());
    auto done = all_set_ups();
    source_.stop();
    if (done) done = places_.finish();
    for (const std::string& sentence : places_.notes()) note(sentence);
    if (!done) {
      result_.ended_by = stop_.stop_requested() ? Error{ErrorCode::interrupted, "stopped on request"} : done.error();
      if (result_.answers.empty()) return tl::unexpected(*result_.ended_by);
    }
    result_.frames_rejected = taker_.rejected();
    result_.frames_lost = taker_.lost();
    result_.frames_used = taker_.used();
    result_.temporal_noise_k = step_.temporal_noise_k();
    result_.constancy = step_.constancy();
    if (const std::string faults = describe(taker_.numbering()); !faults.empty()) note(faults);
    if (const std::string repeats = taker_.cadence(); !repeats.empty()) note(repeats);
    return std::move(result_);
  }

 private:
  [[nodiscard]] const MeasurementOptions& at_rest() const { return options_.measurement; }

  void note(const std::string& sentence) { result_.notes.push_back(sentence); }

  [[nodiscard]] double step_px(double speed_mrad_s) const {
    return speed_mrad_s / at_rest().ifov_mrad / result_.frame_rate_hz;
  }

  Result<void> all_set_ups() {
    std::vector<double> contrasts = options_.delta_t_k;
    std::stable_sort(contrasts.begin(), contrasts.end(), [](double a, double b) { return std::abs(a) > std::abs(b); });
    largest_k_ = contrasts.front();
    for (std::size_t p = 0; p < at_rest().plates.size(); ++p) {
      const TargetPlate& plate = at_rest().plates[p];
      for (std::size_t m = 0; m < options_.mountings.size(); ++m) {
        if (!options_.mountings_per_plate.empty() && m >= options_.mountings_per_plate[p]) break;
        const Mounting mounting = options_.mountings[m];
        MovingSetUp set_up{.plate = mounted(plate, mounting), .name = plate.name, .mounting = mounting, .base = {}};
        TODBENCH_TRY_VOID(locate(set_up, contrasts.front()));
        TODBENCH_TRY_VOID(prepare(set_up));
        for (const double delta_t_k : contrasts) {
          TODBENCH_TRY_VOID(one_contrast(set_up, delta_t_k));
        }
      }
    }
    return {};
  }

  [[nodiscard]] static TargetState at(const MovingSetUp& set_up, double delta_t_k, cv::Point2d shift_mm) {
    return {.plate = set_up.name, .mounting = set_up.mounting, .delta_t_k = delta_t_k, .shift_mm = shift_mm};
  }

  Result<void> present(const MovingSetUp& set_up, double delta_t_k, cv::Point2d shift_mm) {
    if (stop_.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    TODBENCH_TRY(auto change, change_target(target_, taker_, host_, at(set_up, delta_t_k, shift_mm), stop_));
    if (!change.presented && !change.given_up) return target_failure("presenting the target", change.presented.error());
    if (!change.frames) return change.frames;
    presented_ = *std::move(change.presented);
    TODBENCH_TRY(const auto there_ns, host_.now_ns(Moment::scene_changed));
    there_ns_ = there_ns;
    taker_.scene_changed(there_ns);
    return {};
  }

  Result<void> locate(MovingSetUp& set_up, double delta_t_k) {
    TODBENCH_TRY_VOID(places_.finish());
    places_.set_up_located();
    if (auto shown = present(set_up, delta_t_k, {0, 0}); !shown) return shown;
    TODBENCH_TRY(const auto picture, step_.look(stop_));
    TODBENCH_TRY(const auto registration, step_.find(picture, set_up.plate, at(set_up, delta_t_k, {0, 0})));
    set_up.base = registration;
    result_.set_ups.push_back({set_up.name, set_up.mounting, registration});
    return {};
  }

  Result<void> prepare(const MovingSetUp& set_up) {
    if (judges_.contains(set_up.name)) return {};
    if (scale_px_per_mm_ == 0) scale_px_per_mm_ = set_up.base.scale_px_per_mm;
    std::vector<double> sizes;
    std::vector<std::size_t> size_of;
    for (const PlateTriangle& triangle : set_up.plate.triangles) {
      const double size = triangle.size_mm * scale_px_per_mm_;
      const auto known = std::find(sizes.begin(), sizes.end(), size);
      size_of.push_back(static_cast<std::size_t>(known - sizes.begin()));
      if (known == sizes.end()) sizes.push_back(size);
    }
    auto judge = SequenceJudge::prepare(observer_, sizes);
    if (!judge) return fail("plate " + set_up.name, judge.error());
    std::vector<SequenceJudge> at_ends;
    for (const auto& end : ends_) {
      auto other = SequenceJudge::prepare(*end, sizes);
      if (!other) return fail("plate " + set_up.name, other.error());
      at_ends.push_back(*std::move(other));
    }
    judges_.emplace(set_up.name,
                    PreparedJudge{*std::move(judge), std::move(at_ends), std::move(sizes), std::move(size_of)});
    return {};
  }

  Result<void> one_contrast(const MovingSetUp& set_up, double delta_t_k) {
    if (auto shown = present(set_up, delta_t_k, {0, 0}); !shown) return shown;
    const TargetState state = at(set_up, delta_t_k, {0, 0});
    if (const auto deviation = step_.read_back_deviation(state, presented_)) note(*deviation);
    TODBENCH_TRY(seen_, step_.contrast(set_up.plate, set_up.base, state, presented_, stop_));
    result_.presentations.push_back({.presentation = pairs_,
                                     .set = state,
                                     .said = presented_,
                                     .delta_t_k = seen_.contrast_k,
                                     .delta_t_se_k = seen_.standard_error_k,
                                     .reference_triangles = static_cast<int>(seen_.references.size()),
                                     .air_transmittance = at_rest().air_transmittance,
                                     .host_time_ns = there_ns_});
    if (listener_.on_presentation) {
      TODBENCH_TRY_VOID(listener_.on_presentation(result_.presentations.back()));
    }
    for (int phase = 0; phase < options_.passes; ++phase, ++pairs_) {
      for (const double speed : options_.speeds_mrad_s) {
        MovingPassRecord pass{.pass = static_cast<int>(result_.passes.size()),
                              .pair = pairs_,
                              .plate = set_up.name,
                              .mounting = set_up.mounting,
                              .set_delta_t_k = delta_t_k,
                              .delta_t_k = seen_.contrast_k,
                              .speed_mrad_s = speed,
                              .along_x = phase % 2 == 0 ? 1.0 : -1.0,
                              .lag_s = {},
                              .dropped = {}};
        TODBENCH_TRY_VOID(one_pass(set_up, pass));
        dropped_ += pass.dropped.empty() ? 0 : 1;
        if (listener_.on_pass) listener_.on_pass(pass);
        result_.passes.push_back(std::move(pass));
        // A few may fail by chance; at least a third of a dozen or more is a fault of the bench.
        if (dropped_ >= 4 && 3 * dropped_ >= result_.passes.size())
          return fail(ErrorCode::integrity,
                      fmt::format("{} of {} passes could not be measured; reason of the last: {}", dropped_,
                                  result_.passes.size(), result_.passes.back().dropped));
      }
    }
    return {};
  }

  Result<void> one_pass(const MovingSetUp& set_up, MovingPassRecord& pass) {
    const double pixel_mm = at_rest().ifov_mrad * at_rest().distance_m;
    const RandomStream random = phases_.sub(static_cast<std::uint64_t>(pass.pair));
    const cv::Point2d phase_mm(pixel_mm * (random.uniform(0) - 0.5), pixel_mm * (random.uniform(1) - 0.5));
    const double step_mm = step_px(pass.speed_mrad_s) * pixel_mm;
    const double half_mm = pass.along_x * step_mm * (options_.lead_frames + options_.frames + spare_frames) / 2;
    const cv::Point2d from_mm = phase_mm - cv::Point2d(half_mm, 0);
    TODBENCH_TRY_VOID(present(set_up, pass.set_delta_t_k, from_mm));
    const Registration begin = set_up.base.shifted(from_mm);
    Result<std::vector<LocatedFrame>> frames = pass.speed_mrad_s == 0
                                                   ? frames_at_rest(set_up, begin, pass.pair)
                                                   : frames_of_run(set_up, begin, phase_mm.x + half_mm, pass);
    if (!frames) return tl::unexpected(frames.error());
    if (!pass.dropped.empty()) return {};
    return answer(set_up, begin, *frames, pass);
  }

  Result<std::vector<LocatedFrame>> frames_at_rest(const MovingSetUp& set_up, const Registration& begin, int pair) {
    std::vector<Frame> taken;
    for (int k = 0; k < options_.frames; ++k) {
      TODBENCH_TRY(auto frame, taker_.next(stop_));
      taken.push_back(std::move(frame));
    }
    cv::Point2d off_px(0, 0);
    if (places_.looks()) {
      TODBENCH_TRY(const auto seen, places_.look(taken, set_up.plate, set_up.base, begin,
                                                 {.contrast = seen_.contrast_k, .noise = seen_.camera_noise_k}, pair));
      off_px = seen.used_off_px;
    }
    std::vector<LocatedFrame> frames;
    for (const Frame& frame : taken) {
      TODBENCH_TRY(auto kelvin, to_kelvin(frame));
      frames.push_back({frame.sequence, 0, std::move(kelvin), off_px});
    }
    return frames;
  }

  /// Frames of the running plate, with their places; those of the pass are the first after the lead.
  Result<std::vector<LocatedFrame>> frames_of_run(const MovingSetUp& set_up, const Registration& begin, double to_mm,
                                                  MovingPassRecord& pass) {
    const double speed_mm_s = pass.speed_mrad_s * at_rest().distance_m;
    const auto run = target_.moving()->run_along_x(to_mm, speed_mm_s, stop_);
    if (!run) return target_failure("moving the target", run.error());
    // All frames are taken before any is examined, because the camera does not wait.
    TODBENCH_TRY(auto taken, taken_of_run(*run));
    const cv::Point2d px_s =
        run->direction() * run->speed_mm_s * (set_up.base.pixel({1, 0}) - set_up.base.pixel({0, 0}));
    pass.said_px_s = std::hypot(px_s.x, px_s.y);
    const double step = pass.said_px_s / result_.frame_rate_hz, whole = pass.said_px_s * run->duration_s();
    const cv::Point2d along = px_s / pass.said_px_s;
    std::vector<LocatedFrame> chosen;
    cv::Point2d expected(0, 0);
    for (std::size_t i = 0; i < taken.size() && std::ssize(chosen) < options_.frames; ++i) {
      LocatedFrame& frame = taken[i];
      const auto found =
          measure_shift(frame.kelvin, set_up.plate, begin.moved(expected), at_rest().registration, found_within + step);
      if (!found) {
        pass.dropped = "the large triangles were not found in a frame: " + found.error().message;
        return std::vector<LocatedFrame>{};
      }
      frame.moved_px = expected + *found;
      expected = frame.moved_px + (i + 1 < taken.size() ? px_s * (taken[i + 1].time_s - frame.time_s) : cv::Point2d());
      const double gone = frame.moved_px.dot(along);
      if (gone > whole) expected = px_s * run->duration_s();  // at its end
      if (gone < step * options_.lead_frames || gone > whole - step) continue;
      if (!chosen.empty() && frame.sequence != chosen.back().sequence + 1) chosen.clear();
      chosen.push_back(std::move(frame));
    }
    if (std::ssize(chosen) < options_.frames) {
      pass.dropped =
          fmt::format("the run gave {} of the {} successive frames that a pass needs", chosen.size(), options_.frames);
      return std::vector<LocatedFrame>{};
    }
    if (run->start_s && pass.set_delta_t_k == largest_k_) {
      double behind_px = 0;
      for (const LocatedFrame& frame : chosen) {
        const cv::Point2d place =
            frame.moved_px +
            mass_from_place(frame.kelvin, set_up.plate, begin.moved(frame.moved_px), at_rest().min_reference_px);
        behind_px += ((frame.time_s - *run->start_s) * pass.said_px_s - place.dot(along)) / options_.frames;
      }
      pass.lag_s = behind_px / pass.said_px_s;
    }
    follow_line(chosen, px_s, pass);
    return chosen;
  }

  /// Takes frames until the run is over by the camera's clock or, if its start is not known, by the number of frames.
  Result<std::vector<LocatedFrame>> taken_of_run(const PlateRun& run) {
    std::vector<LocatedFrame> taken;
    const int enough = options_.lead_frames + options_.frames + spare_frames;
    for (int k = 0; k < 10 * enough; ++k) {
      TODBENCH_TRY(const auto frame, taker_.next_of_moving_scene(stop_));
      TODBENCH_TRY(auto kelvin, to_kelvin(frame));
      const double time_s = frame.device_time_ns != 0 ? static_cast<double>(frame.device_time_ns) * 1e-9
                                                      : static_cast<double>(frame.sequence) / result_.frame_rate_hz;
      taken.push_back({frame.sequence, time_s, std::move(kelvin), {}});
      if (run.start_s ? time_s >= *run.start_s + run.duration_s() : k + 1 >= enough + spare_frames) break;
    }
    return taken;
  }

  /// Fits the line at the stage's speed through the middle of the places, and the distances from it.
  void follow_line(std::vector<LocatedFrame>& frames, cv::Point2d px_s, MovingPassRecord& pass) {
    const auto n = static_cast<double>(frames.size());
    cv::Point2d offset(0, 0);
    double mean_s = 0;
    for (const LocatedFrame& frame : frames) {
      offset += (frame.moved_px - px_s * (frame.time_s - frames.front().time_s)) / n;
      mean_s += frame.time_s / n;
    }
    const cv::Point2d along = px_s / pass.said_px_s;
    double squares = 0, covariance = 0, variance = 0;
    for (LocatedFrame& frame : frames) {
      const cv::Point2d line = offset + px_s * (frame.time_s - frames.front().time_s);
      const cv::Point2d miss = frame.moved_px - line;
      squares += miss.dot(miss) / (2 * n);
      covariance += (frame.time_s - mean_s) * frame.moved_px.dot(along);
      variance += (frame.time_s - mean_s) * (frame.time_s - mean_s);
      if (options_.places == PlaceSource::stage) frame.moved_px = line;
    }
    pass.residual_px = std::sqrt(squares);
    pass.measured_px_s = variance > 0 ? covariance / variance : pass.said_px_s;
  }

  Result<void> answer(const MovingSetUp& set_up, const Registration& begin, const std::vector<LocatedFrame>& frames,
                      MovingPassRecord& pass) {
    const PreparedJudge& prepared = judges_.at(set_up.name);
    std::vector<cv::Mat1f> pictures;
    for (const LocatedFrame& frame : frames) pictures.emplace_back(frame.kelvin);
    const cv::Rect whole({0, 0}, pictures.front().size());
    // The same numbers at every speed, because ratios between speeds are paired.
    const RandomStream noise = answers_.sub(static_cast<std::uint64_t>(pass.pair));
    for (std::size_t t = 0; t < set_up.plate.triangles.size(); ++t) {
      const PlateTriangle& triangle = set_up.plate.triangles[t];
      const std::size_t size = prepared.size_of[t];
      SeenSequence seen{.frames = pictures, .places = {}, .contrast_k = pass.delta_t_k, .noise_k = seen_.noise_k};
      bool inside = true;
      for (const LocatedFrame& frame : frames) {
        seen.places.push_back(begin.pixel(triangle.position_mm) + frame.moved_px);
        const cv::Rect window = patch_window(seen.places.back(), prepared.judge.window_samples(size)).pixels;
        inside = inside && (window & whole) == window;
      }
      if (!inside) {
        ++pass.left_out;
        continue;
      }
      for (const SequenceObserver kind : all_sequence_observers) {
        const RandomStream own = noise.sub(static_cast<std::uint64_t>(kind)).sub(t);
        Trial trial;
        trial.presentation = pass.pair;
        trial.plate = set_up.name;
        trial.mounting = set_up.mounting;
        trial.triangle = triangle.name;
        trial.set_delta_t_k = pass.set_delta_t_k;
        trial.delta_t_k = pass.delta_t_k;
        trial.size_mm = triangle.size_mm;
        trial.size_mrad = triangle.size_mm / at_rest().distance_m;
        trial.size_px = prepared.sizes[size];
        trial.truth = triangle.apex;
        trial.answer = static_cast<Apex>(prepared.judge.choose(kind, size, seen, own));
        const auto window = patch_window(seen.places.front(), prepared.judge.window_samples(size));
        trial.phase_x_px = window.phase.x;
        trial.phase_y_px = window.phase.y;
        trial.frame = frames.front().sequence;
        MovingAnswer given{kind, pass.speed_mrad_s, std::move(trial)};
        for (std::size_t end = 0; end < prepared.at_ends.size(); ++end) {
          result_.answers_at_ends[end].push_back(given);
          result_.answers_at_ends[end].back().trial.answer =
              static_cast<Apex>(prepared.at_ends[end].choose(kind, size, seen, own));
        }
        if (listener_.on_answer) {
          TODBENCH_TRY_VOID(listener_.on_answer(given));
        }
        result_.answers.push_back(std::move(given));
      }
    }
    return {};
  }

  struct PreparedJudge {
    SequenceJudge judge;
    std::vector<SequenceJudge> at_ends;  ///< of the open parameters: best, worst; empty without an eye
    std::vector<double> sizes;           ///< in samples
    std::vector<std::size_t> size_of;    ///< per triangle
  };

  FrameSource& source_;
  Target& target_;
  TemplateObserver& observer_;
  std::vector<std::unique_ptr<TemplateObserver>> ends_;  ///< at the ends of the open parameters; empty without an eye
  MovingMeasurementOptions options_;
  RunController& host_;
  const MovingListener& listener_;
  std::stop_token stop_;
  FrameTaker taker_;
  PlaceWatch places_{{}};  ///< of the plate at rest; in a run every frame is located
  SetUpStep step_;
  SeenContrast seen_;          ///< of the current set-up and contrast
  PresentedTarget presented_;  ///< last report of the target
  std::int64_t there_ns_ = 0;  ///< its time, on the host's clock
  RandomStream phases_, answers_;
  MovingMeasurement result_;
  std::map<std::string, PreparedJudge> judges_;  ///< by plate
  double scale_px_per_mm_ = 0, largest_k_ = 0;
  int pairs_ = 0;
  std::size_t dropped_ = 0;
};

}  // namespace

Result<void> check_moving(const SourceInfo& camera, Target& target, TemplateObserver& observer,
                          const MovingMeasurementOptions& options) {
  const auto refuse = [](const std::string& why) { return fail(ErrorCode::invalid_input, why); };
  const MeasurementOptions& at_rest = options.measurement;
  if (at_rest.samples_per_pitch != 1)
    return refuse("a moving target can only be measured without microscan and super-resolution");
  if (at_rest.registration.pixel_aspect != 1) return refuse("a moving target can only be measured with square pixels");
  if (at_rest.contrast_unit != ContrastUnit::kelvin)
    return refuse("a moving target can only be measured in kelvin, not in grey levels");
  if (!(camera.frame_rate_hz > 0)) return refuse("camera " + camera.id + " does not report its frame rate");
  if (!target.capabilities().sets_shift || target.moving() == nullptr)
    return refuse("the target cannot run at constant speed: the table of its stage needs [position] and [run]");
  for (const double speed : options.speeds_mrad_s) {
    if (!(speed >= 0 && speed / at_rest.ifov_mrad / camera.frame_rate_hz <= fastest_px))
      return refuse(fmt::format("{:g} mrad/s is more than {:g} pixels per frame", speed, fastest_px));
  }
  return check_before_measuring(at_rest, observer, camera);
}

Result<MovingMeasurement> measure_moving(FrameSource& source, Target& target, TemplateObserver& observer,
                                         const MovingMeasurementOptions& options, RunController& host,
                                         const MovingListener& listener, std::stop_token stop) {
  return MovingRun(source, target, observer, options, host, listener, std::move(stop))();
}

}  // namespace todbench
