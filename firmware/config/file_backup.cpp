#include "firmware/config/file_backup.h"

#include <sys/stat.h>

#include <filesystem>

#include "hal/files/input_file.h"
#include "hal/files/output_file.h"

namespace touchline::config {

Result<std::optional<std::string>> read_text(const std::string& path) {
  Result<std::string> text = hal::read_file(path, hal::kMaxTextFileBytes);
  if (text.ok()) return std::optional(std::move(text).value());
  if (text.code() == ErrorCode::kNotFound) return std::optional<std::string>();
  return std::move(text).error();
}

Result<void> back_up(const std::string& path) {
  TOUCHLINE_TRY_ASSIGN(const std::optional<std::string> text, read_text(path));
  struct stat former {};
  if (!text.has_value() || ::stat(path.c_str(), &former) != 0) return {};
  std::error_code error;
  const std::filesystem::path target = std::filesystem::canonical(path, error);
  // Does not follow a symbolic link that somebody has planted under this name.
  const hal::OutputOptions options{.follow_links = false, .mode = former.st_mode & 0777};
  return hal::write_file((error ? path : target.string()) + ".bak", *text, options);
}

Result<void> replace_file(const std::string& path, std::string_view text) {
  hal::OutputFile file;
  TOUCHLINE_TRY(file.open(path));
  TOUCHLINE_TRY(file.write(text));
  TOUCHLINE_TRY(back_up(path));
  return file.commit();
}

}  // namespace touchline::config
