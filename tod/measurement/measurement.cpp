// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/measurement.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <tuple>

#include "acquisition/base/try.h"
#include "tod/measurement/frame_taker.h"
#include "tod/measurement/place_watch.h"
#include "tod/measurement/prepared_plate.h"
#include "tod/measurement/set_up_step.h"
#include "tod/measurement/target_change.h"
#include "tod/measurement/trial_judge.h"
#include "tod/presentation/target_failure.h"
#include "tod/registration/patch_windows.h"

namespace todbench {
namespace {

class Run {
 public:
  Run(FrameSource& source, Target& target, Observer& observer, TrialSchedule& schedule,
      const MeasurementOptions& options, RunController& host, const MeasurementListener& listener, std::stop_token stop)
      : source_(source),
        target_(target),
        observer_(observer),
        schedule_(schedule),
        options_(options),
        host_(host),
        listener_(listener),
        stop_(std::move(stop)),
        taker_(source, taker_options(options, source.info(), listener.on_rejected)),
        step_(options_, source, taker_, [this](const std::string& sentence) { note(sentence); }),
        judge_(options_, observer, taker_, step_) {
    options_.registration.expected_scale_px_per_mm = 1 / (options.distance_m * options.ifov_mrad);
    places_ = PlaceWatch({.max_shift_error_px = target.capabilities().sets_shift ? options.max_shift_error_px : 0,
                          .registration = options_.registration});
    for (const auto& plate : options.plates) plates_.push_back({plate, {}, {}});
  }

  Result<MeasurementResult> operator()() {
    const std::stop_callback wake(stop_, [this] { source_.stop(); });
    TODBENCH_TRY_VOID(source_.start());
    TODBENCH_TRY_VOID(correct_when_due());
    std::optional<Error> ended_by;
    while (const auto state = schedule_.next()) {
      const std::size_t before = result_.trials.size();
      auto shown = show(*state);
      while (!shown && camera_lost(shown.error()) && host_.recovers()) {
        const Error why = shown.error();
        const auto lost_ns = host_.now_ns(Moment::camera_lost);
        shown = lost_ns ? wait_for_camera(why) : tl::unexpected(lost_ns.error());
        if (!shown) break;
        shown = resume(*state, why, *lost_ns);
      }
      if (!shown) {
        // The stop request is the reason, whichever component noticed it first.
        const bool asked_to = shown.error().code == ErrorCode::interrupted && stop_.stop_requested();
        ended_by = asked_to ? Error{ErrorCode::interrupted, "stopped on request"} : shown.error();
        break;
      }
      schedule_.observe(std::span(result_.trials).subspan(before));
      if (listener_.on_progress) listener_.on_progress(static_cast<std::size_t>(presentation_), schedule_.planned());
    }
    source_.stop();
    if (const auto in_place = places_.finish(); !in_place && !ended_by) ended_by = in_place.error();
    for (const std::string& sentence : places_.notes()) note(sentence);
    if (ended_by && result_.trials.empty()) return tl::unexpected(*ended_by);
    keep_own_contrasts();
    result_.ended_by = ended_by;
    result_.temporal_noise_k = step_.temporal_noise_k();
    result_.temporal_noise_counts = step_.noise_counts();
    result_.lag1_correlation = step_.lag1_correlation();
    result_.constancy = step_.constancy();
    result_.constancy.presented = std::move(presented_contrasts_);
    result_.frames_used = taker_.used();
    result_.frames_rejected = taker_.rejected();
    result_.frames_lost = taker_.lost();
    if (const std::string faults = describe(taker_.numbering()); !faults.empty()) note(faults);
    if (const std::string repeats = taker_.cadence(); !repeats.empty()) note(repeats);
    return std::move(result_);
  }

 private:
  using SetUp = std::tuple<std::string, Mounting>;

  void note(const std::string& sentence) {
    result_.notes.push_back(sentence);
    if (listener_.on_note) listener_.on_note(sentence);
  }

