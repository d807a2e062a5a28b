// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/bill_rows.h"

namespace todbench {

QList<QStringList> bill_rows(const AccuracyBill& bill) {
  QList<QStringList> rows;
  const auto seconds = [](const std::optional<double>& value, const char* otherwise) {
    return value ? QString::number(*value, 'f', 1) : QString::fromUtf8(otherwise);
  };
  for (const BillRow& row : bill.rows) {
    rows << QStringList{QString::fromStdString(row.part), seconds(row.seconds, "not separate"),
                        seconds(row.forecast_s, "–"), QString::fromStdString(row.bought)};
  }
  rows << QStringList{"Total", seconds(bill.total_s, ""), seconds(bill.forecast_s, "–"), QString()};
  for (const std::string& sentence : bill.sentences)
    rows << QStringList{"Remark", QString(), QString(), QString::fromStdString(sentence)};
  return rows;
}

QList<QStringList> bill_rows(const PlanForecast& forecast) {
  if (!forecast.bill) {
    const QString reason = forecast.problem.empty() ? "No forecast: a simulated scene takes computing time alone."
                                                    : "No forecast: " + QString::fromStdString(forecast.problem);
    return {{"Remark", QString(), reason}};
  }
  QList<QStringList> rows = bill_rows(*forecast.bill);
  for (QStringList& row : rows) row.removeAt(2);
  return rows;
}

}  // namespace todbench
