// First of three checks for heap allocations: the core's objects do not reference any allocating function.
#include "tests/checks/heap_symbols.h"

#include <sstream>

#include <gtest/gtest.h>

namespace touchline::checks {
namespace {

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> parts;
  std::istringstream stream(list);
  for (std::string part; std::getline(stream, part, ':');) parts.push_back(part);
  return parts;
}

TEST(HeapSymbols, TheCoreHasNone) {
  const std::vector<std::string> archives = split(TOUCHLINE_CORE_ARCHIVES);
  ASSERT_GE(archives.size(), 10U) << "one per stage, the shared types, and the pipeline";
  std::size_t undefined = 0;
  for (const std::string& archive : archives) {
    const SymbolFindings findings = check_heap_symbols(TOUCHLINE_NM, archive);
    EXPECT_GT(findings.objects, 0U) << archive << " could not be read";
    for (const std::string& refused : findings.refused) ADD_FAILURE() << archive << "\n" << refused;
    undefined += findings.undefined;
  }
  EXPECT_GT(undefined, 50U) << "stages use each other's functions, so there must be undefined symbols";
}

TEST(HeapSymbols, TheRobotsHeaderNeedsNoLibrary) {
  for (const std::string& archive : split(TOUCHLINE_ROBOT_ARCHIVES)) {
    const SymbolFindings findings = check_heap_symbols(TOUCHLINE_NM, archive);
    EXPECT_EQ(findings.objects, 1U) << archive << " could not be read";
    for (const std::string& refused : findings.refused) ADD_FAILURE() << archive << "\n" << refused;
    // The compiler may use memmove, memcpy and memset for loops; every C library for microcontrollers has them.
    EXPECT_LE(findings.undefined, 3U);
  }
}

TEST(HeapSymbols, FindsThePlantedFault) {
  const SymbolFindings findings = check_heap_symbols(TOUCHLINE_NM, TOUCHLINE_PLANTED_ARCHIVE);
  std::string all;
  for (const std::string& refused : findings.refused) all += refused + "\n";
  for (const char* expected : {"operator new(unsigned long)", "operator delete(", "malloc", "__cxa_throw",
                               "__cxa_guard_acquire", "std::__throw_", "std::chrono::"}) {
    EXPECT_NE(all.find(expected), std::string::npos) << expected << " was not found in\n" << all;
  }
}

TEST(HeapSymbols, AMissingArchiveIsAnError) {
  EXPECT_EQ(check_heap_symbols(TOUCHLINE_NM, "/nowhere/libcore.a").objects, 0U);
  EXPECT_EQ(check_heap_symbols("/nowhere/nm", TOUCHLINE_PLANTED_ARCHIVE).objects, 0U);
}

}  // namespace
}  // namespace touchline::checks
