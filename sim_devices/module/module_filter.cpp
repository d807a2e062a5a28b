// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/module/module_filter.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>

namespace todbench {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t our_processor = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t our_processor = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t our_processor = 0;
#endif

constexpr std::uint32_t refused(std::uint32_t error) {
  return SECCOMP_RET_ERRNO | error;
}

constexpr sock_filter load(std::size_t offset) {
  return {BPF_LD | BPF_W | BPF_ABS, 0, 0, static_cast<std::uint32_t>(offset)};
}
constexpr sock_filter end(std::uint32_t verdict) {
  return {BPF_RET | BPF_K, 0, 0, verdict};
}
/// Executes the next instruction if the value is equal, otherwise skips it.
constexpr sock_filter if_equal(std::uint32_t value) {
  return {BPF_JMP | BPF_JEQ | BPF_K, 0, 1, value};
}
constexpr sock_filter if_at_least(std::uint32_t value) {
  return {BPF_JMP | BPF_JGE | BPF_K, 0, 1, value};
}

/// System calls of x32 on x86-64 have this bit set and other numbers.
constexpr std::uint32_t other_numbers = 0x40000000;
// Only the lower half of the first argument is compared, because the kernel takes an int.
const std::array program{
    load(offsetof(seccomp_data, arch)),
    sock_filter{BPF_JMP | BPF_JEQ | BPF_K, 1, 0, our_processor},
    end(SECCOMP_RET_KILL_PROCESS),
    load(offsetof(seccomp_data, nr)),
    if_at_least(other_numbers),
    end(refused(ENOSYS)),
    // Operations of io_uring create and connect sockets without passing this filter.
    if_equal(__NR_io_uring_setup),
    end(refused(ENOSYS)),
    sock_filter{BPF_JMP | BPF_JEQ | BPF_K, 1, 0, __NR_socket},
    end(SECCOMP_RET_ALLOW),
    load(offsetof(seccomp_data, args)),
    // Families that belong to the module's own network. The others reach the host: UNIX sockets by their paths, VSOCK
    // the hypervisor.
    if_equal(AF_INET),
    end(SECCOMP_RET_ALLOW),
    if_equal(AF_INET6),
    end(SECCOMP_RET_ALLOW),
    if_equal(AF_NETLINK),
    end(SECCOMP_RET_ALLOW),
    end(refused(EAFNOSUPPORT)),
};

}  // namespace

int module_filter() {
  if (our_processor == 0) return -1;
  const int made = ::memfd_create("todbench-module-filter", MFD_CLOEXEC);
  if (made < 0) return -1;
  // Above the standard streams, which the module receives.
  const int descriptor = ::fcntl(made, F_DUPFD_CLOEXEC, 10);
  ::close(made);
  if (descriptor < 0) return -1;
  constexpr std::size_t bytes = sizeof program;
  if (::write(descriptor, program.data(), bytes) == static_cast<ssize_t>(bytes) &&
      ::lseek(descriptor, 0, SEEK_SET) == 0)
    return descriptor;
  ::close(descriptor);
  return -1;
}

}  // namespace todbench
