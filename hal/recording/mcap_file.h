#pragma once

#include <cstdint>
#include <string>

#include "hal/result.h"

namespace touchline::hal::mcap {

/// What a path may be, besides a file.
enum class Links : std::uint8_t { kFollowed, kRefused };

/// A file in the format MCAP that is read at any place, also while another program writes it.
class McapFile {
 public:
  McapFile() = default;
  ~McapFile();
  McapFile(const McapFile&) = delete;
  McapFile& operator=(const McapFile&) = delete;

  /// Opens the file and checks its first bytes. kNotFound, kPermission, kIo; kUnsupported: it is no file;
  /// kCorruptFrame: it is not in this format.
  Result<void> open(const std::string& path, Links links);
  /// Reads bytes from a place. Returns false if the file ends before. kIo: the disk fails.
  Result<bool> read(std::uint64_t offset, std::uint64_t count, std::string& out) const;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Returns the size when the file was opened.
  [[nodiscard]] std::uint64_t size() const { return size_; }

 private:
  std::string path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace touchline::hal::mcap
