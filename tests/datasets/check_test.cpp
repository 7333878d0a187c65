// SPDX-License-Identifier: MIT
// The checker against a room whose depth and normals are known in closed form: silent when nothing
// is wrong, and naming every defect that is planted.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>

#include "datasets/check_geometry.h"
#include "datasets/dataset.h"
#include "datasets/map_files.h"
#include "datasets/scene_index.h"
#include "glint/core/config.h"
#include "glint/core/rng.h"
#include "glint/scene/image_files.h"
#include "glint/scene/ply.h"
#include "tests/support/as_nobody.h"
#include "tests/support/box_room.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

constexpr ImageSize kSize{96, 72};

std::string list(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& finding : findings)
    text += fmt::format("[{}] {}: {}\n", finding.check, finding.where, finding.message);
  return text;
}

// Findings after `change` was made to the views before, and `damage` to the folder after writing.
std::vector<Finding> findings_after(
    const std::function<void(std::vector<View>&)>& change,
    const std::function<void(const fs::path&)>& damage = [](const fs::path&) {},
    ImageSize size = kSize
) {
  const TempFolder folder;
  std::vector<View> views = box_room_views(10, size);
  change(views);
  write_easyvolcap(folder.path(), views);
  damage(folder.path());
  return check_dataset(folder.path());
}

std::vector<Finding> findings_after_damage(const std::function<void(const fs::path&)>& damage) {
  return findings_after([](std::vector<View>&) {}, damage);
}

// Exactly one finding, of that check.
Finding only(const std::vector<Finding>& findings, const std::string& check) {
  INFO(list(findings));
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].check == check);
  return findings[0];
}

void for_each_pixel(View& view, const std::function<void(View&, int, int)>& f) {
  for (int y = 0; y < view.camera.height; ++y)
    for (int x = 0; x < view.camera.width; ++x) f(view, x, y);
}

void to_ray_length(std::vector<View>& views) {
  for (View& view : views)
    for_each_pixel(view, [](View& v, int x, int y) {
      const double cosine = length(v.camera.ray_in_cam(x + 0.5, y + 0.5));
      v.truth["depth"].at(x, y) *= static_cast<float>(cosine);
    });
}

void flip_axis(Image& normal, int axis) {
  for (std::size_t i = 0; i < normal.num_pixels(); ++i)
    normal.data()[3 * i + static_cast<std::size_t>(axis)] *= -1;
}

// Two layers: all of the first is glass, and the second lies at `factor` times its depth; in the
// fourth view as `spoil` leaves its maps.
std::vector<Finding> findings_of_layers(
    const std::function<void(Image& glass, Image& second)>& spoil
) {
  std::vector<View> views;
  return findings_after(
      [&](std::vector<View>& all) { views = all; },
      [&](const fs::path& folder) {
        for (std::size_t i = 0; i < views.size(); ++i) {
          Image second = views[i].truth["depth"], glass(kSize.width, kSize.height, 1, 1.0f);
          for (float& z : second.values()) z *= 1.5f;
          if (i == 3) spoil(glass, second);
          const fs::path gt = folder / "gt";
          write_true_map(
              gt / true_map_file(MapId("glass").row(), views[i].name), MapKind::kMask, glass
          );
          write_true_map(
              gt / true_map_file(MapId("layer_2_depth").row(), views[i].name),
              MapKind::kDepth,
              second
          );
        }
      }
  );
}

}  // namespace

TEST_CASE("a clean dataset has no findings") {
  const std::vector<Finding> findings = findings_after([](std::vector<View>&) {});
  INFO(list(findings));
  CHECK(findings.empty());
}

TEST_CASE("wide steps around an occluder are no defect, and ray lengths still show") {
  const auto spread = [](std::vector<View>& views) { views = box_room_views(8, kSize, 0.785); };
  const std::vector<Finding> findings = findings_after(spread);
  INFO(list(findings));
  CHECK(findings.empty());
  only(
      findings_after([&](std::vector<View>& views) {
        spread(views);
        to_ray_length(views);
      }),
      "ray-length-depth"
  );
}

TEST_CASE("a clean nerfstudio dataset has no findings") {
  const TempFolder folder;
  write_nerfstudio(folder.path(), box_room_views(10, kSize));
  const std::vector<Finding> findings = check_dataset(folder.path());
  INFO(list(findings));
  CHECK(findings.empty());
}

