#include "acquisition/aravis/aravis_source.h"

#include <algorithm>
#include <optional>
#include <thread>

#include "acquisition/aravis/frame_buffers.h"
#include "acquisition/aravis/genicam_features.h"
#include "acquisition/aravis/gvcp_client.h"
#include "acquisition/aravis/socket_buffer.h"
#include "acquisition/aravis/test_ramp.h"
#include "acquisition/core/host_clock.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;

/// A camera on loopback is a program: 8000 bytes need six times fewer packets than 1500, and the MTU is 65536.
constexpr int loopback_packet_bytes = 8000;
/// Longer than any answer on a working network (measured below 6 ms at full load), short enough for stop().
constexpr auto ping_patience = 400ms;
/// Longer than a non-uniformity correction that interrupts the stream (0.5 s) is silent.
constexpr auto silence_before_ping = 2s;
/// A test pattern is in the picture some frames after it was chosen.
constexpr int ramp_frames = 10;
constexpr auto ramp_patience = 1s;
/// Two unanswered pings and this much silence make a camera lost.
constexpr auto silence_before_lost = 3s;

FrameIdKind frame_id_kind(ArvDevice* device, AravisTransport transport) {
  if (transport == AravisTransport::usb3_vision) return FrameIdKind::wide;
  const auto extended = get_feature(device, "GevGVSPExtendedIDMode").value_or("Off");
  return extended == "On" || extended == "true" ? FrameIdKind::wide : FrameIdKind::gvsp16;
}

/// GVCP capability register of the GigE Vision standard: bit 29 in its numbering says that packets can be had again.
bool says_it_can_resend(ArvDevice* device) {
  if (!ARV_IS_GV_DEVICE(device)) return false;
  guint32 capability = 0;
  return arv_device_read_register(device, 0x0934, &capability, nullptr) != 0 && (capability & 0x4U) != 0;
}

std::shared_ptr<ArvStream> shared(ArvStream* stream) {
  return {stream, GObjectUnref()};
}

}  // namespace

AravisSource::AravisSource(GObjectPtr<ArvCamera> camera, AravisOptions options, SourceInfo info,
                           std::string device_address)
    : camera_(std::move(camera)),
      options_(std::move(options)),
      info_(std::move(info)),
      device_address_(std::move(device_address)),
      loopback_(device_address_.starts_with("127.")),
      can_resend_(says_it_can_resend(arv_camera_get_device(camera_.get()))) {
  auto* shared_events = new std::shared_ptr<Events>(events_);
  control_lost_handler_ = g_signal_connect_data(
      arv_camera_get_device(camera_.get()), "control-lost", G_CALLBACK(&AravisSource::on_control_lost), shared_events,
      [](void* data, GClosure*) { delete static_cast<std::shared_ptr<Events>*>(data); }, GConnectFlags{});
}

AravisSource::~AravisSource() {
  stop();
  g_signal_handler_disconnect(arv_camera_get_device(camera_.get()), control_lost_handler_);
  if (!is_lost() && !unreachable_stream_) return;
  // Aravis says goodbye to the camera with five attempts of 0.5 s for every register; nobody should wait for that when
  // the camera has gone, and nothing depends on its end.
  std::thread([stream = std::move(unreachable_stream_),
               camera = std::shared_ptr<ArvCamera>(std::move(camera_))]() mutable {
    stream.reset();
    camera.reset();
  }).detach();
}

Result<std::unique_ptr<FrameSource>> AravisSource::create(GObjectPtr<ArvCamera> camera, AravisOptions options,
                                                          SourceInfo info, std::string device_address) {
  std::unique_ptr<AravisSource> source(
      new AravisSource(std::move(camera), std::move(options), std::move(info), std::move(device_address)));
  // A client that crashed may have left the camera streaming to nowhere, with its parameters locked. Refusal is
  // harmless.
  arv_camera_stop_acquisition(source->camera_.get(), nullptr);
  source->family_ = family_of(arv_camera_get_device(source->camera_.get()), source->info_);
  source->bytes_swapped_ = source->family_.high_byte_first;
  auto warnings = prepare_camera(source->camera_.get(), source->family_, source->options_.pixel_format);
  if (!warnings) return tl::unexpected(warnings.error());
  source->setup_warnings_ = std::move(*warnings);
  source->configure_transport();
  const auto read = source->refresh();
  if (!read) return tl::unexpected(read.error());
  // A stream is opened once here so that info() tells about the socket buffer before the first run.
  const auto stream = source->create_stream();
  if (!stream) return tl::unexpected(stream.error());
  if (const auto checked = source->check_byte_order(); !checked) return tl::unexpected(checked.error());
  return std::unique_ptr<FrameSource>(std::move(source));
}

