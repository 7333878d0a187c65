// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <cmath>

#include "datasets/dataset.h"
#include "datasets/prior_maps.h"
#include "datasets/scene_index.h"
#include "glint/core/parallel.h"
#include "glint/scene/image_files.h"
#include "tests/support/box_room.h"
#include "tests/support/image_difference.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

constexpr ImageSize kSize{48, 36};

// A folder with a room of 10 views, numbered 0 to 9.
struct RoomFolder : TempFolder {
  std::vector<View> views = box_room_views(10, kSize);
  RoomFolder() { write_easyvolcap(path(), views); }

  void replace(const std::string& name, const std::string& from, const std::string& to) const {
    std::string text = read_file(path() / name);
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    write_file(path() / name, text.replace(at, from.size(), to));
  }
  std::string load_error() const {
    return bad_reference([&] { load_scene(path(), {}); });
  }
};

// Largest distance of the two cameras' images of points in front of them, in pixels.
double projection_difference(const Camera& a, const Camera& b) {
  double largest = 0;
  for (const double x : {0.0, 20.0, 48.0})
    for (const double y : {0.0, 36.0}) {
      const Vec3d point = a.to_world(2.0 * a.ray_in_cam(x, y));
      const Vec2d pixel = b.project(b.to_cam(point));
      largest = std::max({largest, std::abs(pixel.x - x), std::abs(pixel.y - y)});
    }
  return largest;
}

}  // namespace

TEST_CASE("a folder in EasyVolcap's layout is loaded whole") {
  const RoomFolder folder;
  const Scene scene = load_scene(folder.path(), {});
  CHECK(scene.dataset == "easyvolcap");
  CHECK(scene.name == folder.path().filename().string());
  REQUIRE(scene.test.size() == 2);  // views 0 and 8
  REQUIRE(scene.train.size() == 8);
  CHECK(scene.test[1].name == "0008");
  const View& loaded = scene.train[2];
  const View& made = folder.views[3];
  CHECK(loaded.name == "0003");
  CHECK(loaded.camera.size() == kSize);
  CHECK(projection_difference(made.camera, loaded.camera) < 1e-9);
  CHECK(largest_difference(loaded.rgb, made.rgb) <= 0.5f / 255 + 1e-6f);
  CHECK(largest_difference(loaded.truth["depth"], made.truth["depth"]) == 0);
  CHECK(largest_difference(loaded.truth["normal"], made.truth["normal"]) == 0);
  CHECK(largest_difference(loaded.priors["normal"], made.truth["normal"]) < 0.01f);
  CHECK(
      loaded.priors["depth"].at(3, 4) == Approx(0.2f * made.truth["depth"].at(3, 4)).margin(0.003)
  );
  CHECK(loaded.priors["albedo"].empty());
  CHECK(loaded.truth["glass"].empty());
  CHECK(scene.points.positions.size() == 10 * 6 * 5);
  CHECK(scene.bounds_min.x == Approx(0).margin(0.01));
}

TEST_CASE("Rodrigues vectors give the same poses as matrices") {
  const RoomFolder folder;
  std::string text = read_file(folder / "extri.yml");
  for (const View& view : folder.views) {
    const Vec4<double> q = quaternion_from_rotation(view.camera.rotation_cam_from_world);
    const Vec3d axis{q.x, q.y, q.z};
    const Vec3d vector = (2 * std::atan2(length(axis), q.w) / length(axis)) * axis;
    const std::size_t at = text.find("Rot_" + view.name);
    text.replace(
        at,
        text.find("T_" + view.name) - at,
        fmt::format(
            "R_{}: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ {:.17g}, {:.17g}, "
            "{:.17g} ]\n",
            view.name,
            vector.x,
            vector.y,
            vector.z
        )
    );
  }
  write_file(folder / "extri.yml", text);
  const Scene scene = load_scene(folder.path(), {});
  CHECK(projection_difference(folder.views[3].camera, scene.train[2].camera) < 1e-9);
}

