#include "core/supervision/repeat_detector.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

namespace touchline {
namespace {

// Smallest number of old tiles that stops robots: an eighth of the picture. A robot between two tiles covers less.
constexpr std::size_t kMinOldTiles = RepeatDetector::kTiles / 8;
// A tile is judged after this many renewals, in 1 to 3 s.
constexpr std::uint32_t kMinRenewals = 64;
// Renewals in a period of half a minute to a minute. A rare hiccup of the camera is forgotten after two periods.
constexpr std::uint32_t kPeriod = 2048;
// Longest usual repeat of a tile that is judged. If tiles usually repeat for longer, a frozen one would be noticed too
// late.
constexpr std::uint32_t kMaxUsualRepeat_ms = 1000;
// Time from a command to a visible motion: delay of radio and camera, and lag of the wheels.
constexpr std::uint32_t kReaction_ms = 200;

// An odd factor with irregular bits (Knuth's golden ratio).
constexpr std::uint64_t kMultiplier = 0x9E3779B97F4A7C15u;

std::uint64_t load_word(const std::uint8_t* bytes) {
  std::uint64_t word = 0;
  std::memcpy(&word, bytes, sizeof word);
  return word;
}

std::uint64_t mixed(std::uint64_t hash, std::uint64_t word) { return std::rotl(hash ^ word, 29) * kMultiplier; }

}  // namespace

void RepeatDetector::Usual::add(Time age) {
  now = std::max(now, age);
  if (++renewals_now < kPeriod) return;
  former = now;
  renewals_former = renewals_now;
  now = 0;
  renewals_now = 0;
}

void RepeatDetector::configure(PixelFormat format, std::uint16_t width_px, std::uint16_t height_px) {
  tiles_ = {};
  for (std::array<Content, kSlots>& slots : contents_) slots.fill({});
  still_ = {};
  still_usual_ = {};
  started_ = false;
  const std::size_t bytes = row_bytes(format, 0, width_px);
  const std::size_t tile_bytes = bytes / kColumns;
  active_ = tile_bytes >= sizeof(std::uint64_t) && height_px >= row_.size();
  if (!active_) return;
  for (std::size_t i = 0; i < offset_bytes_.size(); ++i) {
    // Words are evenly distributed from the first to the last whole word of the tile.
    const std::size_t column = i / kWordsPerRow, word = i % kWordsPerRow;
    const std::size_t within = (tile_bytes - sizeof(std::uint64_t)) * (2 * word + 1) / (2 * kWordsPerRow);
    offset_bytes_[i] = static_cast<std::uint32_t>(column * tile_bytes + within);
  }
  for (std::size_t i = 0; i < row_.size(); ++i) {
    row_[i] = static_cast<std::uint16_t>((2 * i + 1) * height_px / (2 * row_.size()));
  }
}

RepeatDetector::Result RepeatDetector::check(const Frame& frame, Duration limit, bool is_moving, std::uint64_t seen) {
  Result result;
  if (!active_) return result;
  if (!started_) begin_ = frame.capture_time;
  started_ = true;
  const auto milliseconds = [](Duration d) {
    return static_cast<Time>(std::chrono::duration_cast<std::chrono::milliseconds>(d).count());
  };
  const Time now = milliseconds(frame.capture_time - begin_), limit_ms = milliseconds(limit);
  const std::uint64_t whole = mixed(look_up(frame, now), seen);

  std::size_t judged = 0, old = 0, changed = 0;
  Time age = 0;
  for (const Tile& tile : tiles_) {
    bool is_judged = false;
    Time tile_age = 0;
    for (const Age& of : tile.ages) {
      const Time usual = of.usual.largest();
      if (of.usual.renewals() < kMinRenewals || usual > kMaxUsualRepeat_ms) continue;
      is_judged = true;
      if (of.value > limit_ms + usual) tile_age = std::max(tile_age, of.value);
    }
    judged += is_judged ? 1 : 0;
    if (tile.is_flat || tile_age == 0) continue;
    ++old;
    changed += tile.is_changed ? 1 : 0;
    age = std::max(age, tile_age);
  }
  result.share = static_cast<float>(old) / float{kTiles};
  result.age = std::chrono::milliseconds(age);
  result.is_repeated = 2 * judged >= kTiles && old >= kMinOldTiles;
  result.is_replayed = result.is_repeated && 2 * changed > old;
  // Ages during a fault do not count as usual.
  if (!result.is_repeated) {
    for (Tile& tile : tiles_) {
      for (Age& of : tile.ages) {
        if (of.value == 0) of.usual.add(of.former);
      }
    }
  }
  check_still(whole, now, limit_ms, is_moving, result);
  return result;
}

// Finds the ages of the tiles. Returns the hash of the whole picture.
std::uint64_t RepeatDetector::look_up(const Frame& frame, Time now) {
  std::uint64_t whole = 0;
  for (std::size_t tile_row = 0; tile_row < kRows; ++tile_row) {
    std::array<std::uint64_t, kColumns> hash{}, first{}, differing{};
    const std::uint8_t* const first_row =
        frame.plane[0] + std::size_t{row_[tile_row * kRowsPerTile]} * frame.stride_bytes[0];
    for (std::size_t column = 0; column < kColumns; ++column) {
      first[column] = load_word(first_row + offset_bytes_[column * kWordsPerRow]);
    }
    for (std::size_t i = 0; i < kRowsPerTile; ++i) {
      const std::uint8_t* const row =
          frame.plane[0] + std::size_t{row_[tile_row * kRowsPerTile + i]} * frame.stride_bytes[0];
      for (std::size_t column = 0; column < kColumns; ++column) {
        for (std::size_t w = 0; w < kWordsPerRow; ++w) {
          const std::uint64_t word = load_word(row + offset_bytes_[column * kWordsPerRow + w]);
          hash[column] = mixed(hash[column], word);
          differing[column] |= word ^ first[column];
        }
      }
    }
    for (std::size_t column = 0; column < kColumns; column += kStripTiles) {
      std::uint64_t strip_hash = 0;
      for (std::size_t i = 0; i < kStripTiles; ++i) strip_hash = mixed(strip_hash, hash[column + i]);
      whole = mixed(whole, strip_hash);
      const std::size_t first_tile = tile_row * kColumns + column;
      const Time strip_age = now - first_delivery(first_tile / kStripTiles, strip_hash, now);
      for (std::size_t i = 0; i < kStripTiles; ++i) {
        Tile& tile = tiles_[first_tile + i];
        const auto code = static_cast<std::uint32_t>(hash[column + i] >> 32u);
        tile.is_changed = code != tile.hash;
        tile.is_flat = differing[column + i] == 0;
        if (tile.is_changed) tile.changed = now;
        tile.hash = code;
        const std::array<Time, 2> ages{now - tile.changed, strip_age};
        for (std::size_t k = 0; k < ages.size(); ++k) {
          tile.ages[k].former = std::exchange(tile.ages[k].value, ages[k]);
        }
      }
    }
  }
  return whole;
}

RepeatDetector::Time RepeatDetector::first_delivery(std::size_t strip, std::uint64_t hash, Time now) {
  const auto code = static_cast<std::uint32_t>(hash >> 32u);
  Content& content = contents_[strip][code % kSlots];
  // New content replaces the content in its slot.
  if (content.hash != code || code == 0) content = {code, now};
  return content.first;
}

// A picture without noise repeats whenever nothing moves, so only the time counts during which robots must move.
void RepeatDetector::check_still(std::uint64_t hash, Time now, Time limit, bool is_moving, Result& result) {
  const bool was_still = still_.age > limit + kReaction_ms + still_usual_.largest();
  if (hash != still_.hash) {
    if (!was_still && is_moving) still_usual_.add(still_.age);
    still_ = {hash, now, 0};
  } else if (is_moving && still_usual_.renewals() >= kMinRenewals) {
    still_.age += now - still_.since;
  } else if (!was_still) {
    still_.age = 0;
  }
  still_.since = now;
  if (still_.age <= limit + kReaction_ms + still_usual_.largest()) return;
  result.is_still = true;
  result.share = 1.0f;
  result.age = std::chrono::milliseconds(still_.age);
}

}  // namespace touchline
