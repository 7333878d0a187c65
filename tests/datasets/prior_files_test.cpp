// SPDX-License-Identifier: MIT
// Priors in the layouts of other programs, beside a scene of nerfstudio's format without points:
// found, resized, turned, and refused where they do not fit.
#include "datasets/prior_files.h"

#include <catch2/catch.hpp>
#include <numeric>

#include "datasets/dataset.h"
#include "glint/core/config.h"
#include "glint/scene/image_files.h"
#include "tests/support/box_room.h"
#include "tests/support/stored_priors.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

constexpr ImageSize kSize{48, 36};

struct PriorFolder : TempFolder {
  std::vector<View> views;
  explicit PriorFolder(int count) : views(box_room_views(count, kSize)) {
    write_nerfstudio(path() / "scene", views);
  }
  fs::path scene() const { return path() / "scene"; }
  fs::path priors() const { return path() / "priors"; }
  Scene load(PriorOptions options = {}) const {
    LoadOptions load;
    load.test_every = 0;
    load.priors = options;
    return load_scene(scene(), load);
  }
  Scene load_priors() const { return load({.folder = priors().string()}); }
  std::string error(PriorOptions options) const {
    return bad_reference([&] { load(options); });
  }

  // As DiffusionRenderer does: chunk by chunk, the last one filled up with the last picture. Copies
  // that do not count are black.
  void write_chunks(const ChunkGrid& grid, const std::string& extension, ImageSize size) const {
    for (std::size_t chunk = 0; chunk < grid.chunks; ++chunk)
      for (std::size_t frame = 0; frame < grid.frames; ++frame)
        write_frame(grid, {chunk, frame}, extension, size);
  }
  void write_frame(
      const ChunkGrid& grid, ChunkFrame at, const std::string& extension, ImageSize size
  ) const {
    const std::size_t picture = std::min(grid.step() * at.chunk + at.frame, views.size() - 1);
    const ChunkFrame counts = frame_of_picture(grid, picture);
    const View& view = views[picture];
    const bool real = counts.chunk == at.chunk && counts.frame == at.frame;
    const auto write = [&](const char* pass, const Image& map) {
      Image sized = resize_image(map, size);
      if (!real)
        for (float& value : sized.values()) value = 0;
      const fs::path file = priors() / "images" /
                            fmt::format("{:04}.{:04}.{}{}", at.chunk, at.frame, pass, extension);
      write_png(file, sized);
    };
    write("rgb", view.rgb);
    write("normal", encoded(stored_normals(view.truth["normal"], PriorAxes::kOpengl, view.camera)));
    Image grey = stored_depth(view.truth["depth"], PriorDepth::kLinear),
          depth(kSize.width, kSize.height, 3);
    for (std::size_t i = 0; i < depth.values().size(); ++i) depth.data()[i] = grey.data()[i / 3];
    write("depth", depth);
    write("basecolor", Image(kSize.width, kSize.height, 3, 0.8f));
    write("metallic", Image(kSize.width, kSize.height, 3, 0.25f));
  }
};

// Mean angle between the maps where both have a normal, degrees.
double mean_angle(const Image& a, const Image& b) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < a.num_pixels(); ++i) {
    const float *p = a.data() + 3 * i, *q = b.data() + 3 * i;
    const float cosine = p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    if (cosine == 0) continue;
    sum += std::acos(std::clamp(static_cast<double>(cosine), -1.0, 1.0)) * 57.29578;
    ++count;
  }
  REQUIRE(count > 500);
  return sum / count;
}

std::string notes_of(const Scene& scene) {
  return std::accumulate(
      scene.data_notes.begin(),
      scene.data_notes.end(),
      std::string(),
      [](auto a, auto b) { return a + b + "\n"; }
  );
}

void check_normals(const Scene& scene, const std::vector<View>& views, double most_deg) {
  REQUIRE(scene.train.size() == views.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    INFO("view " << i);
    const Image& normal = scene.train[i].priors["normal"];
    REQUIRE(normal.size() == kSize);
    CHECK(mean_angle(normal, views[i].truth["normal"]) < most_deg);
  }
}

}  // namespace