  Result<void> correct_when_due() {
    if (options_.nuc_interval_s <= 0) return {};
    TODBENCH_TRY(const auto now_ns, host_.now_ns(Moment::correction_due));
    if (last_nuc_ns_ && static_cast<double>(now_ns - *last_nuc_ns_) * 1e-9 < options_.nuc_interval_s) return {};
    last_nuc_ns_ = now_ns;
    if (auto corrected = taker_.correct_nonuniformity(); !corrected) {
      if (corrected.error().code != ErrorCode::invalid_input) return corrected;
      return rely_on_what_the_camera_tells(corrected.error());
    }
    TODBENCH_TRY(const auto corrected_ns, host_.now_ns(Moment::corrected));
    taker_.corrected(corrected_ns);
    return {};
  }

  /// A camera that takes no command is still measured if its frames report corrections.
  Result<void> rely_on_what_the_camera_tells(const Error& refused) {
    TODBENCH_TRY_VOID(taker_.discard(stop_));
    if (!taker_.camera_tells_of_corrections()) return tl::unexpected(refused);
    options_.nuc_interval_s = 0;
    note("the camera rejects correction commands (" + refused.message +
         "); the run relies on the corrections that it reports");
    return {};
  }

  /// Lost instruments report the same code; they reconnect by themselves or end the run.
  [[nodiscard]] bool camera_lost(const Error& error) const {
    return error.code == ErrorCode::disconnected && !target_failed_;
  }

  Result<void> wait_for_camera(const Error& why) {
    note("the camera was lost in presentation " + std::to_string(presentation_) + ": " + why.message);
    if (listener_.on_lost) listener_.on_lost(why);
    return host_.recover(stop_);
  }

  /// Repeats the presentation in which the camera was lost, after its recovery.
  Result<void> resume(const TargetState& state, const Error& why, std::int64_t lost_ns) {
    const std::optional<cv::Point2d> before =
        current_set_up_ ? std::optional(base_.pixel({0, 0})) : std::optional<cv::Point2d>();
    // Everything that was measured with the old connection is measured again; a registered plate is located near its
    // earlier place.
    current_set_up_.reset();
    current_contrast_.reset();
    last_nuc_ns_.reset();
    const std::int64_t presentation = presentation_;
    TODBENCH_TRY_VOID(show(state));
    TODBENCH_TRY(const auto back_ns, host_.now_ns(Moment::camera_back));
    Interruption interruption{.presentation = presentation,
                              .away_s = static_cast<double>(back_ns - lost_ns) * 1e-9,
                              .moved_px = before ? cv::norm(base_.pixel({0, 0}) - *before) : 0,
                              .reason = why.message};
    note(fmt::format("the camera is back after {:.1f} s; the plate is {:.2f} pixels from its earlier place",
                     interruption.away_s, interruption.moved_px));
    result_.interruptions.push_back(std::move(interruption));
    host_.resumed();
    return {};
  }

  /// Waits during a pause and keeps taking frames, because a free-running camera would lose them.
  Result<void> wait_while_paused() {
    while (!stop_.stop_requested()) {
      TODBENCH_TRY(const auto rests, host_.rests(stop_));
      if (!rests) break;
      if (!options_.free_running) continue;
      TODBENCH_TRY_VOID(taker_.discard(stop_));
    }
    return {};
  }

  /// Changes the target; its report is in `presented_`.
  Result<void> present(const TargetState& state) {
    TODBENCH_TRY(auto change, change_target(target_, taker_, host_, state, stop_));
    target_failed_ = !change.presented && !change.given_up;
    if (target_failed_) return target_failure("presenting the target", change.presented.error());
    if (!change.frames) return change.frames;
    presented_ = *std::move(change.presented);
    return {};
  }

