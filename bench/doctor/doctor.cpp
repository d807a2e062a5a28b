// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/doctor/doctor.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "bench/doctor/system_files.h"

namespace todbench {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t mebibyte = 1 << 20;
/// Aravis 0.8.26 loses frames below this size (emulated cameras that send a frame in one burst).
constexpr std::int64_t least_socket_buffer = 4 * mebibyte;
constexpr std::int64_t frames_in_flight = 8;
/// Rate on a gigabit link up to which packets of 1500 bytes cause little processor load.
constexpr double comfortable_bits_per_s = 400e6;

std::string number(double value, int digits) {
  return fmt::format("{:.{}f}", value, digits);
}

std::string mib(double bytes) {
  return number(bytes / static_cast<double>(mebibyte), 1) + " MiB";
}

std::string listed(std::string items, const std::string& item) {
  if (!items.empty()) items += ", ";
  return items.append(item);
}

}  // namespace

std::string_view to_string(Finding finding) {
  switch (finding) {
    case Finding::ok:
      return "ok";
    case Finding::warning:
      return "warning";
    case Finding::problem:
      return "problem";
    default:
      return "unknown";
  }
}

DoctorCheck check_socket_buffer(const fs::path& root, const DoctorDemand& demand) {
  DoctorCheck check{.name = "socket_buffer"};
  const std::int64_t wanted = std::max(least_socket_buffer, frames_in_flight * demand.frame_bytes);
  check.explanation = "GigE Vision cameras send frames in bursts. A socket buffer below " +
                      mib(static_cast<double>(wanted)) +
                      " (4 MiB or 8 frames, whichever is larger) overflows and loses packets. The system grants at "
                      "most net.core.rmem_max.";
  const auto granted = file_number(root / "proc/sys/net/core/rmem_max");
  if (!granted) {
    check.found = "net.core.rmem_max cannot be read";
    return check;
  }
  check.found =
      "net.core.rmem_max = " + std::to_string(*granted) + " bytes (" + mib(static_cast<double>(*granted)) + ")";
  check.finding = *granted >= wanted ? Finding::ok : Finding::problem;
  if (*granted < wanted) check.command = "sudo sysctl -w net.core.rmem_max=" + std::to_string(wanted);
  return check;
}

DoctorCheck check_mtu(const fs::path& root, const DoctorDemand& demand) {
  DoctorCheck check{.name = "mtu"};
  check.explanation =
      "A GigE Vision packet that is larger than the MTU of the interface never arrives. Small packets cause many "
      "interrupts at high data rates.";
  const auto interfaces = network_interfaces(root);
  if (interfaces.empty()) {
    check.found = "no network interface is up";
    check.finding = Finding::ok;
    return check;
  }
  const auto widest = std::max_element(interfaces.begin(), interfaces.end(),
                                       [](const auto& a, const auto& b) { return a.mtu < b.mtu; });
  for (const auto& one : interfaces) {
    check.found = listed(check.found, one.name) + " " + std::to_string(one.mtu) + " bytes";
  }
  const double bits_per_s = 8.0 * static_cast<double>(demand.frame_bytes) * demand.frame_rate_hz;
  check.finding = Finding::ok;
  if (widest->mtu < demand.packet_bytes) {
    check.finding = Finding::problem;
    check.command = "sudo ip link set " + widest->name + " mtu " + std::to_string(demand.packet_bytes);
  } else if (widest->mtu < 9000 && bits_per_s > comfortable_bits_per_s) {
    check.finding = Finding::warning;
    check.command = "sudo ip link set " + widest->name + " mtu 9000";
  }
  return check;
}

DoctorCheck check_interfaces(const fs::path& root) {
  DoctorCheck check{.name = "interfaces"};
  check.explanation =
      "If several interfaces are up, a camera may answer on the wrong one: control works, but no frame arrives. In "
      "this case give the address of the camera in the plan (id = \"gige:ADDRESS\"). Wireless and slow links lose "
      "frames.";
  const auto interfaces = network_interfaces(root);
  check.finding = Finding::ok;
  std::string slow;
  for (const auto& one : interfaces) {
    check.found = listed(check.found, one.name);
    if (one.wireless) check.found += " (wireless)";
    if (one.speed_mbit > 0) check.found += " " + std::to_string(one.speed_mbit) + " Mbit/s";
    const bool poor = one.wireless || (one.speed_mbit > 0 && one.speed_mbit < 1000);
    if (poor && slow.empty()) slow = one.name;
  }
  if (interfaces.empty())
    check.found = "only the loopback interface is up: only an emulated GigE Vision camera can answer";
  if (interfaces.size() > 1 || !slow.empty()) check.finding = Finding::warning;
  if (interfaces.size() > 1 && !slow.empty()) check.command = "sudo ip link set " + slow + " down";
  return check;
}

