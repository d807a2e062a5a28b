// SPDX-License-Identifier: GPL-3.0-or-later
// Modules as programs: what keeps the contract, and every way to break it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <filesystem>

#include "sim_devices/module/module_check.h"
#include "sim_devices/module/module_observer_check.h"
#include "sim_devices/module/npy_message.h"
#include "tests/support/temporary_folder.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;

ModuleOptions example(const std::string& mode) {
  ::signal(SIGPIPE, SIG_IGN);
  // A test waits as long as a busy machine needs; only the hanging module is given a short time.
  return {.command = std::string(TODBENCH_MODULE_EXAMPLE) + " " + mode,
          .limit = std::chrono::milliseconds(mode == "hang" ? 500 : 60000)};
}

TEST(Npy, PicturesAndTextsComeBackFromAnyPieceOfTheStream) {
  cv::Mat1f picture(2, 3);
  for (int i = 0; i < 6; ++i) picture(i / 3, i % 3) = static_cast<float>(i) / 4;
  const std::string bytes = to_message(picture) + to_message(std::string_view("{}"));

  for (std::size_t length = 0; length < bytes.size() - 66; ++length) {
    const auto part = read_message(std::string_view(bytes).substr(0, length), 100);
    ASSERT_TRUE(part) << length;
    EXPECT_EQ(part->message.has_value(), length >= to_message(picture).size()) << length;
  }
  const auto whole = read_message(bytes, 100);
  ASSERT_TRUE(whole && whole->message);
  EXPECT_EQ(whole->message->shape, (std::vector<std::size_t>{2, 3}));
  EXPECT_EQ(whole->message->values[5], 1.25);
  const auto text = read_message(std::string_view(bytes).substr(whole->bytes), 100);
  EXPECT_EQ(text->message->values, (std::vector<double>{'{', '}'}));
}

TEST(Npy, RefusesWhatIsNoArray) {
  cv::Mat1f picture = cv::Mat1f::zeros(20, 20);
  std::string complex = to_message(picture), columns = complex;
  complex.replace(complex.find("<f4"), 3, "<c8");
  columns.replace(columns.find("False"), 5, "True ");
  EXPECT_FALSE(read_message("hello", 100));
  EXPECT_FALSE(read_message(complex, 1000));
  EXPECT_FALSE(read_message(columns, 1000));
  EXPECT_FALSE(read_message(to_message(picture), 100)) << "too many numbers";
}

TEST(ModuleProcess, AnswersPictureByPicture) {
  auto module = ModuleProcess::start(example("double"));
  ASSERT_TRUE(module) << module.error().message;
  for (int i = 1; i <= 3; ++i) {
    const cv::Mat1f picture(480, 640, static_cast<float>(i));
    const auto answer = module->exchange(picture);
    ASSERT_TRUE(answer) << answer.error().message;
    EXPECT_EQ(cv::norm(*answer, 2 * picture, cv::NORM_INF), 0);
  }
}

TEST(ModuleCheck, FindsWhatAModuleDoes) {
  const auto doubled = check_module(example("double")), squared = check_module(example("square"));

  ASSERT_TRUE(doubled) << doubled.error().message;
  EXPECT_TRUE(doubled->linear);
  EXPECT_FLOAT_EQ(doubled->impulse_response(4, 4), 2);
  EXPECT_NEAR(doubled->impulse_sum, 2, 1e-6);
  EXPECT_EQ(doubled->shapes.size(), 4u);
  ASSERT_TRUE(squared) << squared.error().message;
  EXPECT_FALSE(squared->linear);
}

TEST(ModuleCheck, NamesEveryWayToBreakTheContract) {
  const auto refused = [](const std::string& mode) {
    const auto report = check_module(example(mode));
    EXPECT_FALSE(report) << mode;
    return report ? Error{} : report.error();
  };

  EXPECT_THAT(refused("crash").message, HasSubstr("its last output: the licence has expired"));
  EXPECT_EQ(refused("crash").code, ErrorCode::disconnected);
  EXPECT_EQ(refused("hang").code, ErrorCode::timeout);
  EXPECT_THAT(refused("nan").message, HasSubstr("not finite"));
  EXPECT_THAT(refused("shape").message, HasSubstr("shape (2, 3)"));
  EXPECT_THAT(refused("text").message, HasSubstr("not a .npy array"));
  EXPECT_THAT(refused("random").message, HasSubstr("differently"));
  EXPECT_EQ(refused("twice").code, ErrorCode::integrity);
  EXPECT_EQ(refused("endless").code, ErrorCode::integrity);
  EXPECT_EQ(check_module({.command = "/no/such/program", .limit = std::chrono::seconds(60)}).error().code,
            ErrorCode::disconnected);
}

Result<ObserverModuleReport> checked_observer(const std::string& mode) {
  ::signal(SIGPIPE, SIG_IGN);
  ModulePlan module;
  module.place = ModulePlace::observer;
  module.command = std::string(TODBENCH_MODULE_EXAMPLE) + " hvs " + mode;
  module.limit_ms = 60000;
  return check_observer({}, triangle_alternatives(), module);
}

