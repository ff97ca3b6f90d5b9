#pragma once

#include <string>
#include <string_view>
#include <vector>

// Checks the include rules between folders: the core includes no operating system and no device, and a stage of the
// core includes only the earlier stages that it needs.
namespace touchline::checks {

struct SourceFile {
  std::string path;  // path from the repository's root, '/' between folders
  std::string text;
};

struct Violation {
  std::string file;
  std::size_t line = 0;
  std::string reason;
};

struct Findings {
  std::size_t files = 0, includes = 0;  // numbers of examined files and includes
  std::vector<Violation> violations;
};

/// Checks every #include line of files under core, hal, firmware, tools and tests.
Findings check_inclusion(const std::vector<SourceFile>& files);

/// Returns all C++ files under these folders of the repository.
std::vector<SourceFile> read_sources(const std::string& root);

}  // namespace touchline::checks
