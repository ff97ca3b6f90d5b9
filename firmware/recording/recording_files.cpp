#include "firmware/recording/recording_files.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <optional>
#include <string_view>

#include "hal/linux/unix_time.h"

namespace touchline::recording {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "touchline-", kSuffix = ".mcap";

std::optional<std::uint64_t> number_of(std::string_view name) {
  if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix)) return std::nullopt;
  const char* const begin = name.data() + kPrefix.size();
  const char* const end = name.data() + name.size();
  std::uint64_t number = 0;
  const auto [after, error] = std::from_chars(begin, end, number);
  if (error != std::errc() || after == end || (*after != '-' && *after != '.')) return std::nullopt;
  return number;
}

// "-20261128-173005" in UTC; empty if nobody has set the clock.
std::string date_of_now() {
  if (!hal::measure_unix_time_offset().synchronized) return {};
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  std::array<char, 32> text{};
  if (::gmtime_r(&now, &parts) == nullptr) return {};
  return {text.data(), std::strftime(text.data(), text.size(), "-%Y%m%d-%H%M%S", &parts)};
}

}  // namespace

std::vector<RecordingFile> recordings_in(const std::string& folder) {
  std::vector<RecordingFile> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    const std::optional<std::uint64_t> number = number_of(name);
    std::error_code unknown;
    if (!number || !fs::is_regular_file(entry->symlink_status(unknown))) continue;
    const std::uintmax_t bytes = entry->file_size(unknown);
    files.push_back({name, *number, unknown ? 0 : std::uint64_t{bytes}});
  }
  std::sort(files.begin(), files.end(), [](const RecordingFile& a, const RecordingFile& b) {
    return a.number != b.number ? a.number < b.number : a.name < b.name;
  });
  return files;
}

std::string next_name(const std::vector<RecordingFile>& recordings) {
  const std::uint64_t number = recordings.empty() ? 1 : recordings.back().number + 1;
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%04llu", static_cast<unsigned long long>(number));
  return std::string(kPrefix) + digits.data() + date_of_now() + std::string(kSuffix);
}

std::vector<std::string> keep_quota(const std::string& folder, const std::string& current, std::uint64_t quota_bytes) {
  const std::vector<RecordingFile> files = recordings_in(folder);
  std::uint64_t total = 0;
  for (const RecordingFile& file : files) total += file.bytes;
  std::vector<std::string> deleted;
  for (const RecordingFile& file : files) {
    if (total <= quota_bytes) break;
    std::error_code error;
    if (file.name == current || !fs::remove(fs::path(folder) / file.name, error)) continue;
    total -= file.bytes;
    deleted.push_back(file.name);
  }
  return deleted;
}

}  // namespace touchline::recording
