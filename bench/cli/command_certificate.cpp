// SPDX-License-Identifier: GPL-3.0-or-later
// todbench certificate
#include "bench/cli/commands.h"

#include <memory>

#include "bench/certificate/calibration_certificate.h"
#include "bench/cli/session_argument.h"
#include "bench/run/rebuild_report.h"
#include "bench/session/manifest.h"
#include "bench/text/files.h"

namespace todbench {
namespace {

struct CertificateArguments {
  std::string session, dcc, order;
};

/// The order of the file, else that which a report of the session has added, else that of the plan.
Result<OrderPlan> order_of(const Session& session, const CertificateArguments& arguments) {
  if (!arguments.order.empty()) return load_order(arguments.order);
  const auto kept = std::filesystem::path(arguments.session) / order_file;
  std::error_code none;
  return std::filesystem::exists(kept, none) ? load_order(kept) : session.plan.order;
}

int run_certificate(Console& console, const CertificateArguments& arguments) {
  const auto session = opened(console, arguments.session, {.may_accept = false});
  if (!session) return report_error(console, session.error());
  const auto order = order_of(*session, arguments);
  if (!order) return report_error(console, order.error());
  const auto xml = calibration_certificate(*session, *order);
  if (!xml) return report_error(console, with_context(arguments.session, xml.error()));
  if (auto written = write_file_atomically(arguments.dcc, *xml); !written)
    return report_error(console, with_context("--dcc", written.error()));
  if (console.json()) {
    console.object({{"certificate", arguments.dcc},
                    {"report_number", order->report_number},
                    {"schema_version", certificate_schema_version},
                    {"results", session->curve->points.size()},
                    {"manifest_sha256", session->manifest_sha256}});
  } else {
    console.text(arguments.dcc);
  }
  return 0;
}

}  // namespace

void add_certificate_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand(
      "certificate", "writes a digital calibration certificate (DCC, XML with D-SI units) of a measured session");
  auto a = std::make_shared<CertificateArguments>();
  command->add_option("SESSION", a->session, "session folder")->required();
  command->add_option("--dcc", a->dcc, "XML file to write")->required();
  command->add_option(
      "--order", a->order,
      "TOML file with a section [order]: customer, report number, laboratory, dates, person. By default that "
      "of the report or of the plan");
  finish_command(*command, program, [a](Console& console) { return run_certificate(console, *a); });
}

}  // namespace todbench
