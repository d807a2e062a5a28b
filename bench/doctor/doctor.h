// SPDX-License-Identifier: GPL-3.0-or-later
// Checks for common problems of a bench before a run. Each check states its finding, why it matters, and a command that
// fixes the problem. Checks read system files under a selectable root and get other facts as arguments, so that tests
// can supply both.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace todbench {

/// Result of a check.
enum class Finding {
  ok,
  warning,  ///< may cause errors; a run is possible
  problem,  ///< a run will lose frames, or cannot start
  unknown,  ///< could not be determined
};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(Finding finding);

/// One check with its result.
struct DoctorCheck {
  std::string name{};  ///< "socket_buffer", "mtu" ...: stable, for programs
  Finding finding = Finding::unknown;
  std::string found{};        ///< current state, with units
  std::string explanation{};  ///< reason why it matters
  std::string command{};      ///< command that fixes the problem; empty: not necessary, or no such command
};

/// Requirements of the planned measurement.
struct DoctorDemand {
  std::int64_t frame_bytes = 640 * 480 * 2;
  double frame_rate_hz = 50;
  int packet_bytes = 1500;        ///< GigE Vision packet, including IP and UDP headers
  double recording_minutes = 30;  ///< duration of the recording of frames
};

/// Facts that are not in a file.
struct SystemFacts {
  unsigned user_id = 0;
  std::set<unsigned> group_ids{};
  std::optional<std::string> firewall_rules;  ///< output of `nft list ruleset` and `iptables-save`
  std::optional<bool> clock_synchronised;     ///< according to the kernel
  std::optional<double> clock_step_s;         ///< change of the wall clock against the monotonic clock during the check
  std::optional<std::int64_t> disk_free_bytes;  ///< free space on the disk of the sessions
  std::optional<double> disk_bytes_per_s;       ///< write speed including flush
};

/// Determines the facts of this system. Takes about half a second, mostly to write 32 MiB into `folder` and delete
/// them.
[[nodiscard]] SystemFacts live_facts(const std::filesystem::path& folder);

/// Checks the socket buffer: net.core.rmem_max against max(4 MiB, 8 frames).
[[nodiscard]] DoctorCheck check_socket_buffer(const std::filesystem::path& root, const DoctorDemand& demand);
/// Checks the largest packet (MTU) of the active interfaces against the packets of the camera.
[[nodiscard]] DoctorCheck check_mtu(const std::filesystem::path& root, const DoctorDemand& demand);
/// Checks for firewall rules that drop UDP.
[[nodiscard]] DoctorCheck check_firewall(const std::filesystem::path& root, const SystemFacts& facts);
/// Checks the active network interfaces: warns of several interfaces (a camera may answer on the wrong interface), and
/// of wireless or slow interfaces.
[[nodiscard]] DoctorCheck check_interfaces(const std::filesystem::path& root);
/// Checks usbfs_memory_mb against 8 frames in flight.
[[nodiscard]] DoctorCheck check_usb_memory(const std::filesystem::path& root, const DoctorDemand& demand);
/// Checks the permission to read and write the device nodes of connected cameras, and the udev rules that grant it.
[[nodiscard]] DoctorCheck check_permissions(const std::filesystem::path& root, const SystemFacts& facts);
/// Checks disk space and speed for recorded frames.
[[nodiscard]] DoctorCheck check_disk(const SystemFacts& facts, const DoctorDemand& demand);
/// Checks clock source and synchronisation.
[[nodiscard]] DoctorCheck check_clock(const std::filesystem::path& root, const SystemFacts& facts);

/// Runs all checks in this order.
[[nodiscard]] std::vector<DoctorCheck> examine(const std::filesystem::path& root, const SystemFacts& facts,
                                               const DoctorDemand& demand);

}  // namespace todbench
