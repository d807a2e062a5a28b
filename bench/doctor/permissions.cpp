// SPDX-License-Identifier: GPL-3.0-or-later
// Check of the permissions for the device nodes of cameras.
#include <fmt/format.h>
#include <sys/stat.h>

#include "bench/doctor/doctor.h"
#include "bench/doctor/system_files.h"

namespace todbench {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view seek_vendor = "289d";

bool may_read_and_write(const fs::path& node, const SystemFacts& facts) {
  struct stat status {};
  if (::stat(node.c_str(), &status) != 0) return false;
  if (facts.user_id == 0) return true;
  const unsigned shift = status.st_uid == facts.user_id ? 6 : facts.group_ids.contains(status.st_gid) ? 3 : 0;
  return (status.st_mode >> shift & 6U) == 6U;
}

struct CameraNode {
  std::string node;  ///< "dev/video0"
  std::string rule;  ///< udev rule that allows access for the local user
};

/// Returns whether the device is a Seek camera or of the class of USB3 Vision (EF/02/01 with an interface EF/05).
bool is_usb_camera(const fs::path& device) {
  if (file_text(device / "idVendor") == std::string(seek_vendor)) return true;
  if (file_text(device / "bDeviceClass") != "ef") return false;
  for (const auto& entry : entries_of(device)) {
    if (file_text(entry / "bInterfaceClass") == "ef" && file_text(entry / "bInterfaceSubClass") == "05") return true;
  }
  return false;
}

std::vector<CameraNode> camera_nodes(const fs::path& root) {
  std::vector<CameraNode> nodes;
  for (const auto& device : entries_of(root / "sys/bus/usb/devices")) {
    const auto bus = file_number(device / "busnum");
    const auto number = file_number(device / "devnum");
    if (!bus || !number || !is_usb_camera(device)) continue;
    nodes.push_back({fmt::format("dev/bus/usb/{:03}/{:03}", *bus, *number),
                     "SUBSYSTEM==\"usb\", ATTR{idVendor}==\"" + file_text(device / "idVendor").value_or("") +
                         "\", MODE=\"0660\", TAG+=\"uaccess\""});
  }
  for (const auto& device : entries_of(root / "sys/class/video4linux")) {
    nodes.push_back({"dev/" + device.filename().string(),
                     "SUBSYSTEM==\"video4linux\", MODE=\"0660\", GROUP=\"video\", TAG+=\"uaccess\""});
  }
  return nodes;
}

bool has_rule_for(const fs::path& root, std::string_view word) {
  for (const char* folder : {"etc/udev/rules.d", "usr/lib/udev/rules.d", "lib/udev/rules.d", "run/udev/rules.d"}) {
    for (const auto& file : entries_of(root / folder)) {
      if (file_text(file).value_or("").find(word) != std::string::npos) return true;
    }
  }
  return false;
}

}  // namespace

DoctorCheck check_permissions(const fs::path& root, const SystemFacts& facts) {
  DoctorCheck check{.name = "permissions"};
  check.explanation =
      "A USB camera is a device file that must be readable and writable. A udev rule gives this permission to the "
      "local user, and again each time the camera is plugged in.";
  check.finding = Finding::ok;
  const auto nodes = camera_nodes(root);
  for (const auto& camera : nodes) {
    const bool allowed = may_read_and_write(root / camera.node, facts);
    if (!check.found.empty()) check.found += ", ";
    check.found.append("/").append(camera.node);
    if (!allowed) check.found += " (access denied)";
    if (allowed) continue;
    check.finding = Finding::problem;
    if (!check.command.empty()) continue;
    check.command = "echo '" + camera.rule +
                    "' | sudo tee -a /etc/udev/rules.d/60-todbench.rules && sudo udevadm control --reload && sudo "
                    "udevadm trigger";
  }
  if (nodes.empty()) check.found = "no USB camera is plugged in";
  const bool rule = has_rule_for(root, seek_vendor) || has_rule_for(root, "aravis");
  check.found += rule ? "; a udev rule for cameras is installed" : "; no udev rule for cameras is installed";
  // Without a rule, access works for the administrator and fails for the operator.
  if (!rule && check.finding == Finding::ok && !nodes.empty() && facts.user_id == 0) check.finding = Finding::warning;
  if (check.finding == Finding::warning) {
    check.command = "echo '" + nodes.front().rule + "' | sudo tee -a /etc/udev/rules.d/60-todbench.rules";
  }
  return check;
}

}  // namespace todbench
