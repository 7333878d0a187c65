// SPDX-License-Identifier: MIT
// The shape of the source tree: no include points up the layers, no type stands twice, no file and
// no function is too long.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cctype>
#include <map>
#include <sstream>
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

// The libraries of reports/ and which of them each may include beside itself, all that lies below
// reports/ besides.
struct ReportsFolder {
  const char *name, *may_include;
};
constexpr ReportsFolder kReports[] = {
    {"run/records", ""},
    {"show/tables", "run/records"},
    {"show/pictures", "run/records"},
    {"run/bench", "run/records show/pictures"},
    {"run/parcels", "run/records show/pictures run/bench"},
    {"run/executors", "run/records run/bench"},
    {"run/provenance", "run/records show/pictures run/bench"},
    {"run/import", "run/records show/pictures run/bench"},
    {"run/perf", "run/records"},
    {"run/selftest", "run/records run/bench run/import"},
    {"show/page", "run/records show/tables show/pictures"},
    {"show/viewer", "run/records show/pictures run/bench"},
    {"show/board", "run/records show/tables show/page"},
    {"show/figures", "run/records show/tables show/pictures run/bench show/page run/perf"},
    {"verbs",
     "run/records show/tables show/pictures run/bench run/parcels run/executors run/provenance "
     "run/import run/perf run/selftest show/page show/board show/viewer show/figures"}};

std::vector<Layer> layers_of_reports() {
  std::vector<Layer> all;
  for (const auto& [name, may_include] : kReports) {
    Layer layer{
        fmt::format("reports/{}/", name), {"glint/", "metrics/", "baselines/", "datasets/"}};
    layer.may_include.push_back(layer.path);
    std::istringstream words(may_include);
    for (std::string word; words >> word;) layer.may_include.push_back("reports/" + word + "/");
    all.push_back(std::move(layer));
  }
  return all;
}

