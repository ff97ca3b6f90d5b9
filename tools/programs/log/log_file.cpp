#include "tools/programs/log/log_file.h"

#include <array>
#include <filesystem>
#include <fstream>

#include "hal/recording/mcap_format.h"
#include "hal/recording/ssl_log.h"
#include "tools/programs/command_line/would_overwrite.h"

namespace touchline::log {

Result<LogFormat> format_of(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    return failure(ErrorCode::kNotFound, "%s: no such file", path.c_str());
  }
  if (error) return failure(ErrorCode::kIo, "%s: %s", path.c_str(), error.message().c_str());
  // A FIFO or device would wait for its writer.
  if (!std::filesystem::is_regular_file(status))
    return failure(ErrorCode::kUnsupported, "%s: is not a file", path.c_str());
  std::ifstream file(path, std::ios::binary);
  if (!file) return failure(ErrorCode::kPermission, "%s: cannot be opened", path.c_str());
  std::array<char, 12> bytes{};
  file.read(bytes.data(), bytes.size());
  const std::string_view first(bytes.data(), static_cast<std::size_t>(file.gcount()));
  if (first.starts_with(hal::mcap::kMagic)) return LogFormat::kMcap;
  if (hal::is_ssl_log(first)) return LogFormat::kSslLog;
  return failure(ErrorCode::kCorruptFrame, "%s: byte 0: neither a recording (MCAP) nor a game log (SSL_LOG_FILE)",
                 path.c_str());
}

Result<OutputFormat> output_format_of(const std::string& path) {
  if (path.ends_with(".mcap")) return OutputFormat::kMcap;
  if (path.ends_with(".log") || path.ends_with(".log.gz")) return OutputFormat::kSslLog;
  if (path.ends_with(".csv")) return OutputFormat::kCsv;
  return failure(ErrorCode::kUnsupported, "%s: the name has to end in .mcap, .log, .log.gz or .csv", path.c_str());
}

Result<void> check_output(const std::string& input, const std::string& output) {
  if (!would_overwrite(input, output)) return {};
  return failure(ErrorCode::kInconsistent, "%s: would replace the input", output.c_str());
}

}  // namespace touchline::log
