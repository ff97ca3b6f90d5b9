#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>

#include "core/fixed_vector.h"
#include "core/time.h"

// Bytes of values that pass between the stages. Numbers are little-endian; a list is preceded by its size in 16 bits,
// an optional value by a byte that says whether it follows. Each struct has a function fields() that passes its members
// to an archive (firmware/recording/step_fields.h), for writing and for reading.
namespace touchline::recording {

static_assert(std::endian::native == std::endian::little, "numbers are copied from memory");

template <class T>
concept Plain = (std::is_arithmetic_v<T> && !std::same_as<T, bool>) || std::is_enum_v<T>;

/// Appends values to bytes: a string, or anything else that appends as a string does.
template <class Bytes = std::string>
class ArchiveWriter {
 public:
  explicit ArchiveWriter(Bytes& out) : out_(out) {}

  template <class... Values>
  void operator()(const Values&... values) {
    (put(values), ...);
  }

 private:
  void raw(const void* bytes, std::size_t count) { out_.append(static_cast<const char*>(bytes), count); }
  template <Plain T>
  void put(const T& value) {
    raw(&value, sizeof(T));
  }
  void put(const bool& value) { put(static_cast<std::uint8_t>(value ? 1 : 0)); }
  void put(const Duration& value) { put(static_cast<std::int64_t>(value.count())); }
  void put(const Instant& value) { put(value.time_since_epoch()); }
  template <class T>
  void put(const std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  template <class T, std::size_t N>
  void put(const std::array<T, N>& values) {
    for (const T& value : values) put(value);
  }
  template <class T, std::size_t N>
  void put(const FixedVector<T, N>& values) {
    static_assert(N <= 0xFFFF);
    put(static_cast<std::uint16_t>(values.size()));
    for (const T& value : values) put(value);
  }
  template <class T>
  requires std::is_class_v<T>
  void put(const T& value) { fields(*this, value); }

  Bytes& out_;
};

/// Bytes of a fixed capacity, which a loop may fill.
template <std::size_t kCapacity>
class FixedBytes {
 public:
  void clear() { size_ = 0; }
  /// What does not fit is left out, and fits() is false until clear().
  void append(const char* bytes, std::size_t count) {
    if (fits() && count <= kCapacity - size_) {
      std::memcpy(bytes_.data() + size_, bytes, count);
      size_ += count;
    } else {
      size_ = kCapacity + 1;
    }
  }
  [[nodiscard]] bool fits() const { return size_ <= kCapacity; }
  /// Empty if not everything fits.
  [[nodiscard]] std::span<const std::byte> bytes() const {
    return std::as_bytes(std::span(bytes_)).first(fits() ? size_ : 0);
  }

 private:
  std::array<char, kCapacity> bytes_{};
  std::size_t size_ = 0;
};

/// The last value of an enum that is read, as its member `value`. Each such enum specializes it, because a file may
/// have any byte there, and values index tables.
template <class Enum>
struct LastOf;

/// Which numbers an ArchiveReader takes. kSound: finite ones of at most 1e12, whole ones of at most 2^30, and times of
/// at most 73 years, with which filters compute without an overflow.
enum class Numbers : std::uint8_t { kAny, kSound };

/// Reads what ArchiveWriter has written. After a read beyond the end, of a list that is too long, or of a byte that is
/// no value of its enum or bool, ok() is false and further values keep what they have.
class ArchiveReader {
 public:
  explicit ArchiveReader(std::span<const std::byte> bytes, Numbers numbers = Numbers::kAny)
      : rest_(bytes), numbers_(numbers) {}

  template <class... Values>
  void operator()(Values&... values) {
    (get(values), ...);
  }
  /// For a value that is read, but refused by its limits.
  void refuse() { ok_ = false; }
  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::span<const std::byte> rest() const { return rest_; }

 private:
  template <Plain T>
  requires(!std::is_enum_v<T> || std::same_as<T, std::byte>) void get(T& value) {
    if (rest_.size() < sizeof(T)) ok_ = false;
    if (!ok_) return;
    std::memcpy(&value, rest_.data(), sizeof(T));
    rest_ = rest_.subspan(sizeof(T));
    if constexpr (std::is_floating_point_v<T>) {
      limit(std::abs(value) <= T(1e12));  // false for NaN
    } else if constexpr (std::same_as<T, std::int32_t>) {
      limit(value >= -(1 << 30) && value <= 1 << 30);
    }
  }
  void limit(bool is_sound) { ok_ = ok_ && (is_sound || numbers_ == Numbers::kAny); }
  template <class T>
  requires(std::is_enum_v<T> && !std::same_as<T, std::byte>) void get(T& value) {
    static_assert(std::is_unsigned_v<std::underlying_type_t<T>>, "one bound is enough");
    auto number = static_cast<std::underlying_type_t<T>>(value);
    get(number);
    ok_ = ok_ && number <= static_cast<std::underlying_type_t<T>>(LastOf<T>::value);
    if (ok_) value = static_cast<T>(number);
  }
  void get(bool& value) {
    std::uint8_t byte = 0;
    get(byte);
    ok_ = ok_ && byte <= 1;
    if (ok_) value = byte != 0;
  }
  void get(Duration& value) {
    constexpr std::int64_t kLongest = std::int64_t{1} << 61;
    std::int64_t count = 0;
    get(count);
    limit(count >= -kLongest && count <= kLongest);
    value = Duration(count);
  }
  void get(Instant& value) {
    Duration since{};
    get(since);
    value = Instant(since);
  }
  template <class T>
  void get(std::optional<T>& value) {
    bool has_value = false;
    get(has_value);
    value.reset();
    if (has_value) get(value.emplace());
  }
  template <class T, std::size_t N>
  void get(std::array<T, N>& values) {
    for (T& value : values) get(value);
  }
  template <class T, std::size_t N>
  void get(FixedVector<T, N>& values) {
    std::uint16_t size = 0;
    get(size);
    ok_ = ok_ && size <= N;
    values.clear();
    for (std::size_t i = 0; ok_ && i < size; ++i) {
      T value{};
      get(value);
      values.push_back(value);
    }
  }
  template <class T>
  requires std::is_class_v<T>
  void get(T& value) { fields(*this, value); }

  std::span<const std::byte> rest_;
  Numbers numbers_ = Numbers::kAny;
  bool ok_ = true;
};

/// A struct or a constant one: fields() serves both archives.
template <class Value, class Struct>
concept Of = std::same_as<std::remove_const_t<Value>, Struct>;

/// Classes of the core pass the members on which the next steps depend themselves.
template <class Archive, class Value>
requires requires(Value& value, Archive& archive) { Value::visit_state(value, archive); }
void fields(Archive& archive, Value& value) { Value::visit_state(value, archive); }

}  // namespace touchline::recording
