// SPDX-License-Identifier: MIT
#include "glint/scene/ply.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "tests/support/random_values.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

void check_same(const SurfelCloud& a, const SurfelCloud& b) {
  std::vector<FloatArray> arrays;
  a.for_each_array([&](const char*, const FloatArray& array, std::size_t) {
    arrays.push_back(array);
  });
  std::size_t i = 0;
  b.for_each_array([&](const char* name, const FloatArray& array, std::size_t) {
    INFO(name);
    CHECK(array == arrays[i++]);
  });
  CHECK(a.extra_names == b.extra_names);
}

TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  mesh.colors = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2f, 0.4f, 0.6f}};
  return mesh;
}

// A point cloud file in text form.
std::string ascii_points(const std::string& rows, int count) {
  return "ply\nformat ascii 1.0\ncomment by hand\nelement vertex " + std::to_string(count) +
         "\nproperty double x\nproperty double y\nproperty double z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n" +
         rows;
}

}  // namespace

TEST_CASE("surfels survive a PLY to the bit, with extra channels") {
  const TempFolder folder;
  const SurfelCloud cloud = random_cloud(37, {"transparency", "specular"});
  write_surfel_ply(folder / "x.ply", cloud);
  check_same(cloud, read_surfel_ply(folder / "x.ply"));
  const SurfelCloud plain = random_cloud(5, {});
  write_surfel_ply(folder / "plain.ply", plain);
  check_same(plain, read_surfel_ply(folder / "plain.ply"));
  const SurfelCloud none = random_cloud(0, {"specular"});
  write_surfel_ply(folder / "none.ply", none);
  CHECK(read_surfel_ply(folder / "none.ply").size() == 0);
}

TEST_CASE("the fields stand in the order of common viewers") {
  const TempFolder folder;
  SurfelCloud cloud = random_cloud(1, {"specular"});
  for (std::size_t i = 0; i < 45; ++i) cloud.sh_rest[i] = static_cast<float>(i);
  cloud.rotations = {1, 0, 0, 0};
  write_surfel_ply(folder / "x.ply", cloud);
  const std::string file = read_file(folder / "x.ply");
  const std::size_t rows_at = file.find("end_header\n") + 11;
  std::vector<float> row((file.size() - rows_at) / sizeof(float));
  std::memcpy(row.data(), file.data() + rows_at, row.size() * sizeof(float));
  REQUIRE(row.size() == 63);
  CHECK(row[0] == cloud.means[0]);
  CHECK(row[5] == 1);  // the normal of an unrotated surfel is +z
  CHECK(row[6] == cloud.sh_dc[0]);
  CHECK(row[9] == cloud.sh_rest[0]);                // red of coefficient 1
  CHECK(row[9 + 1] == cloud.sh_rest[3]);            // red of coefficient 2
  CHECK(row[9 + 15] == cloud.sh_rest[1]);           // green of coefficient 1
  CHECK(row[9 + 44] == cloud.sh_rest[3 * 14 + 2]);  // blue of coefficient 15
  CHECK(row[54] == cloud.opacity_logits[0]);
  CHECK(row[55] == cloud.log_scales[0]);
  CHECK(row[57] == Approx(std::log(1e-6)));
  CHECK(row[58] == 1);
  CHECK(row[62] == cloud.extra_logits[0]);
  CHECK_THAT(file, Contains("property float rot_3\nproperty float specular\nend_header\n"));
}

TEST_CASE("a surfel PLY of SH degree 1 without third scale is read") {
  const TempFolder folder;
  std::string header = "ply\nformat ascii 1.0\nelement vertex 1\n";
  for (const char* name :
       {"x",
        "y",
        "z",
        "f_dc_0",
        "f_dc_1",
        "f_dc_2",
        "opacity",
        "scale_0",
        "scale_1",
        "rot_0",
        "rot_1",
        "rot_2",
        "rot_3"})
    header += std::string("property float ") + name + "\n";
  for (int i = 0; i < 9; ++i) header += "property float f_rest_" + std::to_string(i) + "\n";
  write_file(
      folder / "x.ply",
      header + "end_header\n1 2 3 4 5 6 7 8 9 10 11 12 13 " +
          "101 102 103 104 105 106 107 108 109\n"
  );
  const SurfelCloud cloud = read_surfel_ply(folder / "x.ply");
  CHECK(cloud.rotations == FloatArray{10, 11, 12, 13});
  CHECK(cloud.log_scales == FloatArray{8, 9});
  CHECK(cloud.sh_rest[0] == 101);  // coefficient 1: R, G, B
  CHECK(cloud.sh_rest[1] == 104);
  CHECK(cloud.sh_rest[2] == 107);
  CHECK(cloud.sh_rest[3] == 102);  // coefficient 2
  CHECK(cloud.sh_rest[9] == 0);
}

