// SPDX-License-Identifier: GPL-3.0-or-later
// todbench noise
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "acquisition/base/try.h"
#include "acquisition/core/correction_watch.h"
#include "acquisition/core/count_step.h"
#include "acquisition/core/input_gate.h"
#include "bench/cli/commands.h"
#include "bench/cli/noise_components.h"
#include "bench/cli/noise_gates.h"
#include "bench/cli/started_recording.h"
#include "bench/judgement/verdict.h"
#include "bench/plan/descriptions.h"
#include "bench/studies/real_noise_study.h"
#include "tod/measures/pixel_noise.h"
#include "tod/measures/temporal_noise.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

struct NoiseArguments {
  std::string recording;
  std::string sensor = "sc2000", observer = "hvs-1";
  int block_frames = 10;
  RealNoiseOptions study;
  bool components_only = false, across_corrections = false;
};

/// If neighbours correlate by more than this, the scene moved, and the result is not the camera's noise.
constexpr double moved_scene = 0.8;

/// Above this correlation successive frames understate the noise of one by 5 % or more.
constexpr double white_enough = 0.1;

struct Frames {
  std::vector<TimedPicture> pictures;
  bool kelvin = false;
  int repeated = 0;           ///< frames that equal the one before them bit for bit
  double unit_per_count = 1;  ///< 0: unknown
  ByteOrderVerdict byte_order = ByteOrderVerdict::as_stated;
  cv::Mat1d saturated;  ///< frames in which a pixel was at either end of the counts
  CountStep step;
};

/// In kelvin if the recording has a scale, otherwise in counts.
Result<cv::Mat1f> picture_of(const Frame& frame, bool in_kelvin) {
  cv::Mat1f picture;
  if (in_kelvin) {
    TODBENCH_TRY(auto kelvin, to_kelvin(frame));
    // Single precision resolves a tenth of a millikelvin in degrees Celsius.
    cv::Mat1d(kelvin - 273.15).convertTo(picture, CV_32F);
  } else {
    frame.counts.convertTo(picture, CV_32F);
  }
  return picture;
}

/// Separates new exposures from repeated ones, and the segments between corrections of the camera. The frames after a
/// jump of the level decide whether it is a correction.
class Segments {
 public:
  /// Returns the segment of a frame; empty for a repeated frame and for one during a correction.
  [[nodiscard]] std::optional<int> of(const Frame& frame) {
    const bool repeated =
        !last_.empty() && last_.size() == frame.counts.size() && cv::norm(last_, frame.counts, cv::NORM_INF) == 0;
    const auto seen = repeated ? watch_.see_frozen() : watch_.see(frame);
    last_ = frame.counts;
    repeated_ += repeated ? 1 : 0;
    jumped_ = jumped_ || seen == CorrectionSign::level_jump;
    if ((seen && seen != CorrectionSign::level_jump) || frame.correction == CorrectionState::running) ++segment_;
    const bool usable = !repeated && frame.correction != CorrectionState::running && seen != CorrectionSign::shutter;
    return usable ? std::optional(segment_) : std::nullopt;
  }
  /// Frames so far that equal the one before them bit for bit.
  [[nodiscard]] int repeated() const { return repeated_; }
  /// Whether the level jumped since the last call.
  [[nodiscard]] bool jumped() { return std::exchange(jumped_, false); }

 private:
  CorrectionWatch watch_{CorrectionWatchOptions{}};
  cv::Mat1w last_;
  int segment_ = 0, repeated_ = 0;
  bool jumped_ = false;
};

