// SPDX-License-Identifier: MIT
// The glass container: six thin panes in a black frame of twelve beams, and the opaque things in
// it. Local frame: origin at the centre of the box's underside, z up.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "datasets/glassroom/shapes.h"
#include "glint/core/rng.h"

namespace glint {

struct ContainerShape {
  Vec3f size{1.2f, 0.8f, 1.2f};   // outer, metres
  float beam = 0.025f;            // square beams
  float pane_thickness = 0.005f;  // of the slab that each pane stands for
  float glass_ior = 1.52f;
  // Of container_panes(): what each lets pass of what enters it.
  std::array<Vec3f, 6> tints = same_tint({0.985f, 0.995f, 0.988f});

  static constexpr std::array<Vec3f, 6> same_tint(Vec3f t) { return {t, t, t, t, t, t}; }
};

// Sizes of the recipe: (0.6, 0.4, 0.6) m times a factor per axis.
ContainerShape random_container(Rng& rng);

// A pane as a slab: its middle plane, and half sizes with the slab's thickness.
struct Pane {
  Vec3f center, half_size;
  int axis;  // its normal is this axis
};
std::array<Pane, 6> container_panes(const ContainerShape& shape);
std::array<Bounds, 12> container_beams(const ContainerShape& shape);

// An opaque object: what is seen, and the convex pieces that collide.
struct ContainerObject {
  std::string name;
  TraceMesh mesh;  // centred near its middle, metres
  std::vector<std::vector<Vec3f>> hulls;
  float mass = 1;  // kg
};
// `count` different objects that fit side by side into the container.
std::vector<ContainerObject> random_objects(const ContainerShape& shape, int count, Rng& rng);

// A case that stands in another one.
struct InnerCase {
  ContainerShape shape;
  std::vector<ContainerObject> objects;
  Pose start;  // in the outer one's frame
};
// Beside one of the narrow ends of `outer`, with `count` objects.
InnerCase random_inner_case(const ContainerShape& outer, int count, Rng& rng);

// Adds panes (one quad each, thin dielectric) and frame to the scene.
void add_container(TraceScene& scene, const ContainerShape& shape, const Pose& pose);
// Adds the objects, each with a finish of its own.
void add_objects(
    TraceScene& scene,
    std::vector<ContainerObject> objects,
    const std::vector<Pose>& poses,
    Rng& rng
);

}  // namespace glint
