#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/status.h"
#include "hal/error_text.h"

namespace touchline {

/// An error code for the program, and a message for the user: what happened, where (device, file, line, key), and what
/// to do next.
struct Error {
  ErrorCode code = ErrorCode::kIo;
  ErrorText text;
};

/// Makes an Error. The arguments after the code are as for printf.
[[nodiscard]] Error failure(ErrorCode code, const char* format, ...) noexcept __attribute__((format(printf, 2, 3)));
/// Puts `context` in front of the message: prefixed("venue.toml", error) gives "venue.toml: ...".
[[nodiscard]] Error prefixed(std::string_view context, Error error) noexcept;

/// A value, or an Error that explains why there is none. Allocates nothing by itself.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return value_.has_value(); }
  /// Returns the value; only valid if ok().
  [[nodiscard]] const T& value() const& { return *value_; }
  [[nodiscard]] T& value() & { return *value_; }
  [[nodiscard]] T&& value() && { return *std::move(value_); }
  /// Returns the error; only valid if not ok().
  [[nodiscard]] const Error& error() const& { return *error_; }
  [[nodiscard]] Error&& error() && { return *std::move(error_); }
  /// Returns the error code; kOk if ok().
  [[nodiscard]] ErrorCode code() const { return ok() ? ErrorCode::kOk : error().code; }
  /// Returns a copy of the message; "" if ok(). Long messages allocate: the real-time loop reads error().text instead.
  [[nodiscard]] std::string text() const { return ok() ? std::string() : error().text.str(); }

 private:
  // Exactly one of the two is set. std::variant is not used, because gcc 12 warns of null pointers where its
  // std::get_if is inlined.
  std::optional<T> value_;
  std::optional<Error> error_;
};

/// Success, or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return !error_.has_value(); }
  /// Returns the error; only valid if not ok().
  [[nodiscard]] const Error& error() const& { return *error_; }
  [[nodiscard]] Error&& error() && { return *std::move(error_); }
  [[nodiscard]] ErrorCode code() const { return ok() ? ErrorCode::kOk : error_->code; }
  [[nodiscard]] std::string text() const { return ok() ? std::string() : error_->text.str(); }

 private:
  std::optional<Error> error_;
};

}  // namespace touchline

/// Returns the error of a Result from the calling function. On success, ignores its value and continues.
#define TOUCHLINE_TRY(expression)                                       \
  do {                                                                  \
    if (auto touchline_result = (expression); !touchline_result.ok()) { \
      return std::move(touchline_result).error();                       \
    }                                                                   \
  } while (false)

/// As TOUCHLINE_TRY, but on success assigns the value to `target`: TOUCHLINE_TRY_ASSIGN(const Settings settings,
/// read(file));
#define TOUCHLINE_TRY_ASSIGN(target, expression) \
  TOUCHLINE_TRY_ASSIGN_AS(TOUCHLINE_JOINED(touchline_result_, __LINE__), target, expression)
// NOLINTBEGIN(bugprone-macro-parentheses): `result` and `target` are declared here.
#define TOUCHLINE_TRY_ASSIGN_AS(result, target, expression) \
  auto result = (expression);                               \
  if (!result.ok()) return std::move(result).error();       \
  target = std::move(result).value()
// NOLINTEND(bugprone-macro-parentheses)
#define TOUCHLINE_JOINED(a, b) TOUCHLINE_JOINED_AGAIN(a, b)
#define TOUCHLINE_JOINED_AGAIN(a, b) a##b