/// Starts a new segment at each jump after which the level stays changed.
void split_at_jumps(std::vector<TimedPicture>& pictures, const std::vector<std::size_t>& jumps) {
  constexpr std::size_t nearby = 8;  // frames of the same segment on either side
  std::vector<double> levels;
  for (const TimedPicture& picture : pictures) levels.push_back(cv::mean(picture.picture)[0]);
  std::vector<int> more(pictures.size(), 0);
  for (const std::size_t jump : jumps) {
    std::size_t first = jump, end = jump;
    const auto same = [&](std::size_t k) { return pictures[k].segment == pictures[jump].segment; };
    while (first > 0 && jump - first < nearby && same(first - 1)) --first;
    while (end < pictures.size() && end - jump < nearby && same(end)) ++end;
    const std::span<const double> all(levels);
    more[jump] = level_stays_changed(all.subspan(first, jump - first), all.subspan(jump, end - jump)) ? 1 : 0;
  }
  int added = 0;
  for (std::size_t k = 0; k < pictures.size(); ++k) pictures[k].segment += added += more[k];
}

/// Reads all complete frames that are separate exposures.
Result<Frames> frames_of(const std::string& id, Console& console) {
  TODBENCH_TRY(const auto source, started_recording(console, id));
  InputGate gate;
  Frames frames;
  frames.kelvin = source->info().scale.calibrated();
  Segments segments;
  std::vector<std::size_t> jumps;
  for (;;) {
    auto frame = source->next(std::chrono::seconds(1));
    if (!frame && frame.error().code == ErrorCode::disconnected) {
      if (auto sound = gate.verdict(); !sound) return fail(id, sound.error());
      for (const auto& sentence : {gate.note(), gate.cadence(), gate.byte_order().note()}) {
        if (!sentence.empty()) console.note(sentence);
      }
      frames.byte_order = gate.byte_order().verdict();
      frames.repeated = segments.repeated();
      split_at_jumps(frames.pictures, jumps);
      return frames;
    }
    if (!frame) return tl::unexpected(frame.error());
    if (!gate.takes(*frame)) continue;
    const auto segment = segments.of(*frame);
    if (!segment) continue;
    auto picture = picture_of(*frame, frames.kelvin);
    if (!picture) return fail(id, picture.error());
    if (frames.pictures.empty() && frames.kelvin)
      frames.unit_per_count = kelvin_per_count(*frame, source->info().scale);
    if (frames.saturated.empty()) frames.saturated = cv::Mat1d::zeros(frame->counts.size());
    // Frames of different sizes are rejected below.
    if (frames.saturated.size() == frame->counts.size())
      cv::add(frames.saturated, saturated_pixels(*frame), frames.saturated, cv::noArray(), CV_64F);
    frames.step.add(frame->counts);
    if (segments.jumped()) jumps.push_back(frames.pictures.size());
    frames.pictures.push_back({*std::move(picture), frame->sequence, *segment});
  }
}

/// Cuts the pictures into successive blocks of `block_frames` frames without a correction.
std::vector<cv::Mat1f> in_blocks(const std::vector<TimedPicture>& pictures, int block_frames) {
  std::vector<cv::Mat1f> blocks;
  const auto size = static_cast<std::size_t>(block_frames);
  for (std::size_t first = 0; first + size <= pictures.size();) {
    if (pictures[first].segment != pictures[first + size - 1].segment) {
      ++first;
      continue;
    }
    for (std::size_t k = 0; k < size; ++k) blocks.push_back(pictures[first + k].picture);
    first += size;
  }
  return blocks;
}

/// Results of a recording.
struct Found {
  RecordedNoise blocks;
  TemporalNoise time;
  bool kelvin = false;
  std::optional<NoiseFault> fault;  ///< the counts contain no noise that could be stated
  int repeated = 0;
  ByteOrderVerdict byte_order = ByteOrderVerdict::as_stated;
};

bool moved(const RecordedNoise& noise) {
  return std::max(noise.correlation_x, noise.correlation_y) > moved_scene;
}

int pixels_left_out(const TemporalNoise& noise) {
  return static_cast<int>(noise.usable.total()) - cv::countNonZero(noise.usable);
}

bool correlated(const TemporalNoise& noise) {
  return noise.lag1_correlation && std::abs(*noise.lag1_correlation) > white_enough;
}

