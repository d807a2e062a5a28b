// SPDX-License-Identifier: GPL-3.0-or-later
// Stream of a camera: buffers, arrivals, heartbeat. The set-up is in aravis_set_up.cpp.
#include "acquisition/aravis/aravis_source.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "acquisition/aravis/frame_buffers.h"
#include "acquisition/aravis/genicam_features.h"
#include "acquisition/aravis/gvcp_client.h"
#include "acquisition/base/background.h"
#include "acquisition/base/host_clock.h"
#include "acquisition/core/control_text.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;

/// Longer than any answer on a working network (measured below 6 ms at full load), short enough for stop().
constexpr auto ping_patience = 400ms;
/// Longer than the silence of a non-uniformity correction that interrupts the stream (0.5 s).
constexpr auto silence_before_ping = 2s;
/// A camera is lost after two unanswered pings and this silence.
constexpr auto silence_before_lost = 3s;

/// Bytes that Aravis discarded over USB because they belonged to no frame or exceeded their buffer; 0 on a network.
/// Call it on the stream's own thread.
std::uint64_t ignored_bytes(ArvStream* stream) {
  const bool usb = stream != nullptr && ARV_IS_UV_STREAM(stream);
  return usb ? arv_stream_get_info_uint64_by_name(stream, "n_ignored_bytes") : 0;
}

std::uint64_t underruns(ArvStream* stream) {
  guint64 completed = 0, failed = 0, without_buffer = 0;
  if (stream != nullptr) arv_stream_get_statistics(stream, &completed, &failed, &without_buffer);
  return without_buffer;
}

FrameNumberKind number_kind(ArvDevice* device, AravisTransport transport) {
  if (transport == AravisTransport::usb3_vision) return FrameNumberKind::wide;
  const auto extended = get_feature(device, "GevGVSPExtendedIDMode").value_or("Off");
  return extended == "On" || extended == "true" ? FrameNumberKind::gvsp64 : FrameNumberKind::gvsp16;
}

}  // namespace

AravisSource::~AravisSource() {
  stop();
  if (!is_lost() && !unreachable_stream_) return;
  // Aravis closes the connection with five attempts of 0.5 s per register. If the camera is gone, this runs in the
  // background, because nothing depends on its end.
  finish_in_background([camera = std::move(camera_), stream = std::move(unreachable_stream_)]() mutable {
    stream.reset();  // it holds a reference to the camera's device
  });
}

void AravisSource::on_stream_event(void* data, ArvStreamCallbackType type, ArvBuffer*) {
  auto& tap = *static_cast<StreamTap*>(data);
  const std::uint64_t ignored = ignored_bytes(tap.stream);
  if (type == ARV_STREAM_CALLBACK_TYPE_START_BUFFER) tap.ignored_bytes = ignored;
  if (type != ARV_STREAM_CALLBACK_TYPE_BUFFER_DONE) return;
  const std::uint64_t without_buffer = underruns(tap.stream);
  Events& events = *tap.events;
  {
    const std::lock_guard lock(events.mutex);
    // Frames over USB are consecutive: bytes discarded since this one began were its own.
    events.arrivals.push_back({.host_time_ns = monotonic_ns(),
                               .oversized = ignored != tap.ignored_bytes,
                               .after_unread = without_buffer != std::exchange(tap.underruns, without_buffer)});
    events.last_sign_of_life = Clock::now();
    events.failed_pings = 0;
  }
  events.changed.notify_all();
}

void AravisSource::Events::mark_lost() {
  {
    const std::lock_guard lock(mutex);
    lost = true;
  }
  changed.notify_all();
}

Result<void> AravisSource::start() {
  const std::lock_guard control(control_);
  if (is_lost()) return tl::unexpected(disconnected());
  // Destroyed without any lock: a stream joins its thread, whose callback takes events_->mutex.
  std::shared_ptr<ArvStream> unreachable = std::move(unreachable_stream_);
  std::shared_ptr<ArvStream> left_over;
  {
    const std::lock_guard lock(events_->mutex);
    if (stream_ && events_->running) return {};
    left_over = std::move(stream_);
  }
  const auto failed = [&](const Error& error) {
    if (error.code == ErrorCode::disconnected) mark_lost();
    return fail("starting " + info_.id, error);
  };
  if (const auto read = refresh(); !read) return failed(read.error());
  if (left_over || unreachable) {
    // The camera did not answer at stop(), or another thread is about to stop it: it may still be sending to the old
    // stream.
    arv_camera_stop_acquisition(camera_.get(), nullptr);
    left_over.reset();
    unreachable.reset();
  }
  auto stream = create_stream();
  if (!stream) return failed(stream.error());
  for (int i = buffer_count(info_.frame_rate_hz, format_.payload_bytes); i > 0; --i) {
    arv_stream_push_buffer(stream->get(), new_frame_buffer(buffer_bytes(format_)).release());
  }
  frames_of_wrong_size_ = 0;
  sequence_ = FrameSequence(number_kind(arv_camera_get_device(camera_.get()), options_.transport), info_.frame_rate_hz);
  {
    const std::lock_guard lock(events_->mutex);
    events_->arrivals.clear();
    events_->last_sign_of_life = Clock::now();
    events_->failed_pings = 0;
    events_->running = true;
    stream_ = *stream;
  }
  GErrorSlot error;
  arv_camera_set_acquisition_mode(camera_.get(), ARV_ACQUISITION_MODE_CONTINUOUS, nullptr);
  arv_camera_start_acquisition(camera_.get(), error.out());
  if (!error) return {};
  {
    const std::lock_guard lock(events_->mutex);
    events_->running = false;
    stream_.reset();
  }
  return failed(error.failure(ErrorCode::not_found, "starting the acquisition").value());
}

