// SPDX-License-Identifier: GPL-3.0-or-later
// The ideal observer for white noise: it knows shape, contrast, filter and position. For tests and bounds, never for
// reports.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "hvs/observer/observer.h"
#include "hvs/shape/polygon_image.h"

namespace todbench {

/// Maximum likelihood among the exactly known filtered alternatives in white noise, at the position Patch::phase (to
/// 1/16 sample). hvs/observer/known_position.h gives its proportion correct.
class IdealObserver final : public Observer {
 public:
  /// `filter`: the sensor's transfer function in cycles per sample; `band_per_sample`: highest frequency kept.
  IdealObserver(std::string name, Alternatives alternatives, TransferFunction filter, double band_per_sample);
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] Result<std::shared_ptr<const PreparedObserver>> prepare(double size_samples,
                                                                        int samples_per_pitch) override;

 private:
  std::string name_;
  Alternatives alternatives_;
  TransferFunction filter_;
  double band_per_sample_;
  std::mutex mutex_;
  std::map<double, std::shared_ptr<const PreparedObserver>> prepared_;
};

}  // namespace todbench
