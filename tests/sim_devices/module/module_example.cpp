// A module: picture in, picture out. The argument says what it does with it, or how it breaks the contract.
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "sim_devices/module/npy_message.h"

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
  if (mode == "square") picture = picture.mul(picture);
  if (mode == "nan") picture(0, 0) = std::numeric_limits<float>::quiet_NaN();
  if (mode == "shape") picture = cv::Mat1f::zeros(2, 3);
  if (mode == "random") picture(0, 0) += static_cast<float>(std::random_device()());
  return picture;
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
  const std::string mode = argc > 1 ? argv[1] : "identity";
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
    const todbench::NpyMessage message = *found->message;
    stream.erase(0, found->bytes);
    if (!header_read) {
      header_read = true;
      continue;
    }
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
    if (mode == "text") write_all("thank you\n");
    const std::string answer = todbench::to_message(processed(mode, message));
    write_all(answer);
    if (mode == "twice") write_all(answer);
  }
}
