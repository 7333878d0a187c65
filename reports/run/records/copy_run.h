// SPDX-License-Identifier: MIT
// The folder of a run, taken over from another place.
#pragma once

#include "glint/core/files.h"

namespace glint {

// Copies all that lies below `from` to `to`, in place of what is there: whole, or not at all. Links
// are followed: what they lead to is copied. Nothing where there is no `from`: records alone were
// kept. `write`: false: only says what could not be copied. Errors: (kBadPrediction) a pipe, a
// device, a link that leads nowhere or back to a folder that it lies in; (kEnvironment) it cannot
// be read or written.
void copy_run(const fs::path& from, const fs::path& to, bool write);

}  // namespace glint
