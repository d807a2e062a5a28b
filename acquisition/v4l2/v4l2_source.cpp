// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/v4l2/v4l2_source.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "acquisition/base/host_clock.h"
#include "acquisition/base/try.h"
#include "acquisition/core/control_text.h"
#include "acquisition/core/serial_number.h"

namespace todbench {
namespace {

/// Polling interval of a waiting reader, for drivers that do not wake it when their device is gone.
constexpr std::chrono::milliseconds longest_nap{250};
/// A Lepton that corrects itself at the start of a stream is silent for up to 3 s.
constexpr std::chrono::seconds patience_with_first_frame{5};
/// A correction that interrupts the stream has ended by then.
constexpr std::int64_t longest_correction_ns = 5'000'000'000;
/// Frames between the receiving thread and the reader: 5 s of a 50 Hz camera, 37 MiB of 320 x 240.
constexpr std::size_t most_arrivals = 256;

/// Tiny1 modules measure up to 150 degrees Celsius in their high-gain mode (data sheet). This limit is 180 degrees in
/// counts of 1/64 K; if more than a hundredth of the pixels exceed it, they are not single bad pixels.
constexpr double most_high_gain_counts = 64 * (180 + 273.15);
constexpr double most_share_above = 0.01;

bool beyond_high_gain(const cv::Mat1w& counts) {
  const auto above = static_cast<double>(cv::countNonZero(counts > most_high_gain_counts));
  return above > most_share_above * static_cast<double>(counts.total());
}

std::shared_ptr<const RadiometricScale> no_scale() {
  static const auto none = std::make_shared<const RadiometricScale>();
  return none;
}

std::string kernel_version(std::uint32_t version) {
  return std::to_string(version >> 16U & 0xFFU) + "." + std::to_string(version >> 8U & 0xFFU) + "." +
         std::to_string(version & 0xFFU);
}

}  // namespace

V4l2Source::V4l2Source(VideoNode node, V4l2Options options, VideoDevice device, VideoWatch watch, Descriptor wake)
    : node_(std::move(node)),
      options_(std::move(options)),
      watch_(std::move(watch)),
      wake_(std::move(wake)),
      device_(std::move(device)) {}

V4l2Source::~V4l2Source() {
  stop();
}

Result<std::unique_ptr<FrameSource>> V4l2Source::create(const VideoNode& node, const V4l2Options& options) {
  // The watch begins before the node is opened, so that no removal is missed.
  TODBENCH_TRY(auto watch, VideoWatch::create());
  TODBENCH_TRY(auto device, VideoDevice::open(node.node));
  Descriptor wake(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!wake.is_open()) return fail(ErrorCode::io, "the event descriptor cannot be created");
  auto source =
      std::unique_ptr<V4l2Source>(new V4l2Source(node, options, std::move(device), std::move(watch), std::move(wake)));
  if (const auto set = source->take_layout({.pixel_format = options.pixel_format}); !set)
    return tl::unexpected(set.error());
  source->controls_ = list_controls(source->device_);
  source->open_serial_port();
  source->refresh();
  TODBENCH_TRY_VOID(source->learn_scale());
  return source;
}

Result<void> V4l2Source::take_layout(const WantedLayout& wanted) {
  auto layout = choose_layout(device_.modes(wanted.frame), node_.family(), wanted);
  if (!layout) return tl::unexpected(layout.error());
  layout = device_.set_format(*layout);
  if (!layout) return tl::unexpected(layout.error());
  layout_ = *layout;
  wanted_ = wanted;
  telemetry_came_ = false;
  return {};
}

Result<void> V4l2Source::set_layout(const std::string& feature, const std::string& value) {
  WantedLayout wanted = wanted_;
  if (feature == "PixelFormat") {
    wanted.pixel_format = value;
  } else {
    wanted.frame = frame_size_of(value);
    if (!wanted.frame) return fail(ErrorCode::not_found, "WIDTHxHEIGHT in pixels, for example 640x512");
  }
  return take_layout(wanted);
}

void V4l2Source::open_serial_port() {
  if (node_.family() != VideoFamily::boson) return;
  const auto node = serial_port_of(node_.device_path);
  if (!node) {
    serial_port_problem_ = "the system has no serial port of this camera";
    return;
  }
  auto port = BosonPort::open(*node);
  if (port) {
    serial_port_ = *std::move(port);
  } else {
    serial_port_problem_ = port.error().message;
  }
}

void V4l2Source::refresh_serial_port() {
  if (node_.family() != VideoFamily::boson) return;
  for (const auto& [feature, function, name] :
       {std::tuple{"GainMode", BosonFunction::get_gain_mode, &boson_gain_mode},
        std::tuple{"FFCMode", BosonFunction::get_correction_mode, &boson_correction_mode}}) {
    if (!serial_port_) break;
    const auto number = serial_port_->mode(function);
    if (number) {
      const std::string_view known = name(*number);
      info_.settings[feature] = known.empty() ? std::to_string(*number) : std::string(known);
    } else {
      // A port that does not answer would delay every later call.
      serial_port_problem_ = number.error().message;
      serial_port_.reset();
    }
  }
  if (!serial_port_)
    info_.warnings.push_back("The serial port of the Boson is not used: " + serial_port_problem_ +
                             ". Its gain mode is unknown, and it cannot be told to correct its non-uniformity.");
}

Result<void> V4l2Source::set_boson_mode(const std::string& feature, const std::string& value) {
  const bool gain = feature == "GainMode";
  constexpr std::uint32_t most_modes = 8;
  std::string expected;
  for (std::uint32_t number = 0; number < most_modes; ++number) {
    const std::string_view name = gain ? boson_gain_mode(number) : boson_correction_mode(number);
    if (name.empty()) break;
    if (name == value)
      return serial_port_->set_mode(gain ? BosonFunction::set_gain_mode : BosonFunction::set_correction_mode, number);
    expected += (expected.empty() ? "" : ", ") + std::string(name);
  }
  return fail(ErrorCode::not_found, expected);
}

Result<void> V4l2Source::correct_boson() {
  // From the first command on, only commands start a correction.
  if (info_.settings["FFCMode"] != "Manual") {
    TODBENCH_TRY_VOID(set_boson_mode("FFCMode", "Manual"));
    info_.settings["FFCMode"] = "Manual";
  }
  may_pause_until_ns_ = monotonic_ns() + longest_correction_ns;
  TODBENCH_TRY_VOID(serial_port_->call(BosonFunction::run_correction));
  return {};
}

void V4l2Source::refresh() {
  info_.id = node_.id;
  info_.vendor = node_.vendor;
  info_.model = node_.model;
  info_.serial = node_.serial;
  info_.firmware = node_.firmware;
  info_.transport = "V4L2 (" + device_.capability().driver + ")";
  info_.width = layout_.picture.width;
  info_.height = layout_.picture.height;
  info_.pixel_format = layout_.pixel_format;
  info_.significant_bits = layout_.significant_bits;
  info_.frame_rate_hz = device_.frame_rate_hz();
  info_.settings = {{"VideoFormat", fourcc_text(layout_.mode.fourcc) + " " + std::to_string(layout_.mode.width) + "x" +
                                        std::to_string(layout_.mode.height)},
                    {"TelemetryRows", std::to_string(layout_.telemetry_rows + layout_.foreign_rows)},
                    {"DriverVersion", kernel_version(device_.capability().version)}};
  for (const auto& control : controls_) {
    if (!control.readable) continue;
    if (const auto value = get_control(device_, control)) info_.settings[control.name] = *value;
  }
  info_.warnings.clear();
  if (node_.serial.empty()) {
    info_.warnings.emplace_back("The camera has no serial number. The program identifies it by its USB port.");
  }
  if (auto warning = placeholder_serial_warning(node_.serial); !warning.empty())
    info_.warnings.push_back(std::move(warning));
  if (layout_.significant_bits == 8) {
    info_.warnings.emplace_back("The camera sends 8 bits. One count may be larger than its noise.");
  }
  if (layout_.kelvin_per_count > 0 && !stated_kelvin_per_count_) {
    info_.warnings.emplace_back(
        "The camera does not report its gain mode. The program assumes the high-gain mode of this family, with 1/64 K "
        "per count. If the camera is in another mode, state TemperatureLinearScale in [camera.settings]. Counts above "
        "180 degrees Celsius, the limit of the high-gain mode, have no temperature.");
  }
  refresh_serial_port();
  if (node_.family() == VideoFamily::boson && layout_.kelvin_per_count == 0 && !stated_kelvin_per_count_) {
    info_.warnings.emplace_back(
        "A Boson reports no scale. Its counts have no temperature until TemperatureLinearScale is stated in "
        "[camera.settings].");
  }
  const double kelvin_per_count = stated_kelvin_per_count_.value_or(layout_.kelvin_per_count);
  // A scale from telemetry stays valid until telemetry changes it.
  RadiometricScale scale = layout_.telemetry_rows > 0 ? info_.scale : RadiometricScale();
  if (kelvin_per_count > 0) {
    scale =
        RadiometricScale::linear({.kelvin_per_count = kelvin_per_count, .offset_k = stated_offset_k_}).value_or(scale);
  }
  set_scale(scale);
}

void V4l2Source::set_scale(const RadiometricScale& scale) {
  info_.scale = scale;
  scale_ = std::make_shared<const RadiometricScale>(scale);
}

Result<void> V4l2Source::start() {
  const std::lock_guard control(control_);
  if (is_lost()) return tl::unexpected(disconnected());
  if (receiver_.joinable()) return {};
  if (!device_.check_format(layout_)) {
    // Another program may have used the camera since then; its format is set again.
    if (const auto set = device_.set_format(layout_); !set) return fail("starting " + info_.id, noted(set.error()));
  }
  std::uint64_t stale = 0;
  static_cast<void>(!::read(wake_.get(), &stale, sizeof stale));
  sequence_ = FrameSequence(FrameNumberKind::wrap32, info_.frame_rate_hz);
  corrected_last_ = false;
  last_counter_.reset();
  repeated_ = 0;
  if (const auto started = device_.start(options_.buffers); !started) {
    return fail("starting " + info_.id, noted(started.error()));
  }
  {
    const std::lock_guard lock(inbox_.mutex);
    inbox_.arrivals.clear();
    inbox_.running = true;
  }
  receiver_ = std::jthread([this](const std::stop_token& stop) { receive(stop); });
  return {};
}

void V4l2Source::stop() {
  {
    const std::lock_guard lock(inbox_.mutex);
    inbox_.running = false;
  }
  inbox_.changed.notify_all();
  const std::lock_guard control(control_);
  if (!receiver_.joinable()) return;
  receiver_.request_stop();
  const std::uint64_t one = 1;
  static_cast<void>(!::write(wake_.get(), &one, sizeof one));
  receiver_.join();
  device_.stop();
  const std::lock_guard lock(inbox_.mutex);
  inbox_.running = false;
  inbox_.arrivals.clear();
}

void V4l2Source::receive(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const auto taken = device_.take([this](const VideoBuffer& buffer) { keep(buffer); });
    if (!taken) {
      // Every failure of a stream ends it: only reopening the camera helps.
      mark_lost();
      return;
    }
    if (*taken) continue;
    std::array<pollfd, 3> waiting{{{.fd = device_.fd(), .events = POLLIN, .revents = 0},
                                   {.fd = wake_.get(), .events = POLLIN, .revents = 0},
                                   {.fd = watch_.fd(), .events = POLLIN, .revents = 0}}};
    static_cast<void>(::poll(waiting.data(), waiting.size(), static_cast<int>(longest_nap.count())));
    if (device_has_gone()) {
      mark_lost();
      return;
    }
  }
}