std::string_view verdict_of(const Found& found) {
  if (found.fault) return found.fault->verdict;
  if (moved(found.blocks)) return "scene_moved";
  if (found.time.changes) return "unsteady";
  return correlated(found.time) ? "correlated" : "ok";
}

/// States the effect of the correlation on the numbers of this report.
std::string memory_sentence(const TemporalNoise& noise) {
  return "the noise is correlated in time: successive frames have a correlation of " +
         fixed(noise.lag1_correlation, 2) +
         ". The stated temporal noise comes from differences of successive frames. A single frame, which the observer "
         "judges, has " +
         fixed(noise.whole_to_successive, 2) +
         " times as much noise. Averaging N frames reduces the noise by less than the square root of N.";
}

Json components_json(const ThreeDNoise& c, bool stated) {
  if (!stated) return nullptr;
  return {{"tvh", json_number(c.tvh)}, {"tv", json_number(c.tv)}, {"th", json_number(c.th)}, {"t", json_number(c.t)},
          {"vh", json_number(c.vh)},   {"v", json_number(c.v)},   {"h", json_number(c.h)}};
}

Json structure_json(const TemporalNoise& noise, bool stated) {
  return {{"lags", stated ? Json(noise.lags) : Json::array()},
          {"values", stated ? Json(json_numbers(noise.structure)) : Json::array()}};
}

Json noise_json(const Found& found, const std::vector<NoiseAcuity>& points, const NoiseArguments& arguments) {
  const RecordedNoise& noise = found.blocks;
  Json list = Json::array();
  for (const auto& p : points) {
    list.push_back({{"contrast_over_noise", p.contrast_over_noise},
                    {"s75_pitch", json_number(p.real.s75_pitch)},
                    {"s75_white_pitch", json_number(p.white.s75_pitch)},
                    {"acuity_ratio", json_number(p.acuity_ratio)},
                    {"acuity_ratio_ci95", json_interval(p.ratio_ci95)},
                    {"template_noise_ratio", json_number(p.template_noise_ratio)},
                    {"predicted_acuity_ratio", json_number(p.predicted_ratio)},
                    {"memory_acuity_ratio", json_number(p.memory_acuity_ratio)},
                    {"pixel_share", json_number(p.pixel_share)},
                    {"row_share", json_number(p.row_share)},
                    {"column_share", json_number(p.column_share)},
                    {"correlated_share", json_number(p.correlated_share)}});
  }
  return {{"recording", arguments.recording},
          {"unit", found.kelvin ? "K" : "counts"},
          {"width", noise.usable.cols},
          {"height", noise.usable.rows},
          {"blocks", noise.blocks},
          {"block_frames", arguments.block_frames},
          {"frames_repeated", found.repeated},
          {"usable_share", noise.usable_share},
          {"pixels_left_out", pixels_left_out(found.time)},
          {"temporal_noise", found.fault ? Json() : json_number(found.time.successive)},
          {"lag1_correlation", json_number(found.time.lag1_correlation)},
          {"structure_function", structure_json(found.time, !found.fault)},
          {"whole_to_successive", json_number(found.time.whole_to_successive)},
          {"block_noise", found.fault ? Json() : json_number(noise.temporal_noise)},
          {"components", components_json(noise.components, !found.fault)},
          {"correlation_x", json_number(noise.correlation_x)},
          {"correlation_y", json_number(noise.correlation_y)},
          {"observer", arguments.observer},
          {"sensor", arguments.sensor},
          {"byte_order", to_string(found.byte_order)},
          {"verdict", verdict_of(found)},
          {"points", list}};
}

