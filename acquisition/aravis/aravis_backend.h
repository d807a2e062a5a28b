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

enum class AravisTransport {
  gige_vision,  ///< scheme "gige"
  usb3_vision,  ///< scheme "u3v"
};

/// Whether lost packets are asked for again.
enum class PacketResend {
  automatic,  ///< where the camera's capability register says that it can
  never,      ///< a frame with a hole is delivered as incomplete when the next frame begins
  always,     ///< a frame with a hole is delayed by up to 0.1 s
};

struct AravisOptions {
  AravisTransport transport = AravisTransport::gige_vision;
  /// PFNC name; empty: the unpacked monochrome format that carries the most significant bits, Mono14 before Mono16 when
  /// equal.
  std::string pixel_format = {};
  PacketResend packet_resend = PacketResend::automatic;
  /// GigE packet size including IP and UDP headers; 0: 8000 on loopback, elsewhere what the camera says, tested once
  /// when a stream is created and negotiated only when the test packet does not arrive.
  int packet_size_bytes = 0;
  /// The receive buffer is never smaller than eight payloads either: cameras send whole frames in one burst.
  std::uint64_t min_socket_buffer_bytes = 4U << 20U;
  /// How long a GigE camera may take for its description, which is read twice.
  std::chrono::milliseconds description_patience{30'000};
  std::stop_token stop = {};                                        ///< ends the reading of a description
  std::function<void(std::string_view sentence)> on_progress = {};  ///< about once a second while one is read
};

/// Lists by discovery (1 s on a network) and opens "gige:VENDOR-SERIAL", or "gige:192.168.1.10" where broadcasts do not
/// pass; the source then tells the true identity. Opening makes the choices of the camera's family (linear temperature,
/// full depth, filters off; camera_families.h), looks at its test ramp where it has one and reads everything back. The
/// first commanded non-uniformity correction also ends the automatic ones. Opening fails with `not_found` when the
/// camera is absent, busy (another program controls it, or crashed less than its heartbeat of about 3 s ago) or offers
/// no 10 ... 16 bit monochrome format, and when its description is not safe to be evaluated (description_guard.h);
/// with `interrupted` on a stop request.
///
/// The sources' stop() returns within milliseconds while the camera answers and within 0.4 s when it has vanished; only
/// a get or set that is just waiting for a vanished camera delays it, by up to 2.5 s (five attempts of 0.5 s inside
/// Aravis). A vanished GigE camera is reported as `disconnected` about 3 s after its last frame when next() is called
/// with timeouts below 1 s, and 5 s after it by Aravis's heartbeat in any case; an unplugged USB camera at once.
/// Destroying a source whose camera has vanished leaves the goodbye, up to 8 s, to a thread that owns nothing else.
[[nodiscard]] std::unique_ptr<CameraBackend> aravis_backend(AravisOptions options = {});

}  // namespace todbench
