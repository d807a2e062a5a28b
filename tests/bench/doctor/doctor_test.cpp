// SPDX-License-Identifier: GPL-3.0-or-later
// The doctor's checks on made-up systems: files under a folder, facts as values.
#include "bench/doctor/doctor.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>

#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A system of files.
class Doctor : public ::testing::Test {
 protected:
  void write(const std::string& file, const std::string& text) const {
    const auto path = root() / file;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text << "\n";
  }
  void interface(const std::string& name, int mtu, const std::string& state = "up", int speed = 1000) const {
    write("sys/class/net/" + name + "/mtu", std::to_string(mtu));
    write("sys/class/net/" + name + "/operstate", state);
    write("sys/class/net/" + name + "/speed", std::to_string(speed));
  }
  /// A Seek camera with a node of this mode.
  void seek_camera(unsigned mode) const {
    write("sys/bus/usb/devices/1-2/idVendor", "289d");
    write("sys/bus/usb/devices/1-2/busnum", "1");
    write("sys/bus/usb/devices/1-2/devnum", "7");
    write("dev/bus/usb/001/007", "");
    ::chmod((root() / "dev/bus/usb/001/007").c_str(), mode);
  }
  [[nodiscard]] std::filesystem::path root() const { return folder_.path(); }
  /// Somebody who owns no file of this test.
  [[nodiscard]] static SystemFacts operator_facts() {
    SystemFacts facts;
    facts.user_id = 4711;
    facts.group_ids = {4711};
    return facts;
  }

 private:
  testing::TemporaryFolder folder_;
};

TEST_F(Doctor, TheSocketBufferWantsFourMebibytesAtLeast) {
  write("proc/sys/net/core/rmem_max", "212992");

  const auto check = check_socket_buffer(root(), {.frame_bytes = 1000});

  EXPECT_EQ(check.finding, Finding::problem);
  EXPECT_EQ(check.command, "sudo sysctl -w net.core.rmem_max=4194304");
}

TEST_F(Doctor, TheSocketBufferWantsEightFramesOfALargeCamera) {
  write("proc/sys/net/core/rmem_max", "4194304");

  EXPECT_EQ(check_socket_buffer(root(), {.frame_bytes = 524288}).finding, Finding::ok);
  EXPECT_EQ(check_socket_buffer(root(), {.frame_bytes = 524289}).command, "sudo sysctl -w net.core.rmem_max=4194312");
}

TEST_F(Doctor, AnUnreadableSocketBufferIsNotKnownToBeGood) {
  EXPECT_EQ(check_socket_buffer(root(), {}).finding, Finding::unknown);
  write("proc/sys/net/core/rmem_max", "plenty");
  EXPECT_EQ(check_socket_buffer(root(), {}).finding, Finding::unknown);
}

TEST_F(Doctor, PacketsLargerThanTheInterfaceAreAProblem) {
  interface("lo", 65536);
  interface("eth0", 1500);

  EXPECT_EQ(check_mtu(root(), {.packet_bytes = 1500}).finding, Finding::ok);
  const auto jumbo = check_mtu(root(), {.packet_bytes = 9000});
  EXPECT_EQ(jumbo.finding, Finding::problem);
  EXPECT_EQ(jumbo.command, "sudo ip link set eth0 mtu 9000");
}

TEST_F(Doctor, SmallPacketsAtAHighRateAreAWarning) {
  interface("eth0", 1500);

  EXPECT_EQ(check_mtu(root(), {.frame_bytes = 614400, .frame_rate_hz = 190}).finding, Finding::warning);
}

TEST_F(Doctor, OneWiredInterfaceIsFineSeveralOrWirelessOnesAreNot) {
  interface("lo", 65536, "unknown");
  interface("eth0", 1500);
  interface("eth1", 1500, "down");
  EXPECT_EQ(check_interfaces(root()).finding, Finding::ok);

  interface("wlan0", 1500, "up", 300);
  std::filesystem::create_directories(root() / "sys/class/net/wlan0/wireless");

  const auto check = check_interfaces(root());
  EXPECT_EQ(check.finding, Finding::warning);
  EXPECT_EQ(check.command, "sudo ip link set wlan0 down");
}

