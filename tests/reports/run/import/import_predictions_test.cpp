// SPDX-License-Identifier: MIT
// The ground truth of a room, written as other programs would: it must come back without error.
#include "reports/run/import/import_predictions.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>
#include <limits>

#include "glint/scene/image_files.h"
#include "reports/run/bench/stages.h"
#include "tests/support/exif.h"
#include "tests/support/small_room.h"
#include "tests/support/write_jpeg.h"

using namespace glint;

namespace {

Image ray_lengths(const View& view) {
  Image depth = view.truth["depth"];
  for (int y = 0; y < depth.height(); ++y)
    for (int x = 0; x < depth.width(); ++x)
      depth.at(x, y) *= static_cast<float>(length(view.camera.ray_in_cam(x + 0.5, y + 0.5)));
  return depth;
}

Image opengl_normals(const View& view) {
  Image normals = view.truth["normal"];
  for (std::size_t i = 0; i < normals.num_pixels(); ++i)
    for (const int c : {1, 2}) normals.data()[3 * i + static_cast<std::size_t>(c)] *= -1;
  return normals;
}

Image world_normals(const View& view) {
  Image normals = view.truth["normal"];
  for (std::size_t i = 0; i < normals.num_pixels(); ++i) {
    float* n = normals.data() + 3 * i;
    const Vec3d world = transpose_times(
        view.camera.rotation_cam_from_world,
        Vec3d{static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])}
    );
    n[0] = static_cast<float>(world.x), n[1] = static_cast<float>(world.y);
    n[2] = static_cast<float>(world.z);
  }
  return normals;
}

// Predictions in `folder`, the run beside it.
struct Case {
  test::TempFolder folder;
  RunSpec spec;
  Case() {
    for (const View& view : test::small_room().test) {
      write_png(folder.path() / "theirs/rgb" / (view.name + ".png"), view.rgb);
      write_npy(folder.path() / "theirs/depth" / (view.name + ".npy"), ray_lengths(view));
      write_npy(folder.path() / "theirs/normal" / (view.name + ".npy"), opengl_normals(view));
    }
    spec.folder = folder.path() / "run";
    spec.method = "theirs";
    spec.scene = "room_1";
  }
  std::vector<std::string> import(const ImportOptions& options) {
    return import_predictions(folder.path() / "theirs", test::small_room(), spec, options);
  }
};

}  // namespace

TEST_CASE("The truth in another program's conventions scores as the truth") {
  Case c;
  const auto notes = c.import({DepthConvention::kRay, NormalAxes::kOpengl, {}});
  CHECK(notes.size() == 2);  // whose they are, and that the images have 8 bits
  const auto means = eval_stage(c.spec, test::small_room());
  CHECK(means.at("psnr-8bit") == 100);
  CHECK(means.at("depth-absrel") < 1e-6);
  CHECK(means.at("normal-mae") < 0.01);
  CHECK(fs::exists(c.spec.folder / "strip.png"));
}

TEST_CASE("A PNG's PSNR is psnr-8bit only, a float image has both") {
  Case c;
  c.import({});
  auto means = eval_stage(c.spec, test::small_room());
  for (const auto& [id, value] : means) CHECK((id != "psnr" && !id.starts_with("psnr@")));
  CHECK(means.contains("psnr-8bit"));
  CHECK(means.contains("ssim-3dgs"));
  fs::remove_all(c.folder / "theirs/rgb");
  for (const View& view : test::small_room().test)
    write_exr(c.folder.path() / "theirs/rgb" / (view.name + ".exr"), view.rgb);
  c.import({});
  means = eval_stage(c.spec, test::small_room());
  CHECK(means.at("psnr") == 100);
}

TEST_CASE("Renders as JPEG are scored, and the record's notes say that they are lossy") {
  Case c;
  const fs::path renders = c.folder.path() / "theirs/rgb";
  fs::remove_all(renders);
  for (const View& view : test::small_room().test)
    test::write_jpeg(renders / (view.name + ".jpg"), view.rgb, 50);
  const auto notes = c.import({DepthConvention::kRay, NormalAxes::kOpengl, {}});
  const std::size_t count = test::small_room().test.size();
  CHECK(
      std::ranges::count(
          notes,
          fmt::format(
              "{0} of {0} pictures are JPEG, which is lossy: scores are of what the compression "
              "left",
              count
          )
      ) == 1
  );
  CHECK(eval_stage(c.spec, test::small_room()).at("psnr-8bit") < 60);
}

