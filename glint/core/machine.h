// SPDX-License-Identifier: MIT
// The machine that a program runs on, and the memory it takes there.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "glint/core/files.h"

namespace glint {

struct Machine {
  std::string cpu;        // model name
  int cores = 1;          // logical
  bool has_avx2 = false;  // and FMA: the tile kernels need both
  std::uint64_t memory_bytes = 0;
};
Machine this_machine();

// The folder, or the nearest one above that is there: of its disk it will be.
fs::path nearest_existing(const fs::path& folder);

// Free bytes of the disk that holds `folder` (or its nearest existing parent); 0: unknown.
std::uint64_t free_disk_bytes(const fs::path& folder);

// Bytes that this process may still take without paging: of the machine, or of the control group
// that it runs in, whichever is less.
std::uint64_t available_memory_bytes();

std::uint64_t resident_memory_bytes();  // of this process, now

// How often the kernel has ended a process for want of memory since the machine started.
std::uint64_t out_of_memory_kills();

std::string host_name();
// Whether no process of this machine has the number any more; one that nobody has waited for yet
// has ended, too.
bool process_has_ended(int process);

// Highest resident memory of this process since the last reset, in megabytes (10^6 bytes).
void reset_peak_memory();
double peak_memory_mb();

}  // namespace glint
