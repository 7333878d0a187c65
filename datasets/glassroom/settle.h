// SPDX-License-Identifier: MIT
// Rigid-body settling (Bullet): the container falls onto the floor and the objects inside it come
// to rest, and so does a case inside it with its own. One thread, fixed step: the same input gives
// the same poses.
#pragma once

#include <vector>

#include "datasets/glassroom/container.h"

namespace glint {

struct SettleOptions {
  double step_hz = 240;
  double max_seconds = 12;
  float support_height = 0;   // z of the floor
  Vec2f place{};              // of the container's centre
  float yaw = 0;              // of the container, radians
  float drop_height = 0.12f;  // of the container's underside above the floor
  float floor_friction = 0.7f, body_friction = 0.6f;
};

struct SettleResult {
  Pose container;
  std::vector<Pose> objects;
  Pose inner_case;  // where there is one
  std::vector<Pose> inner_objects;
  bool at_rest = false;  // everything fell asleep within max_seconds
  int num_steps = 0;
};

// Objects start apart from each other inside the container, as low as they fit, turned at random.
// `inner`: the case in the container, or null.
// Errors (kEnvironment): objects do not fit, an object left its case, or a case fell over.
SettleResult settle(
    const ContainerShape& shape,
    const std::vector<ContainerObject>& objects,
    const SettleOptions& options,
    Rng& rng,
    const InnerCase* inner = nullptr
);

}  // namespace glint
