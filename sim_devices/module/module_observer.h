// An observer whose scores come from a program of the user's.
#pragma once

#include <functional>
#include <memory>
#include <string_view>

#include "hvs/observer/template_observer.h"
#include "sim_devices/module/module_plan.h"

namespace todbench {

/// The observer `spec` with its window, its search range and its internal noise, whose templates are replaced by a
/// module: for every patch it is sent an array <f8 of six numbers (size in displayed samples, displayed samples per
/// pitch, contrast in kelvin, phase in x and y in samples, noise of the sensor in kelvin) and one <f4 with the patch as
/// the templates would meet it (seen_patch()), and answers with one score for each alternative; the highest wins. It
/// has no judge(): graded answers are those of choose(), 1 or 0. After a failure() every choice is that of no scores.
/// One thread at a time.
[[nodiscard]] std::unique_ptr<Observer> module_observer(const TemplateObserverSpec& spec, Alternatives alternatives,
                                                        const ModulePlan& module,
                                                        std::function<void(std::string_view line)> on_error_line);

}  // namespace todbench
