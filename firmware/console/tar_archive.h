#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace touchline::console {

/// A tar archive (POSIX.1-1988, "ustar") in memory, compressed with gzip. libarchive is not used, because it would load
/// further libraries, such as libxml2, into the firmware's locked memory. Throws std::bad_alloc if memory is short.
class TarArchive {
 public:
  /// `folder`: all files are in it. `time_s`: of the files, Unix time.
  TarArchive(std::string folder, std::int64_t time_s);
  ~TarArchive() { ::deflateEnd(&stream_); }
  TarArchive(const TarArchive&) = delete;
  TarArchive& operator=(const TarArchive&) = delete;

  /// `name`: at most 99 bytes together with the folder and a slash; a longer one is cut off.
  void add(std::string_view name, std::string_view bytes);
  /// The compressed archive; call it once, at the end.
  std::string finish();

 private:
  void compress(std::string_view bytes, int flush);

  const std::string folder_;
  const std::int64_t time_s_;
  z_stream stream_{};
  std::string compressed_;
};

}  // namespace touchline::console
