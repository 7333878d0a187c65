// SPDX-License-Identifier: MIT
// Houses of 3D-FRONT: JSON; and models of furniture as OBJ, read by assimp.
#include "datasets/front3d/house.h"
#include "datasets/front3d/house_room.h"
#include "datasets/glassroom/import_model.h"
#include "tests/fuzz/fuzz_target.h"

namespace glint::fuzz {
namespace {

bool read_json(std::string_view bytes) {
  const fs::path file = input_file(bytes, "house.json");
  return accepts([&] {
    const House house = read_house(file);
    const HouseRoom& room = choose_room(house, "", file);
    const FurnishedRoom furnished = furnish_house_room(house, room, {}, file.string());
    furnished.plan.free_spots();
  });
}

// A floor of 2 x 3 m with a window in its wall, and a box on it. `list`: of numbers, or of rows.
std::string house_of(const std::string& floor, const std::string& window, const std::string& size) {
  return R"({"uid":"h","furniture":[{"uid":"p","jid":"j","valid":true,"category":"Sofa",)" + size +
         R"(}],"mesh":[{"uid":"f","type":"Floor ","material":"m","uv":[0,0,null,0,1,1,0,1],"xyz":)" +
         floor + R"(,"faces":[0,1,2,0,2,3]},{"uid":"w","type":"Window","xyz":)" + window +
         R"(,"faces":[0,1,2]}],"material":[{"uid":"m","color":[9,9,9,255],"UVTransform":[1,0,0,0,1,0,0,0,1]}],)"
         R"("scene":{"room":[{"type":"Library","instanceid":"r","children":[{"ref":"f"},{"ref":"w"},)"
         R"({"ref":"p","pos":[1,0,1],"rot":[0,0.7,0,0.7],"scale":[1,1,1]},{"ref":"nothing"}]}]}})";
}

std::vector<FuzzInput> house_seeds() {
  return {
      {"flat",
       house_of("[0,0,0,2,0,0,2,0,3,0,0,3]", "[0,1,1,0,1,2,0,2,2]", R"("size":[0.5,0.5,0.5])")},
      {"rows",
       house_of(
           "[[0,0,0],[2,0,0],[2,0,3],[0,0,3]]",
           "[[0,1,1],[0,1,2],[0,2,2]]",
           R"("bbox":{"min":[-0.2,0,-0.2],"max":[0.2,0.5,0.2]})"
       )}};
}

bool read_obj(std::string_view bytes) {
  const fs::path file = input_file(bytes, "raw_model.obj");
  return accepts([&] {
    TraceScene scene;
    import_model(file, scene);
  });
}

std::vector<FuzzInput> obj_seeds() {
  return {
      {"triangle", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
      {"quad",
       "mtllib model.mtl\no chair\ng seat\nusemtl cloth\ns 1\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
       "vn 0 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1/1 2/2/1 3/3/1 4/4/1\nf -4//-1 -3//-1 "
       "-2//-1\n"}};
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"front3d", read_json, house_seeds})
GLINT_REGISTER(FuzzTarget, {"obj", read_obj, obj_seeds})

}  // namespace glint::fuzz
