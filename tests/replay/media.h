#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "hal/replay/picture.h"

// Small pictures and videos that tests make.
namespace touchline::media {

/// A temporary folder, which is removed with the object.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string path() const { return path_.string(); }
  [[nodiscard]] std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

std::vector<std::uint8_t> read_bytes(const std::string& path);
void write_bytes(const std::string& path, std::span<const std::uint8_t> bytes);
void write_text(const std::string& path, const std::string& text);

/// Returns a picture in which neighboring pixels differ. Different seeds give different pictures.
hal::Picture colorful(std::uint32_t width_px, std::uint32_t height_px, std::uint32_t seed = 0);
void write_png(const std::string& path, const hal::Picture& picture);
/// Writes a JPEG with chroma subsampling 4:2:0, as from cameras.
void write_jpeg(const std::string& path, const hal::Picture& picture);

/// Writes an uncompressed video (YUV4MPEG2). Each of `frames` contains the planes Y, U and V one after another.
void write_y4m(const std::string& path, int width_px, int height_px, const std::string& header,
               const std::vector<std::vector<std::uint8_t>>& frames);

/// Returns the checksum of PNG and zlib (ISO 3309).
std::uint32_t crc32(std::span<const std::uint8_t> bytes);

}  // namespace touchline::media
