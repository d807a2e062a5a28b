// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/usb/seek_source.h"

#include <algorithm>
#include <utility>

#include "acquisition/base/host_clock.h"
#include "acquisition/base/try.h"
#include "acquisition/core/control_text.h"
#include "acquisition/core/serial_number.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;

/// A camera sometimes drops the beginning of the first frame after initialisation; it is then initialised again.
constexpr int initialisation_attempts = 3;
/// Most frames before the shutter's; a camera sends it among the first ten.
constexpr int most_calibration_frames = 40;
constexpr auto calibration_frame_timeout = 900ms;
/// Time limit of a frame, even if its bytes arrive slowly: at 7 Hz a frame takes 0.15 s, and the shutter half a second.
constexpr auto calibration_frame_patience = 2s;
/// Time limit of all attempts together; a camera needs two seconds.
constexpr auto calibration_patience = 20s;
/// Eight seconds of the fastest camera, 23 MiB.
constexpr std::size_t frames_kept = 128;

}  // namespace

SeekSource::SeekSource(UsbContext context, UsbConnection connection, SeekModel model)
    : context_(std::move(context)), connection_(std::move(connection)), model_(model) {}

SeekSource::~SeekSource() {
  stop();
}

Result<std::unique_ptr<FrameSource>> SeekSource::create(UsbContext context, const SeekOnBus& camera, std::string id,
                                                        UsbConnection connection) {
  auto source = std::unique_ptr<SeekSource>(new SeekSource(std::move(context), std::move(connection), camera.model));
  SourceInfo& info = source->info_;
  const auto serial = source->connection_.serial_number();
  const auto firmware = source->connection_.firmware();
  if (!serial || !firmware) {
    return fail(ErrorCode::not_found, camera.address + ": " + (serial ? firmware : serial).error().message);
  }
  info.id = std::move(id);
  info.vendor = "Seek Thermal";
  info.model = to_string(camera.model);
  info.serial = *serial;
  info.firmware = *firmware;
  info.transport = "USB (Seek)";
  info.width = geometry(camera.model).picture.width;
  info.height = geometry(camera.model).picture.height;
  info.pixel_format = "Mono16";
  info.significant_bits = 16;
  if (auto warning = placeholder_serial_warning(info.serial); !warning.empty())
    info.warnings.push_back(std::move(warning));
  info.settings["ShutterLevel"] = std::to_string(seek_shutter_level);
  source->update_scale();
  return source;
}

void SeekSource::update_scale() {
  RadiometricScale scale;
  if (kelvin_per_count_ > 0) {
    scale = RadiometricScale::linear({.kelvin_per_count = kelvin_per_count_, .offset_k = offset_k_}).value_or(scale);
  }
  info_.scale = scale;
  scale_ = std::make_shared<const RadiometricScale>(scale);
}

Result<void> SeekSource::initialise() {
  for (const auto& transfer : seek_initialisation(model_)) {
    if (!running_) return fail(ErrorCode::interrupted, "stopped");
    auto done = connection_.control(transfer);
    if (!done && transfer.request == SeekRequest::target_platform && done.error().code == ErrorCode::io) {
      // If a program ended without putting the camera to sleep, the camera still streams and refuses until it sleeps.
      sleep();
      done = connection_.control(transfer);
    }
    if (!done) return fail("initialising", done.error());
  }
  return {};
}

Result<SeekFrame> SeekSource::read_frame(std::chrono::steady_clock::time_point latest) {
  const auto deadline = std::min(latest, std::chrono::steady_clock::now() + calibration_frame_patience);
  TODBENCH_TRY_VOID(connection_.control(seek_frame_request(model_)));
  std::vector<std::uint8_t> bytes;
  const std::size_t wanted = geometry(model_).frame_bytes();
  while (bytes.size() < wanted) {
    if (!running_) return fail(ErrorCode::interrupted, "stopped");
    if (std::chrono::steady_clock::now() > deadline) {
      return fail(ErrorCode::io, "its first frames did not arrive in time");
    }
    TODBENCH_TRY(const auto more, connection_.bulk_in(wanted - bytes.size(), calibration_frame_timeout));
    if (more.empty()) break;
    bytes.insert(bytes.end(), more.begin(), more.end());
  }
  return parse_seek_frame(bytes, model_);
}

