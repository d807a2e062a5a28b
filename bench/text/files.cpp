#include "bench/text/files.h"

#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <memory>
#include <system_error>
#include <utility>

namespace todbench {

namespace {

tl::unexpected<Error> io_error(const std::filesystem::path& file, std::string_view doing, int number) {
  return fail(ErrorCode::io,
              file.string() + ": " + std::string(doing) + ": " + std::generic_category().message(number));
}

/// 0 or the error number; interrupted and partial writes are continued.
int write_all(int descriptor, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(descriptor, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    if (written == 0) return ENOSPC;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
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
  const std::filesystem::path part = file.parent_path() / ("." + file.filename().string() + ".part");
  const int descriptor = ::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) return io_error(file, "cannot be created", errno);
  int problem = write_all(descriptor, content);
  if (problem == 0 && ::fsync(descriptor) != 0) problem = errno;
  if (::close(descriptor) != 0 && problem == 0) problem = errno;
  if (problem == 0 && std::rename(part.c_str(), file.c_str()) != 0) problem = errno;
  if (problem == 0) return {};
  ::unlink(part.c_str());
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
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return fail(ErrorCode::io, file.string() + ": cannot be opened for reading");
  const DigestContext context = sha256_context();
  std::array<char, 1 << 16> piece{};
  while (stream) {
    stream.read(piece.data(), piece.size());
    EVP_DigestUpdate(context.get(), piece.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) return fail(ErrorCode::io, file.string() + ": cannot be read");
  return hexadecimal(context.get());
}

Result<AppendFile> AppendFile::open(const std::filesystem::path& file, Start start) {
  const int mode = start == Start::empty ? O_TRUNC : 0;
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | mode, 0666);
  if (descriptor < 0) return io_error(file, "cannot be created", errno);
  return AppendFile(file, descriptor);
}

AppendFile::AppendFile(AppendFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

AppendFile& AppendFile::operator=(AppendFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

AppendFile::~AppendFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> AppendFile::append(std::string_view content) {
  struct ::stat before {};
  const bool known = ::fstat(descriptor_, &before) == 0 && S_ISREG(before.st_mode);
  const int problem = write_all(descriptor_, content);
  if (problem == 0) return {};
  if (known && ::ftruncate(descriptor_, before.st_size) != 0) {
    return io_error(path_, "cannot be written, and its last line is incomplete", problem);
  }
  return io_error(path_, "cannot be written", problem);
}

Result<void> AppendFile::sync() {
  // Pipes and devices have nothing to sync.
  if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS)
    return io_error(path_, "cannot be written", errno);
  return {};
}

}  // namespace todbench