DoctorCheck check_usb_memory(const fs::path& root, const DoctorDemand& demand) {
  DoctorCheck check{.name = "usb_memory"};
  const std::int64_t wanted_mb = (frames_in_flight * demand.frame_bytes + mebibyte - 1) / mebibyte;
  check.explanation =
      "The kernel grants at most usbfs_memory_mb to all USB transfers together. 8 frames in flight need " +
      std::to_string(wanted_mb) + " MiB. If this memory is used up, a USB3 Vision camera does not stream.";
  const auto granted = file_number(root / "sys/module/usbcore/parameters/usbfs_memory_mb");
  if (!granted) {
    check.found = "no USB in this kernel, or its parameters cannot be read";
    return check;
  }
  check.found = "usbfs_memory_mb = " + std::to_string(*granted);
  // 0: no limit.
  check.finding = *granted == 0 || *granted >= wanted_mb ? Finding::ok : Finding::problem;
  if (check.finding == Finding::problem) {
    check.command = "echo " + std::to_string(std::max<std::int64_t>(64, wanted_mb)) +
                    " | sudo tee /sys/module/usbcore/parameters/usbfs_memory_mb";
  }
  return check;
}

DoctorCheck check_disk(const SystemFacts& facts, const DoctorDemand& demand) {
  DoctorCheck check{.name = "disk"};
  const double bytes_per_s = static_cast<double>(demand.frame_bytes) * demand.frame_rate_hz;
  const double wanted = bytes_per_s * 60 * demand.recording_minutes;
  check.explanation = "Recording " + number(demand.recording_minutes, 0) + " minutes needs " + mib(wanted) + " at " +
                      mib(bytes_per_s) + "/s. The disk should write twice as fast, so that frames do not queue up.";
  if (!facts.disk_free_bytes) {
    check.found = "the folder is not writable";
    check.finding = Finding::problem;
    check.explanation += " A session needs a folder in which you may create folders: check its owner and permissions.";
    check.command = "todbench measure PLAN.toml --out FOLDER_OF_YOUR_OWN";
    return check;
  }
  check.found = mib(static_cast<double>(*facts.disk_free_bytes)) + " free";
  if (facts.disk_bytes_per_s) check.found += ", written at " + mib(*facts.disk_bytes_per_s) + "/s";
  const bool small = static_cast<double>(*facts.disk_free_bytes) < wanted;
  const bool slow = facts.disk_bytes_per_s && *facts.disk_bytes_per_s < 2 * bytes_per_s;
  check.finding = small || slow ? Finding::warning : Finding::ok;
  if (!facts.disk_bytes_per_s && !small) check.finding = Finding::unknown;
  if (small || slow) check.command = "todbench measure PLAN.toml --out FOLDER_ON_ANOTHER_DISK";
  return check;
}

DoctorCheck check_clock(const fs::path& root, const SystemFacts& facts) {
  DoctorCheck check{.name = "clock"};
  check.explanation =
      "The wall clock dates sessions, and the monotonic clock orders frames. An unsynchronised wall clock gives "
      "reports a wrong date. A slow clock source delays every reading of the time.";
  const auto source = file_text(root / "sys/devices/system/clocksource/clocksource0/current_clocksource");
  std::error_code error;
  const bool by_daemon = fs::exists(root / "run/systemd/timesync/synchronized", error);
  const bool synchronised = by_daemon || facts.clock_synchronised.value_or(false);
  check.found =
      "clock source " + source.value_or("not known") + ", " +
      (synchronised ? "synchronised" : (facts.clock_synchronised ? "not synchronised" : "synchronisation not known"));
  if (facts.clock_step_s) {
    check.found += ", wall and monotonic clock " + number(1e3 * std::abs(*facts.clock_step_s), 1) + " ms apart";
  }
  const bool slow = source && (*source == "hpet" || *source == "acpi_pm" || *source == "jiffies");
  const bool stepped = facts.clock_step_s && std::abs(*facts.clock_step_s) > 0.1;
  if (!synchronised && !facts.clock_synchronised && !slow) return check;
  check.finding = synchronised && !slow && !stepped ? Finding::ok : Finding::warning;
  if (!synchronised) check.command = "sudo timedatectl set-ntp true";
  return check;
}

std::vector<DoctorCheck> examine(const fs::path& root, const SystemFacts& facts, const DoctorDemand& demand) {
  return {check_socket_buffer(root, demand), check_mtu(root, demand),
          check_firewall(root, facts),       check_interfaces(root),
          check_usb_memory(root, demand),    check_permissions(root, facts),
          check_disk(facts, demand),         check_clock(root, facts)};
}

}  // namespace todbench
