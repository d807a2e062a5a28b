// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/files.h"

#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include "acquisition/base/safe_file.h"
#include "acquisition/base/try.h"

namespace todbench {

namespace {

tl::unexpected<Error> io_error(const std::filesystem::path& file, std::string_view doing, int number) {
  return fail(ErrorCode::io,
              file.string() + ": " + std::string(doing) + ": " + std::generic_category().message(number));
}

using DigestContext = std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)>;

DigestContext sha256_context() {
  DigestContext context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr);
  return context;
}

std::string hexadecimal(EVP_MD_CTX* context) {
  static constexpr char digits[] = "0123456789abcdef";
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int length = 0;
  EVP_DigestFinal_ex(context, digest.data(), &length);
  std::string text;
  for (unsigned int i = 0; i < length; ++i) {
    text += digits[digest[i] / 16];
    text += digits[digest[i] % 16];
  }
  return text;
}

}  // namespace

Result<void> write_file_atomically(const std::filesystem::path& file, std::string_view content) {
  struct stat found {};
  if (::stat(file.c_str(), &found) == 0 && !S_ISREG(found.st_mode) && !S_ISDIR(found.st_mode))
    return fail(ErrorCode::invalid_input, file.string() + ": is a pipe, a socket or a device, expected a file");
  TODBENCH_TRY(const auto part, make_file_beside(file));
  int problem = write_all(part.descriptor, content);
  if (problem == 0 && ::fsync(part.descriptor) != 0) problem = errno;
  if (::close(part.descriptor) != 0 && problem == 0) problem = errno;
  if (problem == 0 && std::rename(part.path.c_str(), file.c_str()) != 0) problem = errno;
  if (problem == 0) return {};
  ::unlink(part.path.c_str());
  return io_error(file, "cannot be written", problem);
}

bool is_there(const std::filesystem::path& file) {
  std::error_code problem;
  return std::filesystem::exists(file, problem);
}

std::string sha256_of(std::string_view text) {
  const DigestContext context = sha256_context();
  EVP_DigestUpdate(context.get(), text.data(), text.size());
  return hexadecimal(context.get());
}

Result<std::string> sha256_of_file(const std::filesystem::path& file) {
  TODBENCH_TRY(const auto opened, open_to_read(file));
  const DigestContext context = sha256_context();
  std::vector<char> piece(std::size_t{1} << 16U);
  ssize_t taken = 0;
  while ((taken = ::read(opened, piece.data(), piece.size())) > 0 || (taken < 0 && errno == EINTR)) {
    if (taken > 0) EVP_DigestUpdate(context.get(), piece.data(), static_cast<std::size_t>(taken));
  }
  const int problem = errno;
  ::close(opened);
  if (taken < 0) return io_error(file, "cannot be read", problem);
  return hexadecimal(context.get());
}

Result<AppendFile> AppendFile::open(const std::filesystem::path& file, Start start) {
  TODBENCH_TRY(const auto descriptor, start == Start::empty ? make_empty_file(file) : open_to_append(file));
  if (start == Start::empty) ::fcntl(descriptor, F_SETFL, O_APPEND);
  return AppendFile(file, descriptor);
}

Result<void> AppendFile::append(std::string_view content) {
  struct ::stat before {};
  const bool known = ::fstat(descriptor_.get(), &before) == 0 && S_ISREG(before.st_mode);
  const int problem = write_all(descriptor_.get(), content);
  if (problem == 0) return {};
  if (known && ::ftruncate(descriptor_.get(), before.st_size) != 0) {
    return io_error(path_, "cannot be written, and its last line is incomplete", problem);
  }
  return io_error(path_, "cannot be written", problem);
}

Result<void> AppendFile::sync() {
  // Pipes and devices cannot be synced.
  if (::fsync(descriptor_.get()) != 0 && errno != EINVAL && errno != EROFS)
    return io_error(path_, "cannot be written", errno);
  return {};
}

}  // namespace todbench
