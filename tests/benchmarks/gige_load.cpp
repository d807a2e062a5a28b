// SPDX-License-Identifier: GPL-3.0-or-later
// Load and soak of the GigE Vision path: a camera on plain sockets, the Aravis back end, and a recording of every
// frame.
//   gige_load SECONDS [RATE_HZ WIDTH HEIGHT [RECORDING or - [FAULT_SHARE]]]
// The camera is a process of its own, so that processor time is the client's alone. Prints one line per ten seconds and
// a sum. Without faults exit 1 when a frame was lost, incomplete or false. With a share, that part of the packets is
// lost, doubled and reordered, and of the frames lost, frozen, of wrong size and late in their leader: exit 1 when a
// frame is false that the client took for whole, or when the client counts other losses and repetitions than the
// camera.
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <new>
#include <optional>
#include <string>

#include "acquisition/aravis/aravis_backend.h"
#include "acquisition/recording/recording_camera.h"
#include "sim_devices/lab/gige/gige_camera.h"
#include "sim_devices/lab/gige/gvsp_camera.h"

namespace todbench {
namespace {

struct Load {
  int seconds = 60;
  double rate_hz = 190;
  int width = 640, height = 480;
  std::string recording;
  double fault_share = 0;
};

GvspFaults faults_of(double share) {
  return {.packet_loss = share,
          .duplicate = share,
          .reorder = share,
          .late_leader = share,
          .lost_frame = share,
          .frozen = share,
          .wrong_size = share};
}

/// Different in every frame, cheap to make and to check: a picture of one count, with the index in its first pixels.
cv::Mat1w load_picture(std::uint64_t index, int width, int height) {
  cv::Mat1w picture(height, width, static_cast<ushort>(7000 + index % 4096));
  picture(0, 0) = static_cast<ushort>(index & 0x3FFF);
  return picture;
}

/// `said` is memory that both processes see: the camera's counts, ten times a second.
[[noreturn]] void serve(const Load& load, int ready, GvspCameraCounts& said) {
  GvspCameraConfig config;
  config.width = load.width;
  config.height = load.height;
  config.frame_rate_hz = load.rate_hz;
  config.automatic_nuc_frames = 1U << 30U;  // a shutter would repeat pictures
  const auto camera =
      GvspCamera::start(config, [&](std::uint64_t index) { return load_picture(index, load.width, load.height); });
  if (!camera) std::fprintf(stderr, "%s\n", camera.error().message.c_str());
  if (camera && load.fault_share > 0) (*camera)->set_faults(faults_of(load.fault_share));
  const char answer = camera ? '+' : '-';
  if (::write(ready, &answer, 1) != 1 || !camera) std::_Exit(EXIT_FAILURE);
  for (;;) {
    said = (*camera)->counts();
    ::usleep(100000);
  }
}

double cpu_s(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Resident memory that belongs to this process alone, in MiB.
double resident_mib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("RssAnon:")) return std::atof(line.c_str() + 8) / 1024;
  }
  return 0;
}

struct Sum {
  std::uint64_t frames = 0, lost = 0, incomplete = 0, repeated = 0, false_pixels = 0;
  std::uint64_t first_exposure = 0, last_exposure = 0;
};

/// Whether the client counted what the camera did, but for exposures behind the last frame that it waited for.
bool counts_agree(const Sum& sum, const GvspCameraCounts& camera) {
  const std::uint64_t behind = camera.exposures - sum.last_exposure - 1;
  const GvspFaultCounts& done = camera.faults;
  std::printf(
      "camera: %llu exposures (%llu late), %llu frames lost, %llu frozen, %llu of wrong size, %llu late leaders; "
      "packets: %llu lost, %llu doubled, %llu reordered, %llu sent again\n",
      static_cast<unsigned long long>(camera.exposures), static_cast<unsigned long long>(camera.late_exposures),
      static_cast<unsigned long long>(done.frames_lost), static_cast<unsigned long long>(done.frames_frozen),
      static_cast<unsigned long long>(done.frames_wrong_size), static_cast<unsigned long long>(done.late_leaders),
      static_cast<unsigned long long>(done.packets_lost), static_cast<unsigned long long>(done.packets_duplicated),
      static_cast<unsigned long long>(done.packets_reordered), static_cast<unsigned long long>(camera.packets_resent));
  std::printf("client: %llu frames and %llu lost from exposure %llu to %llu, %llu repeated pictures\n",
              static_cast<unsigned long long>(sum.frames), static_cast<unsigned long long>(sum.lost),
              static_cast<unsigned long long>(sum.first_exposure), static_cast<unsigned long long>(sum.last_exposure),
              static_cast<unsigned long long>(sum.repeated));
  const bool every_exposure = sum.frames + sum.lost == sum.last_exposure - sum.first_exposure + 1;
  const bool lost = sum.lost <= done.frames_lost && sum.lost + behind >= done.frames_lost;
  return every_exposure && lost;
}

