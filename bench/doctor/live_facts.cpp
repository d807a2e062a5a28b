// SPDX-License-Identifier: GPL-3.0-or-later
// Facts of the running system.
#include <fcntl.h>
#include <sys/statvfs.h>
#include <sys/timex.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <vector>

#include "acquisition/base/process.h"
#include "bench/doctor/doctor.h"

namespace todbench {

namespace {

/// Returns the output of a command without input; empty if it fails.
std::optional<std::string> output_of(const std::string& command) {
  auto run = run_program({"/bin/sh", "-c", command}, ProgramOutput::kept_but_errors);
  return run && run->exit_code == 0 ? std::optional(std::move(run->output)) : std::nullopt;
}

std::optional<std::string> firewall_rules() {
  const auto nft = output_of("PATH=$PATH:/usr/sbin:/sbin nft list ruleset");
  const auto tables = output_of("PATH=$PATH:/usr/sbin:/sbin iptables-save");
  if (!nft && !tables) return std::nullopt;
  return nft.value_or("") + "\n" + tables.value_or("");
}

/// Returns the speed in bytes per second to a file that is flushed and deleted; empty if it cannot be written.
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

/// Returns wall clock minus monotonic clock.
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