bool V4l2Source::device_has_gone() {
  bool gone = false;
  while (const auto event = watch_.next(std::chrono::milliseconds(0))) {
    gone = gone || (event->kind == VideoEvent::Kind::removed && event->sys_path == node_.sys_path);
  }
  return gone;
}

void V4l2Source::keep(const VideoBuffer& buffer) {
  Arrival arrival;
  arrival.sequence = buffer.sequence;
  Frame& frame = arrival.frame;
  frame.host_time_ns = monotonic_ns();
  frame.device_time_ns = buffer.time_ns;
  frame.significant_bits = layout_.significant_bits;
  auto picture = read_video_frame(buffer.bytes, layout_);
  if (picture) {
    frame.counts = picture->counts;
    arrival.telemetry = picture->telemetry;
  } else {
    frame.counts = cv::Mat1w(layout_.picture.size(), std::uint16_t{0});
    frame.status = FrameStatus::wrong_size;
  }
  if (picture && picture->begins_in_the_middle) frame.status = FrameStatus::incomplete;
  if (buffer.oversized) frame.status = FrameStatus::wrong_size;
  // UVC marks frames with missing packets.
  if (buffer.damaged) frame.status = FrameStatus::incomplete;
  {
    const std::lock_guard lock(inbox_.mutex);
    // A slow reader loses the newest frames, which shows as a gap.
    const bool full = inbox_.arrivals.size() >= most_arrivals;
    arrival.after_unread = std::exchange(inbox_.overflowed, full);
    if (!full) inbox_.arrivals.push_back(std::move(arrival));
  }
  inbox_.changed.notify_all();
}