void print_time(Console& console, const Found& found, const std::string& unit) {
  const TemporalNoise& time = found.time;
  const auto noise = found.fault ? std::nullopt : std::optional(time.successive);
  console.text("temporal noise " + fixed(noise, 4) + " " + unit + " (from differences of successive frames) over " +
               fixed(100 * time.usable_share, 1) + " % of the pixels; lag-1 correlation " +
               fixed(time.lag1_correlation, 3));
  if (!noise) return;
  std::vector<TableRow> rows;
  for (std::size_t i = 0; i < time.lags.size(); ++i) {
    const int lag = time.lags[i];
    if (i == 0 || (lag & (lag - 1)) == 0) rows.push_back({std::to_string(lag), fixed(time.structure[i], 4)});
  }
  console.table({"lag [frames]", "sqrt(mean d^2 / 2) [" + unit + "]"}, rows);
  console.text("");
}

void print_components(Console& console, const Found& found) {
  const RecordedNoise& noise = found.blocks;
  const auto& c = noise.components;
  const std::string unit = found.kelvin ? "K" : "counts";
  print_time(console, found, unit);
  if (found.fault) return;
  console.text("noise within blocks " + fixed(noise.temporal_noise, 4) + " " + unit + " over " +
               fixed(100 * noise.usable_share, 1) + " % of the pixels; correlation of adjacent pixels: " +
               fixed(noise.correlation_x, 3) + " in a row, " + fixed(noise.correlation_y, 3) + " in a column");
  console.table({"component", "sd [" + unit + "]"}, {{"pixels in time (tvh)", fixed(c.tvh, 4)},
                                                     {"rows in time (tv)", fixed(c.tv, 4)},
                                                     {"columns in time (th)", fixed(c.th, 4)},
                                                     {"frames in time (t)", fixed(c.t, 4)},
                                                     {"fixed pattern and scene (vh)", fixed(c.vh, 4)},
                                                     {"fixed rows (v)", fixed(c.v, 4)},
                                                     {"fixed columns (h)", fixed(c.h, 4)}});
}

void print_acuities(Console& console, const std::vector<NoiseAcuity>& points) {
  std::vector<TableRow> rows, why;
  for (const auto& p : points) {
    rows.push_back({fixed(p.contrast_over_noise, 1), fixed(p.real.s75_pitch, 3), fixed(p.white.s75_pitch, 3),
                    fixed(p.acuity_ratio, 3), range(p.ratio_ci95, 3), fixed(p.predicted_ratio, 3),
                    fixed(p.memory_acuity_ratio, 3)});
    why.push_back({fixed(p.contrast_over_noise, 1), fixed(p.template_noise_ratio, 3), fixed(p.pixel_share, 3),
                   fixed(p.row_share, 3), fixed(p.column_share, 3), fixed(p.correlated_share, 3)});
  }
  console.text("");
  console.text("S75 with this noise and with white noise of the same standard deviation");
  console.table({"dT / noise", "S75 [pitch]", "S75 white [pitch]", "acuity real / white", "95 %", "predicted from r",
                 "acuity single frame / successive"},
                rows);
  console.text("");
  console.text("r^2: variance of the template differences divided by their variance with white noise, and its parts");
  console.table({"dT / noise", "r", "pixels", "rows", "columns", "correlated"}, why);
}

