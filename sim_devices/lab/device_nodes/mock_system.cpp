// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/device_nodes/mock_system.h"

#include <umockdev.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <vector>

namespace todbench {
namespace {

struct FreeText {
  void operator()(gchar* text) const { g_free(text); }
};

std::string content_of(const char* path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::vector<std::string> command_line() {
  std::vector<std::string> words;
  std::istringstream line(content_of("/proc/self/cmdline"));
  for (std::string word; std::getline(line, word, '\0');) words.push_back(word);
  return words;
}

/// Runtime of the sanitizer if the program is built with one as a shared library; otherwise empty. It must precede
/// every other library, or calls that umockdev forwards are not checked.
std::string sanitizer_runtime() {
  std::istringstream maps(content_of("/proc/self/maps"));
  for (std::string line; std::getline(maps, line);) {
    const auto path = line.find('/');
    if (path == std::string::npos) continue;
    if (line.find("/libasan.so") != std::string::npos || line.find("/libtsan.so") != std::string::npos) {
      return line.substr(path);
    }
  }
  return {};
}

}  // namespace

std::shared_ptr<MockSystem> MockSystem::create() {
  return std::shared_ptr<MockSystem>(new MockSystem(umockdev_testbed_new()));
}

MockSystem::~MockSystem() {
  g_object_unref(testbed_);
}

bool MockSystem::is_preloaded() {
  return content_of("/proc/self/maps").find("libumockdev-preload") != std::string::npos;
}

void MockSystem::enter() {
  // A second failure would restart the program endlessly.
  constexpr const char* tried = "TODBENCH_MOCK_SYSTEM";
  if (is_preloaded() || std::getenv(tried) != nullptr) return;
  const char* before = std::getenv("LD_PRELOAD");
  std::string libraries = preload_library() + (before != nullptr ? std::string(":") + before : std::string());
  if (const std::string runtime = sanitizer_runtime(); !runtime.empty()) libraries = runtime + ":" + libraries;
  ::setenv("LD_PRELOAD", libraries.c_str(), 1);
  ::setenv(tried, "1", 1);
  std::vector<std::string> words = command_line();
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execv("/proc/self/exe", arguments.data());
}

std::string MockSystem::preload_library() {
  return "libumockdev-preload.so.0";
}

std::string MockSystem::folder() const {
  const std::unique_ptr<gchar, FreeText> folder(umockdev_testbed_get_root_dir(testbed_));
  return folder.get();
}

Result<void> MockSystem::add(const std::string& description) {
  GError* error = nullptr;
  if (umockdev_testbed_add_from_string(testbed_, description.c_str(), &error) != 0) return {};
  const std::string message = error != nullptr ? error->message : "unknown error";
  g_clear_error(&error);
  return fail(ErrorCode::internal, "adding an emulated device: " + message);
}

void MockSystem::announce(const std::string& device_path, const std::string& action) {
  umockdev_testbed_uevent(testbed_, device_path.c_str(), action.c_str());
}

void MockSystem::remove(const std::string& device_path) {
  umockdev_testbed_remove_device(testbed_, device_path.c_str());
}

}  // namespace todbench
