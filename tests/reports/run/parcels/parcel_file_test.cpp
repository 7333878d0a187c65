// SPDX-License-Identifier: MIT
#include "reports/run/parcels/parcel_file.h"

#include <catch2/catch.hpp>
#include <cstdlib>

#include "glint/core/rng.h"
#include "glint/scene/image_files.h"
#include "glint/scene/safetensors.h"
#include "reports/run/parcels/find_parcels.h"
#include "reports/run/parcels/make_parcel.h"
#include "reports/run/parcels/model_files.h"
#include "reports/run/parcels/picture_code.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

SurfelCloud some_surfels() {
  Rng rng(1, 2);
  SurfelCloud cloud;
  cloud.extra_names = {"transparency"};
  cloud.resize(40);
  cloud.for_each_array([&](const char*, FloatArray& array, std::size_t) {
    for (float& value : array) value = rng.normal();
  });
  return cloud;
}

Parcel some_parcel() {
  Parcel parcel;
  parcel.record.cell = {"room_1", "glint/plus", 3};
  parcel.record.metrics = {{"psnr", 27.5}};
  parcel.files = {
      {kRecordFile, record_to_json(parcel.record).dump() + "\n"},
      {"config.json", "{}"},
      {"keys/train.json", std::string(5000, 'k')},
      {"renders/0001/rgb.png", "not really"}};
  CompactFile surfels{.name = "interface.ply", .surfels = true, .count = 50};
  surfels.code = pack_surfels(some_surfels(), {.tolerance = 1e-4, .extras = {"transparency"}});
  CompactFile other{.name = "scene_unit.json", .bytes = "{\"scene_unit\": 1}\n"};
  parcel.model = {{surfels, other}, {2e-5, 1e-6}, 1e-4};
  return parcel;
}

// The same header with other metadata, or other bytes of a tensor.
class Edited {
 public:
  explicit Edited(const fs::path& path) : file_(path), path_(path) {
    metadata = file_.metadata();
    for (const std::string& name : file_.names()) {
      tensors[name].resize(file_.find(name)->num_bytes());
      file_.read_bytes(name, tensors[name]);
    }
  }
  void edit_about(const std::function<void(Json&)>& edit) {
    Json about = Json::parse(metadata["about"]);
    edit(about);
    metadata["about"] = about.dump();
    metadata["sha256"] = parcel_hash(metadata["about"]);
  }
  void write() const {
    std::vector<TensorToWrite> list;
    for (const auto& [name, bytes] : tensors)
      list.push_back({name, {TensorType::kU8, {bytes.size()}}, [&bytes = bytes](std::byte* to) {
                        std::copy(bytes.begin(), bytes.end(), to);
                      }});
    write_safetensors(path_, metadata, list);
  }
  std::map<std::string, std::string> metadata;
  std::map<std::string, std::vector<std::byte>> tensors;

 private:
  SafetensorsFile file_;
  fs::path path_;
};

std::string refusal(const fs::path& path) {
  return test::error_of(ExitCode::kBadPrediction, [&] { read_parcel(path); });
}

// What is said of a parcel that was edited.
std::string refusal_of(const std::function<void(Edited&)>& edit) {
  const test::TempFolder folder;
  const fs::path path = folder / "x.parcel";
  write_parcel(path, some_parcel());
  Edited edited(path);
  edit(edited);
  edited.write();
  const std::string message = refusal(path);
  CHECK_THAT(message, Catch::StartsWith(path.string()));
  return message;
}

}  // namespace

TEST_CASE("what is in a parcel comes out of it") {
  const test::TempFolder folder;
  const Parcel parcel = some_parcel();
  const fs::path path = folder / parcel_name(parcel.record.cell);
  CHECK(path.filename() == "room_1+glint+plus+3.parcel");
  write_parcel(path, parcel);
  const Parcel back = read_parcel(path);
  CHECK(back.record.cell == parcel.record.cell);
  CHECK(back.record.metrics == parcel.record.metrics);
  CHECK(back.files == parcel.files);
  CHECK(back.model.difference == parcel.model.difference);
  CHECK(back.model.tolerance == parcel.model.tolerance);
  REQUIRE(back.model.files.size() == 2);
  CHECK(back.model.files[0].bytes == parcel.model.files[1].bytes);
  CHECK(back.model.files[1].code.fields == parcel.model.files[0].code.fields);
  CHECK(back.model.files[1].count == 50);
  CHECK(back.sha256.size() == 64);
  CHECK(read_parcel_record(path).cell == parcel.record.cell);
}

