// SPDX-License-Identifier: GPL-3.0-or-later
// The accuracy bill as rows of a table.
#pragma once

#include <QList>
#include <QStringList>

#include "bench/gui/presenters/plan_preview.h"
#include "bench/report/accuracy_bill.h"

namespace todbench {

/// Returns rows with part, time, forecast of the plan ("–": none) and result, then a row with the total and one row for
/// each sentence.
[[nodiscard]] QList<QStringList> bill_rows(const AccuracyBill& bill);
/// Returns rows with part, time and result of the forecast of a plan, or a row with the reason why there is no
/// forecast.
[[nodiscard]] QList<QStringList> bill_rows(const PlanForecast& forecast);

}  // namespace todbench
