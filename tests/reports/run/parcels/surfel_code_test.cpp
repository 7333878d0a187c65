// SPDX-License-Identifier: MIT
#include "reports/run/parcels/surfel_code.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "glint/core/error.h"
#include "glint/core/rng.h"
#include "glint/scene/camera.h"
#include "reports/run/parcels/number_field.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

// Surfels on two walls of a room of 6 m, of 1 mm to 30 cm.
SurfelCloud walls(std::size_t count) {
  Rng rng(1, 2);
  SurfelCloud cloud;
  cloud.extra_names = {"transparency", "specular"};
  cloud.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const bool floor = i % 2 == 0;
    for (std::size_t axis = 0; axis < 3; ++axis) cloud.means[3 * i + axis] = 6 * rng.uniform() - 2;
    cloud.means[3 * i + (floor ? 2 : 0)] = 0.01f * rng.normal();
    for (std::size_t axis = 0; axis < 2; ++axis)
      cloud.log_scales[2 * i + axis] = std::log(0.001f * std::pow(300.0f, rng.uniform()));
    const float w = floor ? 1.0f : 0.7f, y = floor ? 0.0f : 0.7f;
    const float quaternion[] = {
        w + 0.1f * rng.normal(), 0.1f * rng.normal(), y + 0.1f * rng.normal(), rng.normal()};
    std::copy_n(quaternion, 4, &cloud.rotations[4 * i]);
    cloud.opacity_logits[i] = 4 * rng.normal();
    cloud.extra_logits[2 * i] = rng.normal();
    cloud.extra_logits[2 * i + 1] = rng.normal();
  }
  return cloud;
}

SurfelPacking on_grids(double tolerance, std::vector<std::string> extras = {}) {
  return {.tolerance = tolerance, .extras = std::move(extras)};
}

Mat3d rotation_of(const SurfelCloud& cloud, std::size_t i) {
  double q[4], norm2 = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    q[k] = static_cast<double>(cloud.rotations[4 * i + k]);
    norm2 += q[k] * q[k];
  }
  const double s = 1 / std::sqrt(norm2);
  return rotation_from_quaternion({s * q[0], s * q[1], s * q[2], s * q[3]});
}

double difference(float a, float b) {
  return std::abs(static_cast<double>(a) - static_cast<double>(b));
}

std::string message_of(const Json& about, const std::map<std::string, std::string>& fields) {
  return test::error_of(ExitCode::kBadPrediction, [&] {
    unpack_surfels(about, fields, "room.parcel: interface.ply");
  });
}

}  // namespace

TEST_CASE("numbers of any size come back") {
  std::vector<std::uint64_t> numbers = {0, 1, 7, 8, 15, 16, 1000, 1ull << 40, ~0ull, ~0ull - 1};
  Rng rng(3, 4);
  for (int i = 0; i < 1000; ++i)
    numbers.push_back(static_cast<std::uint64_t>(rng.uniform() * 1e6f) << (i % 40));
  const std::string field = pack_numbers(numbers);
  CHECK(unpack_numbers(field, numbers.size(), "here") == numbers);
  CHECK(unpack_numbers(pack_numbers({}), 0, "here").empty());
  for (const std::int64_t value : {std::int64_t{0}, std::int64_t{-1}, INT64_MAX, INT64_MIN})
    CHECK(unzigzag(zigzag(value)) == value);
  const auto refused = [&](std::string_view bytes, std::size_t count) {
    return test::error_of(ExitCode::kBadPrediction, [&] { unpack_numbers(bytes, count, "here"); });
  };
  CHECK_THAT(refused(field.substr(0, field.size() / 2), numbers.size()), Catch::Contains("here"));
  CHECK_THAT(refused(field + "x", numbers.size()), Catch::Contains("damaged"));
  CHECK_THAT(refused(field, numbers.size() / 2), Catch::Contains("here"));
  CHECK_THAT(refused(field, std::size_t{1} << 40), Catch::Contains("here"));
  CHECK_THAT(refused("", 3), Catch::Contains("0 bytes"));
}

