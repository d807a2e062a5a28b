// What usually goes wrong with a bench before a run: each check says what it found, why it matters, and the command
// that mends it. The system's files are read under a root of choice, and what cannot be read from files is an argument,
// so that every check is a function from values to values.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace todbench {

enum class Finding {
  ok,
  warning,  ///< may hurt; a run is possible
  problem,  ///< a run will lose frames, or cannot start
  unknown,  ///< could not be found out
};
[[nodiscard]] std::string_view to_string(Finding finding);

struct DoctorCheck {
  std::string name{};  ///< "socket_buffer", "mtu", ...: stable, for programs
  Finding finding = Finding::unknown;
  std::string found{};        ///< what there is, with units
  std::string explanation{};  ///< why it matters
  std::string command{};      ///< mends it; empty: nothing to mend, or no command can
};

/// What is going to be asked of the system.
struct DoctorDemand {
  std::int64_t frame_bytes = 640 * 480 * 2;
  double frame_rate_hz = 50;
  int packet_bytes = 1500;        ///< GigE Vision packet, IP and UDP headers included
  double recording_minutes = 30;  ///< of frames on disk
};

/// What is not in a file.
struct SystemFacts {
  unsigned user_id = 0;
  std::set<unsigned> group_ids{};
  std::optional<std::string> firewall_rules;    ///< as `nft list ruleset` and `iptables-save` print them
  std::optional<bool> clock_synchronised;       ///< as the kernel says
  std::optional<double> clock_step_s;           ///< how far wall clock and monotonic clock drifted apart while watched
  std::optional<std::int64_t> disk_free_bytes;  ///< where sessions are written
  std::optional<double> disk_bytes_per_s;       ///< written and flushed
};

/// Asks this system; takes about half a second, most of it to write 32 MiB into `folder` and delete them again.
[[nodiscard]] SystemFacts live_facts(const std::filesystem::path& folder);

/// Granted socket buffer: net.core.rmem_max against max(4 MiB, 8 frames).
[[nodiscard]] DoctorCheck check_socket_buffer(const std::filesystem::path& root, const DoctorDemand& demand);
/// The largest packet of the interfaces that are up against the packets of the camera.
[[nodiscard]] DoctorCheck check_mtu(const std::filesystem::path& root, const DoctorDemand& demand);
/// Rules that drop UDP.
[[nodiscard]] DoctorCheck check_firewall(const std::filesystem::path& root, const SystemFacts& facts);
/// Whether it is clear which interface a camera is on: several, wireless, slow.
[[nodiscard]] DoctorCheck check_interfaces(const std::filesystem::path& root);
/// usbfs_memory_mb against 8 frames in flight.
[[nodiscard]] DoctorCheck check_usb_memory(const std::filesystem::path& root, const DoctorDemand& demand);
/// Whether the nodes of cameras that are plugged in may be read and written, and the udev rules that allow it.
[[nodiscard]] DoctorCheck check_permissions(const std::filesystem::path& root, const SystemFacts& facts);
/// Room and speed for recorded frames.
[[nodiscard]] DoctorCheck check_disk(const SystemFacts& facts, const DoctorDemand& demand);
/// Clock source and synchronisation.
[[nodiscard]] DoctorCheck check_clock(const std::filesystem::path& root, const SystemFacts& facts);

/// All of them, in this order.
[[nodiscard]] std::vector<DoctorCheck> examine(const std::filesystem::path& root, const SystemFacts& facts,
                                               const DoctorDemand& demand);

}  // namespace todbench
