// SPDX-License-Identifier: MIT
// Which revision this program was built from; written at build time (revision.cmake).
#pragma once

namespace glint {

// "1a2b3c4d5e6f", with "-dirty" when files differ; "unknown" without git.
const char* git_revision();

}  // namespace glint
