#include "tools/programs/setup/arguments.h"

#include "tools/programs/command_line/formatted.h"

namespace touchline::setup {
namespace {

// Longest text; names of colors and devices are short, and an import arrives in pieces shorter than a message.
constexpr std::size_t kMaxTextBytes = 4096;

Error wrong(const char* name, const std::string& expected) {
  return Error{ErrorCode::kInconsistent, formatted("\"%s\" must be %s", name, expected.c_str())};
}

}  // namespace

bool Arguments::has(const char* name) const { return command_->contains(name) && !command_->at(name).is_null(); }

Result<double> Arguments::number(const char* name, double low, double high) const {
  if (has(name) && command_->at(name).is_number()) {
    const double value = command_->at(name).get<double>();
    if (value >= low && value <= high) return value;
  }
  return wrong(name, formatted("a number from %g to %g", low, high));
}

Result<double> Arguments::number(const char* name, double low, double high, double absent) const {
  return has(name) ? number(name, low, high) : absent;
}

Result<std::string> Arguments::text(const char* name) const {
  if (!has(name) || !command_->at(name).is_string()) return wrong(name, "a text");
  std::string value = command_->at(name).get_ref<const std::string&>();
  if (value.size() > kMaxTextBytes) return wrong(name, formatted("at most %zu bytes long", kMaxTextBytes));
  return value;
}

Result<std::string> Arguments::text(const char* name, const std::string& absent) const {
  return has(name) ? text(name) : absent;
}

Result<bool> Arguments::flag(const char* name, bool absent) const {
  if (!has(name)) return absent;
  if (!command_->at(name).is_boolean()) return wrong(name, "true or false");
  return command_->at(name).get<bool>();
}

Result<std::vector<std::string>> Arguments::texts(const char* name) const {
  std::vector<std::string> out;
  if (!has(name)) return out;
  if (!command_->at(name).is_array()) return wrong(name, "a list of texts");
  for (const nlohmann::json& one : command_->at(name)) {
    if (!one.is_string()) return wrong(name, "a list of texts");
    out.push_back(one.get_ref<const std::string&>());
  }
  return out;
}

Result<std::vector<PixelPoint>> Arguments::pixels(const char* name, std::size_t count) const {
  const Error error = wrong(name, formatted("a list of %zu pixels [u, v]", count));
  if (!has(name) || !command_->at(name).is_array() || command_->at(name).size() != count) return error;
  std::vector<PixelPoint> out;
  for (const nlohmann::json& pixel : command_->at(name)) {
    if (!pixel.is_array() || pixel.size() != 2 || !pixel[0].is_number() || !pixel[1].is_number()) return error;
    const auto u = pixel[0].get<double>(), v = pixel[1].get<double>();
    // A corner of the field may lie a little outside of the picture.
    if (!(u >= -0.5 * kMaxFrameWidth && u <= 1.5 * kMaxFrameWidth && v >= -0.5 * kMaxFrameHeight &&
          v <= 1.5 * kMaxFrameHeight)) {
      return error;
    }
    out.push_back({static_cast<float>(u), static_cast<float>(v)});
  }
  return out;
}

}  // namespace touchline::setup
