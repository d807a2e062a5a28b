// SPDX-License-Identifier: GPL-3.0-or-later
// GigE Vision and USB3 Vision cameras through Aravis.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>

#include "acquisition/core/camera_registry.h"

namespace todbench {

/// Transport of the cameras of a back end.
enum class AravisTransport {
  gige_vision,  ///< scheme "gige"
  usb3_vision,  ///< scheme "u3v"
};

/// Handling of lost packets.
enum class PacketResend {
  automatic,  ///< missing packets are requested again if the camera's capability register shows support
  never,      ///< a frame with missing packets is delivered as incomplete when the next frame begins
  always,     ///< missing packets are always requested again, which delays a frame by up to 0.1 s
};

/// Options of aravis_backend().
struct AravisOptions {
  AravisTransport transport = AravisTransport::gige_vision;
  /// PFNC name (GenICam Pixel Format Naming Convention). Empty: the unpacked monochrome format with the most
  /// significant bits; Mono14 is preferred to Mono16 if both have the same number of significant bits.
  std::string pixel_format = {};
  PacketResend packet_resend = PacketResend::automatic;
  /// GigE packet size including IP and UDP headers. 0: 8000 on loopback, otherwise the size that the camera states. The
  /// size is tested once when a stream is created, and negotiated only if the test packet does not arrive.
  int packet_size_bytes = 0;
  /// Minimum size of the socket's receive buffer. Cameras send whole frames in one burst, so a size of at least eight
  /// payloads is always requested.
  std::uint64_t min_socket_buffer_bytes = 4U << 20U;
  /// Time limit for reading the description of a GigE camera. The description is read twice.
  std::chrono::milliseconds description_patience{30'000};
  std::stop_token stop = {};                                        ///< interrupts the reading of a description
  std::function<void(std::string_view sentence)> on_progress = {};  ///< called about once a second during the reading
};

/// Lists cameras by discovery (1 s on a network). Opens "gige:VENDOR-SERIAL", or "gige:192.168.1.10" on a network that
/// blocks broadcasts; info().id of the source is "gige:VENDOR-SERIAL" in both cases. Opening applies the settings of
/// the camera's family (linear temperature, full depth, filters off; camera_families.h), checks the camera's test ramp,
/// if any, and reads all settings back. The first commanded non-uniformity correction also switches automatic
/// corrections off. Errors of opening: `not_found` (absent; busy, because a different program controls it or crashed
/// within the heartbeat of about 3 s; no monochrome format of 10 ... 16 bits; description not safe to evaluate, see
/// description_guard.h), `interrupted`.
///
/// stop() of a source returns within milliseconds if the camera answers and within 0.4 s if it has vanished. A get or
/// set that is waiting for a vanished camera delays stop() by up to 2.5 s (five attempts of 0.5 s inside Aravis). If
/// next() is called with timeouts below 1 s, a vanished GigE camera is reported as `disconnected` about 3 s after its
/// last frame. Otherwise Aravis's heartbeat reports it after 5 s. An unplugged USB camera is reported immediately. If
/// the source of a vanished camera is destroyed, a background thread that owns only the camera closes the connection
/// (up to 8 s).
[[nodiscard]] std::unique_ptr<CameraBackend> aravis_backend(AravisOptions options = {});

}  // namespace todbench