TEST_CASE("a missing field and a value that is not finite are named") {
  const TempFolder folder;
  write_point_ply(folder / "points.ply", {{{0, 0, 0}}, {{0, 0, 0}}, {}});
  CHECK_THAT(
      bad_reference([&] { read_surfel_ply(folder / "points.ply"); }),
      Contains("lacks the properties") && Contains("f_dc_0") && Contains("points.ply")
  );
  SurfelCloud cloud = random_cloud(3, {});
  cloud.opacity_logits[2] = std::nanf("");
  write_surfel_ply(folder / "nan.ply", cloud);
  CHECK_THAT(
      bad_reference([&] { read_surfel_ply(folder / "nan.ply"); }), Contains("surfel 2: opacity")
  );
}

TEST_CASE("the reference trainer's 3DGS cloud is read") {
  const fs::path path = "../shared/data/gs_ply/try_iter7000_point_cloud.ply";
  if (!fs::exists(path)) {
    WARN("skipped: " << path << " is not there");
    return;
  }
  const SurfelCloud cloud = read_surfel_ply(path);
  CHECK(cloud.size() == 9080);
  CHECK(cloud.extra_names.empty());
}

TEST_CASE("points survive a PLY, with colours to 8 bits") {
  const TempFolder folder;
  const PointCloud points{
      {{1, 2, 3}, {-4, 5e-3f, 6e3f}}, {{0, 0.5f, 1}, {0.2f, 0.4f, 0.6f}}, {{0, 0, 1}, {1, 0, 0}}};
  write_point_ply(folder / "x.ply", points);
  const PointCloud read = read_point_ply(folder / "x.ply");
  REQUIRE(read.positions.size() == 2);
  CHECK(read.positions[1].z == 6e3f);
  CHECK(read.colors[0].y == 128 / 255.0f);
  CHECK(read.colors[1].z == 153 / 255.0f);
  CHECK(read.normals[1].x == 1);
}

TEST_CASE("text points with doubles and Windows line ends are read; colours may be absent") {
  const TempFolder folder;
  write_file(folder / "x.ply", ascii_points("1 2.5e-1 -3 0 128 255\r\n4 5 6 1 2 3", 2));
  const PointCloud points = read_point_ply(folder / "x.ply");
  CHECK(points.positions[0].y == 0.25f);
  CHECK(points.colors[0].z == 1);
  CHECK(points.positions[1].z == 6);
  write_file(
      folder / "plain.ply",
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "end_header\n1 2 3\n"
  );
  CHECK(read_point_ply(folder / "plain.ply").colors.at(0).x == 0.5f);
}

