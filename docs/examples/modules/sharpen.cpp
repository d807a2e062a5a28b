// SPDX-License-Identifier: GPL-3.0-or-later
// A module: sharpens with the mean of the four neighbours. todbench module check ./sharpen
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

// One .npy message of standard input: its header, as it came, and its numbers. False at the end.
bool read_message(std::string& header, std::vector<unsigned char>& numbers, std::size_t& rows, std::size_t& columns) {
  unsigned char start[10];
  if (std::fread(start, 1, 10, stdin) != 10) return false;
  header.assign(start[8] + 256 * start[9], ' ');
  if (std::fread(header.data(), 1, header.size(), stdin) != header.size()) return false;
  columns = 1;
  std::sscanf(header.c_str() + header.find("'shape': (") + 10, "%zu, %zu", &rows, &columns);
  numbers.resize(rows * columns * (header.find("<f4") == std::string::npos ? 1 : 4));
  header.insert(0, reinterpret_cast<char*>(start), 10);
  return std::fread(numbers.data(), 1, numbers.size(), stdin) == numbers.size();
}

int main() {
  std::string header;
  std::vector<unsigned char> numbers;
  std::size_t rows = 0, columns = 0;
  if (!read_message(header, numbers, rows, columns)) return 1;  // JSON: what the stage is to do
  while (read_message(header, numbers, rows, columns)) {
    const auto* in = reinterpret_cast<const float*>(numbers.data());
    std::vector<float> out(rows * columns);
    for (std::size_t y = 0; y < rows; ++y) {
      for (std::size_t x = 0; x < columns; ++x) {
        const std::size_t up = y > 0 ? y - 1 : 0, down = std::min(y + 1, rows - 1);
        const std::size_t left = x > 0 ? x - 1 : 0, right = std::min(x + 1, columns - 1);
        const float neighbours =
            in[up * columns + x] + in[down * columns + x] + in[y * columns + left] + in[y * columns + right];
        out[y * columns + x] = 2 * in[y * columns + x] - neighbours / 4;
      }
    }
    std::fwrite(header.data(), 1, header.size(), stdout);  // the same type and shape
    std::fwrite(out.data(), sizeof(float), out.size(), stdout);
    std::fflush(stdout);
  }
}
