#pragma once

#include <string_view>

namespace touchline::config {

struct NoKeys {
  template <class Self, class Visitor>
  static void describe(Self&, Visitor&) {}
};

/// visit.section() of a struct of the core; one that declares no parameters (yet) is an empty section.
template <class Struct, class Visitor>
void describe_section(std::string_view key, Struct& value, std::string_view help, Visitor& visit) {
  if constexpr (requires { Struct::describe(value, visit); }) {
    visit.section(key, value, help);
  } else {
    NoKeys none;
    visit.section(key, none, help);
  }
}

}  // namespace touchline::config
