#include "firmware/recording/recording_files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
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

// 18 digits fit into 64 bits.
constexpr std::size_t kMinDigits = 4, kMaxDigits = 18;
constexpr std::string_view kDateShape = "-00000000-000000";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_date(std::string_view text) {
  return std::equal(text.begin(), text.end(), kDateShape.begin(), kDateShape.end(),
                    [](char c, char shape) { return shape == '0' ? is_digit(c) : c == shape; });
}

// The quota deletes these files, so the name must be exactly one that next_name() returns.
std::optional<std::uint64_t> number_of(std::string_view name) {
  if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix)) return std::nullopt;
  name.remove_prefix(kPrefix.size());
  name.remove_suffix(kSuffix.size());
  const auto digits = static_cast<std::size_t>(std::find_if_not(name.begin(), name.end(), is_digit) - name.begin());
  const std::string_view rest = name.substr(digits);
  if (digits < kMinDigits || digits > kMaxDigits || (!rest.empty() && !is_date(rest))) return std::nullopt;
  std::uint64_t number = 0;
  std::from_chars(name.data(), name.data() + digits, number);
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

bool is_recording_name(std::string_view name) {
  return name.ends_with(kSuffix) && name.size() > kSuffix.size() && !name.starts_with('.') &&
         name.find('/') == std::string_view::npos && name.find('\0') == std::string_view::npos;
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names, others;
  for (const RecordingFile& file : recordings_in(folder)) names.push_back(file.name);
  std::reverse(names.begin(), names.end());
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::string name = entry->path().filename().string();
    std::error_code unknown;
    const bool is_shown = is_recording_name(name) && fs::is_regular_file(entry->symlink_status(unknown));
    if (is_shown && !number_of(name)) others.push_back(std::move(name));
  }
  std::sort(others.begin(), others.end());
  names.insert(names.end(), others.begin(), others.end());
  return names;
}

std::string date_of(std::string_view name) {
  if (!number_of(name)) return {};
  name.remove_suffix(kSuffix.size());
  if (name.size() < kDateShape.size() || !is_date(name.substr(name.size() - kDateShape.size()))) return {};
  const std::string digits(name.substr(name.size() - kDateShape.size() + 1));
  return digits.substr(0, 4) + "-" + digits.substr(4, 2) + "-" + digits.substr(6, 2) + " " + digits.substr(9, 2) + ":" +
         digits.substr(11, 2) + ":" + digits.substr(13, 2);
}

bool is_being_written(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0) return false;
  const bool is_locked = ::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(file);
  return is_locked;
}

std::string next_name(const std::vector<RecordingFile>& recordings) {
  const std::uint64_t number = recordings.empty() ? 1 : recordings.back().number + 1;
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%04llu", static_cast<unsigned long long>(number));
  return std::string(kPrefix) + digits.data() + date_of_now() + std::string(kSuffix);
}

QuotaRemovals keep_quota(const std::string& folder, const std::string& current, std::uint64_t quota_bytes) {
  const std::vector<RecordingFile> files = recordings_in(folder);
  std::uint64_t total = 0;
  for (const RecordingFile& file : files) total += file.bytes;
  QuotaRemovals removals;
  for (const RecordingFile& file : files) {
    if (total <= quota_bytes) break;
    const std::string path = (fs::path(folder) / file.name).string();
    if (file.name == current || is_being_written(path)) continue;
    std::error_code error;
    if (fs::remove(path, error)) {
      total -= file.bytes;
      removals.deleted.push_back(file.name);
    } else if (error && removals.failure.empty()) {
      removals.failure = path + ": " + error.message();
    }
  }
  return removals;
}

}  // namespace touchline::recording
