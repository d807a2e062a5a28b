// SPDX-License-Identifier: GPL-3.0-or-later
// The reference numbers of physical measures, by case.
#pragma once

#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/source_file.h"

namespace todbench::test {

/// The cases under one key of tests/golden/measures/NAME.json; by value, so that a loop over it holds it. Throws where
/// there are none: a test over nothing would pass.
[[nodiscard]] inline nlohmann::json reference_cases(const std::string& name, const std::string& key) {
  std::ifstream file(source_file("tests/golden/measures/" + name + ".json"));
  nlohmann::json cases = nlohmann::json::parse(file).at("cases").at(key);
  if (cases.empty()) throw std::runtime_error("no reference cases");
  return cases;
}

/// A cube that is flattened frame by frame, row by row.
template <typename Pixel>
[[nodiscard]] std::vector<cv::Mat_<Pixel>> frames_of(const nlohmann::json& cube) {
  const int frames = cube["frames"], rows = cube["rows"], columns = cube["columns"];
  std::vector<cv::Mat_<Pixel>> out;
  std::size_t next = 0;
  for (int k = 0; k < frames; ++k) {
    cv::Mat_<Pixel> frame(rows, columns);
    for (Pixel& value : frame) value = cube["cube"][next++].get<Pixel>();
    out.push_back(frame);
  }
  return out;
}

/// A picture given by its rows.
[[nodiscard]] inline cv::Mat1d picture_of(const nlohmann::json& rows) {
  cv::Mat1d picture(static_cast<int>(rows.size()), static_cast<int>(rows[0].size()));
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x)
      picture(y, x) = rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)].get<double>();
  }
  return picture;
}

}  // namespace todbench::test