TEST(ObserverModuleCheck, CountsWhatAModuleWithTheTemplatesOfTheObserverFinds) {
  const auto report = checked_observer("identity");

  ASSERT_TRUE(report) << report.error().message;
  ASSERT_EQ(report->sizes.size(), 4u);
  TemplateObserver built_in({}, triangle_alternatives());
  for (const JudgedSize& size : report->sizes) {
    EXPECT_EQ(size.window_samples, (*built_in.prepare(size.size_samples, size.samples_per_pitch))->window_samples());
    EXPECT_EQ(size.asked, 36);
  }
  EXPECT_GE(report->sizes.front().right, 24) << "a guess is right in a quarter of them";
  EXPECT_EQ(report->sizes[2].right, 36);
  EXPECT_EQ(report->sizes[3].right, 36);
  EXPECT_FALSE(report->order_matters);
}

TEST(ObserverModuleCheck, NamesEveryWayToBreakTheContract) {
  const auto refused = [](const std::string& mode) {
    const auto report = checked_observer(mode);
    EXPECT_FALSE(report) << mode;
    return report ? Error{} : report.error();
  };

  EXPECT_THAT(refused("crash").message, HasSubstr("the licence has expired"));
  EXPECT_THAT(refused("nan").message, HasSubstr("not finite"));
  EXPECT_THAT(refused("shape").message, HasSubstr("shape"));
  EXPECT_THAT(refused("text").message, HasSubstr("not a .npy array"));
  EXPECT_THAT(refused("random").message, HasSubstr("differently"));
}

TEST(ObserverModuleCheck, SaysThatAModuleRemembers) {
  const auto report = checked_observer("remembers");

  ASSERT_TRUE(report) << report.error().message;
  EXPECT_TRUE(report->order_matters);
}

#if !defined(__SANITIZE_ADDRESS__)
// The address sanitizer reserves terabytes of address space.
TEST(ModuleProcess, OfAModuleThatTakesMoreMemoryThanItMayEnds) {
  ModuleOptions limited = example("memory"), unlimited = example("memory");
  limited.memory_limit_mib = 512;
  const cv::Mat1f picture = cv::Mat1f::zeros(2, 3);

  EXPECT_EQ(ModuleProcess::start(limited)->exchange(picture).error().code, ErrorCode::disconnected);
  EXPECT_TRUE(ModuleProcess::start(unlimited)->exchange(picture));
}
#endif

TEST(ModuleProcess, HasNoNetworkUnlessItIsLeftIt) {
  if (!can_cut_network()) GTEST_SKIP() << "bubblewrap is not installed or cannot work here";
  const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  ASSERT_EQ(::bind(listener, reinterpret_cast<const sockaddr*>(&address), length), 0);
  ASSERT_EQ(::listen(listener, 4), 0);
  ASSERT_EQ(::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &length), 0);
  ModuleOptions cut = example("connect " + std::to_string(ntohs(address.sin_port))), ours = cut;
  ours.network = ModuleNetwork::ours;
  const cv::Mat1f picture = cv::Mat1f::zeros(2, 3);

  const auto without = ModuleProcess::start(cut)->exchange(picture);
  const auto with = ModuleProcess::start(ours)->exchange(picture);
  ::close(listener);

  ASSERT_FALSE(without);
  EXPECT_EQ(without.error().code, ErrorCode::disconnected);
  EXPECT_TRUE(with) << with.error().message;
}

TEST(ModuleProcess, AndItsVersionCommandReachNoSocketOfAPath) {
  if (!can_cut_network()) GTEST_SKIP() << "bubblewrap is not installed or cannot work here";
  const testing::TemporaryFolder folder;
  const std::string path = folder.path() / "socket";
  const int listener = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::snprintf(address.sun_path, sizeof address.sun_path, "%s", path.c_str());
  ASSERT_EQ(::bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ASSERT_EQ(::listen(listener, 4), 0);
  const auto with_network = [](ModuleOptions options, ModuleNetwork network) {
    options.network = network;
    return options;
  };
  const ModuleOptions picture = example("connect-path " + path), version = example("says-path " + path);

  const auto cut = ModuleProcess::start(picture)->exchange(cv::Mat1f::zeros(2, 3));
  const auto ours = ModuleProcess::start(with_network(picture, ModuleNetwork::ours))->exchange(cv::Mat1f::zeros(2, 3));
  const std::string version_cut = first_line_of_module(version);
  const std::string version_ours = first_line_of_module(with_network(version, ModuleNetwork::ours));
  ::close(listener);

  EXPECT_FALSE(cut);
  EXPECT_TRUE(ours) << ours.error().message;
  EXPECT_EQ(version_cut, "not reached");
  EXPECT_EQ(version_ours, "reached");
}

TEST(ModuleProcess, HasNoSocketsThatLeadOutOfItsNetworkAndQueuesOfItsOwn) {
  if (!can_cut_network()) GTEST_SKIP() << "bubblewrap is not installed or cannot work here";
  ModuleOptions families = example("says-families"), queues = families;
  queues.command = "readlink /proc/self/ns/ipc";
  const std::string of_host = std::filesystem::read_symlink("/proc/self/ns/ipc").string();

  const std::string cut = first_line_of_module(families), queues_cut = first_line_of_module(queues);
  families.network = queues.network = ModuleNetwork::ours;

  EXPECT_EQ(cut, "0 of them, IPv4");
  EXPECT_NE(first_line_of_module(families), cut);
  EXPECT_NE(queues_cut, of_host);
  EXPECT_EQ(first_line_of_module(queues), of_host);
}

}  // namespace
}  // namespace todbench
