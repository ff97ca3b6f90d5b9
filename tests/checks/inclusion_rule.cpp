#include "tests/checks/inclusion_rule.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

namespace touchline::checks {
namespace {

// A folder, and the folders that it may include besides itself.
struct FolderRule {
  std::string_view folder;
  std::vector<std::string_view> may_include;
};
const std::vector<FolderRule>& folder_rules() {
  static const std::vector<FolderRule> rules{
      {"core", {}},
      {"hal", {"core"}},
      {"firmware", {"core", "hal"}},
      {"tools", {"core", "hal", "firmware"}},
      {"tests", {"core", "hal", "firmware", "tools"}},
  };
  return rules;
}

// The folders of the core in the order in which a frame passes through them, and what each may include besides itself
// and the values in core/*.h. This is the only place that states the order. A stage may include only folders above it.
const std::vector<FolderRule>& stage_rules() {
  static const std::vector<FolderRule> rules{
      {"light", {}},
      {"geometry", {}},
      {"color", {"light"}},
      {"region", {"light", "color"}},
      {"marker", {"light", "geometry", "color", "region"}},
      {"subpixel", {"geometry", "color", "light", "marker"}},
      {"track", {"geometry"}},
      {"control", {"geometry"}},
      {"radio", {}},
      {"identification", {"geometry", "radio"}},
      {"supervision", {}},
  };
  return rules;
}

// Headers of the standard library that the core may include: no heap, no operating system, and <chrono> only for
// durations.
constexpr std::array<std::string_view, 26> kCoreHeaders{
    "algorithm", "array",       "bit",     "bitset",      "cassert",   "chrono",   "cmath",
    "compare",   "concepts",    "cstddef", "cstdint",     "cstring",   "iterator", "initializer_list",
    "limits",    "numbers",     "numeric", "optional",    "ratio",     "span",     "string_view",
    "tuple",     "type_traits", "utility", "immintrin.h", "arm_neon.h"};

// Implementations of the HAL: they may not include each other, and the contracts may include none of them.
constexpr std::array<std::string_view, 3> kBackends{"linux", "replay", "mock"};

template <class List>
bool contains(const List& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

// "core/color/x.h" -> {"core", "color"}; "core/types.h" -> {"core", ""}.
struct Place {
  std::string_view folder, inner;
};
Place place_of(std::string_view path) {
  const std::size_t first = path.find('/');
  if (first == std::string_view::npos) return {};
  const std::string_view rest = path.substr(first + 1);
  const std::size_t second = rest.find('/');
  return {path.substr(0, first), second == std::string_view::npos ? std::string_view() : rest.substr(0, second)};
}

const FolderRule* rule_of(const std::vector<FolderRule>& rules, std::string_view folder) {
  const auto rule = std::find_if(rules.begin(), rules.end(), [&](const FolderRule& r) { return r.folder == folder; });
  return rule == rules.end() ? nullptr : &*rule;
}

std::optional<std::string> core_violation(std::string_view file, std::string_view target, Place from, Place to) {
  // The inputs of a step are part of the pipeline's interface, and contain values of several stages.
  const bool is_pipeline = file == "core/pipeline.h" || file == "core/pipeline.cpp" || file == "core/step_inputs.h";
  if (!is_pipeline && (target == "core/pipeline.h" || target == "core/step_inputs.h"))
    return "no stage may include the pipeline";
  // The adaptation feeds sightings back into light and colors; the pipeline calls it after the stages.
  const bool is_adaptation = file == "core/adaptation.h" || file == "core/adaptation.cpp";
  if (is_pipeline || is_adaptation || to.inner.empty() || to.inner == from.inner) return std::nullopt;
  if (from.inner.empty()) return "core/*.h are used by all stages and may not include core/" + std::string(to.inner);
  const std::vector<FolderRule>& stages = stage_rules();
  const FolderRule *user = rule_of(stages, from.inner), *used = rule_of(stages, to.inner);
  for (const Place& place : {from, to}) {
    if (rule_of(stages, place.inner) == nullptr) {
      return "core/" + std::string(place.inner) + " is not in the list of stages";
    }
  }
  if (used > user) return std::string(from.inner) + " comes before " + std::string(to.inner);
  if (!contains(user->may_include, to.inner)) {
    return std::string(from.inner) + " may not include " + std::string(to.inner);
  }
  return std::nullopt;
}

// People copy this folder to their robots' firmware.
constexpr std::string_view kRobotFolder = "tools/robot/";

std::optional<std::string> quoted_violation(std::string_view file, std::string_view target) {
  if (file.starts_with(kRobotFolder)) return "tools/robot is copied to robots and may not include files of Touchline";
  const Place from = place_of(file), to = place_of(target);
  const FolderRule* rule = rule_of(folder_rules(), from.folder);
  if (to.folder.empty()) return "\"" + std::string(target) + "\" must be written from the repository's root";
  if (from.folder != to.folder) {
    if (contains(rule->may_include, to.folder)) return std::nullopt;
    return std::string(from.folder) + " may not include " + std::string(to.folder);
  }
  if (from.folder == "core") return core_violation(file, target, from, to);
  if (from.folder == "hal" && contains(kBackends, to.inner) && to.inner != from.inner) {
    return "hal/" + std::string(from.inner) + (from.inner.empty() ? "" : "/") + " may not include hal/" +
           std::string(to.inner);
  }
  return std::nullopt;
}

std::optional<std::string> bracket_violation(std::string_view file, std::string_view target) {
  if (file.starts_with(kRobotFolder) && file.ends_with(".h") && target != "stdint.h") {
    return "the robots' header may use only <stdint.h>, because AVR has no C++ library";
  }
  if (place_of(file).folder != "core") return std::nullopt;
  if (target.starts_with("Eigen/") || contains(kCoreHeaders, target)) return std::nullopt;
  return "the core may not use <" + std::string(target) + ">";
}

// The name between the delimiters of an #include line.
struct Include {
  std::string_view target;
  bool bracket = false;
};
std::optional<Include> include_of(std::string_view line) {
  const auto skip = [&] { line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size())); };
  skip();
  if (!line.starts_with('#')) return std::nullopt;
  line.remove_prefix(1);
  skip();
  if (!line.starts_with("include")) return std::nullopt;
  line.remove_prefix(7);
  skip();
  if (line.empty() || (line[0] != '"' && line[0] != '<')) return std::nullopt;
  const bool bracket = line[0] == '<';
  const std::size_t end = line.find(bracket ? '>' : '"', 1);
  if (end == std::string_view::npos) return std::nullopt;
  return Include{line.substr(1, end - 1), bracket};
}

}  // namespace

Findings check_inclusion(const std::vector<SourceFile>& files) {
  Findings findings;
  for (const SourceFile& file : files) {
    ++findings.files;
    std::istringstream lines(file.text);
    std::string line;
    for (std::size_t number = 1; std::getline(lines, line); ++number) {
      const auto include = include_of(line);
      if (!include) continue;
      ++findings.includes;
      const auto reason = include->bracket ? bracket_violation(file.path, include->target)
                                           : quoted_violation(file.path, include->target);
      if (reason) findings.violations.push_back({file.path, number, *reason});
    }
  }
  return findings;
}

std::vector<SourceFile> read_sources(const std::string& root) {
  std::vector<SourceFile> files;
  for (const FolderRule& rule : folder_rules()) {
    const std::filesystem::path folder = std::filesystem::path(root) / rule.folder;
    if (!std::filesystem::is_directory(folder)) continue;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".h" && extension != ".cpp" && extension != ".ino") continue;
      std::ostringstream text;
      text << std::ifstream(entry.path()).rdbuf();
      files.push_back({std::filesystem::relative(entry.path(), root).generic_string(), text.str()});
    }
  }
  return files;
}

}  // namespace touchline::checks
