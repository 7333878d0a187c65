// SPDX-License-Identifier: MIT
// The shape of the source tree: no include points up the layers, no file and no function is too
// long.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cctype>
#include <string>
#include <vector>

#include "glint/core/error.h"
#include "glint/core/files.h"

using namespace glint;

namespace {

constexpr std::size_t kMaxFileLines = 600;
constexpr std::size_t kMaxFunctionLines = 60;
constexpr std::size_t kMaxKernelLines = 100;  // CUDA kernels: fetch, loop, call, store

// What files may include, by the beginning of their path; the longest that fits decides.
struct Layer {
  std::string path;
  std::vector<std::string> may_include;
};
const std::vector<Layer>& layers() {
  static const std::vector<Layer> all = {
      {"glint/core/", {"glint/core/"}},
      {"glint/scene/", {"glint/core/", "glint/scene/"}},
      {"glint/render/", {"glint/core/", "glint/scene/", "glint/render/"}},
      {"glint/cuda/",
       {"glint/core/",
        "glint/scene/",
        "glint/render/",
        "glint/train/",
        "glint/cuda/",
        "metrics/ssim_formula.h"}},
      {"glint/method.h", {"glint/core/", "glint/scene/"}},  // what the trainer drives
      {"glint/train/",
       {"glint/core/",
        "glint/scene/",
        "glint/render/",
        "glint/train/",
        "glint/method.h",
        "metrics/"}},
      {"glint/", {"glint/", "metrics/"}},
      {"metrics/", {"glint/core/", "metrics/"}},
      {"metrics/mesh/", {"glint/core/", "glint/scene/camera.h", "metrics/"}},
      {"metrics/fusion/",
       {"glint/core/", "glint/scene/camera.h", "metrics/mesh/", "metrics/fusion/"}},
      {"metrics/tools/", {"glint/core/", "glint/scene/", "metrics/", "datasets/"}},
      {"baselines/", {"glint/", "metrics/"}},
      {"datasets/", {"glint/core/", "glint/scene/", "datasets/"}},
      {"reports/", {"glint/", "metrics/", "baselines/", "datasets/", "reports/"}},
      {"tests/", {"glint/", "metrics/", "baselines/", "datasets/", "reports/", "tests/"}}};
  return all;
}

bool starts_with_any(std::string_view text, const std::vector<std::string>& prefixes) {
  return std::any_of(prefixes.begin(), prefixes.end(), [&](const std::string& prefix) {
    return text.substr(0, prefix.size()) == prefix;
  });
}

const Layer* layer_of(std::string_view path) {
  const Layer* best = nullptr;
  for (const Layer& layer : layers())
    if (starts_with_any(path, {layer.path}) &&
        (best == nullptr || layer.path.size() > best->path.size()))
      best = &layer;
  return best;
}

struct SourceFile {
  std::string path;  // relative to the root, '/' between parts
  std::string text;
};

std::vector<SourceFile> source_files() {
  std::vector<SourceFile> files;
  for (const char* folder : {"glint", "metrics", "baselines", "datasets", "reports", "tests"})
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension == ".h" || extension == ".cpp" || extension == ".cu" || extension == ".cuh")
        files.push_back({entry.path().generic_string(), read_file(entry.path())});
    }
  std::sort(files.begin(), files.end(), [](const SourceFile& a, const SourceFile& b) {
    return a.path < b.path;
  });
  return files;
}

// Project files named by #include "...".
std::vector<std::string> quoted_includes(std::string_view text) {
  std::vector<std::string> includes;
  constexpr std::string_view kOpening = "#include \"";
  for (std::size_t at = 0; (at = text.find(kOpening, at)) != std::string_view::npos;) {
    const bool line_start = at == 0 || text[at - 1] == '\n';
    at += kOpening.size();
    if (line_start) includes.emplace_back(text.substr(at, text.find('"', at) - at));
  }
  return includes;
}

std::vector<std::string> upward_includes(const SourceFile& file) {
  const Layer* layer = layer_of(file.path);
  std::vector<std::string> wrong;
  for (const std::string& include : quoted_includes(file.text))
    if (layer == nullptr || !starts_with_any(include, layer->may_include))
      wrong.push_back(file.path + " includes " + include);
  return wrong;
}