int run_noise(Console& console, NoiseArguments arguments, const Program& program) {
  auto sensor = load_sensor(arguments.sensor);
  if (!sensor) return report_error(console, sensor.error());
  auto spec = load_observer(arguments.observer);
  if (!spec) return report_error(console, spec.error());
  const auto frames = frames_of(arguments.recording, console);
  if (!frames) return report_error(console, frames.error());
  const auto count = static_cast<int>(frames->pictures.size());
  if (count < 2) {
    return report_error(console, with_context(arguments.recording, too_few_frames(count, frames->repeated)));
  }
  if (frames->repeated > 0) console.note(frozen_sentence(frames->repeated));
  if (count < arguments.block_frames) {
    console.note("the recording has " + std::to_string(count) +
                 " usable frames, fewer than --block-frames: all of them form one block");
    arguments.block_frames = count;
  }
  auto time = temporal_noise(frames->pictures);
  if (!time) return report_error(console, with_context(arguments.recording, time.error()));
  auto blocks =
      recorded_noise(in_blocks(frames->pictures, arguments.block_frames), arguments.block_frames, time->usable);
  if (!blocks) return report_error(console, with_context(arguments.recording, blocks.error()));
  if (const int left_out = pixels_left_out(*time); left_out > 0)
    console.note(fmt::format("{} of {} pixels never change or see a moving scene: all results exclude them", left_out,
                             time->usable.total()));
  const double saturated_share = cv::mean(frames->saturated, time->usable)[0] / count;
  EndValues ends;
  for (const TimedPicture& picture : frames->pictures) ends.add(picture.picture, time->usable);
  auto fault =
      noise_fault({saturated_share, frames->unit_per_count, frames->step.counts_per_step(), ends.clipped_share()},
                  time->successive);
  const Found found{*std::move(blocks), *std::move(time), frames->kelvin,
                    std::move(fault),   frames->repeated, frames->byte_order};
  std::vector<NoiseAcuity> points;
  if (found.fault) {
    console.note(found.fault->message);
  } else if (moved(found.blocks)) {
    // Components and acuity would be those of the moving scene.
    console.note(
        "adjacent pixels change together: the scene or the camera moved, so this is not the noise of the camera");
  } else if (found.time.changes) {
    console.note(
        "the noise changes within the recording: its first and its second half differ by more than 7 %, so this is not "
        "the noise of the camera at one setting");
  } else {
    if (correlated(found.time)) console.note(memory_sentence(found.time));
    TemplateObserver observer(*spec, triangle_alternatives());
    arguments.study.seed = program.common.seed;
    arguments.study.stop = program.stop->token();
    arguments.study.whole_to_successive = found.time.whole_to_successive;
    auto studied = real_noise_study(found.blocks, *sensor, observer, arguments.study);
    if (!studied && !(pixels_left_out(found.time) > 0 && studied.error().code == ErrorCode::invalid_input))
      return report_error(console, studied.error());
    if (studied)
      points = *std::move(studied);
    else
      console.note("no acuity was computed: " + studied.error().message);
  }
  if (console.json()) {
    console.object(noise_json(found, points, arguments));
  } else {
    print_components(console, found);
    if (!points.empty()) print_acuities(console, points);
  }
  return points.empty() ? exit_code(VerdictKind::inconclusive) : 0;
}

}  // namespace

void add_noise_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "noise",
      "measures the noise components of a recording and the acuity with this noise, compared with white noise");
  auto a = std::make_shared<NoiseArguments>();
  command
      ->add_option(
          "RECORDING", a->recording,
          "recording of a static scene, for example file.seq or file.raw?width=W&height=H[&kelvin_per_count=K]")
      ->required();
  command->add_option("--sensor", a->sensor, "sensor whose optics blur the triangles: name or file")
      ->capture_default_str();
  command->add_option("--observer", a->observer, "observer: name or file")->capture_default_str();
  command
      ->add_option("--block-frames", a->block_frames,
                   "frames per block; the mean of each pixel is removed within a block")
      ->check(whole_number(2, 100000))
      ->capture_default_str();
  command
      ->add_option("--contrast-over-noise", a->study.contrast_over_noise,
                   "contrasts as multiples of the temporal noise, separated by commas; default: 1.6,3.3,8,28")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(number_in(0.05, 1e6));
  auto* components =
      command->add_flag("--components-only", a->components_only,
                        "computes only the seven components of 3-D noise with intervals, from the whole recording");
  command
      ->add_flag("--across-corrections", a->across_corrections,
                 "accepts a recording in which the camera performed a correction (NUC) or the scene moved")
      ->needs(components);
  finish_command(*command, program, [a, &program](Console& console) {
    if (!a->components_only) return run_noise(console, *a, program);
    const auto across = a->across_corrections ? AcrossCorrections::take : AcrossCorrections::refuse;
    return run_noise_components(console, a->recording, across);
  });
}

}  // namespace todbench
