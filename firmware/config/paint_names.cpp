#include "firmware/config/paint_names.h"

#include <algorithm>
#include <cctype>
#include <vector>

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

// Further names of paints. They are understood, but never suggested.
constexpr std::pair<std::string_view, Rgb> kFurtherPaints[] = {
    {"cream", {245, 235, 200}},  {"ivory", {245, 240, 220}},  {"sand", {215, 190, 145}},  {"tan", {205, 170, 125}},
    {"khaki", {185, 170, 115}},  {"mustard", {205, 165, 55}}, {"amber", {245, 180, 45}},  {"apricot", {250, 180, 125}},
    {"coral", {245, 120, 95}},   {"scarlet", {220, 40, 35}},  {"crimson", {190, 25, 55}}, {"wine", {115, 30, 50}},
    {"burgundy", {115, 30, 50}}, {"fuchsia", {230, 55, 170}}, {"plum", {125, 60, 120}},   {"lilac", {195, 160, 215}},
    {"indigo", {65, 45, 145}},   {"aqua", {60, 210, 230}},    {"sky", {130, 190, 235}},   {"emerald", {30, 150, 95}},
    {"silver", {185, 185, 185}}, {"charcoal", {60, 60, 62}},  {"chocolate", {95, 60, 45}}};

std::optional<Rgb> paint(std::string_view word) {
  const auto named = [&](const auto& p) { return p.first == word; };
  if (const auto* const found = std::find_if(std::begin(kPaints), std::end(kPaints), named); found != std::end(kPaints))
    return found->second;
  const auto* const found = std::find_if(std::begin(kFurtherPaints), std::end(kFurtherPaints), named);
  if (found == std::end(kFurtherPaints)) return std::nullopt;
  return found->second;
}

// Returns the color of a single word, which may begin with "light" or "dark".
std::optional<Rgb> shade(std::string_view word) {
  if (const auto known = paint(word)) return known;
  const bool light = word.rfind("light", 0) == 0, dark = word.rfind("dark", 0) == 0;
  if (!light && !dark) return std::nullopt;
  auto base = paint(word.substr(light ? 5 : 4));
  if (!base) return std::nullopt;
  for (double& x : *base) x = light ? (x + 255.0) / 2 : 0.55 * x;
  return base;
}

}  // namespace

std::span<const std::pair<std::string_view, Rgb>> usual_paints() { return kPaints; }

std::optional<Rgb> usual_rgb(const std::string& name) {
  std::string word;
  std::vector<std::size_t> ends;  // ends of the words in `word`, without the last one
  for (const char c : name) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!word.empty() && (ends.empty() || ends.back() != word.size())) {
      ends.push_back(word.size());
    }
  }
  if (const auto known = shade(word)) return known;
  for (const std::size_t end : ends) {
    const auto first = shade(std::string_view(word).substr(0, end)), second = shade(std::string_view(word).substr(end));
    if (!first || !second) continue;
    return Rgb{((*first)[0] + (*second)[0]) / 2, ((*first)[1] + (*second)[1]) / 2, ((*first)[2] + (*second)[2]) / 2};
  }
  return std::nullopt;
}

}  // namespace touchline::config
