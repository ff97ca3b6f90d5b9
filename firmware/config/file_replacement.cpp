#include "firmware/config/file_replacement.h"

#include <sys/stat.h>

#include <filesystem>

#include "hal/linux/files/input_file.h"
#include "hal/linux/files/output_file.h"

namespace touchline::config {

Status read_text(const std::string& path, std::string& text, bool& exists, std::string& reason) {
  const Status status = hal::read_file(path, hal::kMaxTextFileBytes, text, reason);
  exists = status.code() != ErrorCode::kNotFound;
  return exists ? status : Status();
}

Status back_up(const std::string& path, std::string& reason) {
  std::string text;
  bool exists = false;
  if (const Status status = read_text(path, text, exists, reason); !status.ok() || !exists) return status;
  struct stat former {};
  if (::stat(path.c_str(), &former) != 0) return {};
  std::error_code error;
  const std::filesystem::path target = std::filesystem::canonical(path, error);
  // A link that somebody has put there under this name is not followed.
  const hal::OutputOptions options{.follow_links = false, .mode = former.st_mode & 0777};
  return hal::write_file((error ? path : target.string()) + ".bak", text, reason, options);
}

Status replace_file(const std::string& path, std::string_view text, std::string& reason) {
  hal::OutputFile file;
  Status status = file.open(path);
  if (status.ok()) status = file.write(text);
  if (status.ok()) {
    if (const Status kept = back_up(path, reason); !kept.ok()) return kept;
    status = file.commit();
  }
  if (!status.ok()) reason = file.reason();
  return status;
}

}  // namespace touchline::config
