#pragma once

#include <string>
#include <string_view>
#include <vector>

// The rule of inclusion: which folder may include what. The house stands on it: the core knows no system and no device,
// a stage knows only what comes before it.
namespace touchline::checks {

struct SourceFile {
  std::string path;  // from the repository's root, '/' between folders
  std::string text;
};

struct Violation {
  std::string file;
  std::size_t line = 0;
  std::string reason;
};

struct Findings {
  std::size_t files = 0, includes = 0;  // looked at
  std::vector<Violation> violations;
};

/// Looks at every #include line of files under core, hal, firmware, tools and tests.
Findings check_inclusion(const std::vector<SourceFile>& files);

/// All C++ files under these folders of the repository.
std::vector<SourceFile> read_sources(const std::string& root);

}  // namespace touchline::checks
