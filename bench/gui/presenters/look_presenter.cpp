// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/look_presenter.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "acquisition/recording/tiff_writer.h"
#include "bench/devices/devices.h"
#include "bench/plan/loaded_plan.h"
#include "bench/plan/plan_options.h"
#include "bench/session/provenance.h"
#include "tod/presentation/target_failure.h"
#include "tod/schedule/schedule.h"

namespace todbench {
namespace {

constexpr int picture_period_ms = 40;
constexpr double least_span_counts = 40;
constexpr double dead_pixel_counts = 400;  ///< 4 K at 10 mK per count: fifty times the noise of a good camera
constexpr int histogram_bins = 64;
/// An emulated camera computes a plate before its first exposure, which takes seconds on a busy machine.
constexpr std::chrono::milliseconds frame_timeout{6000};

Result<void> show_first_state(const Plan& plan, const std::vector<TargetPlate>& plates, Target& target,
                              const std::stop_token& stop) {
  const auto states = constant_stimuli(stimuli_options(plan, plates, plan.camera.ifov_mrad, Side::measured),
                                       RandomStream(plan.seed, "schedule"));
  if (states.empty()) return {};
  auto presented = target.present(states.front(), stop);
  if (!presented) return target_failure("presenting the target", presented.error());
  return {};
}

/// Shows the first state of a target that is not part of the camera, while the camera already runs.
void show_target(const Plan& plan, const std::function<void(const std::string&)>& note, const std::stop_token& stop) {
  const auto shown = [&]() -> Result<void> {
    TODBENCH_TRY(const auto loaded, LoadedPlan::load(plan));
    const auto target = open_target(loaded, stop);
    if (!target) return target_failure("opening the target", target.error());
    return show_first_state(plan, loaded.plates(), **target, stop);
  }();
  if (!shown && shown.error().code != ErrorCode::interrupted)
    note("The picture shows the scene without its target: " + shown.error().message);
}

/// Opens the camera: alone, or with its scene if that is part of it.
Result<OpenedBench> open_for_looking(const Plan& plan, const std::stop_token& stop) {
  if (plan.target.kind == TargetKind::scene) {
    TODBENCH_TRY(const auto loaded, LoadedPlan::load(plan));
    auto bench = open_bench(loaded, stop);
    if (!bench) return bench;
    TODBENCH_TRY_VOID(show_first_state(plan, loaded.plates(), *bench->target, stop));
    return bench;
  }
  TODBENCH_TRY(auto camera, camera_registry(stop).open(plan.camera.id));
  OpenedBench bench;
  bench.camera = std::move(camera);
  return bench;
}

/// Recipients of a live picture.
struct LookListener {
  std::function<void(const std::string& sentence)> note;
  std::function<void(FrameSource&)> on_open;
};

Result<void> look(const Plan& plan, LiveFeed& feed, CameraDesk& desk, const LookListener& listener,
                  const std::stop_token& stop) {
  TODBENCH_TRY(auto bench, open_for_looking(plan, stop));
  FrameSource& camera = *bench.camera;
  feed.open(camera.info());
  for (const auto& [feature, value] : plan.camera.settings) {
    if (auto set = camera.set(feature, value); !set)
      listener.note("The camera refuses a setting of the plan: " + set.error().message);
  }
  const std::stop_callback wake(stop, [&camera] { camera.stop(); });
  TODBENCH_TRY_VOID(camera.start());
  desk.open();
  listener.on_open(camera);
  const bool driven = plan.target.kind == TargetKind::scpi && !plan.target.black_body.empty();
  std::jthread target;
  if (driven) target = std::jthread([&](const std::stop_token& end) { show_target(plan, listener.note, end); });
  const bool recorded = has_scheme(plan.camera.id, camera_scheme::file);
  bool again = false;  // a recording with a frame is shown over and over
  while (!stop.stop_requested()) {
    auto frame = camera.next(frame_timeout);
    if (stop.stop_requested()) break;
    if (!frame && again && frame.error().code == ErrorCode::disconnected) {
      again = false;
      camera.stop();
      TODBENCH_TRY_VOID(camera.start());
      continue;
    }
    again = recorded && frame.has_value();
    if (!frame && frame.error().code == ErrorCode::timeout) {
      return fail(ErrorCode::disconnected,
                  "camera " + camera.info().id + " sends no frames; check the connection with 'todbench doctor'");
    }
    if (!frame) return tl::unexpected(frame.error());
    feed.put(*frame);
    if (auto kept = desk.append(*frame); !kept) listener.note("The recording ended: " + kept.error().message);
    desk.serve(camera);
    // These are as fast as requested; frames beyond the display rate are useless.
    if (bench.simulated || recorded) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  camera.stop();
  return {};
}

/// "snapshot-20261127T031500Z" with an ending that no file of the folder has yet.
std::filesystem::path new_file(const std::filesystem::path& folder, const std::string& kind,
                               const std::string& ending) {
  std::string stem = kind + "-";
  for (const char c : utc_now()) {
    if (c != '-' && c != ':') stem += c;
  }
  std::filesystem::path file = folder / (stem + ending);
  for (int number = 2; std::filesystem::exists(file); ++number)
    file = folder / (stem + "-" + std::to_string(number) + ending);
  return file;
}

}  // namespace

LookPresenter::LookPresenter(Workbench& bench, QObject* parent) : QObject(parent), bench_(bench) {
  timer_.setInterval(picture_period_ms);
  connect(&timer_, &QTimer::timeout, this, &LookPresenter::take_latest);
  timer_.start();
}

void LookPresenter::start() {
  LookListener listener;
  listener.note = [this](const std::string& sentence) { bench_.note(sentence); };
  listener.on_open = [this](FrameSource& camera) {
    bench_.post([this, readings = read_controls(camera)] {
      controls_ = readings;
      emit controls_changed();
    });
  };
  bench_.run(Activity::looking, [this, listener, desk = desk_](const Plan& plan, const std::stop_token& stop) {
    auto ended = look(plan, bench_.feed(), *desk, listener, stop);
    bench_.post([this] {
      end_recording();
      controls_.clear();
      emit controls_changed();
    });
    return ended;
  });
}

void LookPresenter::ask(CameraDesk::Request request) {
  if (bench_.activity() == Activity::looking) desk_->ask(std::move(request));
}

void LookPresenter::report(const Result<void>& done) {
  if (!done) emit bench_.trouble(QString::fromStdString(done.error().message), Remedy::none);
}

void LookPresenter::change(const std::string& feature, const std::string& value) {
  ask([this, feature, value](FrameSource& camera) {
    auto set = change_feature(camera, feature, value);
    bench_.post([this, feature, set, readings = read_controls(camera)] {
      controls_ = readings;
      if (set) {
        emit bench_.noted(
            QString::fromStdString(feature + " is " + *set + ". The plan states it in [camera] settings."));
        Plan plan = bench_.plan();
        plan.camera.settings[feature] = *set;
        bench_.set_plan(plan);
      } else {
        report(tl::unexpected(set.error()));
      }
      emit controls_changed();
    });
  });
}

void LookPresenter::correct() {
  ask([this](FrameSource& camera) {
    auto corrected = camera.correct_nonuniformity();
    bench_.post([this, corrected] {
      report(corrected);
      if (corrected) emit bench_.noted("The camera corrects its non-uniformity.");
    });
  });
}

Result<std::filesystem::path> LookPresenter::snapshot() {
  if (!latest_) return fail(ErrorCode::invalid_input, "there is no picture yet");
  const std::filesystem::path file = new_file(bench_.sessions_folder(), "snapshot", ".tif");
  TODBENCH_TRY(auto tiff, TiffWriter::create(file));
  TODBENCH_TRY_VOID(tiff.append(latest_->frame.counts));
  TODBENCH_TRY_VOID(tiff.verified_pages());
  return file;
}

void LookPresenter::toggle_recording() {
  if (recording()) {
    end_recording();
  } else if (const auto info = bench_.feed().info(); info && bench_.activity() == Activity::looking) {
    recorded_ = new_file(bench_.sessions_folder(), "recording", ".todrec");
    report(desk_->record(recorded_, *info));
  }
  emit controls_changed();
}

void LookPresenter::end_recording() {
  const auto frames = desk_->end_recording();
  if (!frames) return report(tl::unexpected(frames.error()));
  if (*frames) {
    emit bench_.noted(QString("Recorded %1 frames: %2").arg(**frames).arg(QString::fromStdString(recorded_.string())));
  }
}

void LookPresenter::take_latest() {
  auto frame = bench_.feed().take();
  if (!frame || frame->frame.counts.empty()) return;
  latest_ = std::move(frame);
  render();
}

void LookPresenter::render() {
  if (!latest_) return;
  const cv::Mat1w& counts = latest_->frame.counts;
  if (mode_ == LevelMode::automatic) level_ = automatic_level(counts, least_span_counts);
  const int full_scale = (1 << latest_->frame.significant_bits) - 1;
  image_ = to_image(counts, level_, map_, {.saturated_from = marks_ ? full_scale : -1});
  histogram_ = todbench::histogram(counts, level_, histogram_bins);
  dead_ = marks_ ? dead_pixels(counts, dead_pixel_counts) : std::vector<cv::Point>();
  emit updated();
}

void LookPresenter::set_colour_map(ColourMap map) {
  map_ = map;
  render();
}

void LookPresenter::set_level_mode(LevelMode mode) {
  mode_ = mode;
  render();
}

void LookPresenter::set_level(double level, double span) {
  mode_ = LevelMode::fixed;
  const double half = std::max(span, 1.0) / 2;
  level_ = {level - half, level + half};
  render();
}

void LookPresenter::set_marks(bool on) {
  marks_ = on;
  render();
}

std::optional<PixelReading> LookPresenter::reading(int column, int row) const {
  if (!latest_) return std::nullopt;
  const Frame& frame = latest_->frame;
  if (column < 0 || row < 0 || column >= frame.counts.cols || row >= frame.counts.rows) return std::nullopt;
  const int counts = frame.counts(row, column);
  return PixelReading{column, row, counts, frame.scale->kelvin(counts)};
}

QString LookPresenter::counters() const {
  if (!latest_) return "no frames yet";
  const FrameCounters& c = latest_->counters;
  QString text = QString("%1 good").arg(c.good);
  for (const auto& [reason, count] : c.rejected)
    text += QString(", %1 %2").arg(count).arg(QString::fromStdString(reason).replace('_', ' '));
  text += QString(", %1 lost").arg(c.lost);
  if (c.rate_hz > 0) text += QString(", %1 Hz").arg(c.rate_hz, 0, 'f', 1);
  if (const auto info = bench_.feed().info()) {
    if (const auto found = info->settings.find("SocketBufferBytes"); found != info->settings.end())
      text += QString(", buffer %1 KiB").arg(QString::fromStdString(found->second).toLongLong() / 1024);
  }
  return text;
}

QString LookPresenter::camera() const {
  const auto info = bench_.feed().info();
  if (!info) return {};
  QString text = QString::fromStdString(info->vendor + " " + info->model + ", serial number " + info->serial);
  text += QString(", %1 × %2, %3, %4")
              .arg(info->width)
              .arg(info->height)
              .arg(QString::fromStdString(info->pixel_format), QString::fromStdString(info->scale.describe()));
  return text;
}

}  // namespace todbench
