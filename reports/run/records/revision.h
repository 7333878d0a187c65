// SPDX-License-Identifier: MIT
// Which revision this program was built from; written at build time (revision.cmake).
#pragma once

namespace glint {

// "1a2b3c4d5e6f", with "-dirty" when files differ; "unknown" without git.
const char* git_revision();
// When it was committed, in seconds since 1970 (UTC); 0: not known.
long long git_time();

}  // namespace glint