std::optional<Frame> V4l2Source::finished(Arrival arrival) {
  Frame& frame = arrival.frame;
  if (arrival.telemetry) {
    const LeptonTelemetry& telemetry = *arrival.telemetry;
    // A Lepton exposes 26 times a second and sends every third; its bridge may send one twice.
    if (last_counter_ == telemetry.frame_counter) {
      ++repeated_;
      return std::nullopt;
    }
    last_counter_ = telemetry.frame_counter;
    telemetry_came_ = true;
    frame.device_time_ns = std::int64_t{telemetry.time_ms} * 1'000'000;
    const bool corrects = telemetry.ffc_state() == FfcState::imminent || telemetry.ffc_state() == FfcState::in_progress;
    frame.correction = corrects ? CorrectionState::running : CorrectionState::idle;
    frame.since_correction_s = telemetry.since_ffc_s().value_or(-1);
    if (const auto scale = scale_of(telemetry); scale != info_.scale) set_scale(scale);
  }
  const bool corrects = frame.correction == CorrectionState::running;
  const bool corrected = std::exchange(corrected_last_, corrects);
  const FramePlace place =
      sequence_.next({.number = static_cast<std::uint32_t>(arrival.sequence - repeated_),
                      .device_time_ns = frame.device_time_ns,
                      .host_time_ns = frame.host_time_ns,
                      .may_pause = corrects || corrected || frame.host_time_ns < may_pause_until_ns_,
                      .after_unread = arrival.after_unread});
  frame.sequence = place.sequence;
  frame.numbering = place.numbering;
  const bool assumed = layout_.kelvin_per_count > 0 && !stated_kelvin_per_count_;
  frame.scale = assumed && beyond_high_gain(frame.counts) ? no_scale() : scale_;
  return std::move(frame);
}