Result<void> AravisSource::check_byte_order() {
  ArvDevice* device = arv_camera_get_device(camera_.get());
  if (family_.test_pattern.empty()) return {};
  const auto patterns = enumeration_entries(device, family_.test_pattern);
  if (std::find(patterns.begin(), patterns.end(), family_.test_ramp) == patterns.end()) return {};
  if (auto set = set_feature(device, family_.test_pattern, family_.test_ramp); !set) {
    if (set.error().code == ErrorCode::disconnected) return set;
    setup_warnings_.push_back("The camera refuses its test ramp, so the order of its bytes is not checked.");
    publish_socket_buffer();
    return {};
  }
  RampVerdict verdict = RampVerdict::no_ramp;
  if (auto started = start(); !started) return started;
  for (int i = 0; i < ramp_frames && verdict == RampVerdict::no_ramp; ++i) {
    const auto frame = next(ramp_patience);
    if (!frame) break;
    if (frame->status == FrameStatus::complete) verdict = judge_test_ramp(frame->counts);
  }
  stop();
  if (auto off = set_feature(device, family_.test_pattern, "Off"); !off) return off;
  if (verdict == RampVerdict::swapped) {
    bytes_swapped_ = !bytes_swapped_;
    setup_warnings_.push_back("The test ramp arrives with its bytes swapped; they are put in order.");
  } else if (verdict == RampVerdict::no_ramp) {
    setup_warnings_.push_back("The test ramp did not arrive as one, so the order of bytes is not checked.");
  }
  return refresh();
}

