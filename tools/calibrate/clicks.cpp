#include "tools/calibrate/clicks.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "tools/calibrate/text.h"

namespace touchline::calibrate {

Status read_clicks(const std::string& path, std::vector<Click>& out, std::string& reason) {
  out.clear();
  std::ifstream file(path);
  if (!file) {
    reason = path + ": cannot be opened";
    return ErrorCode::kNotFound;
  }
  const auto json = nlohmann::json::parse(file, nullptr, false);
  if (json.is_discarded()) {
    reason = path + ": not a JSON file";
    return ErrorCode::kInconsistent;
  }
  if (!json.is_object() || !json.contains("samples") || !json["samples"].is_array()) {
    reason = path + ": no list \"samples\"";
    return ErrorCode::kInconsistent;
  }
  for (const auto& sample : json["samples"]) {
    const auto has = [&](const char* key, bool number) {
      return sample.is_object() && sample.contains(key) && (number ? sample[key].is_number() : sample[key].is_string());
    };
    if (!has("image", false) || !has("color", false) || !has("u", true) || !has("v", true)) {
      reason = text("%s: sample %zu: needs image and color (text), u and v (numbers)", path.c_str(), out.size());
      return ErrorCode::kInconsistent;
    }
    out.push_back({sample["image"].get<std::string>(), sample["color"].get<std::string>(), sample["u"].get<double>(),
                   sample["v"].get<double>()});
  }
  if (out.empty()) {
    reason = path + ": no samples";
    return ErrorCode::kInconsistent;
  }
  return {};
}

}  // namespace touchline::calibrate