// The end (one past) of the comment or literal that opens at `i`; `i` itself if none does.
std::size_t end_of_inert(std::string_view text, std::size_t i) {
  const auto after = [&](std::string_view closing, std::size_t from) {
    const std::size_t found = text.find(closing, from);
    return found == std::string_view::npos ? text.size() : found + closing.size();
  };
  const std::string_view here = text.substr(i);
  if (here.substr(0, 2) == "//")
    return text.find('\n', i) + 1 == 0 ? text.size() : text.find('\n', i);
  if (here.substr(0, 2) == "/*") return after("*/", i + 2);
  if (here.substr(0, 2) == "R\"") {
    const std::size_t open = text.find('(', i);
    return after(fmt::format("){}\"", text.substr(i + 2, open - i - 2)), open);
  }
  const bool digit_separator =
      i > 0 && here[0] == '\'' && std::isxdigit(static_cast<unsigned char>(text[i - 1])) != 0;
  if ((here[0] != '"' && here[0] != '\'') || digit_separator) return i;
  std::size_t end = i + 1;
  while (end < text.size() && text[end] != here[0]) end += text[end] == '\\' ? 2 : 1;
  return std::min(end + 1, text.size());
}

// Comments, literals and preprocessor lines as blanks; line ends stay.
std::string code_only(std::string_view text) {
  std::string code(text);
  const auto blank = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (code[i] != '\n') code[i] = ' ';
  };
  bool line_start = true;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = end_of_inert(text, i);
    if (line_start && text[i] == '#') {
      end = i;
      do end = std::min(text.find('\n', end + 1), text.size());
      while (end < text.size() && text[end - 1] == '\\');
    }
    if (end > i) {
      blank(i, end);
      i = end;
      continue;
    }
    line_start = text[i] == '\n' || (line_start && text[i] == ' ');
    ++i;
  }
  return code;
}

bool has_word(std::string_view text, std::string_view word) {
  const auto is_letter = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
  };
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string_view::npos; ++at) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !is_letter(text[at - 1])) && (end == text.size() || !is_letter(text[end])))
      return true;
  }
  return false;
}

// Does a brace behind this text open a function's body (and not a class, namespace or value)?
bool opens_function(std::string_view head) {
  for (const char* word : {"namespace", "class", "struct", "enum", "union"})
    if (has_word(head, word) && head.find('(') == std::string_view::npos) return false;
  const std::size_t parenthesis = head.find('(');
  return parenthesis != std::string_view::npos && head.find('=') > parenthesis;
}

struct Function {
  std::string head;  // what stands before the body
  std::size_t first_line = 0, num_lines = 0;
};

// Outermost bodies by matching braces.
std::vector<Function> functions_of(std::string_view text) {
  const std::string code = code_only(text);
  std::vector<Function> functions;
  std::size_t head_start = 0, line = 1, head_line = 1;
  int depth = 0, function_depth = -1;
  for (std::size_t i = 0; i < code.size(); ++i) {
    if (code[i] == '\n') ++line;
    if (code[i] == '{') {
      const std::string_view head = std::string_view(code).substr(head_start, i - head_start);
      if (function_depth < 0 && opens_function(head)) {
        function_depth = depth;
        functions.push_back({std::string(head), head_line, 0});
      }
      ++depth;
    } else if (code[i] == '}') {
      if (--depth == function_depth) {
        functions.back().num_lines = line - functions.back().first_line + 1;
        function_depth = -1;
      }
    }
    if (code[i] == '{' || code[i] == '}' || code[i] == ';') head_start = i + 1;
    const std::string_view head = std::string_view(code).substr(head_start, i + 1 - head_start);
    if (head.find_first_not_of(" \n") == std::string_view::npos) head_line = line;
  }
  return functions;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

}  // namespace

TEST_CASE("No file includes a header of a higher layer") {
  std::vector<std::string> wrong;
  for (const SourceFile& file : source_files())
    for (std::string& line : upward_includes(file)) wrong.push_back(std::move(line));
  INFO(joined(wrong));
  CHECK(wrong.empty());
}

