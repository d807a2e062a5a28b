// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/look_presenter.h"

#include <algorithm>
#include <chrono>

#include "bench/plan/loaded_plan.h"
#include "bench/plan/plan_options.h"
#include "bench/run/devices.h"
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
  if (!presented) return fail("presenting the target", presented.error());
  return {};
}

/// Opens camera and target of the plan if the target needs no operator; otherwise the camera alone.
Result<OpenedBench> open_for_looking(const Plan& plan, const std::stop_token& stop) {
  const bool driven = plan.target.kind == TargetKind::scene ||
                      (plan.target.kind == TargetKind::scpi && !plan.target.black_body.empty());
  if (driven) {
    const auto loaded = LoadedPlan::load(plan);
    if (!loaded) return tl::unexpected(loaded.error());
    auto bench = open_bench(*loaded, stop);
    if (!bench) return bench;
    if (auto shown = show_first_state(plan, loaded->plates(), *bench->target, stop); !shown)
      return tl::unexpected(shown.error());
    return bench;
  }
  auto camera = camera_registry(stop).open(plan.camera.id);
  if (!camera) return tl::unexpected(camera.error());
  OpenedBench bench;
  bench.camera = std::move(*camera);
  return bench;
}

Result<void> look(const Plan& plan, LiveFeed& feed, const std::stop_token& stop) {
  auto bench = open_for_looking(plan, stop);
  if (!bench) return tl::unexpected(bench.error());
  FrameSource& camera = *bench->camera;
  feed.open(camera.info());
  const std::stop_callback wake(stop, [&camera] { camera.stop(); });
  if (auto started = camera.start(); !started) return started;
  while (!stop.stop_requested()) {
    auto frame = camera.next(frame_timeout);
    if (stop.stop_requested()) break;
    if (!frame && frame.error().code == ErrorCode::timeout) {
      return fail(ErrorCode::disconnected,
                  "camera " + camera.info().id + " sends no frames; check the connection with 'todbench doctor'");
    }
    if (!frame) return tl::unexpected(frame.error());
    feed.put(*frame);
    // A simulated camera is as fast as requested; frames beyond the display rate are useless.
    if (bench->simulated) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  camera.stop();
  return {};
}

}  // namespace

LookPresenter::LookPresenter(Workbench& bench, QObject* parent) : QObject(parent), bench_(bench) {
  timer_.setInterval(picture_period_ms);
  connect(&timer_, &QTimer::timeout, this, &LookPresenter::take_latest);
  timer_.start();
}

void LookPresenter::start() {
  LiveFeed& feed = bench_.feed();
  bench_.run(Activity::looking,
             [&feed](const Plan& plan, const std::stop_token& stop) { return look(plan, feed, stop); });
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