TEST_CASE("binary points may be of any type of number") {
  const TempFolder folder;
  std::string file =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty short x\n"
      "property double y\nproperty char z\nproperty ushort a\nproperty uint b\n"
      "property int c\nend_header\n";
  const auto put = [&](auto value) {
    file.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  const auto put_row = [&](std::int16_t x, double y, std::int8_t z) {
    put(x), put(y), put(z);
    put(std::uint16_t{60000}), put(std::uint32_t{4000000000}), put(std::int32_t{-5});
  };
  put_row(-300, 0.25, -7);
  put_row(1000, -2.5, 100);
  write_file(folder / "x.ply", file);
  const PointCloud points = read_point_ply(folder / "x.ply");
  REQUIRE(points.positions.size() == 2);
  CHECK(length(points.positions[0] - Vec3f{-300, 0.25f, -7}) == 0);
  CHECK(length(points.positions[1] - Vec3f{1000, -2.5f, 100}) == 0);
}

TEST_CASE("a point that is not finite is named by its index") {
  const TempFolder folder;
  write_file(folder / "x.ply", ascii_points("1 2 3 0 0 0\n1 nan 3 0 0 0\n", 2));
  CHECK_THAT(
      bad_reference([&] { read_point_ply(folder / "x.ply"); }), Contains("vertex 1: y is nan")
  );
}

TEST_CASE("meshes survive a PLY") {
  const TempFolder folder;
  TriangleMesh mesh = tetrahedron();
  write_mesh_ply(folder / "x.ply", mesh);
  const TriangleMesh read = read_mesh_ply(folder / "x.ply");
  CHECK(read.faces == mesh.faces);
  CHECK(read.vertices[3].z == 1);
  CHECK(read.colors[3].y == 102 / 255.0f);
  mesh.colors.clear();
  write_mesh_ply(folder / "x.ply", mesh);
  CHECK(read_mesh_ply(folder / "x.ply").colors.empty());
}

TEST_CASE("a reader that drops faces itself may have vertices that are not finite") {
  const TempFolder folder;
  TriangleMesh mesh = tetrahedron();
  mesh.vertices[2].y = std::nanf("");
  write_mesh_ply(folder / "x.ply", mesh);
  CHECK_THAT(
      bad_reference([&] { read_mesh_ply(folder / "x.ply"); }), Contains("vertex 2: y is nan")
  );
  const TriangleMesh read = read_mesh_ply(folder / "x.ply", NonFinite::kKeep);
  CHECK(std::isnan(read.vertices[2].y));
  CHECK(read.faces == mesh.faces);
}

TEST_CASE("the header tells meshes from points") {
  const TempFolder folder;
  write_mesh_ply(folder / "mesh.ply", tetrahedron());
  write_mesh_ply(folder / "no_faces.ply", {tetrahedron().vertices, {}, {}});
  write_point_ply(folder / "points.ply", {{{1, 2, 3}}, {{0, 0, 0}}, {}});
  CHECK(is_mesh_ply(folder / "mesh.ply"));
  CHECK(is_mesh_ply(folder / "no_faces.ply"));
  CHECK_FALSE(is_mesh_ply(folder / "points.ply"));
  write_file(folder / "x.ply", "ply\n");
  CHECK_THAT(bad_reference([&] { is_mesh_ply(folder / "x.ply"); }), Contains("no end_header"));
}

TEST_CASE("polygons become fans, and faces to vertices that are not there are errors") {
  const TempFolder folder;
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "element face 1\nproperty list uchar int vertex_index\nproperty uchar flags\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  write_file(folder / "quad.ply", header + "4 0 1 2 3 9\n");
  const std::vector<std::array<std::int32_t, 3>> fan{{0, 1, 2}, {0, 2, 3}};
  CHECK(read_mesh_ply(folder / "quad.ply").faces == fan);
  const auto message = [&](const std::string& face) {
    write_file(folder / "bad.ply", header + face);
    return bad_reference([&] { read_mesh_ply(folder / "bad.ply"); });
  };
  CHECK_THAT(message("3 0 1 4 9\n"), Contains("vertex 4, the file has 4"));
  CHECK_THAT(message("3 0 1 -1 9\n"), Contains("vertex -1"));
  CHECK_THAT(message("2 0 1 9\n"), Contains("face 0 has 2 vertices"));
  CHECK_THAT(message("99999 0 1 2\n"), Contains("cut off or damaged"));
}

TEST_CASE("faces are the list of their vertices and no other") {
  const TempFolder folder;
  const auto message = [&](const std::string& faces) {
    write_file(
        folder / "x.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\n" +
            faces
    );
    return bad_reference([&] { read_mesh_ply(folder / "x.ply"); });
  };
  CHECK_THAT(
      message("element face 1\nproperty list uchar float texcoord\nend_header\n"
              "0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n"),
      Contains("x.ply") && Contains("vertex_indices") && Contains("found: texcoord")
  );
}

TEST_CASE("faces without a list are an error, unless there are none") {
  const TempFolder folder;
  const auto file = [](const std::string& count, const std::string& rows) {
    return "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
           "property float z\nelement face " +
           count + "\nproperty int material\nend_header\n0 0 0\n" + rows;
  };
  write_file(folder / "x.ply", file("2", "5\n6\n"));
  CHECK_THAT(bad_reference([&] { read_mesh_ply(folder / "x.ply"); }), Contains("found: none"));
  write_file(folder / "x.ply", file("0", ""));
  CHECK(read_mesh_ply(folder / "x.ply").faces.empty());
}

TEST_CASE("a count that the file cannot hold allocates nothing") {
  const TempFolder folder;
  const auto message = [&](const std::string& file) {
    write_file(folder / "x.ply", file);
    return bad_reference([&] { read_point_ply(folder / "x.ply"); });
  };
  CHECK_THAT(message(ascii_points("1 2 3 0 0 0\n", 2000000000)), Contains("gives 2000000000 rows"));
  const std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\n"
      "property float x\nproperty float y\nproperty float z\nend_header\n123456789012";
  CHECK_THAT(message(binary), Contains("holds at most 1"));
}

TEST_CASE("headers that are no PLY's are errors that say why") {
  const TempFolder folder;
  const auto message = [&](const std::string& file) {
    write_file(folder / "x.ply", file);
    return bad_reference([&] { read_point_ply(folder / "x.ply"); });
  };
  CHECK_THAT(message(""), Contains("not a PLY"));
  CHECK_THAT(message("plywood\n"), Contains("not a PLY"));
  CHECK_THAT(message("ply\nformat ascii 1.0\n"), Contains("no end_header"));
  CHECK_THAT(message("ply\nend_header\n"), Contains("no format line"));
  CHECK_THAT(message("ply\nformat binary_middle 1.0\nend_header\n"), Contains("binary_middle"));
  CHECK_THAT(
      message("ply\nformat ascii 1.0\nelement vertex x\nend_header\n"),
      Contains("'x' is not a count")
  );
  CHECK_THAT(
      message("ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n"),
      Contains("unknown type 'quad'")
  );
  CHECK_THAT(
      message("ply\nformat ascii 1.0\nelement face 0\nend_header\n"),
      Contains("no element 'vertex'")
  );
}

TEST_CASE("formats of viewers are refused with what to export") {
  const TempFolder folder;
  write_file(folder / "x.splat", std::string(64, '\x07'));
  CHECK_THAT(bad_reference([&] { read_surfel_ply(folder / "x.splat"); }), Contains("SuperSplat"));
}

TEST_CASE("every cut-off PLY is an error") {
  const TempFolder folder;
  write_mesh_ply(folder / "x.ply", tetrahedron());
  const std::string file = read_file(folder / "x.ply");
  for (std::size_t length = 0; length < file.size(); ++length) {
    INFO(length << " bytes");
    write_file(folder / "cut.ply", std::string_view(file).substr(0, length));
    CHECK_THAT(bad_reference([&] { read_mesh_ply(folder / "cut.ply"); }), Contains("cut.ply"));
  }
}

TEST_CASE("rows that the header does not count are an error, in both formats") {
  const TempFolder folder;
  write_mesh_ply(folder / "mesh.ply", tetrahedron());
  std::string bytes = read_file(folder / "mesh.ply");
  const auto recount = [&](const std::string& from, const std::string& to) {
    std::string changed = bytes;
    changed.replace(changed.find(from), from.size(), to);
    write_file(folder / "recounted.ply", changed);
    return bad_reference([&] { read_mesh_ply(folder / "recounted.ply"); });
  };
  CHECK_THAT(
      recount("element face 4", "element face 2"),
      Contains("26 bytes are left behind") && Contains("4 vertex, 2 face")
  );
  // Too few vertices shift the faces.
  CHECK_FALSE(recount("element vertex 4", "element vertex 3").empty());
  write_file(folder / "points.ply", ascii_points("1 2 3 0 0 0\n4 5 6 0 0 0\n", 1));
  CHECK_THAT(
      bad_reference([&] { read_point_ply(folder / "points.ply"); }), Contains("are left behind")
  );
  write_file(folder / "blank.ply", ascii_points("1 2 3 0 0 0\n\n  \n", 1));
  CHECK(read_point_ply(folder / "blank.ply").positions.size() == 1);
  write_file(folder / "line.ply", bytes + "\n");  // some writers end binary rows with one
  CHECK(read_mesh_ply(folder / "line.ply").faces.size() == 4);
}

TEST_CASE("a gap in the coefficients is an error that names it") {
  const TempFolder folder;
  write_surfel_ply(folder / "x.ply", random_cloud(2, {}));
  std::string bytes = read_file(folder / "x.ply");
  bytes.replace(bytes.find("f_rest_9\n"), 8, "f_rost_9");
  write_file(folder / "x.ply", bytes);
  CHECK_THAT(
      bad_reference([&] { read_surfel_ply(folder / "x.ply"); }), Contains("but no f_rest_9")
  );
}

TEST_CASE("vertices out of any scene are an error that names them") {
  const TempFolder folder;
  TriangleMesh mesh = tetrahedron();
  mesh.vertices[2].y = -1e36f;
  write_mesh_ply(folder / "far.ply", mesh);
  CHECK_THAT(
      bad_reference([&] { read_mesh_ply(folder / "far.ply"); }), Contains("vertex 2: y is -1e+36")
  );
  write_point_ply(folder / "far.ply", {{{2e6f, 0, 0}}, {{0, 0, 0}}, {}});
  CHECK_THAT(bad_reference([&] { read_point_ply(folder / "far.ply"); }), Contains("x is 2e+06"));
}
