// SPDX-License-Identifier: MIT
// What a cell will take, so that one that does not fit says so before its training and not hours
// into it.
#pragma once

#include <string>
#include <vector>

#include "glint/scene/scene.h"
#include "reports/records/records.h"

namespace glint {

struct MemoryEstimate {
  double bytes = 0;
  std::string from;  // what it goes by
};

struct MemoryUser {
  std::string method;
  std::size_t max_surfels = 0;   // of a set
  std::size_t mesh_samples = 0;  // points on each mesh that is scored
};

// By what cells of this method took at this size of images, where `records` has some; else by the
// images of the scene and the surfels that it begins with, or will have, or by what the scores of
// its meshes take.
MemoryEstimate estimate_memory(
    const MemoryUser& user, const Scene& scene, const std::vector<Record>& records
);

// Bytes that the cell took, all stages; 0: unknown.
double bytes_taken(const Record& record);

// Errors: OutOfMemory when more is needed than `available` bytes; the message says how much and
// why.
void check_fits(const MemoryEstimate& estimate, std::uint64_t available);

// Of the images and maps of all views.
double image_bytes(const Scene& scene);

}  // namespace glint
