#include "hal/error_text.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <new>
#include <ostream>
#include <utility>

namespace touchline {

ErrorText::ErrorText(ErrorText&& other) noexcept : ErrorText() { *this = std::move(other); }

ErrorText& ErrorText::operator=(const ErrorText& other) noexcept {
  if (this == &other) return *this;
  clear();
  append(other.view());
  return *this;
}

ErrorText& ErrorText::operator=(ErrorText&& other) noexcept {
  if (this == &other) return *this;
  if (other.heap_ == nullptr) {
    *this = std::as_const(other);
  } else {
    heap_ = std::move(other.heap_);
    size_ = std::exchange(other.size_, 0);
    capacity_ = std::exchange(other.capacity_, kInlineCapacity);
  }
  other.clear();
  return *this;
}

bool ErrorText::reserve(std::size_t size) noexcept {
  if (size <= capacity_) return true;
  const std::size_t capacity = std::max(size, 2 * capacity_);
  std::unique_ptr<char[]> grown(new (std::nothrow) char[capacity + 1]);
  if (grown == nullptr) return false;
  std::memcpy(grown.get(), c_str(), size_ + 1);
  heap_ = std::move(grown);
  capacity_ = capacity;
  return true;
}

void ErrorText::truncate(std::size_t size) noexcept {
  size_ = std::min(size, size_);
  data()[size_] = '\0';
}

void ErrorText::append(std::string_view text) noexcept {
  const std::size_t added = reserve(size_ + text.size()) ? text.size() : capacity_ - size_;
  std::memcpy(data() + size_, text.data(), added);
  size_ += added;
  data()[size_] = '\0';
}

void ErrorText::prepend(std::string_view text) noexcept {
  const std::size_t before = size_;
  append(text);
  if (size_ == before + text.size()) std::rotate(data(), data() + before, data() + size_);
}

void ErrorText::append_format_list(const char* format, std::va_list arguments) noexcept {
  std::va_list again;
  va_copy(again, arguments);
  const int length = std::vsnprintf(data() + size_, capacity_ - size_ + 1, format, arguments);
  if (length > 0) {
    const auto needed = static_cast<std::size_t>(length);
    if (needed > capacity_ - size_ && reserve(size_ + needed)) {
      std::vsnprintf(data() + size_, capacity_ - size_ + 1, format, again);
    }
    size_ = std::min(size_ + needed, capacity_);
  }
  data()[size_] = '\0';
  va_end(again);
}

void ErrorText::set(const char* format, ...) noexcept {
  clear();
  std::va_list arguments;
  va_start(arguments, format);
  append_format_list(format, arguments);
  va_end(arguments);
}

void ErrorText::append_format(const char* format, ...) noexcept {
  std::va_list arguments;
  va_start(arguments, format);
  append_format_list(format, arguments);
  va_end(arguments);
}

std::ostream& operator<<(std::ostream& stream, const ErrorText& text) { return stream << text.view(); }

}  // namespace touchline
