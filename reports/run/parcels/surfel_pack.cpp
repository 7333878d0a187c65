// SPDX-License-Identifier: MIT
#include "reports/run/parcels/surfel_code.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>
#include <optional>

#include "glint/render/blend.h"
#include "glint/render/morton.h"
#include "reports/run/parcels/byte_pack.h"
#include "reports/run/parcels/number_field.h"
#include "reports/run/parcels/surfel_grid.h"

namespace glint {
namespace {

constexpr double kGroupOctaves = 1;
constexpr int kPackLevel = 12;
constexpr const char* kNumberFields[] = {
    "places", "scale", "flatness", "normal x", "normal y", "angle", "opacity"};
constexpr float kLeastLogit = -8.0f,
                kMostLogit = 9.0f;  // of opacities; beyond them nothing changes

bool is_finite(const SurfelCloud& cloud) {
  bool finite = true;
  cloud.for_each_array([&](const char*, const FloatArray& array, std::size_t) {
    finite = finite && std::all_of(array.begin(), array.end(), [](float value) {
               return std::isfinite(value);
             });
  });
  return finite;
}

bool is_drawn(float opacity_logit) {
  return 1 / (1 + std::exp(-opacity_logit)) >= 0.999f * kMinAlpha;
}

bool is_dropped(const SurfelPacking& packing, std::size_t surfel) {
  return !packing.seen.empty() && packing.seen[surfel] <= packing.drop_below;
}

// Octaves by which a surfel that is seen at so few pixels may move more than others; below zero:
// less. The error of depth goes with pixels times steps.
int group_of(double seen, double mean_seen) {
  const double octaves = std::log2(mean_seen / std::max(seen, 0.1));
  return static_cast<int>(std::clamp(std::round(octaves / kGroupOctaves), -2.0, 4.0));
}

// The surfels that are kept, by group.
std::map<int, std::vector<std::uint32_t>> groups_of(
    const SurfelCloud& cloud, const SurfelPacking& packing
) {
  double mean_seen = 1;
  if (!packing.seen.empty())
    mean_seen = std::max(
        1.0,
        std::accumulate(packing.seen.begin(), packing.seen.end(), 0.0) /
            static_cast<double>(packing.seen.size())
    );
  std::map<int, std::vector<std::uint32_t>> groups;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double seen = packing.seen.empty() ? mean_seen : static_cast<double>(packing.seen[i]);
    if (!is_drawn(cloud.opacity_logits[i]) || is_dropped(packing, i)) continue;
    groups[group_of(seen, mean_seen)].push_back(static_cast<std::uint32_t>(i));
  }
  if (groups.empty() && cloud.size() > 0) groups[0].push_back(0);
  return groups;
}

Vec3<double> mean_of(const SurfelCloud& cloud, std::size_t i) {
  const float* mean = &cloud.means[3 * i];
  return {static_cast<double>(mean[0]), static_cast<double>(mean[1]), static_cast<double>(mean[2])};
}

// ---------------------------------------------------------------- packing

// Of all groups, by field.
struct SurfelNumbers {
  std::map<std::string, std::vector<std::uint64_t>> numbers;
  BitWriter fine;  // of positions
};

// A group of surfels, whose numbers join those of the groups before.
class GroupPacker {
 public:
  GroupPacker(
      const SurfelCloud& cloud,
      std::vector<std::uint32_t> surfels,
      double tolerance,
      SurfelNumbers& fields
  )
      : cloud_(cloud),
        steps_(SurfelSteps::of(tolerance)),
        order_(std::move(surfels)),
        fields_(fields) {
    find_bounds();
    count_bits();
  }

  // Do all positions have a cell?
  bool fits() const { return bits_ <= kMostCellBits; }

  void pack(const std::vector<std::string>& extras) {
    sort();
    put_places();
    put_shapes();
    put_logits("opacity", cloud_.opacity_logits, 1, 0, kLeastLogit, kMostLogit);
    for (const std::string& name : extras) put_extra(name);
  }

  Json about() const {
    return {
        {"count", order_.size()},
        {"low", {low_.x, low_.y, low_.z}},
        {"fine_bits", fine_bits()},
        {"steps", config_to_json(steps_)}};
  }
  const std::vector<std::uint32_t>& order() const { return order_; }

 private:
  void find_bounds() {
    low_ = high_ = mean_of(cloud_, order_.front());
    for (const std::uint32_t i : order_)
      for (int axis = 0; axis < 3; ++axis) {
        low_[axis] = std::min(low_[axis], mean_of(cloud_, i)[axis]);
        high_[axis] = std::max(high_[axis], mean_of(cloud_, i)[axis]);
      }
  }

