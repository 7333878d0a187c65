// SPDX-License-Identifier: MIT
// How a stage in a run folder begins and ends. Its key is forgotten first and written last, so that
// a stage that is interrupted is not done.
#pragma once

#include <string>

#include "reports/run/records/stage_files.h"

namespace glint {

// The files of a stage, or their folder, in the run's; of training none: it says what it saved.
std::vector<std::string> stage_outputs(Stage stage);

// Forgets the stage and the scores behind it.
void begin_stage(const fs::path& run, Stage stage);
void end_stage(
    const fs::path& run, Stage stage, const Json& document, const std::string& note = {}
);

// The stage that ended in the folder, for what is made from it. Errors (kBadPrediction): none did,
// or by an earlier version; `verb` of glint-bench runs it.
StageFile finished_stage(const fs::path& run, Stage stage, std::string_view verb);

}  // namespace glint
