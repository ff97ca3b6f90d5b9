#include "core/region/labeling.h"

#include <algorithm>
#include <limits>

namespace touchline {
namespace {

constexpr std::uint32_t kNoLabel = kNoRun;
// No component is open before this row: the picture's last row has been added.
constexpr std::uint32_t kAfterTheEnd = std::numeric_limits<std::uint32_t>::max();

// Forgetting costs a pass over all runs; this much room gained pays for it, so that its cost a run stays bounded.
constexpr std::size_t kWorthwhileRoom = kMaxRuns / 4;
static_assert(kWorthwhileRoom >= kMaxFrameWidth, "what is worthwhile must be enough for any row");

}  // namespace

void Labeling::begin(std::uint32_t min_area_px) {
  components_ = 0;
  above_begin_ = above_end_ = 0;
  min_area_px_ = min_area_px;
  dropped_ = 0;
}

std::uint32_t Labeling::root(std::uint32_t label) {
  while (!is_root(label)) {
    // Path halving.
    std::uint32_t& parent = component_[label].parent;
    parent = component_[parent].parent;
    label = parent;
  }
  return label;
}

std::uint32_t Labeling::unite(std::uint32_t a, std::uint32_t b) {
  if (a == b) return a;
  const std::uint32_t kept = std::min(a, b), other = std::max(a, b);
  Component& into = component_[kept];
  Component& from = component_[other];
  from.parent = kept;
  into.sum_u += from.sum_u;
  into.sum_v += from.sum_v;
  into.area_px += from.area_px;
  into.box.left = std::min(into.box.left, from.box.left);
  into.box.right = std::max(into.box.right, from.box.right);
  return kept;  // the run that joins them extends the box downwards
}

std::uint32_t Labeling::add_component(const Run& run) {
  const std::uint32_t label = components_++;
  component_[label] = {0, 0, 0, label, {run.begin, run.row, run.begin, run.row}};
  return label;
}

void Labeling::extend(Component& component, const Run& run) {
  const auto last = static_cast<std::uint16_t>(run.end - 1);
  const std::uint32_t length = std::uint32_t{run.end} - run.begin;
  // (first + last) * length is even: of the two factors one is.
  component.sum_u += std::uint64_t{std::uint32_t{run.begin} + last} * length / 2;
  component.sum_v += std::uint64_t{run.row} * length;
  component.area_px += length;
  component.box.left = std::min(component.box.left, run.begin);
  component.box.right = std::max(component.box.right, last);
  component.box.bottom = run.row;
}

void Labeling::add_row(Runs& runs, std::size_t first) {
  const std::size_t end = runs.size();
  if (first == end) return;
  const bool adjacent = above_begin_ < above_end_ && runs[above_begin_].row + 1 == runs[first].row;
  std::size_t above = adjacent ? above_begin_ : above_end_;
  for (std::size_t i = first; i < end; ++i) {
    Run& run = runs[i];
    std::uint32_t label = kNoLabel;
    while (above < above_end_ && runs[above].end <= run.begin) ++above;
    // All runs above that share a column; the last of them may reach the next run as well.
    for (std::size_t touching = above; touching < above_end_ && runs[touching].begin < run.end; ++touching) {
      above = touching;
      if (runs[touching].color != run.color) continue;
      const std::uint32_t other = root(runs[touching].next);
      label = label == kNoLabel ? other : unite(label, other);
    }
    if (label == kNoLabel) label = add_component(run);
    extend(component_[label], run);
    run.next = label;
  }
  above_begin_ = first;
  above_end_ = end;
}

bool Labeling::make_room(Runs& runs, std::size_t wanted, std::uint16_t next_row) {
  if (Runs::capacity() - runs.size() >= wanted) return true;
  compact(runs, next_row, Open::kStay);
  // Where the runs of the row above, all of them open, are now.
  above_begin_ = above_end_ = runs.size();
  while (above_begin_ > 0 && runs[above_begin_ - 1].row + 1 == next_row) --above_begin_;
  return Runs::capacity() - runs.size() >= kWorthwhileRoom;
}

Labeling::Quota Labeling::quota(std::uint32_t next_row) {
  const auto competes = [&](std::uint32_t label) {
    return is_root(label) && !is_open(label, next_row) && component_[label].area_px >= min_area_px_;
  };
  std::size_t competing = 0;
  for (std::uint32_t label = 0; label < components_; ++label) competing += competes(label) ? 1u : 0u;
  if (competing <= kMaxRegions) return {min_area_px_, competing};

  of_area_.fill(0);
  for (std::uint32_t label = 0; label < components_; ++label) {
    if (competes(label)) ++of_area_[std::min<std::size_t>(component_[label].area_px, kAreaBins - 1)];
  }
  std::size_t area = kAreaBins - 1, room = kMaxRegions;
  for (; of_area_[area] < room; --area) room -= of_area_[area];
  return {static_cast<std::uint32_t>(area), room};
}

void Labeling::compact(Runs& runs, std::uint32_t next_row, Open open) {
  Quota quota = this->quota(next_row);
  std::uint32_t labels = 0;
  for (std::uint32_t label = 0; label < components_; ++label) {
    const Component component = component_[label];
    if (component.parent != label) {
      new_label_[label] = new_label_[component.parent];  // parents come first
      continue;
    }
    bool stays = false;
    if (is_open(label, next_row)) {
      stays = open == Open::kStay;
      dropped_ += !stays && component.area_px >= min_area_px_ ? 1u : 0u;
    } else if (component.area_px >= min_area_px_) {
      stays = component.area_px > quota.area_px;
      if (component.area_px == quota.area_px && quota.of_that_area > 0) {
        stays = true;
        --quota.of_that_area;
      }
      dropped_ += stays ? 0u : 1u;
    }
    new_label_[label] = stays ? labels : kNoLabel;
    if (!stays) continue;
    component_[labels] = component;
    component_[labels].parent = labels;
    ++labels;
  }
  components_ = labels;

  std::size_t kept = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::uint32_t label = new_label_[runs[i].next];
    if (label == kNoLabel) continue;
    runs[kept] = runs[i];
    runs[kept].next = label;
    ++kept;
  }
  runs.resize(kept);
}

void Labeling::report(Runs& runs, Regions& regions) {
  regions.resize(components_);
  for (std::uint32_t label = 0; label < components_; ++label) {
    const Component& component = component_[label];
    Region& region = regions[label];
    region.first_run = kNoRun;
    region.area_px = component.area_px;
    const double area = component.area_px;
    region.centroid.u_px = static_cast<float>(static_cast<double>(component.sum_u) / area);
    region.centroid.v_px = static_cast<float>(static_cast<double>(component.sum_v) / area);
    region.box = component.box;
  }
  // From the last run to the first, so that each chain grows at its head.
  for (std::size_t i = runs.size(); i-- > 0;) {
    Region& region = regions[runs[i].next];
    runs[i].next = region.first_run;
    region.first_run = static_cast<std::uint32_t>(i);
    region.color = runs[i].color;
  }
  regions.refuse(dropped_);
}

void Labeling::finish(Runs& runs, Regions& regions) {
  compact(runs, kAfterTheEnd, Open::kDrop);
  report(runs, regions);
}

void Labeling::finish_before(std::uint16_t next_row, Runs& runs, Regions& regions) {
  compact(runs, next_row, Open::kDrop);
  report(runs, regions);
}

}  // namespace touchline
