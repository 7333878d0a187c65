// SPDX-License-Identifier: MIT
// Every kernel stands in the list at the end of its header, and every list is offered to GPUs.
#include <catch2/catch.hpp>
#include <regex>
#include <string>
#include <vector>

#include "glint/core/files.h"
#include "glint/cuda/ops.h"
#include "tests/support/gpu_backends.h"

using namespace glint;
using namespace glint::test;

namespace {

std::vector<fs::path> kernel_headers() {
  std::vector<fs::path> headers;
  for (const char* folder : {"glint/render", "glint/train", "baselines", "metrics"})
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (entry.path().string().ends_with("_kernels.h")) headers.push_back(entry.path());
  return headers;
}

// Structs that run_kernel(), sum_kernel() or run_block_kernel() take: by their call operator.
std::vector<std::string> kernels_of(const std::string& text) {
  static const std::regex part(
      R"(\nstruct (\w+)|operator\(\)\((?:std::size_t(?: \w+)?|int \w+, int \w+|Block& \w+, Shared& \w+)\) const)"
  );
  std::vector<std::string> kernels;
  std::string last;
  for (std::sregex_iterator at(text.begin(), text.end(), part), end; at != end; ++at) {
    if ((*at)[1].matched)
      last = (*at)[1];
    else
      kernels.push_back(last);
  }
  return kernels;
}

std::string list_of(const std::string& text) {
  const std::size_t at = text.rfind("\nusing ");
  return at == std::string::npos ? "" : text.substr(at);
}

// Members of KernelList<...>, not of the templates in it.
std::size_t num_listed(const std::string& list) {
  std::size_t listed = 1, depth = 0;
  for (const char c : list) {
    if (c == '<') ++depth;
    if (c == '>') --depth;
    if (c == ',' && depth == 1) ++listed;
  }
  return listed;
}

template <class Kernel>
bool is_offered() {
  if constexpr (requires { typename Kernel::Shared; })
    return BlocksOnGpu<Kernel>::run != nullptr;
  else if constexpr (requires(const Kernel& kernel) { kernel(0, 0); })
    return SumOnGpu<Kernel>::run != nullptr;
  else
    return OnGpu<Kernel>::run != nullptr;
}
template <class... Kernels>
std::size_t num_offered(KernelList<Kernels...>) {
  return (static_cast<std::size_t>(is_offered<Kernels>()) + ... + 0);
}
template <class... Lists>
std::size_t num_offered_in(KernelList<Lists...>) {
  return (num_offered(Lists{}) + ... + 0);
}

}  // namespace

TEST_CASE("Every kernel of a header stands in the list at its end") {
  std::size_t kernels = 0;
  for (const fs::path& header : kernel_headers()) {
    const std::string text = read_file(header), list = list_of(text);
    for (const std::string& kernel : kernels_of(text)) {
      INFO(header.string() << ": add " << kernel << " to the KernelList at the end");
      CHECK(std::regex_search(list, std::regex("\\b" + kernel + "\\b")));
      ++kernels;
    }
  }
  CHECK(kernels > 30);
}

TEST_CASE("GPU backends offer the kernels of all lists") {
  use_host_kernels();
  use_cpu();
  std::size_t listed = 0;
  for (const fs::path& header : kernel_headers()) listed += num_listed(list_of(read_file(header)));
  CHECK(num_offered_in(KernelLists{}) == listed);
}
