// SPDX-License-Identifier: GPL-3.0-or-later
// Observer that receives its scores from a program of the user.
#pragma once

#include <functional>
#include <memory>
#include <string_view>

#include "hvs/observer/template_observer.h"
#include "sim_devices/module/module_plan.h"

namespace todbench {

/// Returns the observer `spec` with its window, search range and internal noise, and with a module in place of its
/// templates. For every patch the module receives two arrays. The first is <f8 with six numbers: size in displayed
/// samples, displayed samples per pitch, contrast in kelvin, phase in x and y in samples, noise of the sensor in
/// kelvin. The second is <f4 with the patch as the templates would receive it (seen_patch()). The module returns one
/// score for each alternative, and the highest score determines the answer. judge() gives the answer of choose() the
/// probability 1. After a failure() the answers are random. One thread at a time.
[[nodiscard]] std::unique_ptr<Observer> module_observer(const TemplateObserverSpec& spec, Alternatives alternatives,
                                                        const ModulePlan& module,
                                                        std::function<void(std::string_view line)> on_error_line);

}  // namespace todbench
