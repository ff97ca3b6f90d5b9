#include "core/region/labeling.h"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace touchline {
namespace {

constexpr std::uint32_t kNoLabel = kNoRun;
constexpr std::uint32_t kDropped = kMaxRegions;

}  // namespace

// The code below avoids branches whose conditions are random in a noisy picture. A misprediction costs more than the
// few instructions that a branch would save.

void Labeling::begin(std::uint32_t min_area_px, std::uint32_t min_height_px) {
  labels_ = 0;
  above_ = 0;
  if (has_cut_runs_) cut_runs_.fill(0);
  has_cut_runs_ = false;
  min_area_px_ = std::max(min_area_px, 1u);
  min_height_px_ = min_height_px;
}

std::uint32_t Labeling::root(std::uint32_t label) {
  while (parent_[label] != label) {
    parent_[label] = parent_[parent_[label]];  // path halving
    label = parent_[label];
  }
  return label;
}

void Labeling::add_row(Runs& runs, std::size_t first, std::span<const Contact> contacts) {
  const Run* above = runs.data() + above_;
  Run* row = runs.data() + first;
  above_ = first;
  for (const Contact& contact : contacts) {
    std::uint32_t& label = row[contact.below].next;
    const std::uint32_t upper = root(above[contact.above].next), lower = label == kNoLabel ? upper : label;
    label = std::min(upper, lower);
    parent_[std::max(upper, lower)] = label;
  }
  for (; row != runs.end(); ++row) {
    // There are at most as many labels as earlier runs.
    parent_[labels_] = labels_;
    // Labels are far below 2^31; kNoLabel is above.
    const std::uint32_t is_new = row->next >> 31;
    row->next = is_new * labels_ + (1 - is_new) * row->next;
    labels_ += is_new;
  }
}

Labeling::Extent Labeling::extent_of(const Run& run) {
  const auto column = [](int u) { return static_cast<std::int16_t>(u); };
  return Extent{column(run.begin), column(run.end - 1), column(run.row), column(run.row)} ^ kMirrored;
}

PixelBox Labeling::box_of(Extent extent) {
  const auto bound = [&](int i) { return static_cast<std::uint16_t>((extent ^ kMirrored)[i]); };
  return {bound(0), bound(2), bound(1), bound(3)};
}

std::uint32_t Labeling::height_of(Extent extent) {
  return static_cast<std::uint32_t>(extent[3] - (extent[2] ^ kMirror)) + 1;
}

// Replaces the labels in parent_ by the numbers of the components, in the order of their first runs.
void Labeling::number_components() {
  components_ = 0;
  for (std::uint32_t label = 0; label < labels_; ++label) {
    // A parent has a lower label, so its number is already known.
    const std::uint32_t parent = parent_[label], is_root = static_cast<std::uint32_t>(parent == label);
    const std::uint32_t number = is_root * components_ + (1 - is_root) * parent_[parent];
    parent_[label] = number;
    components_ += is_root;
  }
}

// Computes the sums of all components. Returns the number of components that have enough pixels and rows.
std::size_t Labeling::sum_up(const Runs& runs) {
  std::uint32_t begun = 0;
  for (const Run& run : runs) {
    const std::uint32_t length = std::uint32_t{run.end} - run.begin, number = parent_[run.next];
    // This run may be the first one of component `begun`.
    sums_[begun] = {};
    begun += static_cast<std::uint32_t>(number == begun);
    Sums& sums = sums_[number];
    // (first + last) * length is even, because one of the factors is.
    sums.u += std::uint64_t{run.begin + run.end - 1u} * length / 2;
    sums.v += std::uint64_t{run.row} * length;
    sums.area_px += length;
    sums.color = run.color;
    const Extent extent = extent_of(run);
    sums.extent = extent > sums.extent ? extent : sums.extent;
  }
  std::size_t competing = 0;
  for (std::uint32_t i = 0; i < components_; ++i) {
    Sums& sums = sums_[i];
    sums.area_px *= static_cast<std::uint32_t>(height_of(sums.extent) >= min_height_px_);
    competing += static_cast<std::size_t>(sums.area_px >= min_area_px_);
  }
  return competing;
}

Labeling::Quota Labeling::quota(std::size_t competing) {
  if (competing <= kMaxRegions) return {min_area_px_, competing};
  of_area_.fill(0);
  for (std::uint32_t i = 0; i < components_; ++i) {
    const std::uint32_t area = sums_[i].area_px;
    if (area >= min_area_px_) ++of_area_[std::min<std::size_t>(area, kAreaBins - 1)];
  }
  std::size_t area = kAreaBins - 1, room = kMaxRegions;
  for (; of_area_[area] < room; --area) room -= of_area_[area];
  return {static_cast<std::uint32_t>(area), room};
}

// Writes the regions, and writes to region_of_ the region of each component, or kDropped.
void Labeling::report(Quota quota, Regions& regions) {
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < components_; ++i) {
    const Sums& sums = sums_[i];
    bool stays = sums.area_px > quota.area_px;
    if (sums.area_px == quota.area_px && quota.of_that_area > 0) {
      stays = true;
      --quota.of_that_area;
    }
    region_of_[i] = static_cast<std::uint16_t>(stays ? count : kDropped);
    if (!stays) continue;
    Region& region = regions[count++];
    const double area = sums.area_px;
    region.first_run = kNoRun;
    region.area_px = sums.area_px;
    region.centroid.u_px = static_cast<float>(static_cast<double>(sums.u) / area);
    region.centroid.v_px = static_cast<float>(static_cast<double>(sums.v) / area);
    region.box = box_of(sums.extent);
    region.color = static_cast<ColorId>(sums.color);
    region.is_cut = false;
  }
}

void Labeling::mark_cut_regions(const Runs& runs, Regions& regions) const {
  for (std::size_t word = 0; 64 * word < runs.size(); ++word) {
    for (std::uint64_t bits = cut_runs_[word]; bits != 0; bits &= bits - 1) {
      const std::size_t run = 64 * word + static_cast<std::size_t>(std::countr_zero(bits));
      const std::uint32_t number = region_of_[parent_[runs[run].next]];
      if (number != kDropped) regions[number].is_cut = true;
    }
  }
}

void Labeling::chain(Runs& runs, Regions& regions) {
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < regions.size(); ++i) end_of_chain_[i] = &regions[i].first_run;
  end_of_chain_[kDropped] = &unused_link_;
  for (const Run& run : runs) {
    const std::uint32_t number = region_of_[parent_[run.next]];
    Run& place = runs[kept];
    place = run;
    place.next = kNoRun;
    *end_of_chain_[number] = kept;
    end_of_chain_[number] = number == kDropped ? &unused_link_ : &place.next;
    kept += number == kDropped ? 0u : 1u;
  }
  runs.resize(kept);
}

void Labeling::finish(Runs& runs, Regions& regions) {
  number_components();
  const std::size_t competing = sum_up(runs);
  regions.resize(competing);
  regions.add_overflow(competing - regions.size());
  report(quota(competing), regions);
  if (has_cut_runs_) mark_cut_regions(runs, regions);
  chain(runs, regions);
}

}  // namespace touchline