RadiometricScale V4l2Source::scale_of(const LeptonTelemetry& telemetry) const {
  if (stated_kelvin_per_count_) return info_.scale;
  if (!telemetry.kelvin_per_count || telemetry.agc()) return {};
  return RadiometricScale::linear({.kelvin_per_count = *telemetry.kelvin_per_count}).value_or(RadiometricScale());
}

Result<void> V4l2Source::learn_scale() {
  if (layout_.telemetry_rows == 0) return {};
  TODBENCH_TRY_VOID(start());
  const auto deadline = Clock::now() + patience_with_first_frame;
  Result<Frame> frame;
  do {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    frame = next(std::max(left, std::chrono::milliseconds(1)));
  } while (frame && !telemetry_came_ && Clock::now() < deadline);
  stop();
  if (!frame) return fail("reading the telemetry", frame.error());
  if (!telemetry_came_) {
    info_.warnings.emplace_back(
        "The rows below the picture contain no telemetry, so the scale and the corrections of the camera are unknown.");
  }
  return {};
}

Result<Frame> V4l2Source::next(std::chrono::milliseconds timeout) {
  const auto deadline = Clock::now() + timeout;
  for (;;) {
    Arrival arrival;
    {
      std::unique_lock lock(inbox_.mutex);
      const auto ready = [&] { return !inbox_.running || inbox_.lost || !inbox_.arrivals.empty(); };
      if (!inbox_.changed.wait_until(lock, deadline, ready)) {
        return fail(ErrorCode::timeout,
                    "no frame from " + info_.id + " within " + std::to_string(timeout.count()) + " ms");
      }
      if (inbox_.lost && (inbox_.arrivals.empty() || !inbox_.running)) return tl::unexpected(disconnected());
      if (!inbox_.running) return fail(ErrorCode::interrupted, info_.id + " is stopped");
      arrival = std::move(inbox_.arrivals.front());
      inbox_.arrivals.pop_front();
    }
    if (auto frame = finished(std::move(arrival))) return std::move(*frame);
  }
}

bool V4l2Source::is_lost() const {
  const std::lock_guard lock(inbox_.mutex);
  return inbox_.lost;
}

void V4l2Source::mark_lost() {
  {
    const std::lock_guard lock(inbox_.mutex);
    inbox_.lost = true;
  }
  inbox_.changed.notify_all();
}

