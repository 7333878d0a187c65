// SPDX-License-Identifier: MIT
// A parcel becomes a run folder of a profile, by the rules of reports/run/records/merge_runs.h.
#pragma once

#include "reports/run/parcels/parcel_file.h"

namespace glint {

// Takes the cell over into the profile's folder where it is not there, or failed there: its files,
// what is left of its model as the method loads it, parcel.json, and its record. `write`: false:
// only says what would be. `from`: where the parcel lay, for people. Errors: kEnvironment: cannot
// be written.
MergedCell take_parcel(
    const fs::path& into, const Parcel& parcel, const std::string& from, bool write
);

// Is this run one of a parcel whose meshes have not been made yet?
bool wants_meshes(const fs::path& run, const Record& record);
// Would it be, once it is taken?
bool wants_meshes(const Parcel& parcel);

}  // namespace glint
