#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace touchline::console {

/// A tar archive (POSIX.1-1988, "ustar") in memory, compressed with gzip. libarchive is not used, because it would load
/// further libraries, such as libxml2, into the firmware's locked memory. Throws std::bad_alloc if memory runs out.
class TarArchive {
 public:
  /// `folder`: folder of all files in the archive. `time_s`: Unix time of the files.
  TarArchive(std::string folder, std::int64_t time_s);
  ~TarArchive() { ::deflateEnd(&stream_); }
  TarArchive(const TarArchive&) = delete;
  TarArchive& operator=(const TarArchive&) = delete;

  /// `name` may have at most 99 bytes together with the folder and a slash; longer names are cut off.
  void add(std::string_view name, std::string_view bytes);
  /// Returns the compressed archive; call it once, at the end.
  std::string finish();

 private:
  void compress(std::string_view bytes, int flush);

  const std::string folder_;
  const std::int64_t time_s_;
  z_stream stream_{};
  std::string compressed_;
};

}  // namespace touchline::console
