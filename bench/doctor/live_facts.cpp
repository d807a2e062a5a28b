// What only the running system can tell.
#include <fcntl.h>
#include <sys/statvfs.h>
#include <sys/timex.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <vector>

#include "bench/doctor/doctor.h"

namespace todbench {

namespace {

/// Output of a command without input; nothing when it fails.
std::optional<std::string> output_of(const std::string& command) {
  std::FILE* pipe = ::popen((command + " 2>/dev/null").c_str(), "re");
  if (pipe == nullptr) return std::nullopt;
  std::string text;
  std::array<char, 4096> buffer{};
  for (std::size_t size = 0; (size = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    text.append(buffer.data(), size);
  }
  return ::pclose(pipe) == 0 ? std::optional(text) : std::nullopt;
}

std::optional<std::string> firewall_rules() {
  const auto nft = output_of("PATH=$PATH:/usr/sbin:/sbin nft list ruleset");
  const auto tables = output_of("PATH=$PATH:/usr/sbin:/sbin iptables-save");
  if (!nft && !tables) return std::nullopt;
  return nft.value_or("") + "\n" + tables.value_or("");
}

/// Bytes per second to a file that is flushed and deleted; nothing when it cannot be written.
std::optional<double> write_speed(const std::filesystem::path& folder) {
  constexpr std::size_t block = 1 << 20;
  constexpr int blocks = 32;
  std::string name = (folder / "doctor-XXXXXX").string();
  const int file = ::mkostemp(name.data(), O_CLOEXEC);
  if (file < 0) return std::nullopt;
  ::unlink(name.c_str());
  const std::vector<char> data(block, 'x');
  const auto begin = std::chrono::steady_clock::now();
  bool good = true;
  for (int k = 0; k < blocks && good; ++k) good = ::write(file, data.data(), block) == static_cast<ssize_t>(block);
  good = good && ::fsync(file) == 0;
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  ::close(file);
  if (!good || taken.count() <= 0) return std::nullopt;
  return static_cast<double>(block) * blocks / taken.count();
}

/// Wall clock less monotonic clock.
double clock_difference_s() {
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  const auto steady = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double>(wall - steady).count();
}

}  // namespace

SystemFacts live_facts(const std::filesystem::path& folder) {
  SystemFacts facts;
  facts.user_id = ::geteuid();
  std::array<gid_t, 1024> groups{};
  const int count = ::getgroups(static_cast<int>(groups.size()), groups.data());
  if (count > 0) facts.group_ids.insert(groups.begin(), groups.begin() + count);
  facts.group_ids.insert(::getegid());
  const double before_s = clock_difference_s();
  facts.firewall_rules = firewall_rules();
  struct statvfs disk {};
  if (::statvfs(folder.c_str(), &disk) == 0) {
    facts.disk_bytes_per_s = write_speed(folder);
    if (facts.disk_bytes_per_s) {
      facts.disk_free_bytes = static_cast<std::int64_t>(disk.f_bavail) * static_cast<std::int64_t>(disk.f_frsize);
    }
  }
  struct timex clock {};
  const int state = ::adjtimex(&clock);
  if (state >= 0) facts.clock_synchronised = state != TIME_ERROR && (clock.status & STA_UNSYNC) == 0;
  facts.clock_step_s = clock_difference_s() - before_s;
  return facts;
}

}  // namespace todbench
