// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include "glint/core/error.h"
#include "reports/run/parcels/byte_pack.h"
#include "reports/run/parcels/number_field.h"
#include "reports/run/parcels/surfel_code.h"
#include "reports/run/parcels/surfel_grid.h"

namespace glint {
namespace {

constexpr std::size_t kMostSurfels = std::size_t{1} << 22, kMostExtras = 256;
constexpr std::size_t kMostValues = std::size_t{1} << 27;  // floats, of all arrays
constexpr std::size_t kFewSurfels = 4096;                  // of more, each takes a bit at least
constexpr std::size_t kMostGroups = 64;
constexpr double kMostStep = 1e3;
constexpr double kFarthest = 1e6;  // metres, as in PLY files

// Every third bit, from the first on.
std::uint64_t gathered_bits(std::uint64_t v) {
  std::uint64_t gathered = 0;
  for (int bit = 0; bit < kZBits; ++bit) gathered |= (v >> (3 * bit) & 1) << bit;
  return gathered;
}

[[noreturn]] void fail(const std::string& where, const std::string& what) {
  throw Error(ExitCode::kBadPrediction, fmt::format("{}: {}; the file is damaged", where, what));
}

struct GroupAbout {
  std::size_t count = 0;
  SurfelSteps steps;
  Vec3<double> low{};
  int fine_bits = 0;
};
// What `about` says, checked.
struct SurfelAbout {
  std::string kind;
  std::size_t count = 0;
  std::vector<std::string> extras, kept;
  std::vector<GroupAbout> groups;
};

bool in_range(double value, double least, double most) { return value >= least && value <= most; }

void check_group(const GroupAbout& group, const std::string& where) {
  const SurfelSteps& steps = group.steps;
  bool good = in_range(steps.position, 1e-12, kMostStep) &&
              in_range(steps.logit, 1e-12, kMostStep) && in_range(steps.scale_levels, 1, 1 << 20) &&
              in_range(steps.angle_steps, 1, 1 << 20) && in_range(steps.fineness, -1000, 1000);
  good = good && in_range(group.fine_bits, 0, kMostCellBits - kZBits);
  for (int axis = 0; axis < 3; ++axis)
    good = good && in_range(group.low[axis], -kFarthest, kFarthest);
  if (!good) fail(where, "steps that no packed surfels have");
}

void check_about(const SurfelAbout& about, const std::string& where) {
  constexpr std::size_t kOwnValues = 17;
  if (about.kind != kOnGrids && about.kind != kAsTheyAre)
    fail(where, fmt::format("surfels of kind '{}', expected grids or floats", about.kind));
  if (about.count > kMostSurfels || about.extras.size() > kMostExtras ||
      about.count * (kOwnValues + about.extras.size()) > kMostValues)
    fail(where, fmt::format("{} surfels with {} channels", about.count, about.extras.size()));
  if (about.kind == kAsTheyAre) return;
  std::size_t count = 0;
  for (const GroupAbout& group : about.groups) {
    check_group(group, where);
    count += std::min(group.count, kMostSurfels + 1);
  }
  if (count != about.count)
    fail(where, fmt::format("{} surfels in groups of {} together", about.count, count));
}

// Its fields, each by its name in messages.
class AboutReader {
 public:
  explicit AboutReader(std::string where) : where_(std::move(where)) {}

  SurfelAbout read(const Json& json) {
    SurfelAbout about;
    try {
      field(json, "kind", about.kind);
      field(json, "count", about.count);
      field(json, "extras", about.extras);
      if (about.kind == kOnGrids) {
        field(json, "kept", about.kept);
        const Json& groups = json.at(name_ = "groups");
        if (groups.size() > kMostGroups) fail(where_, fmt::format("{} groups", groups.size()));
        for (const Json& group : groups) about.groups.push_back(read_group(group));
      }
    } catch (const std::exception& error) {
      fail(where_, fmt::format("'{}' of packed surfels: {}", name_, error.what()));
    }
    check_about(about, where_);
    return about;
  }

 private:
  template <class T>
  void field(const Json& json, const char* name, T& value) {
    name_ = name;
    read_field(json.at(name), value);
  }
  GroupAbout read_group(const Json& json) {
    GroupAbout group;
    std::array<double, 3> low{};
    field(json, "count", group.count);
    field(json, "low", low);
    field(json, "fine_bits", group.fine_bits);
    group.low = {low[0], low[1], low[2]};
    config_from_json(group.steps, json.at(name_ = "steps"), where_);
    return group;
  }