TEST_CASE("options choose size, split, priors and truth") {
  const RoomFolder folder;
  LoadOptions options;
  options.size = {24, 18};
  options.test_every = 5;
  options.with_priors = false;
  Scene scene = load_scene(folder.path(), options);
  CHECK(scene.test.size() == 2);
  CHECK(scene.test[1].name == "0005");
  CHECK(scene.train[0].priors["normal"].empty());
  CHECK(scene.train[0].rgb.size() == ImageSize{24, 18});
  CHECK(scene.train[0].camera.fx == Approx(0.5 * folder.views[1].camera.fx));
  CHECK(scene.train[0].truth["depth"].size() == ImageSize{24, 18});
  options = {};
  options.test_every = 0;
  options.max_pixels = 500;
  options.with_truth = false;
  scene = load_scene(folder.path(), options);
  CHECK(scene.test.empty());
  CHECK(scene.train.size() == 10);
  CHECK(scene.train[0].rgb.num_pixels() <= 500);
  CHECK(scene.train[0].rgb.num_pixels() > 400);
  CHECK(scene.train[0].truth["depth"].empty());
}

TEST_CASE("a halved scene is the scene rendered at half size, away from the room's edges") {
  const RoomFolder folder;
  LoadOptions options;
  options.size = {24, 18};
  const Scene scene = load_scene(folder.path(), options);
  const View half = box_room_views(10, options.size)[3];
  int same = 0, all = 0;
  for (int y = 0; y < 18; ++y)
    for (int x = 0; x < 24; ++x, ++all) {
      const float expected = half.truth["depth"].at(x, y);
      if (std::abs(scene.train[2].truth["depth"].at(x, y) - expected) < 1e-5f * expected) ++same;
    }
  // Only pixels whose footprint holds two walls differ.
  CHECK(same > 0.8 * all);
}

TEST_CASE("scene.json names the dataset and the hash, and says that priors are simulated") {
  const RoomFolder folder;
  write_file(
      folder / "scene.json",
      R"({"name": "room_1", "dataset": "glassroom", "hash": "abc", "simulated_priors": true, "more": [1]})"
  );
  const Scene scene = load_scene(folder.path(), {});
  CHECK(scene.name == "room_1");
  CHECK(scene.dataset == "glassroom");
  CHECK(scene.spec_hash == "abc");
  CHECK(scene.simulated_priors);
  CHECK_THAT(
      describe_scene(scene),
      Contains("10 (8 train, 2 test)") && Contains("normal (8 views)") && Contains("simulated") &&
          Contains("48 x 36")
  );
  write_file(folder / "scene.json", R"({"name": "room)");
  CHECK_THAT(folder.load_error(), Contains("scene.json"));
}

TEST_CASE("views may lack priors where scene.json says so, and nowhere else") {
  const RoomFolder folder;
  fs::remove_all(folder / "diffrens/normal/0003");
  fs::remove_all(folder / "diffrens/depth/0003");
  fs::remove_all(folder / "diffrens/depth/0004");
  CHECK_THAT(folder.load_error(), Contains("0003"));
  CHECK(check_dataset(folder.path()).size() == 3);
  write_file(folder / "scene.json", R"({"without_priors": ["0003"]})");
  CHECK_THAT(folder.load_error(), Contains("diffrens/depth/0004"));
  write_file(folder / "scene.json", R"({"without_priors": ["0003", "0004", "0005"]})");
  const Scene scene = load_scene(folder.path(), {});
  REQUIRE(scene.train.size() == 8);
  CHECK(scene.train[2].priors.empty());  // 0003
  CHECK(scene.train[3].priors.has("normal"));
  CHECK_FALSE(scene.train[3].priors.has("depth"));
  CHECK(scene.train[4].priors.has("depth"));  // what is there is read
  CHECK(scene.train[2].truth.has("depth"));
  CHECK_THAT(describe_scene(scene), Contains("depth (6 views), normal (7 views)"));
  CHECK(check_dataset(folder.path()).empty());
  write_file(folder / "scene.json", R"({"without_priors": ["0042"]})");
  CHECK_THAT(folder.load_error(), Contains("without_priors: no view is called 0042"));
  write_file(folder / "scene.json", R"({"without_priors": 3})");
  CHECK_THAT(folder.load_error(), Contains("scene.json"));
}

