// SPDX-License-Identifier: MIT
// How much memory and disk cells take, by what finished ones took, else by sizes of pictures: one
// that does not fit says so before its training and not hours into it. Estimates, and named so.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "glint/scene/scene.h"
#include "reports/run/bench/plan.h"

namespace glint {

struct Estimate {
  double bytes = 0;
  std::string from;  // what it goes by: "3 finished runs", "sizes of pictures"
};

struct MemoryUser {
  std::string method;
  std::size_t max_surfels = 0;   // of a set
  std::size_t mesh_samples = 0;  // points on each mesh that is scored
  double voxel = 0;              // metres, of the fusion of meshes; 0: the views choose it
  Json config;                   // the method's settings: some ask for memory by their number
};
// Of a method with these overrides (PlanCell) in a profile.
MemoryUser memory_user(const std::string& method, const Json& config, const Profile& profile);

// What a scene takes, in memory or before it is made.
struct SceneSize {
  double view_pixels = 0;  // of the largest view
  double image_bytes = 0;  // of the images and maps of all views
  double points = 0;       // that surfels begin with
  std::string resolution;  // as in records; empty: no view is scored
};
SceneSize size_of(const Scene& scene);
// Of a room that is made, there or not. Its points are not known: none.
SceneSize size_of(const SceneSource& room);

// By what cells of this method took at this size of images, where `records` has some; else by the
// images of the scene, and the largest of: the surfels that it begins with, or will have; the
// fusion of its meshes in a room; the scores of the meshes. A setting that asks for more by its
// number than all of these take is what it goes by.
Estimate estimate_memory(
    const MemoryUser& user, const SceneSize& scene, const std::vector<Record>& records
);

// Bytes of a card that a training of a method that has not been seen yet will have in use, by the
// images of the scene and its surfels.
double estimate_device_bytes(const MemoryUser& user, const SceneSize& scene);
// What a process has of the card whose training has so many bytes in use: also what it keeps for
// later, its program, and what the driver keeps for it.
double device_bytes_of_process(double bytes_in_use);

// Bytes that the cell took, all stages; 0: unknown.
double bytes_taken(const Record& record);

// Errors: OutOfMemory when more is needed than `available` bytes; the message says how much and
// why.
void check_fits(const Estimate& estimate, std::uint64_t available);

// Of the cells whose runs are not finished. `folder`: the profile's. Nothing: their data are
// folders of the user's, whose sizes are not known, and nothing has run.
std::optional<Estimate> disk_of_runs(
    const std::vector<PlanCell>& plan, const Profile& profile, const fs::path& folder
);

// Of rooms that have to be made.
double disk_of_room(const SceneSource& source);

// Of the largest of the planned cells, by what such cells took before, else by images and surfels
// of rooms. Nothing: their data are folders of the user's, and none has run.
std::optional<Estimate> memory_of_cells(
    const std::vector<PlanCell>& plan, const Profile& profile, const std::vector<Record>& records
);

}  // namespace glint
