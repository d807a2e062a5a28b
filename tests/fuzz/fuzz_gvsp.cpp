// SPDX-License-Identifier: GPL-3.0-or-later
// Streaming packets into the GigE Vision client: a camera opens the way, then every input is a run of packets, each two
// bytes of length (big-endian) and that many bytes, sent to the client's stream port as anybody on the network could.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "acquisition/aravis/aravis_backend.h"
#include "acquisition/aravis/gev_registers.h"
#include "sim_devices/lab/gige/gvsp_camera.h"
#include "tests/support/private_network.h"

namespace {

using namespace todbench;

/// A client that waits for frames of a camera which hardly ever sends one: 8 x 4 pixels.
struct Client {
  std::unique_ptr<GvspCamera> camera;
  std::unique_ptr<FrameSource> source;
  int sender = -1;
  sockaddr_in to{};

  Client() {
    GvspCameraConfig config;
    config.model = CameraModel::unlisted;
    config.width = 8;
    config.height = 4;
    config.frame_rate_hz = 0.1;
    auto started = GvspCamera::start(config, [](std::uint64_t) { return cv::Mat1w::zeros(4, 8); });
    if (!started) give_up(started.error());
    camera = std::move(*started);
    auto opened = aravis_backend()->open("gige:127.0.0.1");
    if (!opened) give_up(opened.error());
    source = std::move(*opened);
    if (const auto streaming = source->start(); !streaming) give_up(streaming.error());
    sender = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(static_cast<std::uint16_t>(camera->register_value(gev::stream_port)));
  }

  [[noreturn]] static void give_up(const Error& error) {
    std::fprintf(stderr, "%s\n", error.message.c_str());
    std::exit(EXIT_FAILURE);
  }
};

}  // namespace

/// libFuzzer starts threads before the first input; a process that has several cannot move.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
  testing_support::enter_private_network();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // One client for all inputs: opening one takes longer than a thousand of them.
  static Client* const client = std::make_unique<Client>().release();
  while (size >= 2) {
    const std::size_t length = std::min<std::size_t>(size - 2, static_cast<std::size_t>(data[0] << 8 | data[1]));
    static_cast<void>(::sendto(client->sender, data + 2, length, 0, reinterpret_cast<const sockaddr*>(&client->to),
                               sizeof client->to));
    data += 2 + length;
    size -= 2 + length;
  }
  // Whatever comes of it is a frame of the size that was negotiated, or none.
  for (auto frame = client->source->next(std::chrono::milliseconds(1)); frame;
       frame = client->source->next(std::chrono::milliseconds(1))) {
    if (frame->counts.rows != 4 || frame->counts.cols != 8) std::abort();
  }
  return 0;
}
