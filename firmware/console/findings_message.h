#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware/console/messages.h"
#include "firmware/picture_exchange.h"
#include "firmware/report/json_writer.h"

// Writes the server's messages with the findings of a picture (docs/console-protocol.md).
namespace touchline::console {

/// Class of a pixel outside the region of interest, in a picture of classes.
inline constexpr std::uint8_t kOutsideClass = 255;
static_assert(kMaxColors < kOutsideClass);
/// Maximum number of regions in a message. A field with 22 robots has about 130.
inline constexpr std::size_t kMaxShownRegions = 400;

/// Appends values in raster order; each run of equal values is written as its length (u16, little-endian) and the value
/// (u8).
class RunLengthWriter {
 public:
  explicit RunLengthWriter(std::vector<std::byte>& out) : out_(out) {}
  void add(std::uint8_t value);
  /// Writes the last run.
  void end();

 private:
  std::vector<std::byte>& out_;
  std::uint8_t value_ = 0;
  std::uint16_t count_ = 0;
};

/// Appends the classes of a picture reduced by `divisor`: for each block, the class of the pixel in its middle. This
/// takes about 2 ms for 640 x 480 pixels.
void append_classes(const Frame& frame, const PixelClassifier& classifier, int divisor, std::vector<std::byte>& out);
/// Appends the light level of each tile, averaged over its channels; without a light map, one neutral tile.
void append_light(const PixelClassifier& classifier, std::vector<std::byte>& out);

/// Writes the regions; if there are too many, only those that were examined and the larger ones.
void write_regions(report::JsonWriter& json, const PictureFindings& findings, std::uint64_t number);

/// Answers request `to` about the pixel, which is in the frame.
void write_probe(report::JsonWriter& json, const Scene& scene, const Frame& frame, const PictureFindings& findings,
                 PixelPoint pixel, std::uint64_t number, std::int64_t to);

}  // namespace touchline::console