TEST_CASE("bits come back, the lowest first") {
  BitWriter writer;
  writer.put(5, 3);
  writer.put(0x1234567890, 37);
  writer.put(7, 0);
  const std::string bytes = writer.take();
  CHECK(bytes.size() == 5);
  BitReader reader(bytes);
  CHECK(reader.get(3) == 5);
  CHECK(reader.get(37) == 0x1234567890);
  CHECK(reader.ended_well());
  CHECK(reader.get(1) == 0);
  CHECK(!reader.ended_well());
}

TEST_CASE("packed surfels stay within their grids' steps, in Z-order") {
  const SurfelCloud cloud = walls(3000);
  const SurfelSteps steps = SurfelSteps::of(1e-4);
  const SurfelCode code = pack_surfels(cloud, on_grids(1e-4, {"transparency"}));
  CHECK(code.num_bytes() < 16 * code.order.size());
  const SurfelCloud back = unpack_surfels(code.about, code.fields, "x");
  REQUIRE(back.size() == code.order.size());
  CHECK(back.size() < cloud.size());  // some are too faint
  double worst_edge = 0, worst_scale = 0;
  for (std::size_t i = 0; i < back.size(); ++i) {
    const std::size_t from = code.order[i];
    for (std::size_t axis = 0; axis < 3; ++axis)
      CHECK(
          difference(back.means[3 * i + axis], cloud.means[3 * from + axis]) < 0.51 * steps.position
      );
    for (std::size_t axis = 0; axis < 2; ++axis)
      worst_scale = std::max(
          worst_scale, difference(back.log_scales[2 * i + axis], cloud.log_scales[2 * from + axis])
      );
    const Vec3<double> before = column(rotation_of(cloud, from), 2),
                       now = column(rotation_of(back, i), 2);
    const double scale = std::exp(
        static_cast<double>(std::max(cloud.log_scales[2 * from], cloud.log_scales[2 * from + 1]))
    );
    worst_edge = std::max(worst_edge, scale * length(cross(before, now)));
    CHECK(
        difference(back.opacity_logits[i], std::clamp(cloud.opacity_logits[from], -8.0f, 9.0f)) <
        0.51 * steps.logit
    );
    CHECK(difference(back.extra_logits[2 * i], cloud.extra_logits[2 * from]) < 0.51 * steps.logit);
    CHECK(back.extra_logits[2 * i + 1] == 0);
  }
  CHECK(worst_edge < 1.0e-3);
  CHECK(worst_scale < 0.36 / steps.scale_levels);
}

TEST_CASE("a rotation within the plane comes back, up to half a turn") {
  const SurfelCloud cloud = walls(1000);
  const SurfelCode code = pack_surfels(cloud, on_grids(1e-5));
  const SurfelCloud back = unpack_surfels(code.about, code.fields, "x");
  for (std::size_t i = 0; i < back.size(); ++i) {
    const std::size_t from = code.order[i];
    const float ratio = std::abs(cloud.log_scales[2 * from] - cloud.log_scales[2 * from + 1]);
    if (ratio < 0.7f) continue;  // of round ones it is nothing
    const Vec3<double> a = column(rotation_of(cloud, from), 0), b = column(rotation_of(back, i), 0);
    CHECK(std::abs(dot(a, b)) > 0.999);
  }
}

TEST_CASE("without steps, and where grids do not reach, surfels are as they were") {
  SurfelCloud cloud = walls(50);
  const auto check_exact = [&](const SurfelCode& code) {
    const SurfelCloud back = unpack_surfels(code.about, code.fields, "x");
    CHECK(back.means == cloud.means);
    CHECK(back.log_scales == cloud.log_scales);
    CHECK(back.rotations == cloud.rotations);
    CHECK(back.opacity_logits == cloud.opacity_logits);
    CHECK(back.extra_logits == cloud.extra_logits);
    CHECK(back.extra_names == cloud.extra_names);
  };
  check_exact(pack_surfels(cloud, {.extras = cloud.extra_names}));
  cloud.means[0] = 9e5f;
  cloud.opacity_logits[0] = 1;
  check_exact(pack_surfels(cloud, on_grids(1e-6, cloud.extra_names)));
}

