#include "firmware/config/file_replacement.h"

#include <sys/stat.h>

#include <filesystem>

#include "hal/linux/files/input_file.h"
#include "hal/linux/files/output_file.h"

namespace touchline::config {

Result<std::optional<std::string>> read_text(const std::string& path) {
  std::string text, reason;
  const Status status = hal::read_file(path, hal::kMaxTextFileBytes, text, reason);
  if (status.ok()) return std::optional(std::move(text));
  if (status.code() == ErrorCode::kNotFound) return std::optional<std::string>();
  return Error{status.code(), reason};
}

Result<void> back_up(const std::string& path) {
  TOUCHLINE_TRY_ASSIGN(const std::optional<std::string> text, read_text(path));
  struct stat former {};
  if (!text.has_value() || ::stat(path.c_str(), &former) != 0) return {};
  std::error_code error;
  const std::filesystem::path target = std::filesystem::canonical(path, error);
  // Do not follow a link that somebody has put there under this name.
  const hal::OutputOptions options{.follow_links = false, .mode = former.st_mode & 0777};
  std::string reason;
  const Status status = hal::write_file((error ? path : target.string()) + ".bak", *text, reason, options);
  if (!status.ok()) return Error{status.code(), reason};
  return {};
}

Result<void> replace_file(const std::string& path, std::string_view text) {
  hal::OutputFile file;
  const auto failed = [&file](Status status) { return Error{status.code(), file.reason()}; };
  if (const Status status = file.open(path); !status.ok()) return failed(status);
  if (const Status status = file.write(text); !status.ok()) return failed(status);
  TOUCHLINE_TRY(back_up(path));
  if (const Status status = file.commit(); !status.ok()) return failed(status);
  return {};
}

}  // namespace touchline::config
