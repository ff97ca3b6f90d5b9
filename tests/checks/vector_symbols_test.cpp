// Code that is compiled for AVX2 must run only on processors with these instructions. If several objects
// define a function (inline, template), the linker takes any of them. One that is compiled for AVX2 could then run
// everywhere.
#include <sstream>
#include <unordered_set>

#include <gtest/gtest.h>

#include "tests/command_output.h"

namespace touchline::checks {
namespace {

struct VectorFindings {
  std::size_t instructions = 0;      // examined
  std::vector<std::string> refused;  // mangled names
};

// Returns true for a function that only objects for AVX2 define.
bool names_its_instruction_set(const std::string& symbol) { return symbol.find("avx2") != std::string::npos; }

std::unordered_set<std::string> weak_functions(const std::string& archive) {
  std::unordered_set<std::string> weak;
  std::istringstream lines(testing::output_of("'" TOUCHLINE_NM "' --defined-only --format=posix '" + archive + "'"));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, type;
    if (words >> name >> type && type == "W" && !names_its_instruction_set(name)) weak.insert(name);
  }
  return weak;
}

VectorFindings check_vector_symbols(const std::string& archive) {
  VectorFindings findings;
  const std::unordered_set<std::string> weak = weak_functions(archive);
  std::istringstream lines(testing::output_of("'" TOUCHLINE_OBJDUMP "' -d --no-show-raw-insn '" + archive + "'"));
  std::string function;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t name = line.find(" <"), address = line.find(':');
    const std::size_t code = address == std::string::npos ? address : line.find_first_not_of(" \t", address + 1);
    if (line.ends_with(">:") && name != std::string::npos) {
      function = line.substr(name + 2, line.size() - name - 4);
    } else if (line.starts_with(' ') && code != std::string::npos) {
      ++findings.instructions;
      const bool is_vector = line[code] == 'v' && line.find("mm", code) != std::string::npos;
      if (!is_vector || weak.count(function) == 0) continue;
      findings.refused.push_back(function);
      function.clear();  // report each function once
    }
  }
  return findings;
}

TEST(VectorSymbols, NoPortableFunctionUsesVectorInstructions) {
  std::istringstream archives(TOUCHLINE_CORE_ARCHIVES);
  for (std::string archive; std::getline(archives, archive, ':');) {
    const VectorFindings findings = check_vector_symbols(archive);
    EXPECT_GT(findings.instructions, 0U) << archive << " could not be read";
    for (const std::string& refused : findings.refused) ADD_FAILURE() << archive << "\n" << refused;
  }
}

TEST(VectorSymbols, FindsThePlantedFault) {
  const VectorFindings findings = check_vector_symbols(TOUCHLINE_PLANTED_ARCHIVE);
  ASSERT_EQ(findings.refused.size(), 1U);
  EXPECT_NE(findings.refused[0].find("planted_sum"), std::string::npos) << findings.refused[0];
}

}  // namespace
}  // namespace touchline::checks
