// SPDX-License-Identifier: MIT
// The documents stay as short as whoever joins can read, and what they lead to is there.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "glint/core/files.h"
#include "glint/core/rows.h"

using namespace glint;

namespace {

constexpr std::size_t kDocsWords = 30000, kReadmeWords = 1200;
constexpr std::size_t kLineCharacters = 120, kParagraphWords = 90;

std::vector<fs::path> files_below(const fs::path& folder, const std::set<std::string>& extensions) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && extensions.contains(entry.path().extension().string()))
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

bool is_result(const fs::path& page) { return page.string().starts_with("docs/results/"); }

std::vector<fs::path> pages() {  // tests run in the project's folder
  std::vector<fs::path> all = files_below("docs", {".md"});
  all.emplace_back("README.md");
  return all;
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

// The lines of a page, those of fenced blocks (and the fences) as empty ones.
std::vector<std::string> prose(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  bool fenced = false;
  for (std::string line; std::getline(stream, line);) {
    const bool fence = line.starts_with("```");
    lines.push_back(fence || fenced ? "" : line);
    if (fence) fenced = !fenced;
  }
  return lines;
}

bool begins_item(const std::string& line) {
  static const std::regex item(R"( *(- |[0-9]+\. ).*)");
  return std::regex_match(line, item);
}

bool is_apart(const std::string& line) {
  return line.empty() || line.front() == '|' || line.front() == '#' || line.front() == '<';
}

// Words of the longest paragraph, or item of a list.
std::size_t longest_paragraph(const std::string& text) {
  std::size_t longest = 0, words = 0;
  for (const std::string& line : prose(text)) {
    if (is_apart(line) || begins_item(line)) words = 0;
    if (!is_apart(line)) words += words_of(line).size();
    longest = std::max(longest, words);
  }
  return longest;
}

// What a heading is called in links, as GitHub makes it.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    if (c == ' ' || c == '-')
      anchor += '-';
    else if (c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0)
      anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return anchor;
}

std::set<std::string> anchors(const fs::path& page) {
  std::set<std::string> found;
  for (const std::string& line : prose(read_file(page)))
    if (line.starts_with('#')) found.insert(anchor_of(line.substr(line.find_first_not_of("# "))));
  return found;
}

std::vector<std::string> links(const std::string& text) {
  static const std::regex link(R"(\]\(([^)\s]+)\))");
  std::string plain;
  for (const std::string& line : prose(text)) plain += line + "\n";
  std::vector<std::string> found;
  for (std::sregex_iterator at(plain.begin(), plain.end(), link), end; at != end; ++at)
    if ((*at)[1].str().find("://") == std::string::npos) found.push_back((*at)[1].str());
  return found;
}

}  // namespace

TEST_CASE("docs/ can be read in an hour or two, README in minutes") {
  std::size_t total = 0;
  for (const fs::path& page : pages())
    if (!is_result(page) && page != "README.md") total += words_of(read_file(page)).size();
  CHECK(total <= kDocsWords);
  CHECK(words_of(read_file("README.md")).size() <= kReadmeWords);
}

TEST_CASE("lines and paragraphs of the documents are short") {
  for (const fs::path& page : pages()) {
    if (is_result(page)) continue;  // generated tables
    INFO(page.string());
    const std::string text = read_file(page);
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
      if (text_width(line) > kLineCharacters) FAIL_CHECK(line);
    CHECK(longest_paragraph(text) <= kParagraphWords);
  }
}

TEST_CASE("links of the documents lead to files and headings that are there") {
  std::map<fs::path, std::set<std::string>> known;
  for (const fs::path& page : pages()) {
    for (const std::string& link : links(read_file(page))) {
      INFO(page.string() << ": " << link);
      const std::size_t mark = link.find('#');
      const fs::path target =
          mark == 0 ? page : (page.parent_path() / link.substr(0, mark)).lexically_normal();
      CHECK(fs::exists(target));
      if (mark == std::string::npos || !fs::exists(target)) continue;
      if (!known.contains(target)) known[target] = anchors(target);
      CHECK(known[target].contains(link.substr(mark + 1)));
    }
  }
}

TEST_CASE("documents that sources name are there") {
  static const std::regex name(R"(docs/[A-Za-z0-9_/]+\.md)");
  for (const char* folder :
       {"glint", "baselines", "metrics", "datasets", "reports", "scripts", "tests"}) {
    for (const fs::path& file :
         files_below(folder, {".h", ".cpp", ".cu", ".cuh", ".sh", ".py", ".toml", ".txt"})) {
      const std::string text = read_file(file);
      if (text.find("docs/") == std::string::npos) continue;
      for (std::sregex_iterator at(text.begin(), text.end(), name), end; at != end; ++at) {
        INFO(file.string() << " names " << at->str());
        CHECK(fs::exists(at->str()));
      }
    }
  }
}

TEST_CASE("what these tests look for is found") {
  CHECK(longest_paragraph("a b\nc\n\n- d e\n- f\n| g h i j |\n") == 3);
  CHECK(longest_paragraph("```sh\na b c d e\n```\n") == 0);
  CHECK(
      anchor_of("Scenes: `[defaults]`, entries of `scenes`") == "scenes-defaults-entries-of-scenes"
  );
  CHECK(
      links("[a](b.md#c) [d](https://e) `f`\n```\n[g](h)\n```\n") ==
      std::vector<std::string>{"b.md#c"}
  );
}