TEST_CASE("Colours that are not finite are refused by file and pixel") {
  Case c;
  fs::remove_all(c.folder / "theirs/rgb");
  for (const View& view : test::small_room().test) {
    Image rgb = view.rgb;
    rgb.at(3, 2, 1) = std::numeric_limits<float>::quiet_NaN();
    write_exr(c.folder.path() / "theirs/rgb" / (view.name + ".exr"), rgb);
  }
  const std::string name = test::small_room().test.front().name + ".exr";
  CHECK_THROWS_WITH(c.import({}), Catch::Contains(name) && Catch::Contains("pixel (3, 2) is nan"));
}

TEST_CASE("An orientation that EXIF states in renders is noted") {
  Case c;
  const fs::path file =
      c.folder.path() / "theirs/rgb" / (test::small_room().test.back().name + ".png");
  write_file(file, test::png_with_exif(read_file(file), 6, true));
  CHECK_THAT(
      fmt::format("{}", fmt::join(c.import({}), "; ")), Catch::Contains("states EXIF orientation 6")
  );
}

TEST_CASE("Depth as 16-bit PNG in millimetres scores as depth, rounded to them") {
  Case c;
  fs::remove_all(c.folder / "theirs/depth");
  double most = 0;  // AbsRel of rounding
  for (const View& view : test::small_room().test) {
    Image shares = view.truth["depth"];
    for (float& z : shares.values()) z *= 1000.0f / 65535;
    write_png16(c.folder.path() / "theirs/depth" / (view.name + ".png"), shares);
    for (const float z : view.truth["depth"].values())
      if (z > 0) most = std::max(most, 0.0005 / static_cast<double>(z));
  }
  const auto notes = c.import({.normals = NormalAxes::kOpengl});
  CHECK_THAT(
      fmt::format("{}", fmt::join(notes, "; ")),
      Catch::Contains("depth of integers: steps of 0.001 m (by the median")
  );
  CHECK(eval_stage(c.spec, test::small_room()).at("depth-absrel") < most);
  // Pictures for people are none.
  for (const View& view : test::small_room().test)
    write_png(c.folder.path() / "theirs/depth" / (view.name + ".png"), view.truth["depth"]);
  CHECK_THAT(
      fmt::format("{}", fmt::join(c.import({}), "; ")), Catch::Contains("no depth maps read")
  );
}

TEST_CASE("Maps that the data have and the renders lack are told, with what lies there instead") {
  Case c;
  fs::rename(c.folder / "theirs/depth", c.folder / "theirs/depth_colored");
  fs::remove_all(c.folder / "theirs/normal");
  const auto notes = c.import({});
  const std::string all = fmt::format("{}", fmt::join(notes, "; "));
  CHECK_THAT(
      all,
      Catch::Contains("no depth maps read") && Catch::Contains("depth_colored/") &&
          Catch::Contains("no normal maps read")
  );
}

TEST_CASE("Maps whose pixels lie in one row, as EasyVolcap's geo_metric has them, come back") {
  Case c;
  for (const char* map : {"depth", "normal"}) fs::remove_all(c.folder / "theirs" / map);
  const auto in_one_row = [](const Image& map) {
    Image row(static_cast<int>(map.num_pixels()), 1, map.channels());
    std::copy(map.values().begin(), map.values().end(), row.values().begin());
    return row;
  };
  for (const View& view : test::small_room().test) {
    const fs::path folder = c.folder / "theirs/geo_metric";
    write_npy(folder / "depths_pred" / (view.name + ".npy"), in_one_row(view.truth["depth"]));
    write_npy(folder / "normals_pred" / (view.name + ".npy"), in_one_row(view.truth["normal"]));
  }
  c.import({});
  const auto means = eval_stage(c.spec, test::small_room());
  CHECK(means.at("depth-absrel") == 0);
  CHECK(means.at("normal-mae") < 0.01);
}

TEST_CASE("Normals in the world's axes come back, too") {
  Case c;
  for (const View& view : test::small_room().test)
    write_npy(c.folder.path() / "theirs/normal" / (view.name + ".npy"), world_normals(view));
  c.import({DepthConvention::kRay, NormalAxes::kWorld, {}});
  CHECK(eval_stage(c.spec, test::small_room()).at("normal-mae") < 0.01);
}

TEST_CASE("A wrong convention is noticed where there is ground truth, and not corrected silently") {
  Case c;
  const auto notes = c.import({});
  const std::string all = fmt::format("{}", fmt::join(notes, "; "));
  CHECK_THAT(all, Catch::Contains("--depth-kind ray") && Catch::Contains("--normal-axes opengl"));
  CHECK(eval_stage(c.spec, test::small_room()).at("normal-mae") > 20);
}