TEST_CASE("the hash of a scene changes with its cameras and is stable otherwise") {
  const RoomFolder folder;
  const std::string hash = load_scene(folder.path(), {}).spec_hash;
  CHECK(hash.size() == 16);
  set_num_threads(1);
  CHECK(load_scene(folder.path(), {}).spec_hash == hash);
  set_num_threads(0);
  folder.replace("intri.yml", "H_0003: 36", "H_0003: 36 ");
  CHECK(load_scene(folder.path(), {}).spec_hash != hash);
}

TEST_CASE("a size of -1 is one that the file does not know, as EasyVolcap writes it") {
  const RoomFolder folder;
  folder.replace("intri.yml", "H_0003: 36", "H_0003: -1");
  folder.replace("intri.yml", "W_0003: 48", "W_0003: -1");
  CHECK(load_scene(folder.path(), {}).train[2].camera.size() == kSize);
}

TEST_CASE("every 8th view is a test view in the order of bytes, as EasyVolcap counts") {
  TempFolder folder;
  std::vector<View> views = box_room_views(12, kSize);
  for (std::size_t i = 0; i < views.size(); ++i) views[i].name = fmt::format("{}", i);
  write_easyvolcap(folder.path(), views);
  const Scene scene = load_scene(folder.path(), {});
  REQUIRE(scene.test.size() == 2);  // of 0, 1, 10, 11, 2, ..., 9 the first and the ninth
  CHECK(scene.test[0].name == "0");
  CHECK(scene.test[1].name == "6");
}

TEST_CASE("bad fields of a camera are named") {
  const auto matrix = [](const std::string& name, int rows, const std::string& values) {
    return fmt::format(
        "{}: !!opencv-matrix\n   rows: {}\n   cols: 1\n   dt: d\n   data: [ {}", name, rows, values
    );
  };
  struct Change {
    std::string file, from, to, message;
  };
  for (const Change& change : std::vector<Change>{
           {"intri.yml", "K_0004", "L_0004", "intri.yml: K_0004: 0 values, expected 9"},
           {"extri.yml", "T_0004", "U_0004", "extri.yml: T_0004"},
           {"extri.yml", "names:", "nemas:", "names: expected a list"},
           {"intri.yml", "H_0004: 36", "H_0004: -2", "H_0004: not a number of pixels"},
           {"intri.yml", "W_0004: 48", "W_0004: 96", "96 x 36 pixels"},
           {"intri.yml", "W_0004: 48", "W_0004: 96", "48 x 36"},
           {"extri.yml",
            "T_0004: !!",
            matrix("R_0004", 3, "1., 2., 3. ]\nT_0004: !!"),
            "Rot_0004: is another rotation than R_"},
           {"extri.yml",
            matrix("T_0004", 3, ""),
            matrix("T_0004", 3, ".Nan, "),
            "T_0004: 4 values, expected 3"},
           {"intri.yml",
            matrix("D_0004", 5, "0,"),
            matrix("D_0004", 5, "0.1, 0,"),
            "D_0004: 6 values, expected 4 or 5"}}) {
    const RoomFolder folder;
    folder.replace(change.file, change.from, change.to);
    CHECK_THAT(folder.load_error(), Contains(change.message));
  }
}