TEST_CASE("a parcel that was cut off or changed anywhere is refused with its name") {
  const test::TempFolder folder;
  const fs::path path = folder / "x.parcel";
  write_parcel(path, some_parcel());
  const std::string whole = read_file(path);
  for (std::size_t bytes = 0; bytes < whole.size(); bytes += whole.size() / 40 + 1) {
    write_file(path, whole.substr(0, bytes));
    CHECK_THAT(refusal(path), Catch::StartsWith(path.string()));
  }
  Rng rng(5, 6);
  std::size_t refused = 0, tries = 300;
  for (std::size_t i = 0; i < tries; ++i) {
    std::string changed = whole;
    const std::size_t at = 8 + rng.below(static_cast<std::uint32_t>(whole.size() - 8));
    changed[at] = static_cast<char>(changed[at] ^ (1 << rng.below(8)));
    write_file(path, changed);
    try {
      read_parcel(path);  // white space between the header and the arrays
    } catch (const Error& error) {
      CHECK(error.code() == ExitCode::kBadPrediction);
      CHECK_THAT(error.what(), Catch::Contains(path.string()));
      ++refused;
    }
  }
  CHECK(refused + 3 >= tries);
}

TEST_CASE("names that leave the folder, hidden ones and those that are there twice are refused") {
  for (const char* name :
       {"../evil", "a/../../evil", "/etc/passwd", "", "a//b", ".hidden/x", "a/."}) {
    INFO(name);
    const std::string message = refusal_of([&](Edited& edited) {
      edited.edit_about([&](Json& about) { about["files"][name] = about["files"]["config.json"]; });
      edited.tensors[std::string("file ") + name] = edited.tensors["file config.json"];
    });
    CHECK_THAT(message, Catch::Contains("its name"));
  }
  CHECK_THAT(
      refusal_of([](Edited& edited) {
        edited.edit_about([](Json& about) {
          about["files"]["interface.ply"] = about["files"]["config.json"];
        });
      }),
      Catch::Contains("there twice")
  );
}

TEST_CASE("counts, sizes and hashes that do not fit are refused, field by field") {
  struct Edit {
    const char *at, *value, *said;  // JSON pointer; "": without it
  };
  const Edit edits[] = {
      {"/files/keys~1train.json/bytes", "5001", "keys/train.json"},
      {"/files/keys~1train.json/bytes", "1152921504606846976", "is said to have"},
      {"/files/keys~1train.json/packed", "", "packed"},
      {"/files/config.json/sha256", "\"0\"", "other bytes"},
      {"/files/record.json", "", "no record.json"},
      {"/files/config.json", "", "says nothing"},
      {"/surfels/interface.ply/code/count", "1073741824", "surfels with"},
      {"/surfels/interface.ply/of", "", "interface.ply"},
      {"/depth/mean_m", "-1", "error of its depth"},
      {"/files", "7", "no list of files"}};
  for (const Edit& edit : edits) {
    INFO(edit.at << " " << edit.value);
    const std::string message = refusal_of([&](Edited& edited) {
      edited.edit_about([&](Json& about) {
        const Json::json_pointer at(edit.at);
        REQUIRE(about.contains(at));
        if (*edit.value != '\0')
          about[at] = Json::parse(edit.value);
        else
          about[at.parent_pointer()].erase(at.back());
      });
    });
    CHECK_THAT(message, Catch::Contains(edit.said));
  }
}

TEST_CASE("pictures come back pixel by pixel, in fewer bytes than PNG has") {
  const test::TempFolder folder;
  Rng rng(7, 8);
  Image picture(160, 90, 3);
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 160; ++x)
      for (int c = 0; c < 3; ++c)
        picture.at(x, y, c) = 0.003f * static_cast<float>(x + y + c) + 0.02f * rng.uniform();
  write_png(folder / "a.png", picture);
  Parcel parcel = some_parcel();
  parcel.files["renders/0001/rgb.png"] = read_file(folder / "a.png");
  write_parcel(folder / "x.parcel", parcel);
  write_file(folder / "b.png", read_parcel(folder / "x.parcel").files.at("renders/0001/rgb.png"));
  const Image before = read_image(folder / "a.png"), after = read_image(folder / "b.png");
  REQUIRE(after.size() == before.size());
  CHECK(std::equal(before.values().begin(), before.values().end(), after.values().begin()));
  const auto code = code_picture(read_file(folder / "a.png"));
  REQUIRE(code);
  CHECK(code->coded.size() < fs::file_size(folder / "a.png"));
  CHECK(!code_picture("no picture"));

  const auto refused = [&](const Json& size) {
    write_parcel(folder / "x.parcel", parcel);
    Edited edited(folder / "x.parcel");
    edited.edit_about([&](Json& about) { about["files"]["renders/0001/rgb.png"]["size"] = size; });
    edited.write();
    return refusal(folder / "x.parcel");
  };
  CHECK_THAT(refused({160, 91, 3}), Catch::Contains("no picture of 160x91"));
  CHECK_THAT(refused({160, 89, 3}), Catch::Contains("no picture of 160x89"));
  CHECK_THAT(refused({90, 160, 3}), Catch::Contains("rgb.png"));
  CHECK_THAT(refused({1 << 20, 1 << 20, 3}), Catch::Contains("with 3 channels"));
  CHECK_THAT(refused({160, 90, 2}), Catch::Contains("with 2 channels"));
  CHECK_THAT(refused({160, 90}), Catch::Contains("rgb.png"));
}