TEST_CASE("ray-length depth is told from planar depth") {
  const Finding finding = only(findings_after(to_ray_length), "ray-length-depth");
  CHECK_THAT(finding.where, Contains("gt/depth"));
}

TEST_CASE("noise on depth and priors is no defect") {
  Rng rng(3);
  const auto noisy = [&](std::vector<View>& views) {
    for (View& view : views) {
      for (float& z : view.truth["depth"].values()) z *= 1 + 0.003f * rng.normal();
      for (float& n : view.priors["normal"].values())
        n = std::clamp(n + 0.1f * rng.normal(), -1.0f, 1.0f);
    }
  };
  const std::vector<Finding> findings = findings_after(noisy);
  INFO(list(findings));
  CHECK(findings.empty());
}

TEST_CASE("every wrong sign pattern of true and prior normals is found") {
  for (int pattern = 1; pattern < 8; ++pattern) {
    INFO("flipped: " << flipped_axes(pattern));
    const auto flip = [&](Image View::*, std::vector<View>& views, bool prior) {
      for (View& view : views)
        for (int axis = 0; axis < 3; ++axis)
          if ((pattern >> axis & 1) != 0)
            flip_axis(prior ? view.priors["normal"] : view.truth["normal"], axis);
    };
    for (const bool prior : {false, true}) {
      const Finding finding = only(
          findings_after([&](std::vector<View>& views) { flip(nullptr, views, prior); }),
          "normal-axes"
      );
      CHECK_THAT(finding.where, Contains(prior ? "diffrens/normal" : "gt/normal"));
      CHECK_THAT(finding.message, Contains("axes " + flipped_axes(pattern) + " are flipped"));
    }
  }
}

TEST_CASE("normals in world axes are found") {
  const Finding finding = only(
      findings_after([](std::vector<View>& views) {
        for (View& view : views)
          for_each_pixel(view, [](View& v, int x, int y) {
            float* n = v.truth["normal"].pixel(x, y);
            const Vec3d world = transpose_times(
                v.camera.rotation_cam_from_world, cast<double>(Vec3f{n[0], n[1], n[2]})
            );
            for (int c = 0; c < 3; ++c) n[c] = static_cast<float>(world[c]);
          });
      }),
      "normal-axes"
  );
  CHECK_THAT(finding.message, Contains("world axes"));
}

TEST_CASE("prior normals that face away are found without true depth") {
  const Finding finding = only(
      findings_after(
          [](std::vector<View>& views) {
            for (View& view : views) flip_axis(view.priors["normal"], 2);
          },
          [](const fs::path& folder) { fs::remove_all(folder / "gt"); }
      ),
      "normal-axes"
  );
  CHECK_THAT(finding.message, Contains("face the camera"));
}

TEST_CASE("depth that does not belong to the poses is found") {
  const std::vector<Finding> findings = findings_after([](std::vector<View>& views) {
    for (View& view : views)
      for (float& z : view.truth["depth"].values()) z *= 1000;  // millimetres
  });
  CHECK_THAT(list(findings), Contains("[depth-poses]"));
}

TEST_CASE("small pictures show the same defects, and none when nothing is wrong") {
  for (const ImageSize size : {ImageSize{32, 18}, ImageSize{64, 36}}) {
    INFO(size.width << " x " << size.height);
    const auto found = [&](const std::function<void(std::vector<View>&)>& change) {
      return findings_after(
          change, [](const fs::path&) {}, size
      );
    };
    const std::vector<Finding> clean = found([](std::vector<View>&) {});
    INFO(list(clean));
    CHECK(clean.empty());
    only(found(to_ray_length), "ray-length-depth");
    const auto depth_scaled = [&](float factor) {
      return list(found([&](std::vector<View>& views) {
        for (View& view : views)
          for (float& z : view.truth["depth"].values()) z *= factor;
      }));
    };
    CHECK_THAT(depth_scaled(1000), Contains("[depth-poses]"));  // millimetres
    CHECK_THAT(depth_scaled(0.5f), Contains("[depth-poses]"));
    CHECK_THAT(
        list(found([&](std::vector<View>& views) {
          const std::vector<View> others = box_room_views(10, size, -0.4);
          for (std::size_t i = 0; i < views.size(); ++i) views[i].camera = others[i].camera;
        })),
        Contains("[depth-poses]")
    );
    only(
        found([](std::vector<View>& views) {
          for (View& view : views) flip_axis(view.truth["normal"], 1);
        }),
        "normal-axes"
    );
  }
}

