// SPDX-License-Identifier: GPL-3.0-or-later
// A module: picture in, picture out, or patch in, scores out, or scene in, frame out. The first argument says what it
// does with it, or how it breaks the contract; the second after how many answers; "hvs" is the observer hvs-1, "sensor"
// a detector of the size of a pitch with a noise of 70 mK.
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "hvs/observer/template_bank.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/module/npy_message.h"
#include "tod/plate/test_pattern.h"

namespace {

void write_all(const std::string& bytes) {
  std::fwrite(bytes.data(), 1, bytes.size(), stdout);
  std::fflush(stdout);
}

cv::Mat1f processed(const std::string& mode, const todbench::NpyMessage& message) {
  cv::Mat1f picture(static_cast<int>(message.shape[0]), static_cast<int>(message.shape[1]));
  for (std::size_t i = 0; i < message.values.size(); ++i)
    picture.begin()[static_cast<int>(i)] = static_cast<float>(message.values[i]);
  if (mode == "double") picture *= 2;
  if (double gain = 1, offset = 0; std::sscanf(mode.c_str(), "affine=%lf,%lf", &gain, &offset) == 2)
    picture = gain * picture + offset;
  if (double most = 0; std::sscanf(mode.c_str(), "ceiling=%lf", &most) == 1) picture = cv::min(picture, most);
  if (mode == "square") picture = picture.mul(picture);
  if (mode == "nan") picture(0, 0) = std::numeric_limits<float>::quiet_NaN();
  if (mode == "shape") picture = cv::Mat1f::zeros(2, 3);
  if (mode == "random") picture(0, 0) += static_cast<float>(std::random_device()());
  return picture;
}

/// The scores of hvs-1 for the patch, which the conditions before it belong to.
std::vector<double> scores(const todbench::NpyMessage& conditions, const todbench::NpyMessage& patch) {
  const auto bank = todbench::TemplateBank::build({}, todbench::triangle_alternatives(), conditions.values[0],
                                                  static_cast<int>(conditions.values[1]));
  if (!bank) return {};
  const std::vector<float> seen(patch.values.begin(), patch.values.end());
  std::vector<float> all(bank->padded_templates());
  bank->project(seen, all);
  std::vector<double> best;
  for (int o = 0; o < bank->alternatives(); ++o) {
    const auto begin = all.begin() + o * bank->places();
    best.push_back(static_cast<double>(*std::max_element(begin, begin + bank->places())));
  }
  return best;
}

/// What detectors of the size of a pitch see of a scene with four samples a pitch, with noise of their own.
todbench::NpyMessage frame_of(const todbench::NpyMessage& scene, double index) {
  constexpr std::size_t fine = 4;
  const std::size_t rows = scene.shape[0] / fine, columns = scene.shape[1] / fine;
  todbench::NpyMessage frame{.shape = {rows, columns}, .values = std::vector<double>(rows * columns)};
  for (std::size_t i = 0; i < scene.values.size(); ++i) {
    const std::size_t row = i / scene.shape[1] / fine, column = i % scene.shape[1] / fine;
    frame.values[row * columns + column] += scene.values[i] / (fine * fine);
  }
  std::mt19937_64 numbers(static_cast<std::uint64_t>(index));
  std::normal_distribution<double> noise(0, 0.07);
  for (double& value : frame.values) value += noise(numbers);
  return frame;
}

/// Whether a socket of this path answers.
bool reaches_path(const char* path) {
  const int end = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::snprintf(address.sun_path, sizeof address.sun_path, "%s", path);
  const bool reached = ::connect(end, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  ::close(end);
  return reached;
}

/// Whether this computer answers at the port.
bool reaches(int port) {
  const int end = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const bool reached = ::connect(end, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  ::close(end);
  return reached;
}

}  // namespace

int main(int argc, char** argv) {
  const bool observes = argc > 1 && std::string(argv[1]) == "hvs";
  const bool senses = argc > 1 && std::string(argv[1]) == "sensor";
  if (observes || senses) --argc, ++argv;
  const std::string planned = argc > 1 ? argv[1] : "identity";
  const int healthy =
      argc > 2 && planned != "connect" && planned != "connect-path" && planned != "ends" ? std::atoi(argv[2]) : 0;
  std::string mode = healthy > 0 ? "identity" : planned;
  todbench::NpyMessage conditions;
  if (mode == "says-path") {
    std::puts(reaches_path(argv[2]) ? "reached" : "not reached");
    return 0;
  }
  if (mode == "says-families") {
    // UNIX, packet, crypto, VSOCK: none belongs to a network of the module's own.
    int made = 0;
    for (const int family : {AF_UNIX, AF_PACKET, AF_ALG, AF_VSOCK}) made += ::socket(family, SOCK_STREAM, 0) >= 0;
    std::printf("%d of them, %s\n", made, ::socket(AF_INET, SOCK_STREAM, 0) >= 0 ? "IPv4" : "no IPv4");
    return 0;
  }
  if (mode == "crash") {
    std::fprintf(stderr, "the licence has expired\n");
    return 3;
  }
  std::string stream;
  bool header_read = false;
  int answered = 0;
  while (true) {
    const auto found = todbench::read_message(stream, 1 << 24);
    if (!found) return 1;
    if (!found->message) {
      char buffer[65536];
      const ssize_t got = ::read(0, buffer, sizeof buffer);
      if (got <= 0) return 0;
      stream.append(buffer, static_cast<std::size_t>(got));
      continue;
    }
    todbench::NpyMessage message = *found->message;
    stream.erase(0, found->bytes);
    if (!header_read) {
      header_read = true;
      continue;
    }
    if ((observes || senses) && message.shape.size() == 1) {
      conditions = message;
      continue;
    }
    if (senses) message = frame_of(message, conditions.values[0]);
    if (healthy > 0 && answered == healthy) mode = planned;
    if (mode == "hang") ::pause();
    if (mode == "ends" && answered == std::atoi(argv[2])) {
      std::fprintf(stderr, "that is enough\n");
      return 3;
    }
    ++answered;
    if (mode == "endless") {
      while (true) write_all(std::string(65536, ' '));
    }
    if (mode == "memory") {
      const std::vector<char> much(std::size_t{1} << 30, 'm');
      if (much[much.size() / 2] != 'm') return 1;
    }
    if (mode == "connect" && !reaches(std::atoi(argv[2]))) return 4;
    if (mode == "connect-path" && !reaches_path(argv[2])) return 4;
    if (mode == "text") write_all("thank you\n");
    if (observes) {
      auto answer = scores(conditions, message);
      if (mode == "nan") answer[0] = std::numeric_limits<double>::quiet_NaN();
      if (mode == "shape") answer.pop_back();
      if (mode == "random") answer[0] += static_cast<double>(std::random_device()());
      if (mode == "remembers") answer[0] += 1e-6 * answered;
      write_all(todbench::to_message(answer));
      continue;
    }
    const std::string answer = todbench::to_message(processed(mode, message));
    write_all(answer);
    if (mode == "twice") write_all(answer);
  }
}
