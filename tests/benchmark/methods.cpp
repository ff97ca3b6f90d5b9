#include <algorithm>

#include "tests/benchmark/benchmark_case.h"
#include "tests/benchmark/paper_scan.h"
#include "tests/region/patterns.h"
#include "tests/region/region_comparison.h"

namespace touchline::testing {
namespace {

struct Outputs {
  Runs runs;
  Regions regions;
};
Outputs& outputs() {
  static Outputs all;
  return all;
}

// Keeps the compiler from removing the computation of `value`.
template <class T>
void optimization_barrier(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

Result<void> check_field(const Regions& regions) {
  const auto patches = std::count_if(regions.begin(), regions.end(), [](const Region& r) { return r.area_px >= 30; });
  if (patches >= 18 && patches <= 30) return {};
  return failure(ErrorCode::kInconsistent, "%td regions as large as a patch on the field", patches);
}

Result<void> add_kernel(BenchmarkCase& benchmark, KernelChoice kernel, const char* name, const ExpectedScan& expected) {
  auto scanner = std::make_shared<RegionScanner>();
  ScanParameters parameters = benchmark.parameters;
  parameters.kernel = kernel;
  const Status configured = scanner->configure(parameters);
  if (configured.code() == ErrorCode::kUnsupported) return {};
  if (!configured.ok()) return Error{configured.code(), describe(configured.code())};

  auto& [runs, regions] = outputs();
  const Status status = scanner->scan(benchmark.picture.frame(), runs, regions);
  if (!status.ok() && status.code() != ErrorCode::kFull) return Error{status.code(), describe(status.code())};
  if (const std::string found = difference(expected, runs, regions); !found.empty()) {
    return Error{ErrorCode::kInconsistent, found};
  }
  if (benchmark.name.starts_with("field")) TOUCHLINE_TRY(check_field(regions));
  benchmark.found = std::to_string(runs.size()) + " runs, " + std::to_string(regions.size()) + " regions";
  if (!status.ok()) benchmark.found += ", truncated";
  benchmark.methods.push_back({name,
                               [&benchmark, scanner] {
                                 optimization_barrier(
                                     scanner->scan(benchmark.next_frame(), outputs().runs, outputs().regions));
                               },
                               {}});
  return {};
}

Result<void> add_paper(BenchmarkCase& benchmark, const ColorGrid& colors) {
  auto paper = std::make_shared<PaperScan>();
  // The paper's scan has no light map and no minimum area.
  if (!paper->configure(benchmark.parameters).ok() || benchmark.name.ends_with(kSpecksLeftOut)) return {};
  std::uint64_t area = 0, expected_area = 0;
  const std::vector<ExpectedRegion> expected = expected_regions(colors);
  const std::vector<PaperScan::Found>& found = paper->scan(benchmark.picture.frame());
  for (const PaperScan::Found& region : found) area += region.area_px;
  for (const ExpectedRegion& region : expected) expected_area += region.pixels.size();
  benchmark.methods.push_back(
      {"paper", [&benchmark, paper] { optimization_barrier(paper->scan(benchmark.next_frame())); }, {}});
  if (found.size() == expected.size() && area == expected_area) return {};
  return Error{ErrorCode::kInconsistent, "finds other regions than the definition"};
}

}  // namespace

Result<void> add_methods(BenchmarkCase& benchmark) {
  if (benchmark.colors.color.empty())
    benchmark.colors = defined_colors(benchmark.picture.frame(), benchmark.parameters);
  const ColorGrid& colors = benchmark.colors;
  const ExpectedScan expected = expected_scan(colors, benchmark.parameters.min_area_px);
  benchmark.methods.push_back({"read", [&benchmark] { optimization_barrier(read_frame(benchmark.next_frame())); }, {}});
  for (const Choice<KernelChoice>& choice : kKernelChoices) {
    if (choice.value == KernelChoice::kFastest) continue;
    const std::string name(choice.word);
    Result<void> added = add_kernel(benchmark, choice.value, name.c_str(), expected);
    if (!added.ok()) return prefixed(name, std::move(added).error());
  }
  TOUCHLINE_TRY(add_paper(benchmark, colors));
#ifdef TOUCHLINE_HAS_OPENCV
  const bool rgb_field =
      benchmark.name.starts_with("field") && color_space(benchmark.parameters.format) == ColorSpace::kRgb;
  if (rgb_field && benchmark.copies.empty() && benchmark.parameters.light.columns == 0) {
    return add_opencv(benchmark, colors);
  }
#endif
  return {};
}

}  // namespace touchline::testing
