// SPDX-License-Identifier: MIT
// Furniture as glTF, read by assimp: text, and binary with its JSON in the first chunk.
#include "datasets/glassroom/import_model.h"
#include "tests/fuzz/fuzz_target.h"

namespace glint::fuzz {
namespace {

bool read(std::string_view bytes) {
  const fs::path folder = input_folder() / "assets";
  fs::remove_all(folder);
  fs::create_directories(folder);
  const fs::path file = folder / (bytes.starts_with("glTF") ? "sofa.glb" : "sofa.gltf");
  input_file(bytes, file);
  return accepts([&] {
    TraceScene scene;
    import_model(file, scene);
  });
}

// One triangle; `uri`: of the buffer, where that is not the file's own.
std::string json_of(const std::string& uri) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"scale":[2,1,1]}],)"
         R"("materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.4,0.3,1]}}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],"buffers":[{)" +
         uri +
         R"("byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,)"
         R"("componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]})";
}

std::string integer(std::size_t value) {
  std::string bytes;
  for (int i = 0; i < 4; ++i, value >>= 8) bytes += static_cast<char>(value & 0xff);
  return bytes;
}

std::string binary() {
  std::string json = json_of("");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::string values(reinterpret_cast<const char*>(corners), sizeof corners);
  const std::string chunks = integer(json.size()) + "JSON" + json + integer(values.size()) +
                             std::string("BIN\0", 4) + values;
  return "glTF" + integer(2) + integer(12 + chunks.size()) + chunks;
}

std::vector<FuzzInput> seeds() {
  return {
      {"text",
       json_of(
           R"("uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA",)"
       )},
      {"binary", binary()}};
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"gltf", read, seeds})

}  // namespace glint::fuzz
