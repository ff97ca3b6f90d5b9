#include <algorithm>

#include "tests/benchmark/paper_scan.h"
#include "tests/benchmark/subject.h"
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

// A result that nobody reads would not be computed.
template <class T>
void keep(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

std::string check_field(const Regions& regions) {
  const auto patches = std::count_if(regions.begin(), regions.end(), [](const Region& r) { return r.area_px >= 30; });
  return patches < 18 || patches > 30 ? std::to_string(patches) + " regions of a patch's size on the field" : "";
}

std::string add_kernel(Subject& subject, KernelChoice kernel, const char* name, const ExpectedScan& expected) {
  auto scanner = std::make_shared<RegionScanner>();
  ScanParameters parameters = subject.parameters;
  parameters.kernel = kernel;
  const Status configured = scanner->configure(parameters);
  if (configured.code() == ErrorCode::kUnsupported) return {};
  if (!configured.ok()) return describe(configured.code());

  auto& [runs, regions] = outputs();
  const Status status = scanner->scan(subject.picture.frame(), runs, regions);
  if (!status.ok() && status.code() != ErrorCode::kFull) return describe(status.code());
  std::string wrong = difference(expected, runs, regions);
  if (wrong.empty() && subject.name.starts_with("field")) wrong = check_field(regions);
  subject.found = std::to_string(runs.size()) + " runs, " + std::to_string(regions.size()) + " regions";
  if (!status.ok()) subject.found += ", cut";
  subject.methods.push_back(
      {name,
       [&subject, scanner] { keep(scanner->scan(subject.next_frame(), outputs().runs, outputs().regions)); },
       {}});
  return wrong;
}

std::string add_paper(Subject& subject, const ColorGrid& colors) {
  auto paper = std::make_shared<PaperScan>();
  // It knows no light map; and a second time, with another least area, it would do the same.
  if (!paper->configure(subject.parameters).ok() || subject.name.ends_with(kSpecksLeftOut)) return {};
  std::uint64_t area = 0, expected_area = 0;
  const std::vector<ExpectedRegion> expected = expected_regions(colors);
  const std::vector<PaperScan::Found>& found = paper->scan(subject.picture.frame());
  for (const PaperScan::Found& region : found) area += region.area_px;
  for (const ExpectedRegion& region : expected) expected_area += region.pixels.size();
  subject.methods.push_back({"paper", [&subject, paper] { keep(paper->scan(subject.next_frame())); }, {}});
  return found.size() == expected.size() && area == expected_area ? "" : "the paper's scan is not the paper's";
}

}  // namespace

std::string add_methods(Subject& subject) {
  if (subject.colors.color.empty()) subject.colors = defined_colors(subject.picture.frame(), subject.parameters);
  const ColorGrid& colors = subject.colors;
  const ExpectedScan expected = expected_scan(colors, subject.parameters.min_area_px);
  subject.methods.push_back({"read", [&subject] { keep(read_frame(subject.next_frame())); }, {}});
  for (const Choice<KernelChoice>& choice : kKernelChoices) {
    if (choice.value == KernelChoice::kFastest) continue;
    const std::string name(choice.word);
    if (const std::string wrong = add_kernel(subject, choice.value, name.c_str(), expected); !wrong.empty()) {
      return name + ": " + wrong;
    }
  }
  if (std::string wrong = add_paper(subject, colors); !wrong.empty()) return wrong;
  return subject.name.starts_with("field") && subject.copies.empty() && subject.parameters.light.columns == 0 &&
                 color_space(subject.parameters.format) == ColorSpace::kRgb
             ? add_opencv(subject, colors)
             : std::string();
}

}  // namespace touchline::testing
