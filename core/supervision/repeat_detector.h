#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/types.h"

namespace touchline {

/// Detects pictures, or parts of them, that the camera has delivered before: frozen, frozen in one half, torn, or old
/// buffers in turn. Between two pictures of a camera, noise changes at least one of many pixels.
///
/// The picture is divided into tiles, and each tile has two ages. For the first, a hash of some of its pixels is
/// compared with the previous frame's. For the second, the hash of its strip of four tiles is searched among those of
/// recent pictures; this gives the time at which the content was first delivered. An age is judged only if this camera
/// keeps it small. The tile must have been renewed often, and only the time beyond its largest usual age counts,
/// because compressed video repeats tiles. Tiles of one value (black, or saturated) are ignored. In pictures without
/// noise most tiles repeat, so they are not judged by tiles.
///
/// The work is bounded: kTiles * kWordsPerTile loads per frame. The object is large (fixed memory).
class RepeatDetector {
 public:
  static constexpr std::size_t kColumns = 8, kRows = 6, kTiles = kColumns * kRows;
  /// A tile's hash covers 256 bytes. Even if each of them repeats with a probability of nine in ten, all of them do
  /// only once in 10^11.
  static constexpr std::size_t kRowsPerTile = 8, kWordsPerRow = 4;

  /// Forgets everything. A picture that is too small for the tiles is not judged.
  void configure(PixelFormat format, std::uint16_t width_px, std::uint16_t height_px);
  /// Forgets how old the picture is, but not the usual ages.
  void restart() { still_ = {}; }

  struct Result {
    float share = 0.0f;        // share of the picture that repeats for longer than usual
    Duration age{};            // largest age in this share
    bool is_repeated = false;  // the share is large enough to stop robots
    bool is_replayed = false;  // is_repeated, and the repeated content moves on: a delayed part, or old buffers in turn
    bool is_still = false;     // the whole picture, which has no noise, repeats although robots are driven
  };
  /// `limit`: age above which a picture must stop the robots. `is_moving`: robots have been commanded to move for long
  /// enough to be moving; only then must a picture without noise change. The frame has the configured format and size,
  /// and all planes. `seen`: a hash of the sightings, which changes with every motion.
  Result check(const Frame& frame, Duration limit, bool is_moving, std::uint64_t seen);

 private:
  // Milliseconds since the first frame; differences are right for 49 days.
  using Time = std::uint32_t;
  // Pictures tear along rows, so strips find old parts, and need less memory than tiles.
  static constexpr std::size_t kStripTiles = 4, kStrips = kTiles / kStripTiles;
  // At 60 Hz, eight in ten contents of half a second ago are still in the table.
  static constexpr std::size_t kSlots = 128;
  struct Content {
    std::uint32_t hash = 0;
    Time first = 0;
  };
  // Usual ages: the largest ones of the present and of the former period. A period ends after kPeriod renewals.
  struct Usual {
    Time now = 0, former = 0;
    std::uint32_t renewals_now = 0, renewals_former = 0;

    void add(Time age);
    [[nodiscard]] Time largest() const { return now > former ? now : former; }
    [[nodiscard]] std::uint32_t renewals() const { return renewals_now + renewals_former; }
  };
  struct Age {
    Time value = 0, former = 0;  // age in this frame, and in the previous one
    Usual usual;
  };
  struct Tile {
    std::uint32_t hash = 0;
    Time changed = 0;
    bool is_flat = false, is_changed = false;  // is_changed: compared with the previous frame
    // Time since the content last changed, and since the strip's content was first delivered. With little noise, a
    // content recurs by chance. Then only the first age reveals a frozen picture.
    std::array<Age, 2> ages;
  };
  struct Still {
    std::uint64_t hash = 0;
    Time since = 0, age = 0;
  };

  [[nodiscard]] std::uint64_t look_up(const Frame& frame, Time now);
  [[nodiscard]] Time first_delivery(std::size_t strip, std::uint64_t hash, Time now);
  void check_still(std::uint64_t hash, Time now, Time limit, bool is_moving, Result& result);

  std::array<std::uint32_t, kColumns * kWordsPerRow> offset_bytes_{};  // offsets of the words from the row's first byte
  std::array<std::uint16_t, kRows * kRowsPerTile> row_{};
  bool active_ = false, started_ = false;
  Instant begin_{};
  std::array<std::array<Content, kSlots>, kStrips> contents_{};
  std::array<Tile, kTiles> tiles_{};
  Still still_;
  Usual still_usual_;
};

}  // namespace touchline
