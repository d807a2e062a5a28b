// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/large_stack.h"

#include <pthread.h>
#include <sys/resource.h>

namespace todbench {
namespace {

constexpr rlim_t small_stack = rlim_t{1} << 20;
constexpr std::size_t large_stack = std::size_t{8} << 20;

struct Call {
  const std::function<int()>* main;
  int result = 0;
};

void* run_call(void* argument) {
  auto& call = *static_cast<Call*>(argument);
  call.result = (*call.main)();
  return nullptr;
}

}  // namespace

int on_a_large_stack(const std::function<int()>& main) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || limit.rlim_cur >= small_stack)
    return main();
  pthread_attr_t attributes;
  ::pthread_attr_init(&attributes);
  ::pthread_attr_setstacksize(&attributes, large_stack);
  ::pthread_setattr_default_np(&attributes);
  Call call{&main};
  pthread_t thread{};
  const bool started = ::pthread_create(&thread, &attributes, run_call, &call) == 0;
  ::pthread_attr_destroy(&attributes);
  if (!started) return main();
  ::pthread_join(thread, nullptr);
  return call.result;
}

}  // namespace todbench