  std::string where_, name_;  // of the field that is read
};

class Unpacker {
 public:
  Unpacker(
      const SurfelAbout& about,
      const std::map<std::string, std::string>& fields,
      const std::string& where
  )
      : about_(about), fields_(fields), where_(where) {}

  SurfelCloud cloud() {
    cloud_.extra_names = about_.extras;
    if (about_.kind == kAsTheyAre) {
      read_floats();
    } else {
      read_places();
      read_shapes();
      read_logits();
    }
    check();
    return std::move(cloud_);
  }

 private:
  const std::string& field(const std::string& name) const {
    const auto found = fields_.find(name);
    if (found == fields_.end()) fail(where_, fmt::format("no field '{}'", name));
    return found->second;
  }
  std::vector<std::uint64_t> numbers(const std::string& name) const {
    return unpack_numbers(field(name), about_.count, fmt::format("{}: {}", where_, name));
  }

  // Without harmonics, which would take most of the memory.
  void resize() {
    cloud_.for_each_array([&](const char* name, FloatArray& array, std::size_t width) {
      array.resize(std::string_view(name) == "sh_rest" ? 0 : width * about_.count);
    });
  }

  void read_floats() {
    cloud_.for_each_array([&](const char* name, FloatArray& array, std::size_t width) {
      if (std::string_view(name).starts_with("sh_")) return;
      const std::string planes =
          unpack_bytes(field(name), 4 * width * about_.count, fmt::format("{}: {}", where_, name));
      array.resize(width * about_.count);
      for (std::size_t i = 0; i < array.size(); ++i) {
        char bytes[4];
        for (std::size_t plane = 0; plane < 4; ++plane)
          bytes[plane] = planes[plane * array.size() + i];
        std::memcpy(&array[i], bytes, sizeof bytes);
      }
    });
    resize();
  }

  // Calls f(group, begin, end) for the surfels of each group.
  template <class F>
  void for_each_group(F&& f) {
    std::size_t begin = 0;
    for (const GroupAbout& group : about_.groups) {
      steps_ = group.steps;
      f(group, begin, begin + group.count);
      begin += group.count;
    }
  }

  void read_places() {
    const auto numbers = this->numbers("places");
    BitReader fine(field("fine"));
    resize();
    for_each_group([&](const GroupAbout& group, std::size_t begin, std::size_t end) {
      std::uint64_t place = 0;
      for (std::size_t i = begin; i < end; ++i) {
        place += numbers[i];
        for (int axis = 0; axis < 3; ++axis) {
          const std::uint64_t cell =
              gathered_bits(place >> axis) << group.fine_bits | fine.get(group.fine_bits);
          cloud_.means[3 * i + static_cast<std::size_t>(axis)] = static_cast<float>(
              group.low[axis] + group.steps.position * static_cast<double>(cell)
          );
        }
      }
    });
    if (!fine.ended_well()) fail(where_, "the field 'fine' has another length");
  }

  void read_shapes() {
    const auto scale = numbers("scale"), flatness = numbers("flatness"), angle = numbers("angle");
    const auto x = numbers("normal x"), y = numbers("normal y");
    for_each_group([&](const GroupAbout&, std::size_t begin, std::size_t end) {
      GridPlace before;
      for (std::size_t i = begin; i < end; ++i) {
        const std::int64_t u = scale_step(scale[i], i), v = u + scale_step(flatness[i], i);
        set_scales(i, u, v);
        const std::int64_t cells =
            normal_cells(std::max(u, v), steps_.scale_levels, steps_.fineness);
        const OctahedralCell expected = on_grid(before.cell, before.cells, cells);
        before = {
            {on_axis(expected.x, x[i], cells, i), on_axis(expected.y, y[i], cells, i)}, cells};
        set_rotation(i, octahedral_normal(before.cell, cells), angle_of(angle[i], u - v));
      }
    });
  }

  double angle_of(std::uint64_t step, std::int64_t scale_difference) const {
    const std::int64_t steps =
        angle_steps(scale_difference, steps_.scale_levels, steps_.angle_steps);
    return std::numbers::pi * static_cast<double>(step) / static_cast<double>(steps);
  }

