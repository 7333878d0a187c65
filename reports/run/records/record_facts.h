// SPDX-License-Identifier: MIT
// Where a record comes from, in words.
#pragma once

#include <string>

#include "reports/run/records/records.h"

namespace glint {

// A field of Record::environment as text; empty: it is not there.
std::string environment_text(const Record& record, const char* field);

// Opens the warning of records that another revision scored than trained.
inline constexpr std::string_view kTrainedBy = "trained by revision ";

// The revision of the program that trained it, or that scored renders of others.
std::string training_revision(const Record& record);

// The GPU's name, or the processor's where it ran on that.
std::string device_text(const Record& record);

}  // namespace glint
