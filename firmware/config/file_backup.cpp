#include "firmware/config/file_backup.h"

#include <sys/stat.h>

#include <filesystem>

#include "hal/files/input_file.h"
#include "hal/files/output_file.h"

namespace touchline::config {
namespace {

Result<std::optional<std::string>> read_if_present(const std::string& path, std::size_t limit_bytes) {
  Result<std::string> text = hal::read_file(path, limit_bytes);
  if (text.ok()) return std::optional(std::move(text).value());
  if (text.code() == ErrorCode::kNotFound) return std::optional<std::string>();
  return std::move(text).error();
}

}  // namespace

Result<std::optional<std::string>> read_text(const std::string& path) {
  return read_if_present(path, hal::kMaxTextFileBytes);
}

Result<std::optional<std::string>> read_data(const std::string& path) {
  return read_if_present(path, hal::kMaxDataFileBytes);
}

Result<void> back_up(const std::string& path) {
  TOUCHLINE_TRY_ASSIGN(const std::optional<std::string> text, read_data(path));
  struct stat former {};
  if (!text.has_value() || ::stat(path.c_str(), &former) != 0) return {};
  std::error_code error;
  const std::filesystem::path target = std::filesystem::canonical(path, error);
  // Do not follow a symbolic link that somebody may have created under this name.
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
