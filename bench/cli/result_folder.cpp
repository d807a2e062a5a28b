// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/result_folder.h"

#include "acquisition/base/try.h"
#include "bench/text/folders.h"

namespace todbench {

Result<void> check_result_folder(const std::filesystem::path& folder, ExistingResults existing) {
  std::error_code error;
  if (!std::filesystem::exists(folder, error)) return {};
  if (!std::filesystem::is_directory(folder, error))
    return fail(ErrorCode::invalid_input, folder.string() + ": is not a folder");
  if (existing == ExistingResults::refused && !std::filesystem::is_empty(folder, error))
    return fail(ErrorCode::invalid_input, folder.string() + ": is not empty (--force overwrites its files)");
  return {};
}

Result<void> make_result_folder(const std::filesystem::path& folder, ExistingResults existing) {
  TODBENCH_TRY_VOID(check_result_folder(folder, existing));
  return make_folder(folder);
}

}  // namespace todbench