TEST_CASE("one surfel, and none that is seen") {
  SurfelCloud cloud = walls(4);
  std::fill(cloud.opacity_logits.begin(), cloud.opacity_logits.end(), -9.0f);
  const SurfelCode code = pack_surfels(cloud, on_grids(1e-4));
  CHECK(code.order == std::vector<std::uint32_t>{0});
  CHECK(unpack_surfels(code.about, code.fields, "x").size() == 1);
}

TEST_CASE("damaged surfels are refused by name, whatever is damaged") {
  const SurfelCloud cloud = walls(200);
  const SurfelCode code = pack_surfels(cloud, on_grids(1e-4, {"transparency"}));
  const auto with = [&](const char* name, const Json& value) {
    Json about = code.about;
    about[name] = value;
    return message_of(about, code.fields);
  };
  for (const auto& [name, field] : code.fields) {
    auto fields = code.fields;
    fields.erase(name);
    CHECK_THAT(message_of(code.about, fields), Catch::Contains(fmt::format("no field '{}'", name)));
    fields[name] = field.size() > 8 ? field.substr(0, field.size() / 2) : field + "x";
    CHECK_THAT(message_of(code.about, fields), Catch::Contains(name));
  }
  const auto with_group = [&](const char* name, const Json& value) {
    Json groups = code.about["groups"];
    groups[0][name] = value;
    return with("groups", groups);
  };
  CHECK_THAT(with("count", code.order.size() + 1), Catch::Contains("in groups of"));
  CHECK_THAT(with("count", 1ull << 40), Catch::Contains("surfels with"));
  Json many = code.about;
  many["count"] = many["groups"][0]["count"] = 1u << 22;
  CHECK_THAT(message_of(many, code.fields), Catch::Contains("are said to lie in"));
  CHECK_THAT(with("count", -1), Catch::Contains("count"));
  CHECK_THAT(with("kind", "magic"), Catch::Contains("'magic'"));
  CHECK_THAT(with("kept", {"colour"}), Catch::Contains("no channel 'colour'"));
  CHECK_THAT(with("groups", 7), Catch::Contains("damaged"));
  CHECK_THAT(with_group("low", {0, 1}), Catch::Contains("'low'"));
  CHECK_THAT(with_group("low", {0, 1, 1e30}), Catch::Contains("steps that no"));
  CHECK_THAT(with_group("count", 1ull << 63), Catch::Contains("in groups of"));
  Json wide = config_to_json(SurfelSteps{});
  wide["position"] = 1e300;
  CHECK_THAT(with_group("steps", wide), Catch::Contains("steps that no"));
}

TEST_CASE("floats that are not finite are refused") {
  SurfelCloud cloud = walls(20);
  cloud.rotations[5] = std::nanf("");
  const SurfelCode code = pack_surfels(cloud, {});
  CHECK_THAT(message_of(code.about, code.fields), Catch::Contains("surfel 1: rotations is nan"));
}

TEST_CASE("surfels that are seen at few pixels take fewer bits, and none where none sees them") {
  const SurfelCloud cloud = walls(4000);
  SurfelPacking packing = on_grids(1e-4);
  const std::size_t alike = pack_surfels(cloud, packing).num_bytes();
  for (std::size_t i = 0; i < cloud.size(); ++i)
    packing.seen.push_back(i % 4 == 0 ? 1000.0f : (i % 4 == 1 ? 0.0f : 10.0f));
  const SurfelCode code = pack_surfels(cloud, packing);
  CHECK(code.num_bytes() < alike);
  const SurfelCloud back = unpack_surfels(code.about, code.fields, "x");
  double worst[2] = {0, 0};  // of those that are seen at many, at few pixels
  for (std::size_t i = 0; i < back.size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double& most = worst[code.order[i] % 4 == 0 ? 0 : 1];
      most = std::max(
          most, difference(back.means[3 * i + axis], cloud.means[3 * code.order[i] + axis])
      );
    }
  CHECK(worst[0] < 5e-5);
  CHECK(worst[1] > 1e-4);
  packing.drop_below = 0;
  for (const double tolerance : {1e-4, 0.0}) {
    packing.tolerance = tolerance;
    for (const std::uint32_t i : pack_surfels(cloud, packing).order) CHECK(i % 4 != 1);
  }
}