void AravisSource::configure_transport() {
  ArvCamera* camera = camera_.get();
  if (arv_camera_is_gv_device(camera) == 0) return;
  // With the privilege for a packet ring Aravis listens on the interface that the discovery came through; a camera on
  // this host then never delivers a frame. Plain sockets behave the same for every user and have a receive buffer that
  // can be checked.
  arv_camera_gv_set_stream_options(camera, ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  const int packet_bytes = options_.packet_size_bytes > 0 ? options_.packet_size_bytes
                           : loopback_                    ? loopback_packet_bytes
                                                          : 0;
  if (packet_bytes > 0) {
    GErrorSlot error;
    arv_camera_gv_set_packet_size_adjustment(camera, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
    arv_camera_gv_set_packet_size(camera, packet_bytes, error.out());
    if (error) setup_warnings_.push_back("The camera refuses packets of " + std::to_string(packet_bytes) + " bytes.");
  }
}

Result<void> AravisSource::refresh() {
  ArvDevice* device = arv_camera_get_device(camera_.get());
  auto format = read_stream_format(camera_.get());
  if (!format) return tl::unexpected(format.error());
  format_ = std::move(*format);
  if (bytes_swapped_) format_.big_endian = !format_.big_endian;
  scale_ = std::make_shared<const RadiometricScale>(read_scale(device, family_));
  info_.width = format_.width;
  info_.height = format_.height;
  info_.pixel_format = format_.name;
  info_.significant_bits = format_.significant_bits;
  info_.frame_rate_hz = read_frame_rate(camera_.get(), family_);
  info_.scale = *scale_;
  info_.settings = read_settings(device);
  info_.settings["CameraFamily"] = family_.name;
  publish_socket_buffer();
  return {};
}

Result<std::shared_ptr<ArvStream>> AravisSource::create_stream() {
  GErrorSlot error;
  auto* shared_events = new std::shared_ptr<Events>(events_);
  ArvStream* raw = arv_camera_create_stream_full(
      camera_.get(), &AravisSource::on_stream_event, shared_events,
      [](void* data) { delete static_cast<std::shared_ptr<Events>*>(data); }, error.out());
  if (raw == nullptr) return error.failure(ErrorCode::not_found, "creating the frame stream");
  auto stream = shared(raw);
  if (ARV_IS_GV_STREAM(raw)) {
    const bool resend = options_.packet_resend == PacketResend::always ||
                        (options_.packet_resend == PacketResend::automatic && can_resend_);
    g_object_set(raw, "packet-resend", resend ? ARV_GV_STREAM_PACKET_RESEND_ALWAYS : ARV_GV_STREAM_PACKET_RESEND_NEVER,
                 nullptr);
    check_socket_buffer(raw);
  }
  return stream;
}

void AravisSource::check_socket_buffer(ArvStream* stream) {
  // AUTO makes the buffer one payload big, which loses most frames of a camera that sends in bursts.
  const std::uint64_t wanted = std::max<std::uint64_t>(options_.min_socket_buffer_bytes, 8 * format_.payload_bytes);
  g_object_set(stream, "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
               static_cast<gint>(std::min<std::uint64_t>(wanted, G_MAXINT / 2)), nullptr);
  const auto granted = request_socket_buffer(arv_gv_stream_get_port(ARV_GV_STREAM(stream)), wanted);
  socket_buffer_bytes_ = granted ? std::to_string(*granted) : "unknown";
  socket_buffer_warning_.clear();
  if (!granted) {
    socket_buffer_warning_ = "The size of the socket receive buffer cannot be read.";
  } else if (*granted < wanted) {
    socket_buffer_warning_ =
        "The system granted a socket receive buffer of " + std::to_string(*granted) + " instead of " +
        std::to_string(wanted) +
        " bytes; frames may be lost. Mend it with: sysctl -w net.core.rmem_max=" + std::to_string(wanted);
  }
  publish_socket_buffer();
}

void AravisSource::publish_socket_buffer() {
  info_.warnings = setup_warnings_;
  if (!socket_buffer_bytes_.empty()) info_.settings["SocketBufferBytes"] = socket_buffer_bytes_;
  if (!socket_buffer_warning_.empty()) info_.warnings.push_back(socket_buffer_warning_);
}

void AravisSource::on_stream_event(void* data, ArvStreamCallbackType type, ArvBuffer*) {
  if (type != ARV_STREAM_CALLBACK_TYPE_BUFFER_DONE) return;
  auto& events = **static_cast<std::shared_ptr<Events>*>(data);
  {
    const std::lock_guard lock(events.mutex);
    events.arrivals_ns.push_back(monotonic_ns());
    events.last_sign_of_life = Clock::now();
    events.failed_pings = 0;
  }
  events.changed.notify_all();
}

void AravisSource::on_control_lost(ArvDevice*, void* data) {
  auto& events = **static_cast<std::shared_ptr<Events>*>(data);
  {
    const std::lock_guard lock(events.mutex);
    events.lost = true;
  }
  events.changed.notify_all();
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
    arv_stream_push_buffer(stream->get(), new_frame_buffer(format_.payload_bytes).release());
  }
  sequence_ = FrameSequence(frame_id_kind(arv_camera_get_device(camera_.get()), options_.transport));
  {
    const std::lock_guard lock(events_->mutex);
    events_->arrivals_ns.clear();
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
    // Closing the stream writes to the camera, which takes seconds when it does not answer.
    unreachable_stream_ = std::move(stream);
  }
}

Result<Frame> AravisSource::next(std::chrono::milliseconds timeout) {
  const auto deadline = Clock::now() + timeout;
  for (;;) {
    std::shared_ptr<ArvStream> stream;
    std::int64_t arrived_ns = 0;
    {
      std::unique_lock lock(events_->mutex);
      const auto ready = [&] { return !events_->running || !events_->arrivals_ns.empty() || events_->lost; };
      if (!events_->changed.wait_until(lock, deadline, ready)) {
        lock.unlock();
        return tl::unexpected(silence(timeout));
      }
      if (events_->lost && (events_->arrivals_ns.empty() || !events_->running)) {
        lock.unlock();
        return tl::unexpected(disconnected());
      }
      if (!events_->running) return fail(ErrorCode::interrupted, info_.id + " is stopped");
      arrived_ns = events_->arrivals_ns.front();
      events_->arrivals_ns.pop_front();
      stream = stream_;
    }
    GObjectPtr<ArvBuffer> buffer(arv_stream_try_pop_buffer(stream.get()));
    if (!buffer) continue;
    std::optional<Frame> frame;
    if (holds_exposure(buffer.get())) {
      frame = frame_from_buffer(buffer.get(), format_);
      frame->sequence = sequence_.next(frame_id_of(buffer.get()));
      frame->host_time_ns = arrived_ns;
      frame->scale = scale_;
    }
    clear_frame_id(buffer.get());
    arv_stream_push_buffer(stream.get(), buffer.release());
    if (frame) return std::move(*frame);
  }
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
  {
    const std::lock_guard lock(events_->mutex);
    events_->lost = true;
  }
  events_->changed.notify_all();
}

Error AravisSource::disconnected() const {
  return {ErrorCode::disconnected, "camera " + info_.id + " does not answer any more"};
}

Result<std::string> AravisSource::get(const std::string& feature) {
  const std::lock_guard control(control_);
  if (is_lost()) return tl::unexpected(disconnected());
  auto value = get_feature(arv_camera_get_device(camera_.get()), feature);
  if (!value && value.error().code == ErrorCode::disconnected) mark_lost();
  return value;
}

Result<void> AravisSource::set(const std::string& feature, const std::string& value) {
  const std::lock_guard control(control_);
  if (is_lost()) return tl::unexpected(disconnected());
  auto done = set_feature(arv_camera_get_device(camera_.get()), feature, value);
  if (done) done = refresh();
  if (!done && done.error().code == ErrorCode::disconnected) mark_lost();
  return done;
}

Result<void> AravisSource::correct_nonuniformity() {
  const std::lock_guard control(control_);
  if (is_lost()) return tl::unexpected(disconnected());
  ArvDevice* device = arv_camera_get_device(camera_.get());
  const auto commands = nonuniformity_commands(device, family_);
  if (commands.empty()) {
    return fail(ErrorCode::invalid_input, "camera " + info_.id + " has no command to correct its non-uniformity");
  }
  if (!corrections_taken_over_) {
    const auto warning = take_over_corrections(device, family_);
    if (!warning) {
      mark_lost();
      return tl::unexpected(warning.error());
    }
    corrections_taken_over_ = true;
    if (*warning) setup_warnings_.push_back(**warning);
    if (auto read = refresh(); !read) return read;
  }
  auto done = set_feature(device, commands.front(), "1");
  if (!done && done.error().code == ErrorCode::disconnected) mark_lost();
  return done;
}

}  // namespace todbench
