#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace touchline::hal {

/// Memory for decoded pictures; the caller borrows some slots at a time. Each remembers the driver's buffer with the
/// picture as it was sent.
class PictureSlots {
 public:
  /// Allocates all memory; all slots are free.
  void allocate(std::size_t count, std::size_t picture_bytes) {
    picture_bytes_ = picture_bytes;
    memory_.assign(count * picture_bytes, 0);
    lent_.assign(count, false);
    source_.assign(count, 0);
  }
  /// Takes the first free slot, so that a caller that holds one picture at a time always gets memory that is in the
  /// caches.
  [[nodiscard]] std::optional<std::size_t> take(std::size_t source_buffer) {
    const auto free = std::find(lent_.begin(), lent_.end(), false);
    if (free == lent_.end()) return std::nullopt;
    *free = true;
    const auto slot = static_cast<std::size_t>(free - lent_.begin());
    source_[slot] = source_buffer;
    return slot;
  }
  /// Returns the source buffer of the picture.
  std::size_t give_back(std::size_t slot) {
    lent_[slot] = false;
    return source_[slot];
  }
  void give_back_all() { std::fill(lent_.begin(), lent_.end(), false); }
  [[nodiscard]] bool all_lent() const { return std::find(lent_.begin(), lent_.end(), false) == lent_.end(); }
  [[nodiscard]] std::uint8_t* bytes(std::size_t slot) { return memory_.data() + slot * picture_bytes_; }

 private:
  std::vector<std::uint8_t> memory_;
  std::size_t picture_bytes_ = 0;
  std::vector<bool> lent_;
  std::vector<std::size_t> source_;
};

}  // namespace touchline::hal
