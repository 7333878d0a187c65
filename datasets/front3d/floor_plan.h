// SPDX-License-Identifier: MIT
// A room's floor as a grid of cells seen from above: what is floor, what stands on it, and how far
// the nearest obstacle is. Metres, world, z up.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "datasets/glassroom/shapes.h"

namespace glint {

class FloorPlan {
 public:
  static constexpr float kCell = 0.05f;

  // `floors`: triangles of the floor. Errors (kBadReference): wider than 60 m, or no cell is floor;
  // `where` opens the message.
  FloorPlan(const std::vector<TraceMesh>& floors, const std::string& where);

  const Bounds& bounds() const { return bounds_; }  // of the floor's vertices
  bool is_floor(Vec2f p) const;

  // Takes away the cells within `margin` of a footprint: a box in a frame of its own.
  void block(const Bounds& local, const Pose& pose, float margin);

  struct Spot {
    Vec2f place{};
    float clearance = 0;  // to the nearest cell that is no free floor, metres
  };
  // Free cells with their clearance, ascending in rows; those without are left out.
  std::vector<Spot> free_spots() const;

  // A straight piece of the floor's outline.
  struct Side {
    Vec2f start{}, along{}, outward{};  // unit vectors
    float length = 0;
  };
  // What only one triangle has of the edges.
  const std::vector<Side>& sides() const { return sides_; }

 private:
  Vec2f center_of(int x, int y) const;
  std::size_t index(int x, int y) const;
  void fill(Vec3f a, Vec3f b, Vec3f c);
  void find_sides(const std::vector<TraceMesh>& floors);
  void add_side(std::pair<long, long> from, std::pair<long, long> to);  // millimetres

  Bounds bounds_;
  int width_ = 0, height_ = 0;               // cells
  std::vector<unsigned char> floor_, free_;  // per cell
  std::vector<Side> sides_;
};

}  // namespace glint
