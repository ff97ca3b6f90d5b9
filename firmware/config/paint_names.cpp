#include "firmware/config/paint_names.h"

#include <algorithm>
#include <cctype>

namespace touchline::config {
namespace {

constexpr std::pair<std::string_view, Rgb> kPaints[] = {
    {"red", {210, 35, 45}},         {"orange", {240, 120, 40}},    {"yellow", {245, 225, 55}},
    {"gold", {215, 165, 45}},       {"lime", {175, 235, 60}},      {"green", {45, 170, 80}},
    {"darkgreen", {30, 95, 60}},    {"olive", {125, 125, 45}},     {"mint", {110, 210, 160}},
    {"teal", {25, 125, 125}},       {"turquoise", {45, 190, 180}}, {"cyan", {60, 210, 230}},
    {"lightblue", {130, 185, 235}}, {"skyblue", {130, 190, 235}},  {"azure", {60, 140, 230}},
    {"blue", {40, 90, 200}},        {"navy", {25, 35, 110}},       {"violet", {140, 70, 200}},
    {"purple", {120, 50, 150}},     {"magenta", {230, 55, 170}},   {"pink", {245, 165, 190}},
    {"rose", {235, 110, 140}},      {"salmon", {245, 140, 120}},   {"peach", {250, 195, 160}},
    {"lavender", {195, 180, 235}},  {"brown", {135, 85, 55}},      {"maroon", {115, 30, 45}},
    {"beige", {220, 200, 165}},     {"white", {240, 240, 240}},    {"grey", {130, 130, 130}},
    {"gray", {130, 130, 130}},      {"black", {25, 25, 25}}};

std::optional<Rgb> paint(std::string_view word) {
  const auto* const found =
      std::find_if(std::begin(kPaints), std::end(kPaints), [&](const auto& p) { return p.first == word; });
  if (found == std::end(kPaints)) return std::nullopt;
  return found->second;
}

}  // namespace

std::span<const std::pair<std::string_view, Rgb>> usual_paints() { return kPaints; }

std::optional<Rgb> usual_rgb(const std::string& name) {
  std::string word;
  for (const char c : name) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  if (const auto known = paint(word)) return known;
  const bool light = word.rfind("light", 0) == 0, dark = word.rfind("dark", 0) == 0;
  if (!light && !dark) return std::nullopt;
  auto base = paint(std::string_view(word).substr(light ? 5 : 4));
  if (!base) return std::nullopt;
  for (double& x : *base) x = light ? (x + 255.0) / 2 : 0.55 * x;
  return base;
}

}  // namespace touchline::config
