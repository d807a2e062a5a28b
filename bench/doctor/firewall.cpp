// SPDX-License-Identifier: GPL-3.0-or-later
// Check for firewall rules that block the packets of a camera. Only a hint: the rules are read, not evaluated.
#include <sstream>

#include "bench/doctor/doctor.h"
#include "bench/doctor/system_files.h"

namespace todbench {

namespace fs = std::filesystem;

namespace {

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

/// Returns the first line that drops or rejects incoming UDP; empty: none.
std::string dropping_line(const std::string& rules) {
  std::istringstream lines(rules);
  bool incoming = false;
  for (std::string line; std::getline(lines, line);) {
    const auto begin = line.find_first_not_of(" \t");
    if (begin == std::string::npos || line[begin] == '#') continue;
    const std::string text = line.substr(begin);
    // nftables: "type filter hook input priority filter; policy drop;", then rules until the closing brace.
    if (contains(text, "hook input")) incoming = true;
    if (text.starts_with("}")) incoming = false;
    const bool drops = contains(text, "drop") || contains(text, "reject");
    if (incoming && contains(text, "policy drop")) return text;
    if (incoming && drops && (contains(text, "udp") || text == "drop" || text.starts_with("reject"))) return text;
    // iptables-save: ":INPUT DROP [0:0]", "-A INPUT -p udp -j DROP".
    if (text.starts_with(":INPUT DROP")) return text;
    const bool to_nowhere = contains(text, "-j DROP") || contains(text, "-j REJECT");
    if (text.starts_with("-A INPUT") && to_nowhere && (contains(text, "-p udp") || !contains(text, "-p "))) return text;
  }
  return {};
}

}  // namespace

DoctorCheck check_firewall(const fs::path& root, const SystemFacts& facts) {
  DoctorCheck check{.name = "firewall"};
  check.explanation =
      "A GigE Vision camera sends its frames as UDP packets that are not answers to requests. A firewall that drops "
      "incoming UDP blocks every frame, although discovery and control work.";
  std::string rules = facts.firewall_rules.value_or("");
  if (!facts.firewall_rules) {
    for (const char* file : {"etc/nftables.conf", "etc/iptables/rules.v4"}) {
      rules += file_text(root / file).value_or("") + "\n";
    }
  }
  const auto ufw = file_text(root / "etc/ufw/ufw.conf").value_or("");
  const bool ufw_on = contains(ufw, "ENABLED=yes") || contains(ufw, "ENABLED=\"yes\"");
  const std::string line = dropping_line(rules);
  check.finding = line.empty() && !ufw_on ? Finding::ok : Finding::warning;
  if (!line.empty()) {
    check.found = "a rule drops incoming packets: " + line;
    check.command = contains(line, "INPUT")
                        ? "sudo iptables -I INPUT -s CAMERA_ADDRESS -p udp -j ACCEPT"
                        : "sudo nft insert rule inet filter input ip saddr CAMERA_ADDRESS udp sport "
                          "1024-65535 accept";
  } else if (ufw_on) {
    check.found = "ufw is enabled";
    check.command = "sudo ufw allow from CAMERA_ADDRESS proto udp";
  } else {
    check.found = facts.firewall_rules ? "no rule drops incoming UDP" : "no configured rule drops incoming UDP";
  }
  return check;
}

}  // namespace todbench