Error V4l2Source::noted(const Error& error) {
  if (error.code == ErrorCode::disconnected) mark_lost();
  return error;
}

Error V4l2Source::disconnected() const {
  return {ErrorCode::disconnected, "camera " + info_.id + " is no longer connected"};
}

Result<std::string> V4l2Source::get(const std::string& feature) {
  const std::lock_guard control(control_);
  if (is_lost()) return tl::unexpected(disconnected());
  if (feature == "PixelFormat") return info_.pixel_format;
  if (feature == frame_size_feature) return frame_size_text({layout_.mode.width, layout_.mode.height});
  if (feature == "Width") return std::to_string(info_.width);
  if (feature == "Height") return std::to_string(info_.height);
  if (feature == "DeviceVendorName") return info_.vendor;
  if (feature == "DeviceModelName") return info_.model;
  if (feature == "DeviceSerialNumber") return info_.serial;
  if (feature == "AcquisitionFrameRate") return control_text(info_.frame_rate_hz);
  if (feature == "TemperatureLinearScale") return control_text(info_.scale.kelvin_per_count(0).value_or(0));
  if (feature == "TemperatureLinearOffset") return control_text(info_.scale.kelvin(0).value_or(0));
  if (serial_port_ && (feature == "GainMode" || feature == "FFCMode")) return info_.settings[feature];
  const VideoControl* known = find_control(controls_, feature);
  if (known == nullptr)
    return fail(ErrorCode::invalid_input, "camera " + info_.id + " has no feature '" + feature + "'");
  return get_control(device_, *known);
}

Result<void> V4l2Source::set(const std::string& feature, const std::string& value) {
  const std::lock_guard control(control_);
  if (is_lost()) return tl::unexpected(disconnected());
  const auto refused = [&](const std::string& expected) {
    return fail(ErrorCode::invalid_input, feature + " = " + value + ": expected " + expected);
  };
  Result<void> done;
  if (feature == "TemperatureLinearScale" || feature == "TemperatureLinearOffset") {
    const auto kelvin = control_number(value);
    const bool is_scale = feature == "TemperatureLinearScale";
    if (!kelvin || (is_scale && !(*kelvin > 0))) return refused(is_scale ? "kelvin per count, above 0" : "kelvin");
    (is_scale ? stated_kelvin_per_count_.emplace() : stated_offset_k_) = *kelvin;
  } else if (feature == "PixelFormat" || feature == frame_size_feature || feature == "AcquisitionFrameRate") {
    if (receiver_.joinable())
      return fail(ErrorCode::invalid_input, feature + " cannot change while the camera streams");
    const auto rate = control_number(value);
    if (feature != "AcquisitionFrameRate") {
      done = set_layout(feature, value);
      if (!done && done.error().code == ErrorCode::not_found) return refused(done.error().message);
    } else if (!rate) {
      return refused("frames per second");
    } else {
      done = device_.set_frame_rate(*rate);
    }
  } else if (serial_port_ && (feature == "GainMode" || feature == "FFCMode")) {
    done = set_boson_mode(feature, value);
    if (!done && done.error().code == ErrorCode::not_found) return refused(done.error().message);
  } else if (feature == nuc_command_feature) {
    if (find_control(controls_, value) == nullptr) return refused("the name of a control of the camera");
    nuc_command_ = value;
  } else if (const VideoControl* known = find_control(controls_, feature)) {
    done = set_control(device_, *known, value);
  } else {
    return fail(ErrorCode::invalid_input, "camera " + info_.id + " has no feature '" + feature + "'");
  }
  if (!done) return tl::unexpected(noted(done.error()));
  refresh();
  return {};
}

Result<void> V4l2Source::correct_nonuniformity() {
  const std::lock_guard control(control_);
  if (is_lost()) return tl::unexpected(disconnected());
  if (serial_port_ && nuc_command_.empty()) return correct_boson();
  const VideoControl* button =
      nuc_command_.empty() ? nonuniformity_button(controls_) : find_control(controls_, nuc_command_);
  if (button == nullptr) {
    return fail(ErrorCode::invalid_input, "camera " + info_.id +
                                              " has no control with a known name for the non-uniformity correction. "
                                              "State the name in the plan: [camera] nuc_command");
  }
  may_pause_until_ns_ = monotonic_ns() + longest_correction_ns;
  if (const auto done = set_control(device_, *button, "1"); !done) return tl::unexpected(noted(done.error()));
  return {};
}

}  // namespace todbench
