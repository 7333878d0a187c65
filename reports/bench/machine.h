// SPDX-License-Identifier: MIT
// The machine a run happens on, and what it costs there.
#pragma once

#include <cstdint>
#include <string>

#include "glint/core/config.h"
#include "glint/core/files.h"

namespace glint {

struct Machine {
  std::string cpu;        // model name
  int cores = 1;          // logical
  bool has_avx2 = false;  // and FMA: the tile kernels need both
  std::uint64_t memory_bytes = 0;
};
Machine this_machine();

// Free bytes of the disk that holds `folder` (or its nearest existing parent); 0: unknown.
std::uint64_t free_disk_bytes(const fs::path& folder);

// Machine, threads, build (compiler, git revision), device and date: part of every record.
Json environment_json();

// Highest resident memory of this process since the last reset, in megabytes (10^6 bytes).
void reset_peak_memory();
double peak_memory_mb();

// Where ops run from now on: "cpu", "cuda", or "auto": the GPU where one is usable, else the CPU,
// with one line that says why. Call before the first scene is loaded. Errors: kEnvironment ("cuda"
// without a usable device), kUsage (others).
void choose_device(const std::string& requested);

}  // namespace glint
