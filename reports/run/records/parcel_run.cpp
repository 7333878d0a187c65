// SPDX-License-Identifier: MIT
#include "reports/run/records/parcel_run.h"

#include "glint/core/error.h"

namespace glint {

std::optional<Json> parcel_of_run(const fs::path& run) {
  std::error_code code;
  const fs::path file = run / kParcelFile;
  if (run.empty() || !fs::exists(file, code)) return std::nullopt;
  return read_json_object(file, ExitCode::kBadPrediction);
}

void refuse_parcel_run(const fs::path& run, std::string_view verb) {
  GLINT_CHECK(
      !parcel_of_run(run),
      kBadPrediction,
      "{}: {}: the run came in a parcel, without colours and renders; `glint-bench mesh` and "
      "`merge` "
      "make meshes of it, for all else train it here or bring its whole folder",
      run.string(),
      verb
  );
}

}  // namespace glint