TEST_CASE("other files and newer versions are told apart") {
  CHECK_THAT(
      refusal_of([](Edited& edited) { edited.metadata["format"] = "glint-scene"; }),
      Catch::Contains("no parcel: its format is 'glint-scene'")
  );
  CHECK_THAT(
      refusal_of([](Edited& edited) { edited.metadata["version"] = "2"; }),
      Catch::Contains("version '2'")
  );
  CHECK_THAT(
      refusal_of([](Edited& edited) { edited.metadata["about"] += " "; }),
      Catch::Contains("another hash")
  );
}

TEST_CASE("parcels are found in folders, as files and in archives; what is damaged is named") {
  const test::TempFolder folder;
  Parcel parcel = some_parcel();
  const auto put = [&](const std::string& scene) {
    parcel.record.cell.scene = scene;
    parcel.files[kRecordFile] = record_to_json(parcel.record).dump();
    write_parcel(folder / "parcels" / parcel_name(parcel.record.cell), parcel);
  };
  put("room_1");
  put("room_2");
  write_file(folder / "parcels/broken.parcel", "half");
  write_file(folder / "parcels/notes.txt", "none of ours");
  const auto found = [&](const fs::path& path, std::vector<LostParcel>& lost) {
    std::vector<std::string> scenes;
    lost = for_each_parcel(path, [&](const Parcel& one, const std::string&) {
      scenes.push_back(one.record.cell.scene);
    });
    return scenes;
  };
  const std::vector<std::string> both = {"room_1", "room_2"};
  std::vector<LostParcel> lost;
  CHECK(holds_parcels(folder / "parcels"));
  CHECK(!holds_parcels(folder.path()));
  CHECK(found(folder / "parcels", lost) == both);
  REQUIRE(lost.size() == 1);
  CHECK_THAT(lost[0].file, Catch::Contains("broken.parcel"));
  CHECK(found(folder / "parcels/room_2+glint+plus+3.parcel", lost).size() == 1);

  const fs::path archive = folder / "results.tar";
  const std::string command =
      fmt::format("tar --sort=name -cf {} -C {} parcels", archive.string(), folder.path().string());
  REQUIRE(std::system(command.c_str()) == 0);
  CHECK(found(archive, lost) == both);
  CHECK(lost.size() == 1);
  const std::string bytes = read_file(archive);
  write_file(archive, bytes.substr(0, bytes.find("parcels/room_2") + 1000));
  CHECK(found(archive, lost) == std::vector<std::string>{"room_1"});
  REQUIRE(lost.size() == 2);
  CHECK_THAT(lost[1].why, Catch::StartsWith("cut off in parcels/room_2+glint+plus+3.parcel"));
  const std::string other =
      test::error_of(ExitCode::kBadPrediction, [&] { found(folder / "parcels/notes.txt", lost); });
  CHECK_THAT(other, Catch::Contains("neither a parcel"));
}

TEST_CASE("a long log is thinned, with its ends and its events") {
  std::string log;
  for (int i = 0; i < 1000; ++i)
    log += fmt::format("{{\"iteration\": {}{}}}\n", i, i == 501 ? ", \"events\": []" : "");
  const std::string thin = thinned_log(log, 100);
  CHECK(std::count(thin.begin(), thin.end(), '\n') == 102);
  CHECK_THAT(thin, Catch::StartsWith("{\"iteration\": 0}"));
  CHECK_THAT(thin, Catch::Contains("501"));
  CHECK_THAT(thin, Catch::EndsWith("{\"iteration\": 999}\n"));
  CHECK(thinned_log("", 100).empty());
}
