// SPDX-License-Identifier: GPL-3.0-or-later
// Set-up of a camera when it is opened: features, corrections, scale. Its stream is in aravis_source.cpp.
#include <algorithm>
#include <optional>

#include "acquisition/aravis/aravis_source.h"
#include "acquisition/aravis/aravis_version.h"
#include "acquisition/aravis/genicam_features.h"
#include "acquisition/aravis/host_network.h"
#include "acquisition/aravis/object_parameters.h"
#include "acquisition/aravis/socket_buffer.h"
#include "acquisition/aravis/test_ramp.h"
#include "acquisition/aravis/u3v_registers.h"
#include "acquisition/base/host_clock.h"
#include "acquisition/base/try.h"
#include "acquisition/core/control_text.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;

/// A camera on loopback is a program: 8000 bytes need six times fewer packets than 1500, and the MTU is 65536.
constexpr int loopback_packet_bytes = 8000;
/// A test pattern appears in the picture some frames after it was selected.
constexpr int ramp_frames = 10;
constexpr auto ramp_patience = 1s;
/// A correction that interrupts the stream has ended by then.
constexpr auto longest_correction = 5s;
/// Feature of a plan's scale that was measured on the bench; never written to the camera.
constexpr const char* scale_feature = "TemperatureLinearScale";
constexpr const char* offset_feature = "TemperatureLinearOffset";

/// GVCP capability register of the GigE Vision standard: bit 29 in its numbering states support of packet resend.
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
    : camera_(std::move(camera), [events = events_] { events->mark_lost(); }),
      options_(std::move(options)),
      info_(std::move(info)),
      device_address_(std::move(device_address)),
      loopback_(device_address_.starts_with("127.")),
      can_resend_(says_it_can_resend(arv_camera_get_device(camera_.get()))) {}

Result<std::unique_ptr<FrameSource>> AravisSource::create(GObjectPtr<ArvCamera> camera, AravisOptions options,
                                                          SourceInfo info, std::string device_address) {
  std::unique_ptr<AravisSource> source(
      new AravisSource(std::move(camera), std::move(options), std::move(info), std::move(device_address)));
  // A crashed client may have left the camera streaming, with its parameters locked. A refusal is harmless.
  arv_camera_stop_acquisition(source->camera_.get(), nullptr);
  source->family_ = family_of(arv_camera_get_device(source->camera_.get()), source->info_);
  source->bytes_swapped_ = source->family_.high_byte_first;
  TODBENCH_TRY(auto warnings, prepare_camera(source->camera_.get(), source->family_, source->options_.pixel_format));
  source->setup_warnings_ = source->info_.warnings;
  source->setup_warnings_.insert(source->setup_warnings_.end(), warnings.begin(), warnings.end());
  source->configure_transport();
  if (const auto read = source->refresh(); !read) return tl::unexpected(read.error());
  // A stream is opened here once so that info() contains the socket buffer before the first run.
  TODBENCH_TRY_VOID(source->create_stream());
  TODBENCH_TRY_VOID(source->check_byte_order());
  return std::unique_ptr<FrameSource>(std::move(source));
}

Result<void> AravisSource::check_byte_order() {
  ArvDevice* device = arv_camera_get_device(camera_.get());
  if (family_.test_pattern.empty()) return {};
  const auto patterns = enumeration_entries(device, family_.test_pattern);
  if (std::find(patterns.begin(), patterns.end(), family_.test_ramp) == patterns.end()) return {};
  if (auto set = set_feature(device, family_.test_pattern, family_.test_ramp); !set) {
    if (set.error().code == ErrorCode::disconnected) return set;
    setup_warnings_.push_back("The camera rejects the setting of its test ramp, so the byte order is not checked.");
    publish_socket_buffer();
    return {};
  }
  RampVerdict verdict = RampVerdict::no_ramp;
  TODBENCH_TRY_VOID(start());
  for (int i = 0; i < ramp_frames && verdict == RampVerdict::no_ramp; ++i) {
    const auto frame = next(ramp_patience);
    if (!frame) break;
    if (frame->status == FrameStatus::complete) verdict = judge_test_ramp(frame->counts);
  }
  stop();
  TODBENCH_TRY_VOID(set_feature(device, family_.test_pattern, "Off"));
  if (verdict == RampVerdict::swapped) {
    bytes_swapped_ = !bytes_swapped_;
    setup_warnings_.push_back("The bytes of the test ramp arrive swapped. The program swaps the bytes of every frame.");
  } else if (verdict == RampVerdict::no_ramp) {
    setup_warnings_.push_back("The frame of the test ramp shows no ramp, so the byte order is not checked.");
  }
  return refresh();
}