Result<void> SeekSource::read_calibration_frames(std::chrono::steady_clock::time_point deadline) {
  shutter_.release();
  const auto first = read_frame(deadline);
  if (!first) return tl::unexpected(first.error());
  if (!first->is(SeekFrameKind::calibration)) {
    return fail(ErrorCode::io, "the first frame is of kind " + std::to_string(first->kind) + ", expected 4");
  }
  dead_ = SeekDeadPixels(first->picture);
  info_.settings["DeadPixels"] = std::to_string(dead_.count());
  TODBENCH_TRY_VOID(dead_.check());
  for (int k = 0; k < most_calibration_frames && running_; ++k) {
    TODBENCH_TRY(const auto frame, read_frame(deadline));
    if (!frame.is(SeekFrameKind::shutter)) continue;
    shutter_ = frame.picture;
    shutter_time_ns_ = monotonic_ns();
    return {};
  }
  if (!running_) return fail(ErrorCode::interrupted, "stopped");
  return fail(ErrorCode::io, "no shutter frame among the first " + std::to_string(most_calibration_frames) + " frames");
}

Result<void> SeekSource::calibrate() {
  const auto deadline = std::chrono::steady_clock::now() + calibration_patience;
  Result<void> done;
  for (int attempt = 0; attempt < initialisation_attempts; ++attempt) {
    done = initialise();
    if (done) done = read_calibration_frames(deadline);
    if (std::chrono::steady_clock::now() > deadline) break;
    if (done || done.error().code == ErrorCode::disconnected || done.error().code == ErrorCode::interrupted ||
        done.error().code == ErrorCode::calibration)
      break;
  }
  return done;
}

Result<void> SeekSource::start() {
  if (lost_) return tl::unexpected(disconnected());
  const std::lock_guard lock(mutex_);
  if (stream_ && running_) return {};
  stream_.reset();
  running_ = true;
  pictures_begun_ = false;
  sequence_ = FrameSequence(FrameNumberKind::wrap16, 0);
  corrected_last_ = false;
  if (auto calibrated = calibrate(); !calibrated) {
    running_ = false;
    return failed(calibrated.error());
  }
  auto stream = SeekStream::start(context_, connection_, model_, frames_kept);
  if (!stream) {
    running_ = false;
    return failed(stream.error());
  }
  stream_ = std::move(*stream);
  return {};
}

void SeekSource::sleep() {
  for (int k = 0; k < 3; ++k) static_cast<void>(connection_.control(seek_sleep()));
}

void SeekSource::stop() {
  running_ = false;
  const std::lock_guard lock(mutex_);
  // A start() between the two lines above has precedence: its stream continues.
  if (running_ || !stream_) return;
  stream_->end();  // a reader may still hold it
  stream_.reset();
  if (!lost_) sleep();
}

Frame SeekSource::frame_of(const SeekArrival& arrival) {
  Frame frame;
  frame.host_time_ns = arrival.host_time_ns;
  frame.significant_bits = info_.significant_bits;
  frame.scale = scale_;
  const auto parsed = parse_seek_frame(arrival.bytes, model_);
  pictures_begun_ = true;
  const bool corrects = parsed && !parsed->is(SeekFrameKind::image);
  const FramePlace place = sequence_.next({.number = seek_counter(arrival.bytes, model_),
                                           .device_time_ns = 0,
                                           .host_time_ns = arrival.host_time_ns,
                                           .may_pause = std::exchange(corrected_last_, corrects) || corrects,
                                           .after_unread = arrival.after_unread});
  frame.sequence = place.sequence;
  frame.numbering = place.numbering;
  if (!parsed) {
    frame.status = FrameStatus::incomplete;
    frame.counts = cv::Mat1w(info_.height, info_.width, std::uint16_t{0});
    return frame;
  }
  if (parsed->is(SeekFrameKind::shutter)) {
    shutter_ = parsed->picture;
    shutter_time_ns_ = arrival.host_time_ns;
  }
  frame.correction = corrects ? CorrectionState::running : CorrectionState::idle;
  frame.since_correction_s = static_cast<double>(arrival.host_time_ns - shutter_time_ns_) * 1e-9;
  frame.counts = corrected_seek_picture(parsed->picture, shutter_, dead_);
  return frame;
}