  // Bits of a cell's number along an axis.
  void count_bits() {
    double cells = 1;
    for (int axis = 0; axis < 3; ++axis)
      cells = std::max(cells, (high_[axis] - low_[axis]) / steps_.position + 2);
    bits_ = cells < 1e18 ? static_cast<int>(std::ceil(std::log2(cells))) : kMostCellBits + 1;
  }
  int fine_bits() const { return std::max(0, bits_ - kZBits); }

  std::array<std::uint64_t, 3> cell(std::size_t surfel) const {
    std::array<std::uint64_t, 3> cell{};
    for (int axis = 0; axis < 3; ++axis)
      cell[static_cast<std::size_t>(axis)] = static_cast<std::uint64_t>(
          (mean_of(cloud_, surfel)[axis] - low_[axis]) / steps_.position + 0.5
      );
    return cell;
  }
  // Of the coarse cells, whose order is theirs.
  std::uint64_t place(std::size_t surfel) const {
    std::uint64_t place = 0;
    const auto cell = this->cell(surfel);
    for (std::size_t axis = 0; axis < 3; ++axis)
      place |= spread_bits(cell[axis] >> fine_bits()) << axis;
    return place;
  }

  void sort() {
    std::vector<std::uint64_t> places(cloud_.size());
    for (const std::uint32_t i : order_) places[i] = place(i);
    std::stable_sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return places[a] < places[b];
    });
  }

  void put_places() {
    std::uint64_t before = 0;
    for (const std::uint32_t i : order_) {
      const std::uint64_t at = place(i);
      put("places", at - before);
      before = at;
      for (const std::uint64_t along : cell(i)) fields_.fine.put(along, fine_bits());
    }
  }

  std::int64_t scale_step(std::size_t surfel, std::size_t axis) const {
    const auto log2_scale =
        static_cast<double>(cloud_.log_scales[2 * surfel + axis]) / std::numbers::ln2;
    return std::llround(std::clamp(log2_scale, -40.0, 40.0) * steps_.scale_levels);
  }

  // Scales and rotation: the normal as it goes on from the surfel before, and the angle within the
  // plane. Turning a surfel over changes nothing, so its nearer side is taken.
  void put_shapes() {
    GridPlace before;
    for (const std::uint32_t i : order_) {
      const std::int64_t u = scale_step(i, 0), v = scale_step(i, 1);
      put_signed("scale", u);
      put_signed("flatness", v - u);
      const std::int64_t cells = normal_cells(std::max(u, v), steps_.scale_levels, steps_.fineness);
      const Mat3d rotation = rotation_of(i);
      Vec3<double> normal = column(rotation, 2);
      if (dot(normal, octahedral_normal(before.cell, before.cells)) < 0) normal = -1.0 * normal;
      const OctahedralCell cell = octahedral_cell(normal, cells);
      const OctahedralCell expected = on_grid(before.cell, before.cells, cells);
      put_signed("normal x", cell.x - expected.x);
      put_signed("normal y", cell.y - expected.y);
      put_angle(column(rotation, 0), octahedral_normal(cell, cells), u - v);
      before = {cell, cells};
    }
  }

  Mat3d rotation_of(std::size_t surfel) const {
    double q[4], norm2 = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      q[k] = static_cast<double>(cloud_.rotations[4 * surfel + k]);
      norm2 += q[k] * q[k];
    }
    if (!(norm2 > 0)) return rotation_from_quaternion({1, 0, 0, 0});
    const double scale = 1 / std::sqrt(norm2);
    return rotation_from_quaternion({scale * q[0], scale * q[1], scale * q[2], scale * q[3]});
  }

  void put_angle(Vec3<double> first_axis, Vec3<double> normal, std::int64_t scale_difference) {
    const std::int64_t steps =
        angle_steps(scale_difference, steps_.scale_levels, steps_.angle_steps);
    const PlaneAxes axes = plane_axes(normal);
    const double half_turns =
        std::atan2(dot(first_axis, axes.v), dot(first_axis, axes.u)) / std::numbers::pi;
    const std::int64_t step = std::llround(half_turns * static_cast<double>(steps));
    put("angle", static_cast<std::uint64_t>((step % steps + steps) % steps));
  }

  void put_logits(
      const std::string& field,
      const FloatArray& values,
      std::size_t width,
      std::size_t at,
      float least,
      float most
  ) {
    for (const std::uint32_t i : order_) {
      const float value = std::clamp(values[i * width + at], least, most);
      put_signed(field, std::llround(static_cast<double>(value) / steps_.logit));
    }
  }

  void put_extra(const std::string& name) {
    const auto& names = cloud_.extra_names;
    const auto at =
        static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    put_logits("extra " + name, cloud_.extra_logits, cloud_.num_extra(), at, -1e9f, 1e9f);
  }

  void put(const std::string& field, std::uint64_t value) {
    fields_.numbers[field].push_back(value);
  }
  void put_signed(const std::string& field, std::int64_t value) { put(field, zigzag(value)); }

  const SurfelCloud& cloud_;
  SurfelSteps steps_;
  Vec3<double> low_{}, high_{};
  int bits_ = 0;
  std::vector<std::uint32_t> order_;
  SurfelNumbers& fields_;
};

