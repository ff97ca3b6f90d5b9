#include "tools/programs/calibrate/colors/clicks.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>

namespace touchline::calibrate {

Result<std::vector<Click>> read_clicks(const std::string& path) {
  std::ifstream file(path);
  if (!file) {
    return Error{ErrorCode::kNotFound, path + ": cannot be opened"};
  }
  const auto json = nlohmann::json::parse(file, nullptr, false);
  if (json.is_discarded()) {
    return Error{ErrorCode::kInconsistent, path + ": is not a JSON file"};
  }
  if (!json.is_object() || !json.contains("samples") || !json["samples"].is_array()) {
    return Error{ErrorCode::kInconsistent, path + ": the list \"samples\" is missing"};
  }
  std::vector<Click> out;
  for (const auto& sample : json["samples"]) {
    const auto has = [&](const char* key, bool number) {
      return sample.is_object() && sample.contains(key) && (number ? sample[key].is_number() : sample[key].is_string());
    };
    const bool boxed = sample.is_object() && sample.contains("box");
    if (!has("image", false) || !has("color", false) || (!boxed && (!has("u", true) || !has("v", true)))) {
      return failure(ErrorCode::kInconsistent,
                     "%s: sample %zu: needs image and color (text), u and v (numbers) or box (four numbers)",
                     path.c_str(), out.size());
    }
    Click click{sample["image"].get<std::string>(), sample["color"].get<std::string>(), 0, 0, 0, {}};
    if (boxed) {
      const auto& box = sample["box"];
      const bool numbers = box.is_array() && box.size() == 4 &&
                           std::all_of(box.begin(), box.end(), [](const auto& x) { return x.is_number(); });
      if (!numbers || box[0] == box[2] || box[1] == box[3]) {
        return failure(ErrorCode::kInconsistent,
                       "%s: sample %zu: box needs four numbers, u0, v0, u1, v1, with u0 != u1 and v0 != v1",
                       path.c_str(), out.size());
      }
      const double u0 = box[0], v0 = box[1], u1 = box[2], v1 = box[3];
      click.box = {std::min(u0, u1), std::min(v0, v1), std::max(u0, u1), std::max(v0, v1)};
      click.u_px = (u0 + u1) / 2;
      click.v_px = (v0 + v1) / 2;
    } else {
      click.u_px = sample["u"].get<double>();
      click.v_px = sample["v"].get<double>();
    }
    out.push_back(std::move(click));
  }
  if (out.empty()) {
    return Error{ErrorCode::kInconsistent, path + ": the list \"samples\" is empty"};
  }
  return out;
}

Result<Click> parse_click(const std::string& text, const std::string& image) {
  // Only the first commas separate, because the picture's name may contain some.
  std::array<std::string, 4> word;
  std::size_t begin = 0, words = 0;
  for (; words < word.size() && begin <= text.size(); ++words) {
    const std::size_t end = words + 1 < word.size() ? std::min(text.find(',', begin), text.size()) : text.size();
    word[words] = text.substr(begin, end - begin);
    begin = end + 1;
  }
  Click click{words > 3 ? word[3] : image, word[0], 0, 0};
  const auto number = [](const std::string& from, double& out) {
    const char* const end = from.data() + from.size();
    const auto [stop, error] = std::from_chars(from.data(), end, out);
    return error == std::errc{} && stop == end;
  };
  if (click.color.empty() || !number(word[1], click.u_px) || !number(word[2], click.v_px)) {
    return failure(ErrorCode::kInconsistent,
                   "--click %s: needs COLOR,U,V or COLOR,U,V,PICTURE (column and row of a pixel of the patch)",
                   text.c_str());
  }
  return click;
}

}  // namespace touchline::calibrate
