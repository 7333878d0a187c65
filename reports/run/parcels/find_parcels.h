// SPDX-License-Identifier: MIT
// Parcels as they come home: files of a folder, one file, or a tar archive of them, which may have
// been cut off.
#pragma once

#include <functional>

#include "reports/run/parcels/parcel_file.h"

namespace glint {

// Is this where parcels come from, and no profile's folder?
bool holds_parcels(const fs::path& path);

// What could not be used, and why.
struct LostParcel {
  std::string file;  // "results.tar: room_1+2dgs+0.parcel"
  std::string why;
};

// Calls `take` with each parcel that is whole, in the order of the names (of archives: theirs), and
// with where it lay. Returns the others. Errors (kBadPrediction): a file that is neither.
std::vector<LostParcel> for_each_parcel(
    const fs::path& path, const std::function<void(const Parcel&, const std::string& from)>& take
);

}  // namespace glint
