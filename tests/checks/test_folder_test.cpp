// Checks that a test lies in the folder named after the folder of the code that it tests, as CONTRIBUTING.md says.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/checks/inclusion_rule.h"

namespace touchline::checks {
namespace {

// Exceptions: drivers' fakes replace calls of the program that they are linked into.
constexpr std::array<std::string_view, 3> kWithTheFakesOfDrivers{
    "tests/linux/camera_choice_test.cpp", "tests/linux/device_answer_test.cpp", "tests/linux/device_list_test.cpp"};
// core/*.h have no folder of their own.
constexpr std::string_view kTestsOfTheCoresOwnFiles = "pipeline";

// The header with the name of the test among those that it includes, as {"core", "light", "shading.h"}.
std::vector<std::string> tested_header(const SourceFile& test) {
  constexpr std::string_view kSuffix = "_test.cpp", kInclude = "#include \"";
  const std::size_t slash = test.path.rfind('/');
  if (!test.path.starts_with("tests/") || !test.path.ends_with(kSuffix)) return {};
  const std::string header = test.path.substr(slash + 1, test.path.size() - slash - 1 - kSuffix.size()) + ".h";
  std::istringstream lines(test.text);
  for (std::string line; std::getline(lines, line);) {
    const bool is_it = line.starts_with(kInclude) && line.ends_with("/" + header + "\"");
    if (is_it && line.find("\"tests/") == std::string::npos) {
      std::istringstream path(line.substr(kInclude.size(), line.size() - kInclude.size() - 1));
      std::vector<std::string> parts;
      for (std::string part; std::getline(path, part, '/');) parts.push_back(part);
      return parts;
    }
  }
  return {};
}

// Returns what is wrong with the folder of a test; empty: nothing.
std::string folder_violation(const SourceFile& test) {
  const std::vector<std::string> header = tested_header(test);
  const bool has_fakes = std::count(kWithTheFakesOfDrivers.begin(), kWithTheFakesOfDrivers.end(), test.path) > 0;
  if (header.empty() || has_fakes) return "";
  const std::size_t begin = std::string_view("tests/").size();
  const std::string folder = test.path.substr(begin, test.path.find('/', begin) - begin);
  if (header.size() == 2 && header[0] == "core" && folder == kTestsOfTheCoresOwnFiles) return "";
  if (std::find(header.begin(), header.end() - 1, folder) != header.end() - 1) return "";
  return test.path + " tests " + header.back() + ": move it to tests/" + header[header.size() - 2];
}

TEST(TestFolders, HaveTheNameOfWhatIsTested) {
  std::size_t tested = 0;
  for (const SourceFile& file : read_sources(TOUCHLINE_SOURCE_DIR)) {
    if (!tested_header(file).empty()) ++tested;
    EXPECT_EQ(folder_violation(file), "");
  }
  EXPECT_GT(tested, 100U) << "the check must not pass because it found no tests";
}

TEST(TestFolders, APlantedTestInAnotherFolderIsFound) {
  const SourceFile test{"tests/color/shading_test.cpp", "#include <cmath>\n#include \"core/light/shading.h\"\n"};
  EXPECT_EQ(folder_violation(test), "tests/color/shading_test.cpp tests shading.h: move it to tests/light");
  EXPECT_EQ(folder_violation({"tests/light/shading_test.cpp", test.text}), "");
  EXPECT_EQ(folder_violation({"tests/pipeline/shading_test.cpp", test.text}),
            "tests/pipeline/shading_test.cpp tests shading.h: move it to tests/light");
  EXPECT_EQ(folder_violation({"tests/light/light_change_test.cpp", test.text}), "") << "tests another file";
}

}  // namespace
}  // namespace touchline::checks