TEST_CASE("of overlapping chunks the copy nearest to its chunk's middle counts") {
  const ChunkGrid grid{3, 24, 6};
  CHECK(grid.covered() == 60);
  const auto place = [&](std::size_t i) {
    const ChunkFrame at = frame_of_picture(grid, i);
    return std::pair(at.chunk, at.frame);
  };
  CHECK(place(0) == std::pair<std::size_t, std::size_t>(0, 0));
  CHECK(place(18) == std::pair<std::size_t, std::size_t>(0, 18));
  CHECK(place(20) == std::pair<std::size_t, std::size_t>(0, 20));
  CHECK(place(21) == std::pair<std::size_t, std::size_t>(1, 3));
  CHECK(place(59) == std::pair<std::size_t, std::size_t>(2, 23));
  for (std::size_t i = 0; i < grid.covered(); ++i)
    CHECK(grid.step() * place(i).first + place(i).second == i);
}

TEST_CASE("DiffusionRenderer's chunks are read, resized and turned") {
  const PriorFolder folder(30);
  folder.write_chunks({2, 24, 6}, ".png", {64, 64});
  const Scene scene = folder.load_priors();
  check_normals(scene, folder.views, 5);
  CHECK(scene.train[20].priors["depth"].size() == kSize);
  CHECK(scene.train[20].priors["basecolor"].at(3, 4, 1) == Approx(0.8f).margin(0.003));
  CHECK(scene.train[0].priors["albedo"].empty());
  CHECK_THAT(notes_of(scene), Contains("2 x 24 frames, overlap 6"));
  CHECK_THAT(notes_of(scene), Contains("opengl axes, nothing to compare with"));
  CHECK_THAT(notes_of(scene), Contains("no diffuse_albedo"));
  CHECK_THAT(notes_of(scene), Contains("prior normal: 100 % of training views"));
}

TEST_CASE("the Cosmos version's JPEGs have no overlap") {
  const PriorFolder folder(10);
  folder.write_chunks({2, 5, 0}, ".png", {80, 44});
  const fs::path clip = folder.priors() / "images", to = folder.priors() / "gbuffer_frames";
  // This program writes no JPEG; to the reader the ending says which version it was.
  fs::create_directories(to);
  fs::rename(clip, to / "any");
  for (const fs::path& file : list_files(to / "any"))
    fs::rename(file, fs::path(file).replace_extension(".jpg"));
  SceneIndex index;
  for (const View& view : folder.views) {
    index.views.push_back({.name = view.name});
    index.views.back().image = folder.scene() / "images" / (view.name + ".png");
  }
  attach_priors(folder.scene(), {.folder = folder.priors().string()}, index);
  CHECK(index.views[4].priors["normal"].filename() == "0000.0004.normal.jpg");
  CHECK(index.views[5].priors["depth"].filename() == "0001.0000.depth.jpg");
  CHECK(index.documented_priors.axes == PriorAxes::kOpengl);
}

TEST_CASE("chunks that do not fit the pictures are refused, and the overlap can be stated") {
  const PriorFolder folder(30);
  folder.write_chunks({2, 15, 0}, ".png", {32, 24});
  CHECK(folder.load({.folder = folder.priors().string(), .overlap = 0}).train.size() == 30);
  CHECK_THAT(
      folder.error({.folder = folder.priors().string(), .overlap = 14}),
      Contains("do not fit 30 pictures")
  );
  CHECK_THAT(
      folder.error({.folder = (folder.path() / "none").string()}), Contains("no such folder")
  );
  CHECK_THAT(folder.error({.folder = folder.scene().string()}), Contains("no priors of the scene"));
}

TEST_CASE("a first chunk alone gives priors to the first pictures, and the notes say so") {
  const PriorFolder folder(12);
  folder.write_chunks({1, 8, 0}, ".png", {32, 24});
  const Scene scene = folder.load_priors();
  CHECK(scene.train[7].priors.has("normal"));
  CHECK_FALSE(scene.train[8].priors.has("normal"));
  CHECK_THAT(notes_of(scene), Contains("only the first 8 of 12"));
  CHECK_THAT(notes_of(scene), Contains("prior normal: 67 % of training views"));
}

