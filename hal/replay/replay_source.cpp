#include "hal/replay/replay_source.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "core/types.h"
#include "hal/replay/picture_decoder.h"

namespace touchline::hal {
namespace {

bool digit(char c) { return c >= '0' && c <= '9'; }

// Removes the leading digits from `text` and returns them without leading zeros.
std::string_view take_number(std::string_view& text) {
  const auto end = static_cast<std::size_t>(std::find_if_not(text.begin(), text.end(), digit) - text.begin());
  std::string_view number = text.substr(0, end);
  text.remove_prefix(end);
  number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
  return number;
}

}  // namespace

bool natural_less(const std::string& a, const std::string& b) {
  std::string_view x = a, y = b;
  while (!x.empty() && !y.empty()) {
    if (digit(x.front()) && digit(y.front())) {
      const std::string_view m = take_number(x), n = take_number(y);
      if (m.size() != n.size()) return m.size() < n.size();
      if (m != n) return m < n;
      continue;
    }
    if (x.front() != y.front()) return static_cast<unsigned char>(x.front()) < static_cast<unsigned char>(y.front());
    x.remove_prefix(1);
    y.remove_prefix(1);
  }
  if (x.empty() != y.empty()) return x.empty();
  return a < b;  // a fixed order for "01" and "1"
}

bool is_picture_name(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array<std::string_view, 5> kEndings{".png", ".ppm", ".pgm", ".jpg", ".jpeg"};
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

Result<void> PictureSource::open() {
  files_.clear();
  next_ = 0;
  std::error_code error;
  if (!std::filesystem::is_directory(path_, error)) {
    files_.push_back(path_);
    return {};
  }
  const auto is_before = [](const std::filesystem::path& a, const std::filesystem::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  };
  std::filesystem::path other;  // the first file of another format
  std::filesystem::directory_iterator entry(path_, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    if (entry->is_directory()) continue;
    if (is_picture_name(entry->path())) {
      files_.push_back(entry->path());
    } else if (other.empty() || is_before(entry->path(), other)) {
      other = entry->path();
    }
  }
  if (error) {
    return failure(error == std::errc::permission_denied ? ErrorCode::kPermission : ErrorCode::kIo, "%s: %s",
                   path_.c_str(), error.message().c_str());
  }
  if (files_.empty()) {
    return failure(ErrorCode::kNotFound, "%s: the folder has no picture of a format that is read (%s)%s%s%s",
                   path_.c_str(), "png, ppm, pgm, jpg, jpeg", other.empty() ? "; it has no file at all" : "; ",
                   other.filename().c_str(), other.empty() ? "" : " is of another one: convert it");
  }
  std::sort(files_.begin(), files_.end(), is_before);
  return {};
}

Result<void> PictureSource::next(SourceFrame& out) {
  if (next_ == files_.size()) {
    return failure(ErrorCode::kEndOfStream, "%s: no more pictures", path_.c_str());
  }
  const std::filesystem::path& file = files_[next_];
  out.file = file.filename().string();
  out.stamp = from_seconds(static_cast<double>(next_) / rate_hz_);
  ++next_;
  const JpegColors colors = is_yuv(color_space(format_)) ? JpegColors::kAsStored : JpegColors::kRgb;
  constexpr std::int64_t kMaxPixels = std::int64_t{kMaxFrameWidth} * kMaxFrameHeight;
  TOUCHLINE_TRY_ASSIGN(const StoredPicture picture, decode_picture(file.string(), kMaxPixels, colors));
  Result<void> converted = convert(picture, format_, out);
  if (!converted.ok()) return prefixed(file.string(), std::move(converted).error());
  return converted;
}

}  // namespace touchline::hal
