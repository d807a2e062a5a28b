// SPDX-License-Identifier: GPL-3.0-or-later
// The accuracy bill as rows of a table.
#pragma once

#include <QList>
#include <QStringList>

#include "bench/gui/presenters/plan_preview.h"
#include "bench/report/accuracy_bill.h"

namespace todbench {

/// Part, time, forecast of the plan ("–": none) and result; each sentence is a remark below.
[[nodiscard]] QList<QStringList> bill_rows(const AccuracyBill& bill);
/// Part, time and result of the forecast of a plan, or the reason why there is none.
[[nodiscard]] QList<QStringList> bill_rows(const PlanForecast& forecast);

}  // namespace todbench