TEST_CASE("a file missing among the chunks is an error that names it") {
  const PriorFolder folder(10);
  folder.write_chunks({1, 10, 0}, ".png", {32, 24});
  fs::remove(folder.priors() / "images" / "0000.0003.depth.png");
  CHECK_THAT(folder.error({.folder = folder.priors().string()}), Contains("0000.0003.depth.png"));
}

TEST_CASE("an albedo of base colour and metallic is made only where it is asked for") {
  const PriorFolder folder(5);
  folder.write_chunks({1, 5, 0}, ".png", {32, 24});
  const Scene scene =
      folder.load({.folder = folder.priors().string(), .albedo_from_basecolor = true});
  CHECK(scene.train[2].priors["albedo"].at(5, 5, 0) == Approx(0.6f).margin(0.005));
  CHECK(scene.train[2].priors["basecolor"].at(5, 5, 0) == Approx(0.8f).margin(0.003));
  CHECK_THAT(notes_of(scene), Contains("(1 - metallic)"));
}

TEST_CASE("StableNormal's normals beside the pictures are read, in either layout") {
  const PriorFolder folder(6);
  const bool in_folders = GENERATE(false, true);
  for (const View& view : folder.views) {
    const fs::path name =
        in_folders ? fs::path(view.name) / "000000.png" : fs::path(view.name + ".png");
    write_png(
        folder.scene() / "normals" / name,
        encoded(stored_normals(view.truth["normal"], PriorAxes::kStableNormal, view.camera))
    );
  }
  const Scene scene = folder.load();
  check_normals(scene, folder.views, 1);
  CHECK_THAT(notes_of(scene), Contains("stablenormal axes"));
}

TEST_CASE("arrays, floats and 16-bit PNG by name are read, of another size, too") {
  const PriorFolder folder(6);
  for (const View& view : folder.views) {
    const bool array = view.name < "0003";
    const fs::path normal = folder.priors() / "normal" / (view.name + (array ? ".npy" : ".exr"));
    if (array)
      write_npy(normal, view.truth["normal"]);
    else
      write_exr(normal, view.truth["normal"], true);
    const Image half = resize_image(view.truth["depth"], {24, 18});
    if (array)
      write_npy(folder.priors() / "depth" / (view.name + ".npy"), half);
    else
      write_png16(
          folder.priors() / "depth" / (view.name + ".png"), stored_depth(half, PriorDepth::kLinear)
      );
  }
  const Scene scene = folder.load_priors();
  check_normals(scene, folder.views, 0.1);
  CHECK(scene.train[1].priors["depth"].size() == kSize);
  const float z = folder.views[1].truth["depth"].at(10, 18);
  CHECK(scene.train[1].priors["depth"].at(10, 18) == Approx(z).epsilon(0.05));
  CHECK(scene.train[5].priors["depth"].at(10, 18) > 0);
}

TEST_CASE("diffrens/ of the official release is read beside other formats") {
  const PriorFolder folder(4);
  for (const View& view : folder.views)
    write_png(
        folder.scene() / "diffrens/normal" / view.name / "000000.png", encoded(view.truth["normal"])
    );
  const Scene scene = folder.load();
  check_normals(scene, folder.views, 1);
  CHECK_THAT(notes_of(scene), Contains("opencv axes"));
}

TEST_CASE("scene.json says where priors lie and how they are stored") {
  const PriorFolder folder(4);
  for (const View& view : folder.views)
    write_png(
        folder.scene() / "net/normal" / (view.name + ".png"),
        encoded(stored_normals(view.truth["normal"], PriorAxes::kWorld, view.camera))
    );
  const auto state = [&](const Json& json) {
    write_file(folder.scene() / "scene.json", json.dump());
  };
  state({{"prior_folder", "net"}, {"prior_axes", "world"}});
  check_normals(folder.load(), folder.views, 1);
  state({{"prior_folder", "../priors"}});
  CHECK_THAT(folder.error({}), Contains("leaves the scene's folder"));
  state({{"prior_folder", "net"}, {"prior_axes", "sideways"}});
  CHECK_THAT(folder.error({}), Contains("'sideways'; expected auto, opencv"));
}
