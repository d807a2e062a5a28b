#include "bench/session/human_record.h"

#include <system_error>
#include <utility>

#include "bench/session/files.h"
#include "bench/session/fit_record.h"
#include "bench/session/manifest.h"
#include "bench/session/plan_options.h"
#include "bench/session/text.h"
#include "bench/session/trials_csv.h"

namespace todbench {
namespace {

constexpr const char* trials_name = "trials_human.csv";
constexpr const char* fits_name = "fits_human.json";

}  // namespace

Result<HumanRecord> human_record(std::vector<Trial> answers, const Plan& plan) {
  auto curve = tod_curve(answers, fit_options(plan));
  if (!curve) return tl::unexpected(curve.error());
  curve->observer = "human";
  return HumanRecord{std::move(answers), *std::move(curve)};
}

Result<void> write_human(const std::filesystem::path& session, const HumanRecord& record) {
  auto writer = TrialsWriter::create(session / trials_name);
  if (!writer) return tl::unexpected(writer.error());
  for (const Trial& trial : record.trials) {
    if (auto written = writer->append(trial); !written) return written;
  }
  if (auto synced = writer->sync(); !synced) return synced;
  if (auto written = write_file_atomically(session / fits_name, to_page(curve_record(record.curve))); !written)
    return written;
  return refresh_manifest(session, {trials_name, fits_name});
}

Result<std::optional<HumanRecord>> read_human(const std::filesystem::path& session) {
  std::error_code none;
  if (!std::filesystem::exists(session / trials_name, none)) return std::nullopt;
  auto trials = read_trials(session / trials_name);
  if (!trials) return tl::unexpected(trials.error());
  const auto text = read_text_file(session / fits_name);
  if (!text) return tl::unexpected(text.error());
  const Json json = Json::parse(*text, nullptr, false);
  if (json.is_discarded()) return fail(ErrorCode::invalid_input, (session / fits_name).string() + ": not valid JSON");
  auto curve = curve_from(json);
  if (!curve) return tl::unexpected(curve.error());
  return HumanRecord{*std::move(trials), *std::move(curve)};
}

}  // namespace todbench
