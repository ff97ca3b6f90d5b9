#pragma once

#include <array>
#include <cstddef>

namespace touchline {

/// A vector of at most `N` default-constructible, trivially copyable elements that never allocates.
/// `push_back` on a full vector only increments the overflow count, which the caller reports.
template <class T, std::size_t N>
class FixedVector {
 public:
  using value_type = T;
  static constexpr std::size_t capacity() { return N; }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] bool full() const { return size_ == N; }
  /// Number of rejected elements since the last clear().
  [[nodiscard]] std::size_t overflow() const { return overflow_; }

  bool push_back(const T& value) {
    if (size_ == N) {
      ++overflow_;
      return false;
    }
    data_[size_++] = value;
    return true;
  }
  /// Adds `count` to the overflow count, for elements that the caller did not pass to push_back because the vector is
  /// full.
  void add_overflow(std::size_t count) { overflow_ += count; }
  void pop_back() { --size_; }
  void clear() { size_ = overflow_ = 0; }
  /// Changes the size, at most to the capacity. New elements have unspecified values.
  void resize(std::size_t size) { size_ = size < N ? size : N; }

  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  T& back() { return data_[size_ - 1]; }
  const T& back() const { return data_[size_ - 1]; }
  T* data() { return data_.data(); }
  const T* data() const { return data_.data(); }
  T* begin() { return data_.data(); }
  T* end() { return data_.data() + size_; }
  const T* begin() const { return data_.data(); }
  const T* end() const { return data_.data() + size_; }

 private:
  std::array<T, N> data_{};
  std::size_t size_ = 0;
  std::size_t overflow_ = 0;
};

}  // namespace touchline
