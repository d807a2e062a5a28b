// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/gige_test_support.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>

namespace todbench::testing_support {

EmulatedGigeCamera::Exposure test_exposures(const EmulatedGigeCameraConfig& config) {
  return [width = config.width, height = config.height, bits = config.significant_bits](std::uint64_t index) {
    return test_picture(index, width, height, bits);
  };
}

std::unique_ptr<EmulatedGigeCamera> start_camera(const EmulatedGigeCameraConfig& config) {
  auto camera = EmulatedGigeCamera::start(config, test_exposures(config));
  if (!camera) {
    ADD_FAILURE() << camera.error().message;
    return nullptr;
  }
  return std::move(*camera);
}

std::unique_ptr<FrameSource> open_camera(const AravisOptions& options) {
  return opened(aravis_backend(options)->open("gige:127.0.0.1"));
}

CameraProcess::CameraProcess(double frame_rate_hz) {
  std::array<int, 2> pipe_ends{};
  if (::pipe(pipe_ends.data()) != 0) return;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, pipe_ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_addclose(&actions, pipe_ends[0]);
  std::string program = "/proc/self/exe";
  std::string command = "--serve-camera";
  std::string rate = std::to_string(frame_rate_hz);
  std::array<char*, 4> arguments{program.data(), command.data(), rate.data(), nullptr};
  const int spawned = posix_spawn(&pid_, program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(pipe_ends[1]);
  output_ = pipe_ends[0];
  if (spawned != 0) pid_ = -1;
  char answer = 0;
  started_ = pid_ > 0 && ::read(output_, &answer, 1) == 1 && answer == '+';
}

CameraProcess::~CameraProcess() {
  kill();
  if (output_ >= 0) ::close(output_);
}

void CameraProcess::kill() {
  if (pid_ <= 0) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
  pid_ = -1;
}

}  // namespace todbench::testing_support
