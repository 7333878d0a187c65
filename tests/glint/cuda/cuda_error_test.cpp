// SPDX-License-Identifier: MIT
// Words and exit codes for failures of a device; the errors are those of driver_types.h by number.
#include "glint/cuda/cuda_error.h"

#include <catch2/catch.hpp>

#include "glint/core/device_lost.h"
#include "glint/cuda/card_lock.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::gpu;
using test::error_of;

namespace {

constexpr int kMemoryAllocation = 2, kInsufficientDriver = 35, kDevicesUnavailable = 46;
constexpr int kInvalidValue = 1, kNoKernelImage = 209, kIllegalAddress = 700, kLaunchFailure = 719;
constexpr int kMpsRpcFailure = 806, kMpsMaxClients = 808;
constexpr std::size_t kGiB = std::size_t{1} << 30;

}  // namespace

TEST_CASE("What can be mended is said with how") {
  CHECK_THAT(advice_for(kMemoryAllocation), Catch::Contains("--max-pixels"));
  CHECK_THAT(advice_for(kInsufficientDriver), Catch::Contains("newer NVIDIA driver"));
  CHECK_THAT(advice_for(kDevicesUnavailable), Catch::Contains("another process"));
  CHECK_THAT(advice_for(kNoKernelImage), Catch::Contains("CMAKE_CUDA_ARCHITECTURES"));
  CHECK(advice_for(kInvalidValue).empty());
}

TEST_CASE("A failure names what was done, CUDA's reason and the advice, and exits with 6") {
  const auto message = error_of(ExitCode::kEnvironment, [] {
    throw_cuda_error("allocating memory", kMemoryAllocation, "out of memory");
  });
  CHECK(
      message == "CUDA: allocating memory failed: out of memory; " + advice_for(kMemoryAllocation)
  );
  CHECK(error_of(ExitCode::kEnvironment, [] {
          throw_cuda_error("copying", kInvalidValue, "why");
        }) == "CUDA: copying failed: why");
}

TEST_CASE("A device that is lost is told from a call that failed") {
  CHECK_THROWS_AS(throw_cuda_error("waiting", kIllegalAddress, "why"), DeviceLost);
  CHECK_THROWS_AS(throw_cuda_error("waiting", kLaunchFailure, "why"), DeviceLost);
  CHECK_FALSE(loses_device(kMemoryAllocation));
  CHECK_FALSE(loses_device(kDevicesUnavailable));
}

TEST_CASE("A card that is too small is told with what is needed and what is free") {
  const auto message =
      error_of(ExitCode::kEnvironment, [] { throw_out_of_memory(3 * kGiB, kGiB / 2, 8 * kGiB); });
  CHECK_THAT(message, Catch::Contains("3.00 GiB are needed, 0.50 GiB of its 8.00 GiB are free"));
  CHECK_THAT(message, Catch::Contains("max_surfels") && Catch::Contains("nvidia-smi"));
}

TEST_CASE("A full card is want of memory, whoever finds it") {
  CHECK_THROWS_AS(throw_out_of_memory(3 * kGiB, kGiB / 2, 8 * kGiB), OutOfMemory);
  CHECK_THROWS_AS(throw_cuda_error("finding a device", kMemoryAllocation, "why"), OutOfMemory);
}

TEST_CASE("A device is lost with MPS, but not where MPS takes no one") {
  CHECK(loses_device(kMpsRpcFailure));
  CHECK_FALSE(loses_device(kMpsMaxClients));
  CHECK_THAT(advice_for(kMpsMaxClients), Catch::Contains("--jobs"));
}

TEST_CASE("Versions of driver and program are told as people know them") {
  CHECK(driver_text(12020, 13000) == "driver for CUDA 12.2, program for CUDA 13.0");
}

TEST_CASE("A card that a process has is not to be had by a second one") {
  const test::TempFolder folder;
  const std::string place = folder.path().string();
  CHECK(take_card("0000:18:00.0", place));
  CHECK_FALSE(take_card("0000:18:00.0", place)
  );  // another opening of the file is as another process
  CHECK_FALSE(take_card("0000:18:00.0", place, true));
  CHECK(take_card("0000:3b:00.0", place));
  CHECK(take_card("0000:18:00.0", place + "/nowhere"));
}

TEST_CASE("A card that several take together is not to be had by others") {
  const test::TempFolder folder;
  const std::string place = folder.path().string();
  CHECK(take_card("0000:18:00.0", place, true));
  CHECK(take_card("0000:18:00.0", place, true));
  CHECK_FALSE(take_card("0000:18:00.0", place));
}