void AravisSource::configure_transport() {
  ArvCamera* camera = camera_.get();
  if (arv_camera_is_gv_device(camera) == 0) return;
  // With the privilege for a packet ring Aravis listens on the interface of the discovery; a camera on this host then
  // never delivers a frame. Plain sockets behave the same for every user, and their receive buffer can be checked.
  arv_camera_gv_set_stream_options(camera, ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  const int packet_bytes = options_.packet_size_bytes > 0 ? options_.packet_size_bytes
                           : loopback_                    ? loopback_packet_bytes
                                                          : 0;
  if (packet_bytes > 0) {
    GErrorSlot error;
    arv_camera_gv_set_packet_size_adjustment(camera, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
    arv_camera_gv_set_packet_size(camera, packet_bytes, error.out());
    if (error) setup_warnings_.push_back("The camera rejects packets of " + std::to_string(packet_bytes) + " bytes.");
  }
  // If a camera answers no test packet, its size stays unchanged even if the network cannot pass it, and no frame
  // arrives.
  const auto present = get_number(arv_camera_get_device(camera), "GevSCPSPacketSize");
  if (!present) return;
  if (auto warning = packets_too_large(device_address_, static_cast<int>(*present), host_addresses()); !warning.empty())
    setup_warnings_.push_back(std::move(warning));
}

Result<void> AravisSource::refresh() {
  ArvDevice* device = arv_camera_get_device(camera_.get());
  TODBENCH_TRY(format_, read_stream_format(camera_.get()));
  if (stated_frame_) format_.width = stated_frame_->width, format_.height = stated_frame_->height;
  if (bytes_swapped_) format_.big_endian = !format_.big_endian;
  // Eight-bit pixels are a display picture behind a gain control; the camera's scale does not apply to them.
  RadiometricScale scale =
      format_.pixel_format == PixelFormat::mono8 ? RadiometricScale() : read_scale(device, family_);
  if (stated_kelvin_per_count_) {
    scale = RadiometricScale::linear({*stated_kelvin_per_count_, stated_offset_k_.value_or(0)}).value_or(scale);
  }
  scale_ = std::make_shared<const RadiometricScale>(scale);
  info_.width = format_.width;
  info_.height = format_.height;
  info_.pixel_format = to_string(format_.pixel_format);
  info_.significant_bits = format_.significant_bits;
  info_.frame_rate_hz = read_frame_rate(camera_.get(), family_);
  info_.scale = *scale_;
  TODBENCH_TRY(info_.settings, read_settings(device));
  info_.settings["CameraFamily"] = family_.name;
  info_.settings["AravisVersion"] = to_string(running_aravis());
  if (stated_kelvin_per_count_) info_.settings[scale_feature] = control_text(*stated_kelvin_per_count_);
  if (stated_offset_k_) info_.settings[offset_feature] = control_text(*stated_offset_k_);
  publish_socket_buffer();
  return {};
}

Result<std::shared_ptr<ArvStream>> AravisSource::create_stream() {
  GErrorSlot error;
  if (auto safe = check_stream_registers(arv_camera_get_device(camera_.get())); !safe) {
    return fail("creating the frame stream", safe.error());
  }
  auto* tap = new StreamTap{.events = events_};
  const auto destroy_tap = [](void* data) { delete static_cast<StreamTap*>(data); };
  // Aravis 0.9.1 renamed the function.
#if ARAVIS_CHECK_VERSION(0, 9, 1)
  ArvStream* raw =
      arv_camera_create_stream(camera_.get(), &AravisSource::on_stream_event, tap, destroy_tap, error.out());
#else
  ArvStream* raw =
      arv_camera_create_stream_full(camera_.get(), &AravisSource::on_stream_event, tap, destroy_tap, error.out());
#endif
  if (raw == nullptr) return error.failure(ErrorCode::not_found, "creating the frame stream");
  tap->stream = raw;
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
  // AUTO makes the buffer as large as one payload, which loses most frames of a camera that sends in bursts.
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
        " bytes. Frames may be lost. Raise the limit with: sysctl -w net.core.rmem_max=" + std::to_string(wanted);
  }
  publish_socket_buffer();
}

void AravisSource::publish_socket_buffer() {
  info_.warnings = setup_warnings_;
  // Object parameters matter only for counts that are temperatures.
  if (info_.scale.calibrated()) {
    for (auto& note : object_parameter_notes(info_.settings)) info_.warnings.push_back(std::move(note));
  }
  if (!socket_buffer_bytes_.empty()) info_.settings["SocketBufferBytes"] = socket_buffer_bytes_;
  if (!socket_buffer_warning_.empty()) info_.warnings.push_back(socket_buffer_warning_);
}

Result<std::string> AravisSource::get(const std::string& feature) {
  const std::lock_guard control(control_);
  if (is_lost()) return tl::unexpected(disconnected());
  if (feature == scale_feature && stated_kelvin_per_count_) return control_text(*stated_kelvin_per_count_);
  if (feature == frame_size_feature) return frame_size_text({format_.width, format_.height});
  if (feature == nuc_command_feature) return nuc_command_;
  if (feature == offset_feature && stated_offset_k_) return control_text(*stated_offset_k_);
  auto value = get_feature(arv_camera_get_device(camera_.get()), feature);
  if (!value && value.error().code == ErrorCode::disconnected) mark_lost();
  return value;
}

Result<void> AravisSource::set(const std::string& feature, const std::string& value) {
  const std::lock_guard control(control_);
  if (is_lost()) return tl::unexpected(disconnected());
  auto done = feature == scale_feature || feature == offset_feature ? state_scale(feature, value)
              : feature == frame_size_feature                       ? state_frame(value)
              : feature == nuc_command_feature                      ? name_nuc_command(value)
                                               : set_feature(arv_camera_get_device(camera_.get()), feature, value);
  if (done) done = refresh();
  if (!done && done.error().code == ErrorCode::disconnected) mark_lost();
  return done;
}

Result<void> AravisSource::state_scale(const std::string& feature, const std::string& value) {
  const bool is_scale = feature == scale_feature;
  const auto stated = control_number(value);
  if (!stated || (is_scale && !(*stated > 0))) {
    return fail(ErrorCode::invalid_input,
                feature + " = " + value + ": expected " + (is_scale ? "kelvin per count, above 0" : "kelvin"));
  }
  (is_scale ? stated_kelvin_per_count_ : stated_offset_k_) = *stated;
  return {};
}

Result<void> AravisSource::state_frame(const std::string& value) {
  const auto size = frame_size_of(value);
  if (!size)
    return fail(ErrorCode::invalid_input, std::string(frame_size_feature) + " = " + value + ": expected WIDTHxHEIGHT");
  const std::size_t bytes = bytes_of_pixels(format_.pixel_format, static_cast<std::size_t>(size->area()));
  if (bytes > format_.payload_bytes) {
    return fail(ErrorCode::invalid_input, std::string(frame_size_feature) + " = " + value +
                                              ": larger than the camera's payload of " +
                                              std::to_string(format_.payload_bytes) + " bytes");
  }
  stated_frame_ = size;
  return {};
}

Result<void> AravisSource::name_nuc_command(const std::string& value) {
  ArvDevice* device = arv_camera_get_device(camera_.get());
  if (ARV_IS_GC_COMMAND(arv_device_get_feature(device, value.c_str()))) {
    nuc_command_ = value;
    return {};
  }
  std::string names;
  for (const auto& name : command_names(device)) names += (names.empty() ? "" : ", ") + name;
  return fail(ErrorCode::invalid_input,
              std::string(nuc_command_feature) + " = " + value +
                  ": the camera has no such command; its commands: " + (names.empty() ? "none" : names));
}

Result<void> AravisSource::correct_nonuniformity() {
  const std::lock_guard control(control_);
  if (is_lost()) return tl::unexpected(disconnected());
  ArvDevice* device = arv_camera_get_device(camera_.get());
  const auto commands =
      nuc_command_.empty() ? nonuniformity_commands(device, family_) : std::vector<std::string>{nuc_command_};
  if (commands.empty()) {
    return fail(ErrorCode::invalid_input, "camera " + info_.id +
                                              " has no command with a known name for the non-uniformity correction. "
                                              "State the name in the plan: [camera] nuc_command");
  }
  if (!corrections_taken_over_) {
    const auto warning = take_over_corrections(device, family_);
    if (!warning) {
      mark_lost();
      return tl::unexpected(warning.error());
    }
    corrections_taken_over_ = true;
    if (*warning) setup_warnings_.push_back(**warning);
    TODBENCH_TRY_VOID(refresh());
  }
  may_pause_until_ns_ = monotonic_ns() + std::chrono::nanoseconds(longest_correction).count();
  auto done = set_feature(device, commands.front(), "1");
  if (!done && done.error().code == ErrorCode::disconnected) mark_lost();
  return done;
}

}  // namespace todbench
