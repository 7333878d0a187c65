// SPDX-License-Identifier: MIT
#include "datasets/camera_yaml.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <sstream>
#include <vector>

#include "glint/core/error.h"

namespace glint {
namespace {

using nlohmann::json;

constexpr std::size_t kDeepest = 50;  // files of cameras have three

// Numbers where a number stands, text else.
json scalar_of(std::string_view text) {
  const std::string_view digits = text.substr(text.starts_with('+') ? 1 : 0);
  const std::string_view unsigned_text = digits.substr(digits.starts_with('-') ? 1 : 0);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (unsigned_text == ".Inf" || unsigned_text == ".inf")
    return digits.starts_with('-') ? -kInfinity : kInfinity;
  if (text == ".Nan" || text == ".NaN" || text == ".nan")
    return std::numeric_limits<double>::quiet_NaN();
  const bool may_be_number =
      !unsigned_text.empty() &&
      (unsigned_text[0] == '.' || (unsigned_text[0] >= '0' && unsigned_text[0] <= '9'));
  double value = 0;
  const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (may_be_number && end.ec == std::errc{} && end.ptr == digits.data() + digits.size())
    return value;
  return std::string(text);
}

[[noreturn]] void fail(const std::string& path, int line, const std::string& why) {
  throw Error(
      ExitCode::kBadReference,
      fmt::format(
          "{}: line {}: {}; it is cut off, damaged or no YAML as OpenCV writes it, write it again",
          path,
          line,
          why
      )
  );
}

// Errors end at a zero byte: what() is a C string, and the file's name may stand behind. At byte 4
// yaml-cpp ends the file.
void refuse_control_characters(std::string_view text, const std::string& path) {
  const auto is_control = [](char c) {
    return static_cast<unsigned char>(c) < ' ' && c != '\t' && c != '\n' && c != '\r';
  };
  const auto found = std::find_if(text.begin(), text.end(), is_control);
  if (found != text.end())
    fail(path, 1 + static_cast<int>(std::count(text.begin(), found, '\n')), "a control character");
}

// For yaml-cpp a quote may also end with the file.
bool ends_in_its_line(std::string_view text, std::size_t begin) {
  const char quote = begin < text.size() ? text[begin] : '\n';
  if (quote != '"' && quote != '\'') return true;  // an anchor in front of it
  for (std::size_t i = begin + 1; i < text.size() && text[i] != '\n'; ++i)
    if (quote == '"' && text[i] == '\\')
      ++i;
    else if (text[i] == quote)
      return true;
  return false;
}

// Makes JSON of what the parser meets. Aliases, which can repeat a text without bound, are refused.
class JsonBuilder final : public YAML::EventHandler {
 public:
  JsonBuilder(std::string_view text, const std::string& path) : text_(text), path_(path) {}
  json take() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (ended_) refuse(mark, "a line that stands further left or right than its neighbours");
  }
  void OnDocumentEnd() override { ended_ = true; }
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override {
    if (at_name()) refuse(mark, "expected a name");
    put(nullptr);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { refuse(mark, "an alias"); }
  void OnScalar(
      const YAML::Mark& mark, const std::string& tag, YAML::anchor_t, const std::string& text
  ) override {
    const bool quoted = tag == "!";
    if (quoted && !ends_in_its_line(text_, static_cast<std::size_t>(mark.pos)))
      refuse(mark, "a quote that does not end in its line");
    if (at_name())
      open_.back().name = text;
    else
      put(quoted ? json(text) : scalar_of(text));
  }
  void OnSequenceStart(
      const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value
  ) override {
    open(mark, json::array());
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(
      const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value
  ) override {
    open(mark, json::object());
  }
  void OnMapEnd() override { close(); }

 private:
  struct Level {
    json value;
    std::optional<std::string> name;  // of the field that comes next
  };

  [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& why) const {
    fail(path_, mark.line + 1, why);
  }
  bool at_name() const {
    return !open_.empty() && open_.back().value.is_object() && !open_.back().name;
  }
  void open(const YAML::Mark& mark, json empty) {
    if (at_name()) refuse(mark, "a name that is no text");
    if (open_.size() >= kDeepest) refuse(mark, fmt::format("nested more than {} deep", kDeepest));
    open_.push_back({std::move(empty), {}});
  }
  void close() {
    json value = std::move(open_.back().value);
    open_.pop_back();
    put(std::move(value));
  }
  void put(json value) {
    if (open_.empty()) {
      root_ = std::move(value);
    } else if (Level& level = open_.back(); level.value.is_array()) {
      level.value.push_back(std::move(value));
    } else {
      level.value.emplace(*level.name, std::move(value));
      level.name.reset();
    }
  }

  std::string_view text_;
  const std::string& path_;
  json root_;
  std::vector<Level> open_;
  bool ended_ = false;
};

}  // namespace

nlohmann::json parse_camera_yaml(std::string_view text, const std::string& path) {
  constexpr std::string_view kByteOrder = "\xef\xbb\xbf";  // yaml-cpp does not count it
  if (text.starts_with(kByteOrder)) text.remove_prefix(kByteOrder.size());
  refuse_control_characters(text, path);
  std::istringstream in{std::string(text)};
  JsonBuilder builder(text, path);
  try {
    YAML::Parser parser(in);
    // A second time for what stands behind, where the builder refuses it.
    if (parser.HandleNextDocument(builder)) parser.HandleNextDocument(builder);
  } catch (const YAML::Exception& error) {
    fail(path, error.mark.line + 1, error.msg);
  }
  return builder.take();
}

}  // namespace glint