TEST_CASE("Of gsplat's pictures, truth beside render, the render counts") {
  Case c;
  int i = 0;
  for (const View& view : test::small_room().test) {
    const int width = view.camera.width;
    Image both(2 * width, view.camera.height, 3, 0.25f);
    for (int y = 0; y < both.height(); ++y)
      std::copy_n(view.rgb.data() + view.rgb.width() * y * 3, 3 * width, &both.at(0, y));
    write_png(c.folder.path() / fmt::format("gsplat/renders/val_{:04}.png", i++), both);
  }
  const auto import = [&] {
    return import_predictions(c.folder.path() / "gsplat", test::small_room(), c.spec, {});
  };
  CHECK_THAT(fmt::format("{}", fmt::join(import(), "; ")), Catch::Contains("right halves"));
  const Image render =
      read_image(view_folder(c.spec.folder, test::small_room().test[1].name) / "rgb.png", 3);
  CHECK(render.size() == test::small_room().test[1].camera.size());
  CHECK(render.at(5, 5, 1) == 64.0f / 255);
  // Twice the width without the truth is another size.
  write_png(
      c.folder.path() / "gsplat/renders/val_0000.png",
      Image(2 * render.width(), render.height(), 3, 0.25f)
  );
  CHECK_THROWS_WITH(import(), Catch::Contains("128x36"));
}

TEST_CASE("Renders of another size and damaged files are refused by name") {
  Case c;
  const fs::path first =
      c.folder.path() / "theirs/rgb" / (test::small_room().test[0].name + ".png");
  write_png(first, Image(32, 18, 3));
  CHECK_THROWS_WITH(
      c.import({}), Catch::Contains("32x18") && Catch::Contains("--image-ratio or --max-pixels")
  );
  write_file(first, "no picture");
  CHECK_THROWS_WITH(c.import({}), Catch::Contains(first.string()));
  ImportOptions with_mesh;
  with_mesh.mesh = "/nowhere.ply";
  write_png(first, test::small_room().test[0].rgb);
  CHECK_THROWS_WITH(c.import(with_mesh), Catch::Contains("no such mesh"));
}

TEST_CASE("Float renders of another range are told in the record's notes") {
  Case c;
  fs::remove_all(c.folder.path() / "theirs/rgb");
  for (const View& view : test::small_room().test) {
    Image bytes = view.rgb;
    for (float& value : bytes.values()) value = 1 + 254 * value;
    write_exr(c.folder.path() / "theirs/rgb" / (view.name + ".exr"), bytes);
  }
  CHECK_THAT(fmt::format("{}", fmt::join(c.import({}), "; ")), Catch::Contains("divide bytes by"));
}

TEST_CASE("values in other units, of no direction or none at all are noted once a map") {
  const auto note_of = [](const std::string& map, const std::function<void(Image&)>& change) {
    Case c;
    for (const View& view : test::small_room().test) {
      Image values = map == "depth" ? view.truth["depth"] : opengl_normals(view);
      change(values);
      write_npy(c.folder.path() / "theirs" / map / (view.name + ".npy"), values);
    }
    const auto notes = c.import({DepthConvention::kPlanar, NormalAxes::kOpengl, {}});
    std::string found;
    for (const std::string& note : notes)
      if (note.find("/" + map + "/") != std::string::npos) found += note + "\n";
    return found;
  };
  const auto times = [](float factor) {
    return [factor](Image& map) {
      for (float& v : map.values()) v *= factor;
    };
  };
  const auto nothing = [](Image& map) {
    for (float& v : map.values()) v = std::numeric_limits<float>::quiet_NaN();
  };
  const auto as_color = [](Image& map) {
    for (float& v : map.values()) v = (v + 1) / 2;
  };
  CHECK(note_of("depth", times(1)).empty());
  CHECK(note_of("normal", times(1)).empty());
  CHECK_THAT(
      note_of("depth", times(1000)),
      Catch::Contains("depth is 1e+03 times the true one") &&
          Catch::Contains("another unit (millimetres, by the ratio)") &&
          Catch::Contains("(2 maps of depth are odd)")
  );
  CHECK_THAT(note_of("depth", nothing), Catch::Contains("no pixel has a finite depth"));
  CHECK_THAT(note_of("normal", times(5)), Catch::Contains("normals are 5 long"));
  CHECK_THAT(note_of("normal", as_color), Catch::Contains("not colours"));
  CHECK_THAT(note_of("normal", nothing), Catch::Contains("no pixel has a finite normal"));
}
