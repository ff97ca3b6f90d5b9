#include "tools/programs/command_line/would_overwrite.h"

#include <filesystem>

namespace touchline {

bool would_overwrite(const std::string& input, const std::string& output) {
  namespace fs = std::filesystem;
  if (input.empty() || output.empty()) return false;
  std::error_code ignored;
  if (fs::is_character_file(output, ignored)) return false;
  const auto canonical = [](const std::string& path) {
    std::error_code failure;
    // Make the path absolute first, because weakly_canonical() leaves the path of a file that does not exist relative.
    const fs::path full = fs::weakly_canonical(fs::absolute(path), failure);
    return full.has_filename() ? full : full.parent_path();  // without a slash at the end
  };
  const fs::path from = canonical(input), to = canonical(output);
  const bool among_pictures = to.has_extension() && to.extension() != ".jsonl" && to.extension() != ".mp4";
  return from == to || (from == to.parent_path() && among_pictures);
}

}  // namespace touchline
