// SPDX-License-Identifier: MIT
// Which code this program was built from; the values are written at build time (revision.cmake).
#pragma once

namespace glint {

const char* git_revision(
);  // "1a2b3c4d5e6f", with "-dirty" when files differ; "unknown" without git
const char* source_hash();  // of glint/, baselines/ and metrics/: what results depend on

}  // namespace glint
