// SPDX-License-Identifier: MIT
// The two files of one house, whole or changed; and a model made here.
#pragma once

#include "datasets/front3d/house.h"
#include "glint/core/config.h"
#include "glint/core/files.h"

namespace glint::test {

inline const fs::path kFlatHouse = "tests/datasets/front3d/house_flat.json";
inline const fs::path kRowsHouse = "tests/datasets/front3d/house_rows.json";
inline const char* const kLivingRoom = "LivingDiningRoom-2";
inline const char* const kBedroom = "MasterBedroom-1";

inline Json flat_house() { return Json::parse(read_file(kFlatHouse)); }

inline fs::path written(const fs::path& file, const Json& house) {
  write_file(file, house.dump());
  return file;
}

// Element of a list with that uid.
inline Json& entry(Json& house, const char* list, const std::string& uid) {
  for (Json& item : house[list])
    if (item["uid"] == uid) return item;
  throw std::logic_error("no " + uid);
}
inline const HouseMesh& mesh_of(const House& house, const std::string& uid) {
  for (const HouseMesh& mesh : house.meshes)
    if (mesh.uid == uid) return mesh;
  throw std::logic_error("no mesh " + uid);
}

// A wedge, 2 m wide, 0.8 m high, 0.9 m deep as the sofa's size says; y up; its own folder below
// `models`, with `material` as its .mtl.
inline void write_sofa(const fs::path& models, const std::string& material = "") {
  const fs::path folder = models / "sofa-with-a-model";
  write_file(
      folder / "raw_model.obj",
      "mtllib model.mtl\nusemtl cloth\n"
      "v -1 0 -0.45\nv 1 0 -0.45\nv 1 0 0.45\nv -1 0 0.45\nv -1 0.8 -0.45\nv 1 0.8 -0.45\n"
      "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
      "f 4/1 3/2 6/3 5/4\nf 1/1 5/2 6/3 2/4\nf 1/1 2/2 3/3 4/4\nf 1/1 4/2 5/3\nf 2/1 6/2 3/3\n"
  );
  write_file(folder / "model.mtl", "newmtl cloth\nKd 0.7 0.2 0.1\nKe 9 9 9\n" + material);
}

}  // namespace glint::test
