#include "core/region/pixel_classifier.h"

#include <algorithm>
#include <span>

namespace touchline {

void PixelClassifier::copy(const RowClassifier& classifier, const RegionOfInterest& region_of_interest) {
  tables_ = classifier.tables();
  region_of_interest_ = region_of_interest;
  const Shading& shading = classifier.shading();
  columns_ = shading.active() ? shading.columns() : std::uint16_t{0};
  rows_ = shading.active() ? shading.rows() : std::uint16_t{0};
  const std::size_t tiles = std::max<std::size_t>(std::size_t{columns_} * rows_, 1);
  for (std::size_t tile = 0; tile < tiles; ++tile) level_[tile] = classifier.levels_of_tile(tile);
}

bool PixelClassifier::is_inside(std::uint16_t u, std::uint16_t v) const {
  const std::span<const ColumnSpan> spans = region_of_interest_.row(v);
  return std::any_of(spans.begin(), spans.end(),
                     [u](const ColumnSpan& span) { return u >= span.begin && u < span.end; });
}

}  // namespace touchline
