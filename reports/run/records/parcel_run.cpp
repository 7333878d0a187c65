// SPDX-License-Identifier: MIT
#include "reports/run/records/parcel_run.h"

#include "glint/core/error.h"
#include "glint/core/presence.h"

namespace glint {

std::optional<Json> parcel_of_run(const fs::path& run) {
  const fs::path file = run / kParcelFile;
  return with_exit_code(ExitCode::kBadPrediction, [&]() -> std::optional<Json> {
    if (run.empty() || !is_there(file)) return std::nullopt;
    return read_json_object(file);
  });
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