TEST_CASE("poses that are not finite or no rotations are errors that name the camera") {
  std::vector<View> views = box_room_views(3, kSize);
  const auto message = [&] {
    const TempFolder folder;
    write_easyvolcap(folder.path(), views);
    return bad_reference([&] { load_scene(folder.path(), {}); });
  };
  Camera& camera = views[1].camera;
  const Camera good = camera;
  camera.rotation_cam_from_world.rows[0] = 2.0 * camera.rotation_cam_from_world.rows[0];
  CHECK_THAT(message(), Contains("camera 0001") && Contains("no rotation"));
  camera = good;
  camera.rotation_cam_from_world.rows[2] = -camera.rotation_cam_from_world.rows[2];
  CHECK_THAT(message(), Contains("no rotation"));
  camera = good;
  camera.fx = -1;
  CHECK_THAT(message(), Contains("focal lengths"));
  camera = good;
  TempFolder folder;
  write_easyvolcap(folder.path(), views);
  std::string text = read_file(folder / "extri.yml");
  const std::size_t at = text.find("data: [ ", text.find("T_0001")) + 8;
  text.replace(at, text.find(',', at) - at, ".Nan");
  write_file(folder / "extri.yml", text);
  CHECK_THAT(
      bad_reference([&] { load_scene(folder.path(), {}); }),
      Contains("camera 0001") && Contains("not finite")
  );
}

TEST_CASE("missing and unusable images and maps are errors that name the file") {
  Image bad_depth(kSize.width, kSize.height, 1);
  bad_depth.at(5, 6) = std::nanf("");
  struct Damage {
    std::function<void(const RoomFolder&)> make;
    std::string message;
  };
  const std::vector<Damage> all = {
      {[](const RoomFolder& f) { fs::remove_all(f / "images/0002"); }, "images/0002"},
      {[](const RoomFolder& f) { write_file(f / "images/0002/000000.png", ""); },
       "images/0002/000000.png: the file is empty"},
      {[](const RoomFolder& f) { fs::remove(f / "gt/depth/0002.exr"); }, "gt/depth/0002.exr"},
      {[](const RoomFolder& f) { write_exr(f / "gt/depth/0002.exr", Image(4, 4, 1)); },
       "4 x 4 pixels, its view's image has 48 x 36"},
      {[&](const RoomFolder& f) { write_exr(f / "gt/depth/0002.exr", bad_depth); },
       "gt/depth/0002.exr: pixel (5, 6) is nan"}};
  for (const Damage& damage : all) {
    const RoomFolder folder;
    damage.make(folder);
    CHECK_THAT(folder.load_error(), Contains(damage.message));
  }
}

TEST_CASE("a scene without images and a folder that is no dataset are errors") {
  const TempFolder folder;
  CHECK_THAT(
      bad_reference([&] { load_scene(folder.path(), {}); }),
      Contains("easyvolcap: intri.yml") && Contains("nerfstudio: transforms.json")
  );
  CHECK_THAT(
      bad_reference([&] { load_scene(folder / "nowhere", {}); }), Contains("no such folder")
  );
  fs::create_directory(folder / "images");
  write_file(folder / "intri.yml", "%YAML:1.0\n---\nnames: [ ]\n");
  write_file(folder / "extri.yml", "%YAML:1.0\n---\nnames: [ ]\n");
  CHECK_THAT(bad_reference([&] { load_scene(folder.path(), {}); }), Contains("names"));
  write_easyvolcap(folder.path(), box_room_views(1, kSize));
  CHECK_THAT(bad_reference([&] { load_scene(folder.path(), {}); }), Contains("no train views"));
}

