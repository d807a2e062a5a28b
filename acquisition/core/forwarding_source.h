// SPDX-License-Identifier: GPL-3.0-or-later
// Base of decorators of a frame source.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "acquisition/core/frame_source.h"

namespace todbench {

/// Owns a source and forwards every call to it. A decorator overrides the calls that it changes.
class ForwardingSource : public FrameSource {
 public:
  [[nodiscard]] const SourceInfo& info() const override { return source_->info(); }
  [[nodiscard]] Result<void> start() override { return source_->start(); }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds timeout) override { return source_->next(timeout); }
  void stop() override { source_->stop(); }
  [[nodiscard]] Result<std::string> get(const std::string& feature) override { return source_->get(feature); }
  [[nodiscard]] Result<void> set(const std::string& feature, const std::string& value) override {
    return source_->set(feature, value);
  }
  [[nodiscard]] Result<void> correct_nonuniformity() override { return source_->correct_nonuniformity(); }

 protected:
  explicit ForwardingSource(std::unique_ptr<FrameSource> source) : source_(std::move(source)) {}

 private:
  std::unique_ptr<FrameSource> source_;
};

}  // namespace todbench