TEST_F(Doctor, FirewallRulesThatDropUdpAreFoundInEitherDialect) {
  const auto found = [&](const std::string& rules) {
    SystemFacts facts;
    facts.firewall_rules = rules;
    return check_firewall(root(), facts).finding;
  };

  EXPECT_EQ(found(""), Finding::ok);
  EXPECT_EQ(found("table inet filter {\n chain input {\n  type filter hook input priority 0; policy drop;\n }\n}"),
            Finding::warning);
  EXPECT_EQ(found("chain input {\n type filter hook input priority 0; policy accept;\n udp dport 1-1023 drop\n}"),
            Finding::warning);
  EXPECT_EQ(found("chain output {\n type filter hook output priority 0; policy drop;\n}"), Finding::ok);
  EXPECT_EQ(found("chain input {\n type filter hook input priority 0; policy accept;\n tcp dport 22 drop\n}"),
            Finding::ok);
  EXPECT_EQ(found("*filter\n:INPUT ACCEPT [0:0]\n-A INPUT -p udp -j DROP\nCOMMIT"), Finding::warning);
  EXPECT_EQ(found("*filter\n:INPUT DROP [0:0]\nCOMMIT"), Finding::warning);
  EXPECT_EQ(found("*filter\n:INPUT ACCEPT [0:0]\n-A INPUT -p tcp -j DROP\n-A OUTPUT -j DROP\nCOMMIT"), Finding::ok);
}

TEST_F(Doctor, AFirewallIsReadFromItsFilesWhenItCannotBeAsked) {
  write("etc/ufw/ufw.conf", "ENABLED=yes");

  const auto check = check_firewall(root(), {});

  EXPECT_EQ(check.finding, Finding::warning);
  EXPECT_THAT(check.command, HasSubstr("ufw allow"));
}

TEST_F(Doctor, UsbMemoryHoldsEightFramesOrHasNoLimit) {
  const DoctorDemand demand{.frame_bytes = 3 << 20};
  EXPECT_EQ(check_usb_memory(root(), demand).finding, Finding::unknown);

  write("sys/module/usbcore/parameters/usbfs_memory_mb", "16");
  EXPECT_EQ(check_usb_memory(root(), demand).finding, Finding::problem);
  EXPECT_THAT(check_usb_memory(root(), demand).command, HasSubstr("echo 64 |"));

  write("sys/module/usbcore/parameters/usbfs_memory_mb", "24");
  EXPECT_EQ(check_usb_memory(root(), demand).finding, Finding::ok);
  write("sys/module/usbcore/parameters/usbfs_memory_mb", "0");
  EXPECT_EQ(check_usb_memory(root(), demand).finding, Finding::ok);
}

TEST_F(Doctor, ACameraThatMayNotBeOpenedIsAProblemWithItsRule) {
  seek_camera(0600);

  const auto check = check_permissions(root(), operator_facts());

  EXPECT_EQ(check.finding, Finding::problem);
  EXPECT_THAT(check.found, HasSubstr("/dev/bus/usb/001/007 (access denied)"));
  EXPECT_THAT(check.command, HasSubstr("ATTR{idVendor}==\"289d\""));
}

TEST_F(Doctor, ACameraThatMayBeOpenedIsFine) {
  seek_camera(0666);

  EXPECT_EQ(check_permissions(root(), operator_facts()).finding, Finding::ok);
}

