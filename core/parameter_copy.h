#pragma once

#include <cstddef>

#include "core/parameter.h"

namespace touchline {

/// Returns `own`, or `outer` (of the enclosing section) if `own` is kInherit.
constexpr Reload inherited(Reload own, Reload outer) { return own == Reload::kInherit ? outer : own; }

/// Visitor of core/parameter.h that copies the keys of one kind of reload from one struct to another of the same type.
template <class Root>
class ReloadableCopy {
 public:
  ReloadableCopy(const Root& from, Root& to, Reload which) : from_(from), to_(to), which_(which) {
    Root::describe(from_, *this);
  }

  template <class T>
  void number(const T& value, const Key& key) {
    copy(value, key);
  }
  template <class Container>
  void numbers(const Container& values, const Key& key) {
    copy(values, key);
  }
  void flag(const bool& value, const Key& key) { copy(value, key); }
  template <class Text>
  void text(const Text& value, const Key& key) {
    copy(value, key);
  }
  template <class Texts>
  void texts(const Texts& values, const Key& key) {
    copy(values, key);
  }
  template <class Enum, class Choices>
  void choice(const Enum& value, const Choices& /*choices*/, const Key& key) {
    copy(value, key);
  }
  template <class Struct>
  void section(const Struct& value, const Key& key) {
    const Reload outer = outer_;
    outer_ = inherited(key.reload, outer);
    Struct::describe(value, *this);
    outer_ = outer;
  }
  template <class Container>
  void list(const Container& values, const Key& key) {
    copy(values, key);
  }

 private:
  // Lists are copied as a whole, so every visited value is a member of the struct. Its offset is equal in both structs.
  template <class T>
  void copy(const T& value, const Key& key) {
    if (inherited(key.reload, outer_) != which_) return;
    const auto offset = reinterpret_cast<const std::byte*>(&value) - reinterpret_cast<const std::byte*>(&from_);
    *reinterpret_cast<T*>(reinterpret_cast<std::byte*>(&to_) + offset) = value;
  }

  const Root& from_;
  Root& to_;
  const Reload which_;
  Reload outer_ = Reload::kRestart;
};

/// Copies the keys with the reload kind `which` from one struct to another of the same type.
template <class Struct>
void copy_reloadable(const Struct& from, Struct& to, Reload which) {
  ReloadableCopy<Struct>(from, to, which);
}

}  // namespace touchline
