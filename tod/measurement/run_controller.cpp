// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/run_controller.h"

namespace todbench {

std::string_view to_string(Moment moment) {
  switch (moment) {
    case Moment::correction_due:
      return "correction_due";
    case Moment::corrected:
      return "corrected";
    case Moment::scene_changed:
      return "scene_changed";
    case Moment::camera_lost:
      return "camera_lost";
    case Moment::camera_back:
      return "camera_back";
  }
  return "";
}

}  // namespace todbench