void AravisSource::stop() {
  {
    const std::lock_guard lock(events_->mutex);
    events_->running = false;
  }
  events_->changed.notify_all();

  const std::lock_guard control(control_);
  std::shared_ptr<ArvStream> stream;
  bool reachable = true;
  {
    const std::lock_guard lock(events_->mutex);
    events_->running = false;
    stream = std::move(stream_);
    reachable = !events_->lost;
  }
  if (!stream) return;
  if (reachable && answers()) {
    arv_camera_stop_acquisition(camera_.get(), nullptr);
  } else {
    // Closing the stream writes to the camera, which takes seconds if it does not answer.
    unreachable_stream_ = std::move(stream);
  }
}

Result<Frame> AravisSource::next(std::chrono::milliseconds timeout) {
  const auto deadline = Clock::now() + timeout;
  for (;;) {
    std::shared_ptr<ArvStream> stream;
    Arrival arrived;
    {
      std::unique_lock lock(events_->mutex);
      const auto ready = [&] { return !events_->running || !events_->arrivals.empty() || events_->lost; };
      if (!events_->changed.wait_until(lock, deadline, ready)) {
        lock.unlock();
        return tl::unexpected(silence(timeout));
      }
      if (events_->lost && (events_->arrivals.empty() || !events_->running)) {
        lock.unlock();
        return tl::unexpected(disconnected());
      }
      if (!events_->running) return fail(ErrorCode::interrupted, info_.id + " is stopped");
      arrived = events_->arrivals.front();
      events_->arrivals.pop_front();
      stream = stream_;
    }
    GObjectPtr<ArvBuffer> buffer(arv_stream_try_pop_buffer(stream.get()));
    if (!buffer) continue;
    std::optional<Frame> frame;
    cv::Size sent;
    if (holds_exposure(buffer.get())) {
      frame = frame_from_buffer(buffer.get(), format_);
      sent = size_of_leader(buffer.get());
      if (arrived.oversized && frame->status == FrameStatus::complete) frame->status = FrameStatus::wrong_size;
      frame->host_time_ns = arrived.host_time_ns;
      const FramePlace place = sequence_.next({.number = frame_id_of(buffer.get()),
                                               .device_time_ns = frame->device_time_ns,
                                               .host_time_ns = frame->host_time_ns,
                                               .may_pause = frame->host_time_ns < may_pause_until_ns_,
                                               .after_unread = arrived.after_unread});
      frame->sequence = place.sequence;
      frame->numbering = place.numbering;
      frame->scale = scale_;
    }
    clear_frame_id(buffer.get());
    arv_stream_push_buffer(stream.get(), buffer.release());
    if (frame) {
      if (auto error = misstated_size(*frame, sent)) return tl::unexpected(*std::move(error));
      return std::move(*frame);
    }
  }
}

std::optional<Error> AravisSource::misstated_size(const Frame& frame, cv::Size sent) {
  constexpr int enough = 16;
  const bool whole = frame.status == FrameStatus::wrong_size && !sent.empty();
  if (frames_of_wrong_size_ < 0 || frame.status == FrameStatus::incomplete) return std::nullopt;
  if (!whole || sent == cv::Size(format_.width, format_.height)) {
    frames_of_wrong_size_ = frame.status == FrameStatus::complete ? -1 : 0;
    return std::nullopt;
  }
  if (++frames_of_wrong_size_ < enough) return std::nullopt;
  return Error{ErrorCode::integrity,
               "camera " + info_.id + " states frames of " + frame_size_text({format_.width, format_.height}) +
                   " but sends frames of " + frame_size_text(sent) +
                   ". If the picture is correct, state its size in the plan: [camera] frame_size = \"" +
                   frame_size_text(sent) + "\""};
}

Error AravisSource::silence(std::chrono::milliseconds timeout) {
  Error nothing{ErrorCode::timeout, "no frame from " + info_.id + " within " + std::to_string(timeout.count()) + " ms"};
  Clock::time_point since;
  {
    const std::lock_guard lock(events_->mutex);
    since = events_->last_sign_of_life;
  }
  if (device_address_.empty() || Clock::now() - since < silence_before_ping) return nothing;
  const bool alive = answers();
  {
    const std::lock_guard lock(events_->mutex);
    if (alive) {
      events_->failed_pings = 0;
      events_->last_sign_of_life = Clock::now();
      return nothing;
    }
    ++events_->failed_pings;
    if (events_->failed_pings < 2 || Clock::now() - events_->last_sign_of_life < silence_before_lost) return nothing;
    events_->lost = true;
  }
  return disconnected();
}

bool AravisSource::answers() const {
  if (device_address_.empty()) return true;
  return gvcp_read_register(device_address_, gvcp_version_register, ping_patience).has_value();
}

bool AravisSource::is_lost() const {
  const std::lock_guard lock(events_->mutex);
  return events_->lost;
}

void AravisSource::mark_lost() {
  events_->mark_lost();
}

Error AravisSource::disconnected() const {
  return {ErrorCode::disconnected, "camera " + info_.id + " no longer answers"};
}

}  // namespace todbench