TEST_F(Doctor, ACameraThatOnlyTheAdministratorMayOpenIsAWarningUntilThereIsARule) {
  seek_camera(0600);
  EXPECT_EQ(check_permissions(root(), {}).finding, Finding::warning);

  write("etc/udev/rules.d/60-todbench.rules", "SUBSYSTEM==\"usb\", ATTR{idVendor}==\"289d\", TAG+=\"uaccess\"");

  EXPECT_EQ(check_permissions(root(), {}).finding, Finding::ok);
}

TEST_F(Doctor, AUsb3VisionCameraIsKnownByItsClass) {
  write("sys/bus/usb/devices/2-1/idVendor", "1e10");
  write("sys/bus/usb/devices/2-1/bDeviceClass", "ef");
  write("sys/bus/usb/devices/2-1/busnum", "2");
  write("sys/bus/usb/devices/2-1/devnum", "3");
  write("sys/bus/usb/devices/2-1/2-1:1.0/bInterfaceClass", "ef");
  write("sys/bus/usb/devices/2-1/2-1:1.0/bInterfaceSubClass", "05");

  EXPECT_THAT(check_permissions(root(), operator_facts()).found, HasSubstr("/dev/bus/usb/002/003"));
}

TEST_F(Doctor, ADiskHasToHoldTheFramesAndToBeTwiceAsFast) {
  const DoctorDemand demand{.frame_bytes = 1 << 20, .frame_rate_hz = 10, .recording_minutes = 1};
  const auto judged = [&](double mib_free, double mib_per_s) {
    SystemFacts facts;
    facts.disk_free_bytes = static_cast<std::int64_t>(mib_free * 1048576);
    facts.disk_bytes_per_s = mib_per_s * 1048576;
    return check_disk(facts, demand).finding;
  };

  EXPECT_EQ(judged(600, 20), Finding::ok);
  EXPECT_EQ(judged(599, 20), Finding::warning);
  EXPECT_EQ(judged(600, 19), Finding::warning);
  EXPECT_EQ(check_disk({}, demand).finding, Finding::problem);
}

TEST_F(Doctor, AClockIsGoodWhenItIsSynchronisedAndQuickToRead) {
  write("sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc");
  SystemFacts facts;
  EXPECT_EQ(check_clock(root(), facts).finding, Finding::unknown);
  facts.clock_synchronised = false;
  EXPECT_EQ(check_clock(root(), facts).finding, Finding::warning);
  EXPECT_EQ(check_clock(root(), facts).command, "sudo timedatectl set-ntp true");

  facts.clock_synchronised = true;
  EXPECT_EQ(check_clock(root(), facts).finding, Finding::ok);
  facts.clock_step_s = 0.5;
  EXPECT_EQ(check_clock(root(), facts).finding, Finding::warning);
  facts.clock_step_s = 0;
  write("sys/devices/system/clocksource/clocksource0/current_clocksource", "hpet");
  EXPECT_EQ(check_clock(root(), facts).finding, Finding::warning);
}

TEST_F(Doctor, EveryCheckSaysWhatItFoundAndWhyItMatters) {
  for (const auto& check : examine(root(), {}, {})) {
    EXPECT_THAT(check.name, ::testing::Not(IsEmpty()));
    EXPECT_THAT(check.found, ::testing::Not(IsEmpty())) << check.name;
    EXPECT_THAT(check.explanation, ::testing::Not(IsEmpty())) << check.name;
    EXPECT_TRUE(check.finding != Finding::problem || check.name == "disk" || !check.command.empty()) << check.name;
  }
}

TEST_F(Doctor, TheRunningSystemIsMeasuredAndLeavesNoFileBehind) {
  const auto facts = live_facts(root());

  EXPECT_TRUE(facts.disk_free_bytes);
  EXPECT_TRUE(facts.disk_bytes_per_s && *facts.disk_bytes_per_s > 0);
  EXPECT_TRUE(std::filesystem::is_empty(root()));
  EXPECT_EQ(examine("/", facts, {}).size(), 8U);
}

}  // namespace
}  // namespace todbench
