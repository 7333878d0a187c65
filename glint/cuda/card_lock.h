// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace glint::gpu {

// A setting of the environment of processes that share a card because their pool wants it so
// (reports/run/executors): how many run at a time.
inline constexpr const char* kCardJobs = "GLINT_CARD_JOBS";

// Takes a card for as long as the process lives; false: another process of ours has it. Those that
// are `one_of_several` take it together, and stand in the way of all others. `card` names it on
// this machine ("0000:18:00.0"), `folder` is for the lock's file, and where none can be made the
// card counts as free.
bool take_card(const std::string& card, const std::string& folder, bool one_of_several = false);
// The same among the system's temporary files, once, by kCardJobs; warns where the card is taken:
// both processes work, but slower, and with the memory that the other leaves.
void warn_of_sharing(const std::string& card);

}  // namespace glint::gpu
