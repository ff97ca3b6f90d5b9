#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/region/region_scanner.h"
#include "hal/result.h"
#include "tests/color/owned_picture.h"
#include "tests/region/literal_labeling.h"

namespace touchline::testing {

/// One method to measure: each call processes one frame.
struct Method {
  std::string name;  // "read", the name of a kernel, "paper", ...
  std::function<void()> work;
  std::vector<float> times_us;  // CPU time of each call
};

/// One block of the report: a picture and the methods that are measured on it.
struct BenchmarkCase {
  std::string name;
  OwnedPicture picture;
  ScanParameters parameters;
  ColorGrid colors{};  // color of each pixel by definition; if empty, add_methods() computes it
  // Copies of the picture, used in turn so that none is in a cache; empty: always use `picture`.
  std::vector<OwnedPicture> copies{};
  bool slow_methods = false;  // measure also the slow methods
  std::size_t turn = 0;
  std::vector<Method> methods{};
  std::string found{};  // number of runs and regions, for the report

  Frame next_frame();
};

// Suffix of the name of cases in which regions of one pixel are dropped.
inline constexpr char kSpecksLeftOut[] = ", specks left out";

/// Makes the cases whose names contain `part`.
std::vector<std::unique_ptr<BenchmarkCase>> make_cases(std::string_view part);
/// Makes a case of 640 x 480 whose pixels have five colors; eight more color classes are configured that no pixel has.
BenchmarkCase many_colors_case(const ColorGrid& grid, std::uint32_t min_area_px);

/// Reads every byte of the picture, in blocks of 128; returns their XOR.
std::uint64_t read_frame(const Frame& frame);

/// Adds all methods that apply to the case and checks their results. kInconsistent: a result is wrong.
Result<void> add_methods(BenchmarkCase& benchmark);

/// Adds the methods of OpenCV; only with TOUCHLINE_HAS_OPENCV. Errors as of add_methods().
Result<void> add_opencv(BenchmarkCase& benchmark, const ColorGrid& colors);

}  // namespace touchline::testing