  // Of a damaged file: nothing that could overflow.
  std::int64_t scale_step(std::uint64_t number, std::size_t surfel) const {
    const std::int64_t step = unzigzag(number), most = 200 * std::int64_t{steps_.scale_levels};
    if (step < -most || step > most)
      fail(where_, fmt::format("surfel {}: a scale of {} steps", surfel, step));
    return step;
  }
  std::int64_t on_axis(
      std::int64_t expected, std::uint64_t number, std::int64_t cells, std::size_t surfel
  ) const {
    const std::int64_t difference = unzigzag(number);
    if (difference < -expected || difference >= cells - expected)
      fail(where_, fmt::format("surfel {}: a normal beyond its {} cells", surfel, cells));
    return expected + difference;
  }

  void set_scales(std::size_t surfel, std::int64_t u, std::int64_t v) {
    const auto log_of = [&](std::int64_t step) {
      return static_cast<float>(
          static_cast<double>(step) / steps_.scale_levels * std::numbers::ln2
      );
    };
    cloud_.log_scales[2 * surfel] = log_of(u);
    cloud_.log_scales[2 * surfel + 1] = log_of(v);
  }

  void set_rotation(std::size_t surfel, Vec3<double> normal, double angle) {
    const PlaneAxes axes = plane_axes(normal);
    const Vec3<double> first = std::cos(angle) * axes.u + std::sin(angle) * axes.v;
    const Vec3<double> second = cross(normal, first);
    const Mat3d rotation{
        Vec3<double>{first.x, second.x, normal.x},
        Vec3<double>{first.y, second.y, normal.y},
        Vec3<double>{first.z, second.z, normal.z}};
    const Vec4<double> q = quaternion_from_rotation(rotation);
    const double wxyz[] = {q.w, q.x, q.y, q.z};
    for (std::size_t k = 0; k < 4; ++k)
      cloud_.rotations[4 * surfel + k] = static_cast<float>(wxyz[k]);
  }

  void read_logits() {
    read_logits("opacity", cloud_.opacity_logits, 1, 0);
    for (const std::string& name : about_.kept) {
      const auto found = std::find(about_.extras.begin(), about_.extras.end(), name);
      if (found == about_.extras.end()) fail(where_, fmt::format("no channel '{}'", name));
      read_logits(
          "extra " + name,
          cloud_.extra_logits,
          about_.extras.size(),
          static_cast<std::size_t>(found - about_.extras.begin())
      );
    }
  }
  void read_logits(const std::string& name, FloatArray& array, std::size_t width, std::size_t at) {
    const auto numbers = this->numbers(name);
    for_each_group([&](const GroupAbout& group, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        array[i * width + at] =
            static_cast<float>(static_cast<double>(unzigzag(numbers[i])) * group.steps.logit);
    });
  }

  void check() const {
    cloud_.for_each_array([&](const char* name, const FloatArray& array, std::size_t width) {
      for (std::size_t i = 0; i < array.size(); ++i)
        if (!std::isfinite(array[i]))
          fail(where_, fmt::format("surfel {}: {} is {}", i / width, name, array[i]));
    });
    for (std::size_t i = 0; i < cloud_.means.size(); ++i)
      if (std::abs(static_cast<double>(cloud_.means[i])) > kFarthest)
        fail(where_, fmt::format("surfel {} is {} m from the origin", i / 3, cloud_.means[i]));
  }

  const SurfelAbout& about_;
  const std::map<std::string, std::string>& fields_;
  const std::string& where_;
  SurfelSteps steps_;  // of the group that is read
  SurfelCloud cloud_;
};

}  // namespace

SurfelCloud unpack_surfels(
    const Json& about, const std::map<std::string, std::string>& fields, const std::string& where
) {
  const SurfelAbout checked = AboutReader(where).read(about);
  std::size_t bytes = 0;
  for (const auto& [name, packed] : fields) bytes += packed.size();
  if (checked.count > kFewSurfels && checked.count / 8 > bytes)
    fail(where, fmt::format("{} surfels are said to lie in {} bytes", checked.count, bytes));
  return Unpacker(checked, fields, where).cloud();
}

}  // namespace glint