Result<Frame> SeekSource::next(std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  for (;;) {
    std::shared_ptr<SeekStream> stream;
    if (lost_) return tl::unexpected(disconnected());
    {
      const std::lock_guard lock(mutex_);
      stream = stream_;
    }
    if (!running_ || !stream) return fail(ErrorCode::interrupted, info_.id + " is stopped");
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    const auto arrival = stream->next(std::max(left, 0ms));
    if (!arrival) return failed(arrival.error());
    // Calibration continues for some frames after the first shutter picture: the sequence begins with the first image.
    const auto parsed = pictures_begun_ ? Result<SeekFrame>() : parse_seek_frame(arrival->bytes, model_);
    if (!pictures_begun_ && (!parsed || !parsed->is(SeekFrameKind::image))) {
      if (parsed && parsed->is(SeekFrameKind::shutter)) {
        shutter_ = parsed->picture;
        shutter_time_ns_ = arrival->host_time_ns;
      }
      continue;
    }
    return frame_of(*arrival);
  }
}

tl::unexpected<Error> SeekSource::failed(const Error& error) {
  if (error.code == ErrorCode::disconnected) lost_ = true;
  // An error of a camera that is still present is not a loss, but the camera cannot be measured.
  const auto code = error.code == ErrorCode::io ? ErrorCode::not_found : error.code;
  return fail("camera " + info_.id, with_code(code, error));
}

Error SeekSource::disconnected() const {
  return {ErrorCode::disconnected, "camera " + info_.id + " is no longer connected"};
}

Result<std::string> SeekSource::get(const std::string& feature) {
  if (lost_) return tl::unexpected(disconnected());
  if (feature == "PixelFormat") return info_.pixel_format;
  if (feature == "Width") return std::to_string(info_.width);
  if (feature == "Height") return std::to_string(info_.height);
  if (feature == "DeviceVendorName") return info_.vendor;
  if (feature == "DeviceModelName") return info_.model;
  if (feature == "DeviceSerialNumber") return info_.serial;
  if (feature == "TemperatureLinearScale") return control_text(kelvin_per_count_);
  if (feature == "TemperatureLinearOffset") return control_text(offset_k_);
  if (const auto found = info_.settings.find(feature); found != info_.settings.end()) return found->second;
  return fail(ErrorCode::invalid_input, "camera " + info_.id + " has no feature '" + feature + "'");
}

Result<void> SeekSource::set(const std::string& feature, const std::string& value) {
  if (lost_) return tl::unexpected(disconnected());
  const bool is_scale = feature == "TemperatureLinearScale";
  if (!is_scale && feature != "TemperatureLinearOffset") {
    return fail(ErrorCode::invalid_input, "camera " + info_.id + " has no feature '" + feature + "' that can be set");
  }
  const auto kelvin = control_number(value);
  if (!kelvin || (is_scale && !(*kelvin > 0))) {
    return fail(ErrorCode::invalid_input,
                feature + " = " + value + ": expected " + (is_scale ? "kelvin per count, above 0" : "kelvin"));
  }
  (is_scale ? kelvin_per_count_ : offset_k_) = *kelvin;
  info_.settings[feature] = control_text(*kelvin);
  update_scale();
  return {};
}

Result<void> SeekSource::correct_nonuniformity() {
  return fail(ErrorCode::invalid_input,
              "camera " + info_.id + " closes its shutter automatically; it has no command for a correction");
}

}  // namespace todbench