TEST_CASE("poses of another world are found") {
  const std::vector<Finding> findings = findings_after([](std::vector<View>& views) {
    const std::vector<View> others = box_room_views(10, kSize, -0.4);
    for (std::size_t i = 0; i < views.size(); ++i) views[i].camera = others[i].camera;
  });
  CHECK_THAT(list(findings), Contains("[depth-poses]"));
}

TEST_CASE("intrinsics of another size are found, stated or not") {
  const auto declare = [](const fs::path& folder, const std::string& from, const std::string& to) {
    std::string text = read_file(folder / "intri.yml");
    text.replace(text.find(from), from.size(), to);
    write_file(folder / "intri.yml", text);
  };
  Finding finding = only(
      findings_after_damage([&](const fs::path& f) { declare(f, "W_0004: 96", "W_0004: 192"); }),
      "intrinsics-size"
  );
  CHECK_THAT(finding.where, Contains("camera 0004"));
  CHECK_THAT(finding.message, Contains("192 x 72"));
  finding = only(
      findings_after(
          [](std::vector<View>& views) {
            views[4].camera = resized(views[4].camera, {192, 144});
          },
          [&](const fs::path& f) { declare(f, "H_0004: 144\nW_0004: 192\n", ""); }
      ),
      "intrinsics-size"
  );
  CHECK_THAT(finding.message, Contains("principal point (96.0, 72.0)"));
}

TEST_CASE("every missing file is found") {
  const std::vector<Finding> findings = findings_after_damage([](const fs::path& folder) {
    fs::remove(folder / "images/0003/000000.png");
    fs::remove(folder / "gt/normal/0005.exr");
    fs::remove(folder / "diffrens/normal/0007/000000.png");
  });
  INFO(list(findings));
  REQUIRE(findings.size() == 3);
  for (const Finding& finding : findings) CHECK(finding.check == "missing-file");
  CHECK_THAT(findings[0].where, Contains("images/0003"));
  CHECK_THAT(findings[1].where, Contains("gt/normal/0005.exr"));
  CHECK_THAT(findings[2].where, Contains("diffrens/normal/0007"));
}

TEST_CASE("a test picture among the train views is found by its bytes") {
  const Finding finding = only(
      findings_after_damage([](const fs::path& folder) {
        fs::copy_file(
            folder / "images/0008/000000.png",
            folder / "images/0003/000000.png",
            fs::copy_options::overwrite_existing
        );
      }),
      "test-in-train"
  );
  CHECK_THAT(finding.message, Contains("train view 0003"));
}

TEST_CASE("a test pose among the train views is found") {
  const Finding finding = only(
      findings_after([](std::vector<View>& views) {
        Rng rng(1);
        std::string name = views[3].name;
        views[3] = views[8];
        views[3].name = name;
        for (float& v : views[3].rgb.values()) v += 0.01f * rng.normal();  // another exposure
      }),
      "test-in-train"
  );
  CHECK_THAT(finding.message, Contains("same pose as train view 0003"));
}

TEST_CASE("views in both lists of a split are found") {
  const TempFolder folder;
  write_nerfstudio(folder.path(), box_room_views(4, kSize));
  Json json = Json::parse(read_file(folder / "transforms.json"));
  json["train_filenames"] = {"images/0000.png", "images/0001.png", "images/0002.png"};
  json["test_filenames"] = {"images/0002.png", "images/0003.png"};
  write_file(folder / "transforms.json", json.dump());
  const Finding finding = only(check_dataset(folder.path()), "test-in-train");
  CHECK_THAT(finding.where, Contains("images/0002.png"));
}

TEST_CASE("values that are not finite are found in maps and poses") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  Finding finding = only(
      findings_after([&](std::vector<View>& views) { views[2].truth["depth"].at(5, 5) = infinity; }
      ),
      "non-finite"
  );
  CHECK_THAT(finding.where, Contains("gt/depth/0002.exr"));
  finding = only(
      findings_after([&](std::vector<View>& views) { views[2].truth["normal"].at(5, 5, 1) = nan; }),
      "non-finite"
  );
  CHECK_THAT(finding.where, Contains("gt/normal/0002.exr"));
  finding = only(
      findings_after_damage([](const fs::path& folder) {
        std::string text = read_file(folder / "extri.yml");
        const std::size_t at = text.find("data: [ ", text.find("T_0001")) + 8;
        text.replace(at, text.find(',', at) - at, ".Inf");
        write_file(folder / "extri.yml", text);
      }),
      "non-finite"
  );
  CHECK_THAT(finding.where, Contains("camera 0001"));
}

