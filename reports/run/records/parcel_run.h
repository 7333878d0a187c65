// SPDX-License-Identifier: MIT
// Run folders that were made of a parcel (reports/run/parcels): scores, a few pictures and what is
// left of the model are there; its colours and renders are not.
#pragma once

#include <optional>

#include "glint/core/config.h"
#include "glint/core/files.h"

namespace glint {

// In such a folder: where it came from, how near its depth is, what became of its meshes.
inline constexpr const char* kParcelFile = "parcel.json";
// In it: small pictures of maps, by view.
inline constexpr const char* kParcelPictures = "pictures";

// Nothing: the run was trained here, or copied whole. Errors (kBadPrediction): the file is damaged.
std::optional<Json> parcel_of_run(const fs::path& run);

// Errors (kBadPrediction): the run came in a parcel, so it cannot be done what `verb` of
// glint-bench would do.
void refuse_parcel_run(const fs::path& run, std::string_view verb);

}  // namespace glint
