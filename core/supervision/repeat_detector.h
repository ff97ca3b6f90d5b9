#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/types.h"

namespace touchline {

/// Notices pictures that the camera has delivered before, as a whole or in a part: frozen, frozen in one half, torn, or
/// old buffers in turn. Between two pictures of a camera, its noise changes at least one of many pixels.
///
/// The picture is divided into tiles. A hash of some pixels of a tile is compared with that of the frame before, and
/// the hash of the strip of four tiles that it belongs to is looked up among those of the last pictures, which tells
/// when this content was delivered first: two ages of the tile. An age is judged only if this camera keeps it small:
/// the tile must have been renewed often, and an age counts only beyond the largest one that this tile usually reaches,
/// as in compressed video. Tiles of one value (black, or saturated) say nothing. Pictures without noise, in which most
/// tiles stay the same, are not judged by tiles.
///
/// The work is bounded: kTiles * kWordsPerTile loads per frame. The object is large (fixed memory).
class RepeatDetector {
 public:
  static constexpr std::size_t kColumns = 8, kRows = 6, kTiles = kColumns * kRows;
  /// 256 bytes of a tile: if nine in ten of their values equal those of the frame before, all of them do once in 10^11.
  static constexpr std::size_t kRowsPerTile = 8, kWordsPerRow = 4;

  /// Forgets everything. A picture that is too small for the tiles is not judged.
  void configure(PixelFormat format, std::uint16_t width_px, std::uint16_t height_px);
  /// Forgets how old the picture is, not what is usual.
  void restart() { still_ = {}; }

  struct Result {
    float share = 0.0f;        // part of the picture that was delivered before, for longer than is usual
    Duration age{};            // the largest age in that part
    bool is_repeated = false;  // the part is large enough to stop robots
    bool is_replayed = false;  // the same, and what it repeats goes on: a delayed part, or old buffers in turn
    bool is_still = false;     // the whole picture repeats while robots are driven; only they could change it
  };
  /// `limit`: robots must stop if they are controlled by an older picture. `is_moving`: robots have been commanded to
  /// move for so long that they do; pictures without noise change only then. The frame has the configured format and
  /// size, and all planes. `seen`: a hash of what was recognized in it, which changes with every motion.
  Result check(const Frame& frame, Duration limit, bool is_moving, std::uint64_t seen);

 private:
  // Milliseconds since the first frame; differences are right for 49 days.
  using Time = std::uint32_t;
  // Pictures tear along rows, so strips find old parts, and need less memory than tiles.
  static constexpr std::size_t kStripTiles = 4, kStrips = kTiles / kStripTiles;
  // At 60 Hz, eight in ten of the contents of half a second ago are still known.
  static constexpr std::size_t kSlots = 128;
  struct Content {
    std::uint32_t hash = 0;
    Time first = 0;
  };
  // What ages are usual: the largest ones of the present and the former period, which end after kPeriod renewals.
  struct Usual {
    Time now = 0, former = 0;
    std::uint32_t renewals_now = 0, renewals_former = 0;

    void add(Time age);
    [[nodiscard]] Time largest() const { return now > former ? now : former; }
    [[nodiscard]] std::uint32_t renewals() const { return renewals_now + renewals_former; }
  };
  struct Age {
    Time value = 0, former = 0;  // in this frame, and in the one before
    Usual usual;
  };
  struct Tile {
    std::uint32_t hash = 0;
    Time changed = 0;
    bool is_flat = false, is_changed = false;  // since the frame before
    // Since the content last changed, and since that of the strip was delivered first. With little noise, a content
    // comes back by chance, and then only the first one tells a picture that is frozen.
    std::array<Age, 2> ages;
  };
  struct Still {
    std::uint64_t hash = 0;
    Time since = 0, age = 0;
  };

  [[nodiscard]] std::uint64_t look_up(const Frame& frame, Time now);
  [[nodiscard]] Time first_delivery(std::size_t strip, std::uint64_t hash, Time now);
  void check_still(std::uint64_t hash, Time now, Time limit, bool is_moving, Result& result);

  std::array<std::uint32_t, kColumns * kWordsPerRow> offset_bytes_{};  // of the words, from the row's first byte
  std::array<std::uint16_t, kRows * kRowsPerTile> row_{};
  bool active_ = false, started_ = false;
  Instant begin_{};
  std::array<std::array<Content, kSlots>, kStrips> contents_{};
  std::array<Tile, kTiles> tiles_{};
  Still still_;
  Usual still_usual_;
};

}  // namespace touchline