TEST_CASE("unreadable files and wrong sizes are found") {
  const std::vector<Finding> findings = findings_after_damage([](const fs::path& folder) {
    write_file(folder / "images/0001/000000.png", "no picture");
    const std::string depth = read_file(folder / "gt/depth/0002.exr");
    write_file(folder / "gt/depth/0002.exr", std::string_view(depth).substr(0, depth.size() / 2));
    write_exr(folder / "gt/normal/0004.exr", Image(10, 10, 3), true);
    write_file(folder / "sparse/0/points3D.ply", "ply\n");
  });
  INFO(list(findings));
  REQUIRE(findings.size() == 4);
  CHECK(findings[0].check == "unreadable-file");
  CHECK_THAT(findings[0].where, Contains("images/0001"));
  CHECK(findings[1].check == "unreadable-file");
  CHECK_THAT(findings[1].where, Contains("gt/depth/0002.exr"));
  CHECK(findings[2].check == "wrong-size");
  CHECK_THAT(findings[2].message, Contains("10 x 10"));
  CHECK(findings[3].check == "unreadable-file");
  CHECK_THAT(findings[3].where, Contains("points3D.ply"));
}

TEST_CASE("too few points to start from are found") {
  const Finding finding = only(
      findings_after_damage([](const fs::path& folder) {
        PointCloud points = read_point_ply(folder / "sparse/0/points3D.ply");
        points.positions.resize(3);
        points.colors.resize(3);
        write_point_ply(folder / "sparse/0/points3D.ply", points);
      }),
      "points"
  );
  CHECK_THAT(finding.message, Contains("3 points, expected at least 4"));
}

TEST_CASE("negative depth, normals without unit length and points in other axes are found") {
  const std::vector<Finding> findings = findings_after(
      [](std::vector<View>& views) {
        views[1].truth["depth"].at(3, 3) = -1;
        for (float& n : views[2].truth["normal"].values()) n *= 0.8f;
      },
      [](const fs::path& folder) {
        PointCloud points = read_point_ply(folder / "sparse/0/points3D.ply");
        for (Vec3f& p : points.positions) p = {p.x, p.z + 20, p.y};
        write_point_ply(folder / "sparse/0/points3D.ply", points);
      }
  );
  INFO(list(findings));
  REQUIRE(findings.size() == 3);
  CHECK(findings[0].check == "depth-values");
  CHECK(findings[1].check == "normal-length");
  CHECK(findings[2].check == "points");
}

TEST_CASE("bad camera fields are all found, and a cut-off camera file is one finding") {
  const std::vector<Finding> findings = findings_after_damage([](const fs::path& folder) {
    std::string text = read_file(folder / "intri.yml");
    for (const char* key : {"K_0002", "K_0005"}) text[text.find(key)] = 'L';
    write_file(folder / "intri.yml", text);
  });
  CHECK(std::count_if(findings.begin(), findings.end(), [](const Finding& finding) {
          return finding.check == "camera-field";
        }) == 2);
  const Finding finding = only(
      findings_after_damage([](const fs::path& folder) {
        write_file(folder / "extri.yml", "%YAML:1.0\n---\nnames: [ \"0");
      }),
      "unreadable-file"
  );
  CHECK_THAT(finding.message, Contains("extri.yml"));
}

TEST_CASE("several defects at once are all named") {
  const std::vector<Finding> findings = findings_after(
      [](std::vector<View>& views) {
        to_ray_length(views);
        for (View& view : views) flip_axis(view.truth["normal"], 1);
      },
      [](const fs::path& folder) { fs::remove(folder / "images/0003/000000.png"); }
  );
  CHECK_THAT(
      list(findings),
      Contains("[ray-length-depth]") && Contains("[normal-axes]") && Contains("[missing-file]")
  );
}

TEST_CASE("a folder that no loader knows cannot be checked") {
  const TempFolder folder;
  bad_reference([&] { check_dataset(folder.path()); });
}