TEST_CASE("No file is longer than 600 lines") {
  for (const SourceFile& file : source_files()) {
    INFO(file.path);
    CHECK(
        std::count(file.text.begin(), file.text.end(), '\n') <=
        static_cast<std::ptrdiff_t>(kMaxFileLines)
    );
  }
}

TEST_CASE("No function is longer than 60 lines") {
  std::vector<std::string> wrong;
  std::size_t seen = 0;
  for (const SourceFile& file : source_files())
    for (const Function& function : functions_of(file.text)) {
      ++seen;
      const bool kernel = has_word(function.head, "__global__");
      if (function.num_lines > (kernel ? kMaxKernelLines : kMaxFunctionLines))
        wrong.push_back(
            fmt::format("{}:{}: {} lines", file.path, function.first_line, function.num_lines)
        );
    }
  INFO(joined(wrong));
  CHECK(wrong.empty());
  CHECK(seen > 200);
}

// What a lean build does without stays in the files of libraries that it leaves out (NEEDS in their
// CMakeLists.txt): nothing else would build there.
TEST_CASE("Only optional libraries meet OpenCV, Open3D, CGAL, Embree, Bullet, assimp and oneDNN") {
  const std::vector<std::string> optional = {
      "datasets/glassroom/",
      "datasets/opencv_yaml.cpp",
      "datasets/undistort.cpp",
      "glint/render/trace_embree.cpp",
      "glint/scene/image_files_resize.cpp",
      "glint/scene/image_files_text.cpp",
      "metrics/feature_net_onednn.cpp",
      "metrics/fusion/clusters.cpp",
      "metrics/fusion/tsdf_open3d.cpp",
      "metrics/mesh/",
      "metrics/npz.cpp",
      "metrics/tools/mesh",
      "reports/figures/"};
  std::size_t heavy = 0;
  for (const SourceFile& file : source_files()) {
    if (starts_with_any(file.path, {"tests/"})) continue;
    for (const char* library :
         {"opencv2/", "open3d/", "CGAL/", "embree3/", "bt", "assimp/", "oneapi/", "minizip/"}) {
      if (file.text.find(fmt::format("\n#include <{}", library)) == std::string::npos) continue;
      ++heavy;
      INFO(file.path << " includes <" << library);
      CHECK(starts_with_any(file.path, optional));
    }
  }
  CHECK(heavy >= 8);
}

TEST_CASE("The check finds an include that points upwards") {
  const auto wrong = [](const char* path, const char* text) {
    return upward_includes({path, text}).size();
  };
  CHECK(wrong("glint/core/vec.h", "#include \"glint/core/real.h\"\n#include <cmath>\n") == 0);
  CHECK(wrong("glint/core/vec.h", "\n#include \"glint/scene/camera.h\"\n") == 1);
  CHECK(wrong("metrics/ssim.h", "#include \"glint/scene/camera.h\"\n") == 1);
  CHECK(wrong("metrics/mesh/cull.h", "#include \"glint/scene/camera.h\"\n") == 0);
  CHECK(wrong("metrics/mesh/cull.h", "#include \"glint/scene/ply.h\"\n") == 1);
  CHECK(wrong("metrics/tools/ssim_tool.cpp", "#include \"glint/scene/image_files.h\"\n") == 0);
  CHECK(wrong("baselines/envgs.cpp", "#include \"baselines/2dgs.h\"\n") == 1);
  CHECK(wrong("unknown/file.h", "#include \"glint/core/real.h\"\n") == 1);
}

TEST_CASE("The check finds functions and their lengths") {
  const std::vector<Function> functions = functions_of(R"(
// void comment() {
namespace a {
struct B : public C {
  int x{};
  int f() const { return 1; }
};
const char* text = "{ (";
constexpr int values[] = {1, 2};
template <class T>
void g(
    T value
) {
  if (value) {
    h('{', 1'000);
  }
}
}  // namespace a
)");
  REQUIRE(functions.size() == 2);
  CHECK(functions[0].first_line == 6);
  CHECK(functions[0].num_lines == 1);
  CHECK(functions[1].first_line == 10);
  CHECK(functions[1].num_lines == 8);
}