// Nothing: grids do not reach so far.
std::optional<SurfelCode> pack_on_grids(const SurfelCloud& cloud, const SurfelPacking& packing) {
  SurfelCode code;
  code.about = {
      {"kind", kOnGrids},
      {"extras", cloud.extra_names},
      {"kept", packing.extras},
      {"groups", Json::array()}};
  SurfelNumbers fields;
  for (const char* name : kNumberFields) fields.numbers[name] = {};  // of no surfels, too
  for (const std::string& name : packing.extras) fields.numbers["extra " + name] = {};
  for (auto& [group, surfels] : groups_of(cloud, packing)) {
    GroupPacker packer(
        cloud, std::move(surfels), packing.tolerance * std::exp2(kGroupOctaves * group), fields
    );
    if (!packer.fits()) return std::nullopt;
    packer.pack(packing.extras);
    code.about["groups"].push_back(packer.about());
    code.order.insert(code.order.end(), packer.order().begin(), packer.order().end());
  }
  for (const auto& [name, numbers] : fields.numbers) code.fields[name] = pack_numbers(numbers);
  code.fields["fine"] = fields.fine.take();
  code.about["count"] = code.order.size();
  return code;
}

// The rows of these surfels, bytes of equal weight side by side, which pack better.
std::string byte_planes(
    const FloatArray& array, std::size_t width, const std::vector<std::uint32_t>& surfels
) {
  const std::size_t count = width * surfels.size();
  std::string planes(4 * count, '\0');
  for (std::size_t i = 0; i < count; ++i) {
    char bytes[4];
    std::memcpy(bytes, &array[surfels[i / width] * width + i % width], sizeof bytes);
    for (std::size_t plane = 0; plane < 4; ++plane) planes[plane * count + i] = bytes[plane];
  }
  return planes;
}

// Channels that are not kept are zero.
FloatArray kept_extras(const SurfelCloud& cloud, const SurfelPacking& packing) {
  FloatArray extras = cloud.extra_logits;
  for (std::size_t i = 0; i < extras.size(); ++i) {
    const std::string& name = cloud.extra_names[i % cloud.num_extra()];
    if (std::find(packing.extras.begin(), packing.extras.end(), name) == packing.extras.end())
      extras[i] = 0;
  }
  return extras;
}

SurfelCode pack_floats(const SurfelCloud& cloud, const SurfelPacking& packing) {
  SurfelCode code;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (!is_dropped(packing, i)) code.order.push_back(static_cast<std::uint32_t>(i));
  if (code.order.empty() && cloud.size() > 0) code.order.push_back(0);
  code.about = {{"kind", kAsTheyAre}, {"count", code.order.size()}, {"extras", cloud.extra_names}};
  const FloatArray extras = kept_extras(cloud, packing);
  cloud.for_each_array([&](const char* name, const FloatArray& array, std::size_t width) {
    if (std::string_view(name).starts_with("sh_")) return;
    const bool is_extra = &array == &cloud.extra_logits;
    code.fields[name] = pack_bytes(
        byte_planes(is_extra ? extras : array, width, code.order), packing.draft ? 1 : kPackLevel
    );
  });
  return code;
}

}  // namespace

SurfelSteps SurfelSteps::of(double tolerance) {
  // Balanced on models of three methods: each number of a surfel has the same share of the error.
  SurfelSteps steps;
  steps.position = tolerance;
  steps.fineness = static_cast<int>(std::lround(32 + 4 * std::log2(2e-4 / tolerance)));
  steps.scale_levels = std::clamp(static_cast<int>(std::lround(3.1e-2 / tolerance)), 4, 1 << 14);
  steps.angle_steps = std::clamp(static_cast<int>(std::lround(0.19 / tolerance)), 8, 1 << 16);
  steps.logit = std::clamp(40 * tolerance, 1e-6, 0.5);
  return steps;
}

std::size_t SurfelCode::num_bytes() const {
  std::size_t bytes = 0;
  for (const auto& [name, packed] : fields) bytes += packed.size();
  return bytes;
}

SurfelCode pack_surfels(const SurfelCloud& cloud, const SurfelPacking& packing) {
  if (packing.tolerance <= 0 || !is_finite(cloud)) return pack_floats(cloud, packing);
  auto code = pack_on_grids(cloud, packing);
  return code ? std::move(*code) : pack_floats(cloud, packing);
}

}  // namespace glint