TEST_CASE("names that share a folder, and a scene's name that leaves it, are found and not loaded"
) {
  const TempFolder folder;
  write_easyvolcap(folder.path(), box_room_views(10, kSize));
  write_file(folder / "scene.json", R"({"name": "../../elsewhere"})");
  const std::string message = bad_reference([&] { load_scene(folder.path(), {}); });
  CHECK_THAT(message, Contains("scene.json: name: '../../elsewhere' holds a path separator"));
  CHECK_THAT(list(check_dataset(folder.path())), Contains("holds a path separator"));
}

TEST_CASE("views whose names become one folder's are told with both names") {
  SceneIndex index;
  index.name = "x";
  index.views = {
      {.name = "a/b", .where = "file: a/b", .is_train = true},
      {.name = "a_b", .where = "file: a_b", .is_train = true}};
  const std::string message = bad_reference([&] { load_indexed(index, {}); });
  CHECK_THAT(message, Contains("a/b and a_b would share the folder a_b"));
  CHECK_THAT(list(check_indexed(index)), Contains("[view-name] file: a_b: views a/b and a_b"));
}

TEST_CASE("a camera that stands nowhere near is found") {
  const auto findings = findings_after([](std::vector<View>& views) {
    views[3].camera.translation_cam_from_world.x = 1e50;
  });
  CHECK_THAT(list(findings), Contains("[pose]") && Contains("1e+50 m from the origin"));
}

TEST_CASE("float images of another range are found") {
  const TempFolder folder;
  write_npy(folder / "a.npy", Image(8, 6, 3, 255.0f));
  SceneIndex index;
  index.views = {{.name = "a", .where = "file: a", .image = folder / "a.npy", .is_train = true}};
  Camera& camera = index.views[0].camera;
  camera.fx = camera.fy = 8, camera.cx = 4, camera.cy = 3;
  CHECK_THAT(list(check_indexed(index)), Contains("[color-values]") && Contains("by 255"));
}

TEST_CASE("a folder that may not be read is told as that") {
  const TempFolder folder;
  fs::permissions(folder.path(), fs::perms(0755));
  write_easyvolcap(folder / "room", box_room_views(2, kSize));
  fs::permissions(folder / "room", fs::perms::none);
  {
    const AsNobody nobody;
    if (nobody.lacks_privileges())
      CHECK_THAT(
          error_of(ExitCode::kEnvironment, [&] { find_loader(folder / "room"); }),
          Contains("room: permission denied")
      );
  }
  fs::permissions(folder / "room", fs::perms::owner_all);
}

TEST_CASE("an image of another size than its maps is named itself") {
  const auto shrink = [](const fs::path& folder) {
    write_png(folder / "images/0003/000000.png", Image(48, 36, 3, 0.5f));
  };
  const Finding finding = only(findings_after_damage(shrink), "wrong-size");
  CHECK_THAT(finding.where, Contains("images/0003"));
  CHECK_THAT(
      finding.message, Contains("48 x 36 pixels, its camera and its 4 maps 96 x 72; store the")
  );
}

TEST_CASE("a split that leaves no train view or no test view is told with the way out") {
  const TempFolder folder;
  write_easyvolcap(folder.path(), box_room_views(1, kSize));
  const std::string message = bad_reference([&] { load_scene(folder.path(), {}); });
  CHECK_THAT(
      message, Contains("the only view is a test view") && Contains("scene.json as \"test_views\"")
  );
  CHECK_THAT(list(check_dataset(folder.path())), Contains("[no-views]") && Contains("test view;"));
  only(
      findings_after_damage([](const fs::path& f) {
        write_file(f / "scene.json", R"({"test_views": []})");
      }),
      "no-test-views"
  );
}

TEST_CASE("Layers lie behind each other, and only behind glass and mirrors") {
  CHECK(list(findings_of_layers([](Image&, Image&) {})).empty());
  const Finding order = only(
      findings_of_layers([](Image&, Image& second) {
        for (float& z : second.values()) z *= 0.5f;
      }),
      "layer-order"
  );
  CHECK_THAT(order.where, Contains("layer_2_depth"));
  CHECK_THAT(order.message, Contains("layer 2 are nearer than layer 1"));
  const Finding behind = only(
      findings_of_layers([](Image& glass, Image&) {
        for (float& value : glass.values()) value = 0;
      }),
      "layer-behind-opaque"
  );
  CHECK_THAT(behind.message, Contains("neither glass nor a mirror"));
}