int measure(const Load& load, const GvspCameraCounts& camera) {
  auto source = aravis_backend()->open("gige:127.0.0.1");
  if (!source) return std::fprintf(stderr, "%s\n", source.error().message.c_str()), EXIT_FAILURE;
  for (const auto& warning : (*source)->info().warnings) std::printf("%s\n", warning.c_str());
  if (!load.recording.empty()) {
    StreamHeader header;
    header.info = (*source)->info();
    auto writer = FrameStreamWriter::create(load.recording, header);
    if (!writer) return std::fprintf(stderr, "%s\n", writer.error().message.c_str()), EXIT_FAILURE;
    *source = recording_camera(std::move(*source), std::make_shared<FrameStreamWriter>(std::move(*writer)));
  }
  if (const auto started = (*source)->start(); !started)
    return std::fprintf(stderr, "%s\n", started.error().message.c_str()), EXIT_FAILURE;
  Sum sum;
  std::optional<std::uint64_t> last;
  const double begin = cpu_s(CLOCK_MONOTONIC);
  const double cpu_begin = cpu_s(CLOCK_PROCESS_CPUTIME_ID);
  double next_line = begin + 10;
  while (cpu_s(CLOCK_MONOTONIC) - begin < load.seconds) {
    const auto frame = (*source)->next(std::chrono::seconds(2));
    if (!frame) {
      ::usleep(500000);
      counts_agree(sum, camera);
      std::printf("controllers lost: %llu\n", static_cast<unsigned long long>(camera.controls_lost));
      std::fflush(stdout);
      return std::fprintf(stderr, "%s\n", frame.error().message.c_str()), EXIT_FAILURE;
    }
    ++sum.frames;
    if (last) sum.lost += frame->sequence - *last - 1;
    const std::uint64_t exposure = exposure_index(*frame, load.rate_hz);
    if (!last) sum.first_exposure = exposure;
    sum.last_exposure = exposure;
    last = frame->sequence;
    if (frame->status != FrameStatus::complete) {
      ++sum.incomplete;
    } else {
      const auto shows = [&](std::uint64_t index) {
        const auto truth = load_picture(index, load.width, load.height);
        return std::memcmp(truth.data, frame->counts.data, truth.total() * truth.elemSize()) == 0;
      };
      if (!shows(exposure)) {
        // A frozen picture is that of the frame before it, which may be frozen too.
        bool earlier = false;
        for (std::uint64_t back = 1; load.fault_share > 0 && back <= std::min<std::uint64_t>(exposure, 8); ++back)
          earlier = earlier || shows(exposure - back);
        ++(earlier ? sum.repeated : sum.false_pixels);
        if (!earlier && sum.false_pixels <= 5)
          std::printf("frame %llu, exposure %llu is false: its first pixel counts %d\n",
                      static_cast<unsigned long long>(frame->sequence), static_cast<unsigned long long>(exposure),
                      frame->counts(0, 0));
      }
    }
    if (cpu_s(CLOCK_MONOTONIC) < next_line) continue;
    next_line += 10;
    std::printf("%6.0f s  %8llu frames  %llu lost  %llu incomplete  %.1f MiB\n", cpu_s(CLOCK_MONOTONIC) - begin,
                static_cast<unsigned long long>(sum.frames), static_cast<unsigned long long>(sum.lost),
                static_cast<unsigned long long>(sum.incomplete), resident_mib());
    std::fflush(stdout);
  }
  const double wall = cpu_s(CLOCK_MONOTONIC) - begin;
  const double cpu = cpu_s(CLOCK_PROCESS_CPUTIME_ID) - cpu_begin;
  (*source)->stop();
  const double bits = 16.0 * load.width * load.height * static_cast<double>(sum.frames) / wall;
  std::printf(
      "%.1f frames/s, %.0f Mbit/s of pixels, %llu frames, %llu lost, %llu incomplete, %llu false; client %.1f %% "
      "of one core with the check of every pixel\n",
      static_cast<double>(sum.frames) / wall, bits * 1e-6, static_cast<unsigned long long>(sum.frames),
      static_cast<unsigned long long>(sum.lost), static_cast<unsigned long long>(sum.incomplete),
      static_cast<unsigned long long>(sum.false_pixels), 100 * cpu / wall);
  if (load.fault_share > 0) {
    ::usleep(500000);
    return counts_agree(sum, camera) && sum.false_pixels == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
  }
  return sum.lost + sum.incomplete + sum.false_pixels == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace
}  // namespace todbench

int main(int argc, char** argv) {
  todbench::Load load;
  if (argc > 1) load.seconds = std::atoi(argv[1]);
  if (argc > 4) {
    load.rate_hz = std::atof(argv[2]);
    load.width = std::atoi(argv[3]);
    load.height = std::atoi(argv[4]);
  }
  if (argc > 5 && std::string(argv[5]) != "-") load.recording = argv[5];
  if (argc > 6) load.fault_share = std::atof(argv[6]);
  auto* said = static_cast<todbench::GvspCameraCounts*>(
      ::mmap(nullptr, sizeof(todbench::GvspCameraCounts), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  if (said == MAP_FAILED) return EXIT_FAILURE;
  new (said) todbench::GvspCameraCounts();
  int ends[2];
  if (::pipe(ends) != 0) return EXIT_FAILURE;
  const pid_t camera = ::fork();
  if (camera == 0) todbench::serve(load, ends[1], *said);
  char answer = 0;
  if (::read(ends[0], &answer, 1) != 1 || answer != '+') return EXIT_FAILURE;
  const int result = todbench::measure(load, *said);
  ::kill(camera, SIGKILL);
  ::waitpid(camera, nullptr, 0);
  return result;
}
