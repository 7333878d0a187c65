// SPDX-License-Identifier: MIT
#include <set>

#include "reports/run/records/stage_files.h"

namespace glint {
namespace {

constexpr std::size_t kFilesNamed = 3;  // of the code that has changed
constexpr std::size_t kLongestValue = 40;

std::string value_text(const Json& value) {
  if (value.is_null()) return "none";
  if (value.is_string()) return value.get<std::string>();
  const std::string text = value.dump();
  return text.size() <= kLongestValue ? text : text.substr(0, kLongestValue) + "...";
}

// Floats as they were typed (0.2, not 0.20000000298) unless that hides the difference.
std::string change_text(const Json& then, const Json& now) {
  if (then.is_number_float() || now.is_number_float()) {
    const auto short_text = [](const Json& value) {
      return value.is_number() ? fmt::format("{:g}", value.get<double>()) : value_text(value);
    };
    if (short_text(then) != short_text(now)) return short_text(then) + " -> " + short_text(now);
  }
  return value_text(then) + " -> " + value_text(now);
}

const Json& member(const Json& object, const std::string& name) {
  static const Json none;
  const auto found = object.is_object() ? object.find(name) : object.end();
  return object.is_object() && found != object.end() ? *found : none;
}

std::set<std::string> names_of(const Json& a, const Json& b) {
  std::set<std::string> names;
  for (const Json* json : {&a, &b})
    if (json->is_object())
      for (const auto& entry : json->items()) names.insert(entry.key());
  return names;
}

class Differences {
 public:
  std::vector<std::string> between(const Json& then, const Json& now) {
    compare(then, now, "");
    if (!code_.empty()) lines_.push_back(code_text());
    return std::move(lines_);
  }

 private:
  void compare(const Json& then, const Json& now, const std::string& prefix) {
    for (const std::string& name : names_of(then, now)) {
      const Json &a = member(then, name), &b = member(now, name);
      if (a == b || name == "inputs") continue;
      if (name == "code")
        note_code(a, b);
      else if (name == "machine")
        note_machine(a, b);
      else if (name == "content")
        note_content(a, b);
      else if (a.is_object() && b.is_object())
        compare(a, b, name == "data" ? prefix : prefix + name + ".");
      else
        lines_.push_back(fmt::format("{}{} {}", prefix, name, change_text(a, b)));
    }
  }

  void note_code(const Json& then, const Json& now) {
    for (const std::string& file : names_of(then, now))
      if (member(then, file) != member(now, file)) code_.insert(file);
  }

  void note_machine(const Json& then, const Json& now) {
    for (const std::string& name : names_of(then, now)) {
      const Json &a = member(then, name), &b = member(now, name);
      if (a == b) continue;
      const auto text = [](const Json& entry) {
        return entry.is_object() ? "there" : value_text(entry);
      };
      lines_.push_back(
          a.is_object() && b.is_object() ? name + " has other files"
                                         : fmt::format("{} {} -> {}", name, text(a), text(b))
      );
    }
  }

  // Data that are not there yet have no content.
  void note_content(const Json& then, const Json& now) {
    if (!then.is_null() && !now.is_null()) lines_.push_back("other files in the data");
  }

  std::string code_text() const {
    std::string text;
    std::size_t named = 0;
    for (const std::string& file : code_)
      if (named++ < kFilesNamed) text += (text.empty() ? "code of " : ", ") + file;
    if (code_.size() > kFilesNamed) text += fmt::format(" and {} more", code_.size() - kFilesNamed);
    return text;
  }

  std::vector<std::string> lines_;
  std::set<std::string> code_;
};

}  // namespace

std::vector<std::string> stage_differences(const Json& then, const Json& now) {
  return Differences().between(then, now);
}

}  // namespace glint