const std::vector<Layer>& layers() {
  static const std::vector<Layer> all = [] {
    std::vector<Layer> layers = {
        {"glint/core/", {"glint/core/"}},
        {"glint/scene/", {"glint/core/", "glint/scene/"}},
        {"glint/render/", {"glint/core/", "glint/scene/", "glint/render/"}},
        {"glint/cuda/",
         {"glint/core/",
          "glint/scene/",
          "glint/render/",
          "glint/train/",
          "glint/cuda/",
          "kernel_lists.h"}},                                 // made by the build from *_kernels.h
        {"glint/method.h", {"glint/core/", "glint/scene/"}},  // what the trainer drives
        {"glint/train/",
         {"glint/core/",
          "glint/scene/",
          "glint/render/",
          "glint/train/",
          "glint/method.h",
          "metrics/"}},
        {"glint/", {"glint/", "metrics/"}},
        {"glint/drawing/", {"glint/core/", "glint/scene/", "glint/drawing/"}},
        {"metrics/",
         {"glint/core/",
          "glint/scene/layer_maps.h",
          "glint/scene/maps.h",
          "glint/scene/safetensors.h",
          "glint/render/ssim_formula.h",
          "metrics/"}},
        {"metrics/mesh/", {"glint/core/", "glint/scene/camera.h", "metrics/"}},
        {"metrics/fusion/",
         {"glint/core/", "glint/scene/camera.h", "metrics/mesh/", "metrics/fusion/"}},
        {"metrics/tools/",
         {"glint/core/", "glint/scene/", "glint/drawing/", "metrics/", "datasets/"}},
        {"baselines/",
         {"glint/",
          "metrics/",
          "baselines/deferred/",
          "baselines/planar/"}},  // and a method's own kernels
        {"baselines/deferred/", {"glint/", "baselines/deferred/"}},
        {"baselines/planar/", {"glint/", "baselines/deferred/", "baselines/planar/"}},
        {"datasets/", {"glint/core/", "glint/scene/", "datasets/"}},
        {"datasets/glassroom/", {"glint/core/", "glint/scene/", "glint/drawing/", "datasets/"}},
        {"reports/run/code/", {"glint/core/", "reports/run/code/"}},
        {"reports/glint_bench.cpp", {"glint/core/", "reports/verbs/"}},
        {"python/", {"glint/", "metrics/", "datasets/", "reports/", "python/"}},
        {"tests/", {"glint/", "metrics/", "baselines/", "datasets/", "reports/", "tests/"}}};
    for (Layer& layer : layers_of_reports()) layers.push_back(std::move(layer));
    return layers;
  }();
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
  for (auto folder : {"glint", "metrics", "baselines", "datasets", "reports", "python", "tests"})
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

// baselines/x.cpp has its kernels in baselines/x_kernels.h.
bool is_own_kernels(const std::string& path, const std::string& include) {
  return path.starts_with("baselines/") && path.ends_with(".cpp") &&
         include == path.substr(0, path.size() - 4) + "_kernels.h";
}

std::vector<std::string> upward_includes(const SourceFile& file) {
  const Layer* layer = layer_of(file.path);
  std::vector<std::string> wrong;
  for (const std::string& include : quoted_includes(file.text))
    if (layer == nullptr ||
        !(starts_with_any(include, layer->may_include) || is_own_kernels(file.path, include)))
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

// Functions that start programs, where they are called.
std::vector<std::string> called_words(std::string_view text) {
  const std::string code = code_only(text);
  std::vector<std::string> called;
  for (const char* word :
       {"system",
        "popen",
        "wordexp",
        "fork",
        "vfork",
        "execl",
        "execle",
        "execlp",
        "execv",
        "execve",
        "execvp",
        "execvpe",
        "posix_spawn",
        "posix_spawnp"})
    for (std::size_t at = 0; (at = code.find(word, at)) != std::string::npos; ++at) {
      const std::size_t end = code.find_first_not_of(' ', at + std::string_view(word).size());
      const bool call = end != std::string::npos && code[end] == '(';
      if (call && has_word(std::string_view(code).substr(at > 0 ? at - 1 : 0, end - at + 2), word))
        called.emplace_back(word);
    }
  return called;
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

// What a brace opens: a named namespace, a type, or anything else (functions, values, blocks).
struct Scope {
  enum Kind { kNamespace, kType, kOther } kind = kOther;
  std::string name;  // of a namespace: empty when it has none
};

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \n");
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \n") - first + 1));
}

// The last word of a head without base classes: "SurfelBvh::Impl" of "class SurfelBvh::Impl :
// public Base"; a specialisation keeps its arguments, so that it is another type.
std::string type_name(std::string_view head) {
  std::size_t colon = std::string_view::npos;
  for (std::size_t i = 0; i < head.size() && colon == std::string_view::npos; ++i) {
    const bool twice = head[i] == ':' && i + 1 < head.size() && head[i + 1] == ':';
    if (twice) ++i;
    if (head[i] == ':' && !twice) colon = i;
  }
  std::string name = trimmed(head.substr(0, colon));
  if (name.ends_with(" final")) name = trimmed(name.substr(0, name.size() - 6));
  const std::size_t arguments = name.find('<');
  return trimmed(name.substr(name.find_last_of(" \n", arguments) + 1));
}

Scope scope_of(std::string_view head) {
  const std::string text = trimmed(head);
  if (has_word(text, "namespace")) {
    const std::string name = trimmed(std::string_view(text).substr(text.find("namespace") + 9));
    return {Scope::kNamespace, name};
  }
  std::string_view rest = text;  // behind "template <...>"
  if (rest.starts_with("template")) {
    std::size_t at = rest.find('<'), depth = 0;
    for (; at < rest.size(); ++at) {
      if (rest[at] == '<') ++depth;
      if (rest[at] == '>' && --depth == 0) break;
    }
    rest = rest.substr(std::min(at + 1, rest.size()));
  }
  const std::string type = trimmed(rest);
  for (const char* word : {"struct ", "class ", "enum ", "union "})
    if (type.starts_with(word) && type.find('(') == std::string::npos)
      return {Scope::kType, type_name(type)};
  return {};
}

// "a::B::C" of every type with a name that other files can say: none in functions, none in
// namespaces without a name.
std::vector<std::string> types_of(std::string_view text) {
  const std::string code = code_only(text);
  std::vector<Scope> scopes;
  std::vector<std::string> types;
  std::size_t head_start = 0;
  for (std::size_t i = 0; i < code.size(); ++i) {
    if (code[i] == '{') {
      scopes.push_back(scope_of(std::string_view(code).substr(head_start, i - head_start)));
      const bool named = std::all_of(scopes.begin(), scopes.end(), [](const Scope& scope) {
        return scope.kind != Scope::kOther && !scope.name.empty();
      });
      if (named && scopes.back().kind == Scope::kType) {
        std::string name;
        for (const Scope& scope : scopes) name += (name.empty() ? "" : "::") + scope.name;
        types.push_back(std::move(name));
      }
    } else if (code[i] == '}' && !scopes.empty()) {
      scopes.pop_back();
    }
    if (code[i] == '{' || code[i] == '}' || code[i] == ';') head_start = i + 1;
  }
  return types;
}

// Two implementations of one interface, of which a program links one: they share their types'
// names.
bool are_alternatives(const std::string& a, const std::string& b) {
  return a == "glint/render/trace_embree.cpp" && b == "glint/render/trace_tree.cpp";
}

// "type: file and file" of types that stand in two files.
std::vector<std::string> types_defined_twice(const std::vector<SourceFile>& files) {
  std::map<std::string, std::string> place_of;
  std::vector<std::string> twice;
  for (const SourceFile& file : files)
    for (const std::string& type : types_of(file.text)) {
      const auto [place, fresh] = place_of.emplace(type, file.path);
      if (!fresh && !are_alternatives(place->second, file.path))
        twice.push_back(fmt::format("{}: {} and {}", type, place->second, file.path));
    }
  return twice;
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

TEST_CASE("No type is defined under one name in two places") {
  const std::vector<SourceFile> files = source_files();
  const std::vector<std::string> twice = types_defined_twice(files);
  INFO(joined(twice));
  CHECK(twice.empty());
  std::size_t seen = 0;
  for (const SourceFile& file : files) seen += types_of(file.text).size();
  CHECK(seen > 200);
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

// What a lean build does without stays in files of libraries that it leaves out (NEEDS in CMake).
TEST_CASE(
    "Only optional libraries meet OpenCV, cairo, Open3D, CGAL, Embree, Bullet, assimp, yaml-cpp, "
    "oneDNN and Boost"
) {
  const std::vector<std::string> optional = {
      "datasets/camera_yaml.cpp",
      "datasets/glassroom/",
      "datasets/known_surfaces.cpp",
      "datasets/undistort.cpp",
      "glint/drawing/",
      "glint/render/trace_embree.cpp",
      "glint/scene/image_files_resize.cpp",
      "glint/scene/model_files.cpp",
      "metrics/feature_net_onednn.cpp",
      "metrics/fusion/clusters.cpp",
      "metrics/fusion/tsdf_open3d.cpp",
      "metrics/mesh/",
      "metrics/tools/mesh",
      "reports/show/figures/",
      "reports/show/viewer/web_server_beast.cpp"};
  std::size_t heavy = 0;
  for (const SourceFile& file : source_files()) {
    if (starts_with_any(file.path, {"tests/"})) continue;
    std::istringstream libraries(
        "opencv2/ cairo pango/ open3d/ CGAL/ embree3/ bt assimp/ yaml-cpp/ oneapi/ boost/"
    );
    for (std::string library; libraries >> library;) {
      if (file.text.find(fmt::format("\n#include <{}", library)) == std::string::npos) continue;
      ++heavy;
      INFO(file.path << " includes <" << library);
      CHECK(starts_with_any(file.path, optional));
    }
  }
  CHECK(heavy >= 8);
}

// A file name is never text of a command: programs are started by their words, in one place.
TEST_CASE("No source but one starts programs, and none by a shell") {
  CHECK(called_words("x = std::system(c); FILE* f = ::popen (c, m);").size() == 2);
  CHECK(called_words("std::system_error(e); system = 1; // system(x)\n\"popen(\"").empty());
  for (const SourceFile& file : source_files()) {
    if (starts_with_any(file.path, {"tests/", "reports/run/bench/child_process.cpp"})) continue;
    INFO(file.path);
    CHECK(called_words(file.text) == std::vector<std::string>());
  }
  CHECK(
      called_words(read_file("reports/run/bench/child_process.cpp")) ==
      std::vector<std::string>{"fork", "execvp"}
  );
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
  CHECK(wrong("baselines/envgs.cpp", "#include \"baselines/envgs_kernels.h\"\n") == 0);
  CHECK(wrong("baselines/envgs.cpp", "#include \"baselines/2dgs_kernels.h\"\n") == 1);
  CHECK(wrong("reports/run/records/records.h", "#include \"reports/run/bench/plan.h\"\n") == 1);
  CHECK(wrong("reports/show/tables/tables.h", "#include \"reports/show/pictures/strip.h\"\n") == 1);
  CHECK(wrong("reports/run/bench/runner.h", "#include \"reports/show/page/page.h\"\n") == 1);
  CHECK(wrong("reports/show/page/page.h", "#include \"reports/show/figures/chart.h\"\n") == 1);
  CHECK(wrong("reports/show/figures/chart.h", "#include \"reports/verbs/verb.h\"\n") == 1);
  CHECK(wrong("reports/verbs/verb.h", "#include \"reports/run/bench/plan.h\"\n") == 0);
  CHECK(wrong("reports/loose.h", "#include \"glint/core/real.h\"\n") == 1);
  CHECK(wrong("unknown/file.h", "#include \"glint/core/real.h\"\n") == 1);
}

TEST_CASE("The check finds types and where they stand twice") {
  const std::string text = R"(
namespace a::b {
// struct Comment {};
struct Plain { enum class Inner { kOne }; };
template <class T, class U = Box<T>>
class Template final : public other::Base<T> {};
template <>
struct Template<int> {};
struct Declared;
namespace {
struct Local {};
}
void f() { struct InFunction {}; }
struct Owner::Impl : Base {};
const struct Plain value{};
}
)";
  CHECK(
      types_of(text) ==
      std::vector<std::string>{
          "a::b::Plain",
          "a::b::Plain::Inner",
          "a::b::Template",
          "a::b::Template<int>",
          "a::b::Owner::Impl"}
  );
  const SourceFile one{"x.cpp", "namespace a { struct B {}; }"};
  const auto twice_with = [&](const char* path, const char* other) {
    return types_defined_twice({one, {path, other}}).size();
  };
  CHECK(twice_with("y.h", "namespace a {\nenum class B { kOne };\n}") == 1);
  CHECK(twice_with("y.cpp", "namespace a { struct B {}; }") == 1);
  CHECK(twice_with("y.h", "namespace a { namespace { struct B {}; } }") == 0);
  CHECK(twice_with("y.h", "namespace b { struct B {}; }") == 0);
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
