// SPDX-License-Identifier: GPL-3.0-or-later
// Feeds the kept inputs of a fuzzing target to it, and as many changed copies of them as asked for: the same ones every
// time. A short form of
// ./run fuzz for compilers without libFuzzer, which also knows what was covered. Usage: fuzz_NAME DIR [CHANGED].
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string_view>
#include <vector>

#ifdef TODBENCH_SANITIZED
#include <sanitizer/common_interface_defs.h>
#endif

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
/// What a target does before the first input, if anything.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) __attribute__((weak));

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t longest_input = 65536;

/// What the target reads now: written to a file when a sanitizer ends the program.
const Bytes* being_read = nullptr;

void keep_what_was_read() {
  if (being_read == nullptr) return;
  std::ofstream out("fuzz-finding", std::ios::binary);
  out.write(reinterpret_cast<const char*>(being_read->data()), static_cast<std::streamsize>(being_read->size()));
  std::fprintf(stderr, "the input is in %s\n", std::filesystem::absolute("fuzz-finding").c_str());
}

void read_by_target(const Bytes& input) {
  being_read = &input;
  (void)LLVMFuzzerTestOneInput(input.data(), input.size());
  being_read = nullptr;
}

/// The files of a folder by name, so that their order does not depend on the disk.
std::vector<Bytes> inputs_of(const char* folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) paths.push_back(entry.path());
  std::ranges::sort(paths);
  std::vector<Bytes> inputs;
  for (const auto& path : paths) {
    std::ifstream in(path, std::ios::binary);
    inputs.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  return inputs;
}

/// Where parsers of numbers and lengths go wrong.
constexpr std::array<std::string_view, 12> words = {
    "nan", "-1", "1e999", "0", "4294967296", "18446744073709551615", "-0.0", "1e-320", "\n", "\"", "[[", "\xff\xfe"};

void change(Bytes& input, const std::vector<Bytes>& others, std::mt19937_64& random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(random() % n); };
  const auto place = [&](std::size_t at) { return input.begin() + static_cast<std::ptrdiff_t>(at); };
  const std::size_t at = below(input.size() + 1);
  switch (random() % 7) {
    case 0:  // a bit
      if (at < input.size()) input[at] ^= static_cast<std::uint8_t>(1U << below(8));
      break;
    case 1:  // a byte
      if (at < input.size()) input[at] = static_cast<std::uint8_t>(random());
      break;
    case 2: {  // a whole number of 1, 2, 4 or 8 bytes at its ends
      const std::uint8_t value = random() % 2 == 0 ? 0x00 : 0xff;
      const std::size_t end = std::min(input.size(), at + (std::size_t{1} << below(4)));
      std::fill(place(std::min(at, end)), place(end), value);
      break;
    }
    case 3: {  // a part left out
      const std::size_t end = std::min(input.size(), at + 1 + below(64));
      input.erase(place(std::min(at, end)), place(end));
      break;
    }
    case 4: {  // a part twice
      const Bytes part(place(at), place(std::min(input.size(), at + 1 + below(64))));
      input.insert(place(at), part.begin(), part.end());
      break;
    }
    case 5: {  // a word
      const std::string_view word = words[below(words.size())];
      if (random() % 2 == 0) input.erase(place(at), place(std::min(input.size(), at + word.size())));
      input.insert(place(at), word.begin(), word.end());
      break;
    }
    default: {  // the end of another input, or no end
      const Bytes& other = others[below(others.size())];
      const std::size_t from = random() % 4 == 0 ? other.size() : below(other.size() + 1);
      input.resize(at);
      input.insert(input.end(), other.begin() + static_cast<std::ptrdiff_t>(from), other.end());
    }
  }
  if (input.size() > longest_input) input.resize(longest_input);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  if (LLVMFuzzerInitialize != nullptr) (void)LLVMFuzzerInitialize(&argc, &argv);
#ifdef TODBENCH_SANITIZED
  __sanitizer_set_death_callback(keep_what_was_read);
#else
  (void)keep_what_was_read;
#endif
  const std::vector<Bytes> kept = inputs_of(argv[1]);
  if (kept.empty()) return 1;
  for (const Bytes& input : kept) read_by_target(input);
  const std::size_t changed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 0;
  std::mt19937_64 random(1);
  for (std::size_t i = 0; i < changed; ++i) {
    Bytes input = kept[random() % kept.size()];
    for (std::uint64_t changes = 1 + random() % 6; changes > 0; --changes) change(input, kept, random);
    read_by_target(input);
  }
  std::printf("%zu kept inputs, %zu changed ones\n", kept.size(), changed);
  return 0;
}