  /// One presentation: target, frame, answers.
  Result<void> show(const TargetState& state) {
    TODBENCH_TRY_VOID(wait_while_paused());
    if (stop_.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    const auto plate = std::find_if(plates_.begin(), plates_.end(),
                                    [&](const PreparedPlate& p) { return p.plate.name == state.plate; });
    if (plate == plates_.end())
      return fail(ErrorCode::invalid_input,
                  "the schedule names the plate '" + state.plate + "', which the plan does not list");
    TODBENCH_TRY_VOID(correct_when_due());
    for (;;) {
      const Kept before{result_.set_ups.size(), result_.contrasts.size(), result_.judged_contrasts.size(),
                        result_.grey_frames.size()};
      const auto shown = show(*plate, state);
      if (shown || shown.error().code != ErrorCode::calibration || target_failed_ ||
          !target_.asks_again(shown.error().message))
        return shown;
      note("presentation " + std::to_string(presentation_) + " is requested again: " + shown.error().message);
      forget_set_up(state, before);
    }
  }

  /// Numbers of results before a presentation.
  struct Kept {
    std::size_t set_ups, contrasts, judged_contrasts, grey_frames;
  };

  /// Drops the results of a set-up that was not the requested one.
  void forget_set_up(const TargetState& state, const Kept& kept) {
    const auto cut = [](auto& list, std::size_t count) {
      if (list.size() > count) list.erase(list.begin() + static_cast<std::ptrdiff_t>(count), list.end());
    };
    if (result_.set_ups.size() > kept.set_ups) registered_.erase({state.plate, state.mounting});
    cut(result_.set_ups, kept.set_ups);
    cut(result_.contrasts, kept.contrasts);
    cut(result_.judged_contrasts, kept.judged_contrasts);
    cut(result_.grey_frames, kept.grey_frames);
    current_set_up_.reset();
    current_contrast_.reset();
    if (!result_.set_ups.empty()) return;
    // The scale of the run came from this set-up.
    scale_px_per_mm_ = 0;
    for (PreparedPlate& plate : plates_) plate = {plate.plate, {}, {}};
  }

  Result<void> show(PreparedPlate& prepared, const TargetState& state) {
    PreparedPlate* const plate = &prepared;
    TODBENCH_TRY_VOID(present(state));
    TODBENCH_TRY(const auto there_ns, host_.now_ns(Moment::scene_changed));
    taker_.scene_changed(there_ns);
    const TargetPlate mounted_plate = mounted(plate->plate, state.mounting);
    plate_seen_ = {};
    const auto asked = look_at(*plate, mounted_plate, state);
    const auto exposed = asked ? expose(*plate, mounted_plate, *asked, state) : tl::unexpected(asked.error());
    // The instrument's report is recorded even if the camera's frames could not be used.
    keep_presentation(state, there_ns, asked.has_value());
    if (!exposed) return tl::unexpected(exposed.error());
    TODBENCH_TRY_VOID(answer(*plate, mounted_plate, *exposed, state));
    ++presentation_;
    return {};
  }

  /// The first frames of a presentation, and the place of the plate in them.
  struct Exposed {
    Registration registration;
    std::vector<Frame> frames;  ///< empty if the place is not checked
  };

  /// Set contrast of the point of the curve to which a presentation belongs.
  [[nodiscard]] static double point_of(const TargetState& state) {
    return state.point_delta_t_k.value_or(state.delta_t_k);
  }

  /// Adds the triangles of a presentation to the mean of its set-up and point. The contrast itself differs between
  /// presentations; only the deviations of the triangles from it are errors.
  void add_own_contrast(const TargetState& state) {
    auto& sum = own_contrasts_[{state.plate, state.mounting, point_of(state)}];
    if (sum.count > 0 && sum.references.size() != seen_.references.size()) return;
    if (sum.count++ == 0) {
      sum.references = seen_.references;
      for (ReferenceTriangle& reference : sum.references) reference.value = 0;
    }
    for (std::size_t i = 0; i < sum.references.size(); ++i)
      sum.references[i].value += seen_.references[i].value - seen_.contrast_k;
  }

  void keep_own_contrasts() {
    for (auto& [where, sum] : own_contrasts_) {
      const double contrast_k = std::get<2>(where);
      for (ReferenceTriangle& reference : sum.references)
        reference.value = contrast_k + reference.value / static_cast<double>(sum.count);
      result_.contrasts.push_back({contrast_k, contrast_k, sum.references});
    }
  }

  [[nodiscard]] int frames_at(const TargetState& state) const {
    const auto own = options_.frames_at_contrast.find(point_of(state));
    return own == options_.frames_at_contrast.end() ? options_.frames_per_presentation : own->second;
  }

  Result<Exposed> expose(const PreparedPlate& plate, const TargetPlate& mounted_plate, const Registration& asked,
                         const TargetState& state) {
    Exposed exposed{.registration = asked.moved(places_.off_px()), .frames = {}};
    std::vector<int> sides = plate.sides();
    for (int& side : sides) side = judge_.in_pixels(side);
    const auto problems = windows_out_of_picture(mounted_plate, exposed.registration, sides,
                                                 {source_.info().width, source_.info().height});
    if (!problems.empty()) {
      std::string text;
      for (const auto& problem : problems) text += (text.empty() ? "" : "; ") + sentence(problem);
      return fail(ErrorCode::calibration, "the plate is too close to the edge of the picture: " + text);
    }
    const bool own_contrast = state.wait != ContrastWait::settled;
    if (!places_.looks() && !own_contrast) return exposed;
    const int most = own_contrast ? frames_at(state) : std::min(frames_at(state), most_frames_looked_at);
    for (int k = 0; k < most; ++k) {
      TODBENCH_TRY(auto frame, taker_.next(stop_));
      exposed.frames.push_back(std::move(frame));
    }
    if (own_contrast) {
      TODBENCH_TRY(seen_, step_.own_contrast(exposed.frames, mounted_plate, exposed.registration, state, seen_));
      add_own_contrast(state);
    }
    if (!places_.looks()) return exposed;
    const double unit_per_k = options_.contrast_unit == ContrastUnit::kelvin ? 1 : seen_.levels_per_k;
    TODBENCH_TRY(const auto seen, places_.look(exposed.frames, mounted_plate, base_, asked,
                                               {.contrast = seen_.contrast_k * unit_per_k,
                                                .noise = seen_.camera_noise_k * std::abs(unit_per_k)},
                                               presentation_));
    plate_seen_ = seen;
    if (state.wait == ContrastWait::settled) add_presented_contrast(seen);
    exposed.registration = asked.moved(seen.used_off_px);
    return exposed;
  }

  void add_presented_contrast(const PlateSeen& seen) {
    if (!seen_.large || seen.amplitude_error == 0 || presented_contrasts_.empty()) return;
    PresentedContrast& sum = presented_contrasts_.back();
    sum.sum += seen.amplitude, sum.errors += seen.amplitude_error, sum.shared += seen.shared;
    ++sum.presentations;
  }

  /// Expected place of the plate; after a change of plate, mounting or contrast also the effective contrast.
  Result<Registration> look_at(PreparedPlate& plate, const TargetPlate& mounted_plate, const TargetState& state) {
    const SetUp set_up{state.plate, state.mounting};
    const bool new_set_up = !current_set_up_ || *current_set_up_ != set_up;
    const bool on_its_way = state.wait == ContrastWait::none;
    const bool new_contrast = new_set_up || (!on_its_way && *current_contrast_ != state.delta_t_k);
    if (new_contrast) read_back_noted_ = false;
    step_.expect(state.wait);
    const bool settled = state.wait == ContrastWait::settled;
    if (const auto deviation =
            read_back_noted_ || !settled ? std::nullopt : step_.read_back_deviation(state, presented_)) {
      note(*deviation);
      read_back_noted_ = true;
    }
    if (new_set_up) {
      TODBENCH_TRY_VOID(locate(plate, mounted_plate, state));
    }
    if (!new_set_up && !target_.capabilities().sets_shift) {
      TODBENCH_TRY_VOID(follow(mounted_plate));
    }
    const Registration registration = target_.capabilities().sets_shift ? base_.shifted(state.shift_mm) : base_;
    if (new_contrast) {
      TODBENCH_TRY(seen_,
                   step_.contrast(mounted_plate, registration.moved(places_.off_px()), state, presented_, stop_));
      if (seen_.judged)
        result_.judged_contrasts.push_back({.plate = state.plate,
                                            .mounting = state.mounting,
                                            .set_delta_t_k = state.delta_t_k,
                                            .delta_t_k = seen_.contrast_k,
                                            .judged_delta_t_k = seen_.contrast_k * seen_.judged->gain,
                                            .noise_k = seen_.noise_k,
                                            .scale = *seen_.judged});
      if (seen_.large)
        presented_contrasts_.push_back({.set_delta_t_k = state.delta_t_k,
                                        .measured = seen_.large->amplitude,
                                        .measured_error = seen_.large->amplitude_error});
      if (settled && !seen_.references.empty()) {
        result_.contrasts.push_back({state.delta_t_k, seen_.contrast_k, seen_.references});
        schedule_.observe_contrasts(contrast_errors(result_.contrasts));
      }
    }
    current_set_up_ = set_up;
    current_contrast_ = state.delta_t_k;
    return registration;
  }

  void keep_presentation(const TargetState& state, std::int64_t there_ns, bool seen) {
    result_.presentations.push_back({.presentation = presentation_,
                                     .set = state,
                                     .said = presented_,
                                     .delta_t_k = seen ? std::optional(seen_.contrast_k) : std::nullopt,
                                     .delta_t_se_k = seen ? seen_.standard_error_k : std::nullopt,
                                     .reference_triangles = seen ? static_cast<int>(seen_.references.size()) : 0,
                                     .small_delta_t_k = seen ? seen_.small_contrast_k : std::nullopt,
                                     .air_transmittance = options_.air_transmittance,
                                     .asked_px = plate_seen_ ? std::optional(plate_seen_->asked_px) : std::nullopt,
                                     .seen_px = plate_seen_ ? plate_seen_->seen_px : std::nullopt,
                                     .seen_error_px = seen_error_px(),
                                     .host_time_ns = there_ns});
    if (listener_.on_presentation) listener_.on_presentation(result_.presentations.back());
  }

  [[nodiscard]] std::optional<double> seen_error_px() const {
    if (!plate_seen_ || !plate_seen_->seen_px) return std::nullopt;
    return std::max(plate_seen_->standard_error_px.x, plate_seen_->standard_error_px.y);
  }

  /// Locates the plate of a set-up: by registration the first time, by its shift when it returns.
  Result<void> locate(PreparedPlate& plate, const TargetPlate& mounted_plate, const TargetState& state) {
    TODBENCH_TRY_VOID(places_.finish());
    places_.set_up_located();
    TODBENCH_TRY(const auto picture, step_.look(stop_));
    const cv::Point2d shift_mm = target_.capabilities().sets_shift ? state.shift_mm : cv::Point2d(0, 0);
    const auto known = registered_.find({state.plate, state.mounting});
    if (known != registered_.end()) {
      auto moved = measure_shift(picture.kelvin, mounted_plate, known->second.shifted(shift_mm), options_.registration,
                                 search_px);
      if (!moved)
        return fail("finding plate " + state.plate + " mounted " + std::string(to_string(state.mounting)) + " again",
                    moved.error());
      base_ = known->second.moved(*moved);
    } else {
      TODBENCH_TRY(const auto registration, step_.find(picture, mounted_plate, state));
      result_.set_ups.push_back({state.plate, state.mounting, registration});
      if (listener_.on_set_up) listener_.on_set_up(result_.set_ups.back());
      base_ = registration.shifted(-shift_mm);
    }
    registered_[{state.plate, state.mounting}] = base_;
    if (scale_px_per_mm_ == 0) scale_px_per_mm_ = base_.scale_px_per_mm;
    if (plate.observers.empty()) {
      const int finer = options_.judged_samples_per_pixel;
      TODBENCH_TRY_VOID(prepare(plate, observer_, scale_px_per_mm_ * finer, options_.samples_per_pitch * finer));
    }
    return {};
  }

  /// Locates a plate that was moved by hand.
  Result<void> follow(const TargetPlate& mounted_plate) {
    TODBENCH_TRY(auto picture, taker_.average(options_.contrast_frames, stop_));
    auto moved = measure_shift(picture.kelvin, mounted_plate, base_, options_.registration, search_px);
    if (!moved) return fail("following the plate", moved.error());
    base_ = base_.moved(*moved);
    return {};
  }

  /// Every triangle is a trial. No trial of a presentation is reported before its last frame has arrived.
  Result<void> answer(const PreparedPlate& plate, const TargetPlate& mounted_plate, const Exposed& exposed,
                      const TargetState& state) {
    TODBENCH_TRY(const auto answered, judge_.answers({.plate = plate,
                                                      .mounted_plate = mounted_plate,
                                                      .registration = exposed.registration,
                                                      .state = state,
                                                      .point_delta_t_k = point_of(state),
                                                      .seen = seen_,
                                                      .presentation = presentation_,
                                                      .first_frames = exposed.frames,
                                                      .frames = frames_at(state)},
                                                     stop_));
    result_.grey_frames.insert(result_.grey_frames.end(), answered.greys.begin(), answered.greys.end());
    for (std::size_t i = 0; i < answered.trials.size(); ++i) {
      result_.trials.push_back(answered.trials[i]);
      if (listener_.on_trial) listener_.on_trial(answered.trials[i]);
      if (listener_.on_patch) listener_.on_patch(answered.trials[i], answered.patches[i]);
    }
    return {};
  }

  static constexpr int most_frames_looked_at = 16;  ///< for the place of the plate: they are kept until judged
  static constexpr double search_px = 6;  ///< furthest movement of the plate by hand between two presentations

  FrameSource& source_;
  Target& target_;
  Observer& observer_;
  TrialSchedule& schedule_;
  MeasurementOptions options_;
  RunController& host_;
  const MeasurementListener& listener_;
  std::stop_token stop_;
  FrameTaker taker_;
  PlaceWatch places_{{}};
  SetUpStep step_;
  TrialJudge judge_;
  std::vector<PreparedPlate> plates_;
  std::map<SetUp, Registration> registered_;  ///< at shift 0
  std::optional<SetUp> current_set_up_;
  std::optional<double> current_contrast_;
  Registration base_;                        ///< of the current set-up, at shift 0
  SeenContrast seen_;                        ///< of the current set-up and set-point
  double scale_px_per_mm_ = 0;               ///< of the first registration: one scale for the whole run
  std::optional<std::int64_t> last_nuc_ns_;  ///< time of the last command
  std::int64_t presentation_ = 0;
  struct OwnContrasts {
    std::vector<ReferenceTriangle> references;  ///< sums of deviations from the contrast
    std::size_t count = 0;
  };
  std::map<std::tuple<std::string, Mounting, double>, OwnContrasts> own_contrasts_;  ///< by set-up and point
  std::vector<PresentedContrast> presented_contrasts_;
  std::optional<PlateSeen> plate_seen_;
  PresentedTarget presented_;   ///< last report of the target
  bool target_failed_ = false;  ///< the error of this presentation is the target's
  bool read_back_noted_ = false;
  MeasurementResult result_;
};

}  // namespace

Result<MeasurementResult> measure(FrameSource& source, Target& target, Observer& observer, TrialSchedule& schedule,
                                  const MeasurementOptions& options, RunController& host,
                                  const MeasurementListener& listener, std::stop_token stop) {
  TODBENCH_TRY_VOID(check_before_measuring(options, observer, source.info()));
  return Run(source, target, observer, schedule, options, host, listener, std::move(stop))();
}

}  // namespace todbench