TEST_CASE("the loader that is surest of a folder reads it, and a tie names both and the way out") {
  const TempFolder folder;
  write_file(folder / "intri.yml", "nothing of use");
  write_nerfstudio(folder.path(), box_room_views(3, kSize));
  CHECK(find_loader(folder.path()).name == "nerfstudio");  // it has frames; intri.yml only a name
  write_easyvolcap(folder.path(), box_room_views(3, kSize));
  CHECK_THAT(
      bad_reference([&] { find_loader(folder.path()); }),
      Contains("easyvolcap: intri.yml with cameras, extri.yml and images") &&
          Contains("nerfstudio: transforms.json with frames") &&
          Contains("--loader (easyvolcap or nerfstudio)")
  );
  for (const std::string id : {"easyvolcap", "nerfstudio"}) {
    LoadOptions options;
    options.loader = id;
    CHECK(load_scene(folder.path(), options).dataset == id);
    CHECK(check_dataset(folder.path(), options).empty());
  }
  write_file(folder / "transforms.json", "{}");
  CHECK(find_loader(folder.path()).name == "easyvolcap");
  CHECK_THAT(
      error_of(ExitCode::kUsage, [&] { find_loader(folder.path(), "scans"); }),
      Contains("loader scans: no such loader") && Contains("nerfstudio: transforms.json")
  );
}

TEST_CASE("coloured depth priors carry 24 bits") {
  const TempFolder folder;
  Image encoded(1, 1, 3);
  encoded.at(0, 0, 0) = 100 / 255.0f;
  encoded.at(0, 0, 1) = 200 / 255.0f;
  encoded.at(0, 0, 2) = 50 / 255.0f;
  write_png(folder / "depth.png", encoded);
  const double expected = (100 + 200 / 256.0 + 50 / 65536.0) / 255.0;
  CHECK(
      read_prior(folder / "depth.png", MapKind::kDepth).at(0, 0) == Approx(expected).epsilon(1e-7)
  );
}

namespace {

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

}  // namespace

TEST_CASE("YAML of another kind, or nested deeply, is the file's error") {
  const TempFolder folder;
  write_easyvolcap(folder.path(), box_room_views(3, {16, 12}));
  for (const std::string& text :
       {std::string("%YAML:1.0\n---\n- 1\n- 2\n"),
        "%YAML:1.0\n---\nnames: " + std::string(100000, '[') + "\n",
        "%YAML:1.0\n---\n" + std::string(100000, '-') + "\n",
        "%YAML:1.0\n---\nnames: " + std::string(100000, '{') + "\n",
        "%YAML:1.0\n---\nnames: " + repeated("a: ", 200000) + "\n"}) {
    write_file(folder / "intri.yml", text);
    CHECK_THAT(bad_reference([&] { load_scene(folder.path(), {}); }), Contains("intri.yml"));
  }
}

TEST_CASE("further frames and pictures without cameras are passed over and named") {
  const RoomFolder folder;
  CHECK(check_dataset(folder.path()).empty());
  const std::string picture = read_file(folder / "images/0003/000000.png");
  write_file(folder / "images/0003/000001.png", picture);
  write_file(folder / "images/0003/000002.png", "not even a picture");
  fs::create_directories(folder / "images/camera_z");
  write_file(folder / "images/camera_z/000000.png", picture);
  const std::vector<Finding> findings = check_dataset(folder.path());
  REQUIRE(findings.size() == 2);
  CHECK(findings[0].check == "extra-frames");
  CHECK_THAT(findings[0].where, Contains("images/0003"));
  CHECK_THAT(findings[0].message, Contains("3 frames, of 1 views") && Contains("000000.png"));
  CHECK(findings[1].check == "picture-without-camera");
  CHECK_THAT(findings[1].where, Contains("camera_z"));
  const Scene scene = load_scene(folder.path(), {});
  CHECK(scene.train.size() + scene.test.size() == 10);
  REQUIRE(scene.data_notes.size() > 2);  // what is found out of its priors follows
  CHECK_THAT(scene.data_notes[0], Contains("images/0003: 3 frames"));
  CHECK_THAT(describe_scene(scene), Contains("notes          ") && Contains("camera_z: no camera"));
}

TEST_CASE("a camera without its picture is a finding and an error") {
  const RoomFolder folder;
  fs::remove_all(folder / "images/0004");
  const std::vector<Finding> findings = check_dataset(folder.path());
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].check == "missing-file");
  CHECK_THAT(folder.load_error(), Contains("camera 0004"));
}
