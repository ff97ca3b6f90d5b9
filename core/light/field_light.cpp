#include "core/light/field_light.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/light/field_light_steps.h"

namespace touchline {
namespace {

constexpr int kStepsPerOctave = kStepsPerLevel * static_cast<int>(kLevelsPerOctave);
// Largest change of light: a factor of 4.
constexpr int kMaxChange = 2 * kStepsPerOctave;

// Smallest usable sums of four pixels, in the reference and in the present frame. The quantization of darker cells is
// too coarse: more than 10 % of a pixel (reference) or of the sum (present frame).
constexpr std::uint16_t kMinReferenceSum = 40, kMinPresentSum = 10;

// Largest difference between a cell's change and the known change that noise and the floor's texture explain.
constexpr int kFit = 6 * kStepsPerLevel;
// The light counts as changed if the mean difference exceeds its usual value by kStep, or if the number of cells that
// agree falls below this share of its usual value. With fewer than kMinCells cells, no change is detected.
constexpr int kStep = 5 * kStepsPerLevel / 2;
constexpr std::int32_t kFewer_percent = 75;
constexpr std::int32_t kMinCells = 20;
// Fixed-point units of Agreement: its share of cells is in 1/kWhole, its deviations in 1/kParts of a step.
constexpr std::int32_t kWhole = 1024, kParts = 16;

// Largest deviation of a cell's tint from the median tint. Lamps of different colors differ less.
constexpr int kMaxTint = 10 * kStepsPerLevel;
// Smaller changes count as none.
constexpr int kNoChange = 3 * kStepsPerLevel / 2;

// Cells on each side of the window's center. A robot covers 2 x 2 cells.
constexpr std::size_t kWindow = 3;
// kFrequent_percent: smallest share of the window's weight that makes a level its mode. kKeep_percent: share of the
// mode's weight with which the known level stays. Below kMinWindowWeight, a window has no mode.
constexpr std::int32_t kFrequent_percent = 40, kKeep_percent = 97;
constexpr std::int32_t kMinWindowWeight = 20;

constexpr std::size_t kBins = 64;
constexpr int kStepsPerBin = 2 * kMaxChange / static_cast<int>(kBins);

// Returns log2(value) in steps, for values from 1. Uses only integers, because libraries differ in the last bit of
// log2.
constexpr std::int16_t log_steps(std::uint32_t value) {
  std::uint64_t x = std::uint64_t{value} << 32u;
  int whole = 0;
  while (x >= std::uint64_t{2} << 32u) {
    x >>= 1u;
    ++whole;
  }
  std::uint32_t mantissa = static_cast<std::uint32_t>(x >> 2u);  // 30 bits after the point
  std::uint32_t fraction = 0;
  for (int bit = 0; bit < 12; ++bit) {
    const std::uint64_t square = std::uint64_t{mantissa} * mantissa >> 30u;
    fraction = 2 * fraction + (square >> 31u != 0 ? 1u : 0u);
    mantissa = static_cast<std::uint32_t>(square >> 31u != 0 ? square >> 1u : square);
  }
  const std::uint32_t steps = (fraction * kStepsPerOctave + 2048) >> 12u;
  return static_cast<std::int16_t>(whole * kStepsPerOctave + static_cast<int>(steps));
}

constexpr auto kLog = [] {
  std::array<std::int16_t, 1021> table{};
  for (std::uint32_t i = 1; i < table.size(); ++i) table[i] = log_steps(i);
  return table;
}();

// Bins are counted from 1; see FieldLight::Window.
constexpr std::size_t kNoBin = kBins + 2;
std::uint8_t bin_of(int steps) {
  return static_cast<std::uint8_t>(1 + std::clamp((steps + kMaxChange) / kStepsPerBin, 0, int{kBins} - 1));
}

}  // namespace

// Histogram of the brightness in a window that moves along a row of cells. Bins are counted from 1; bins 0 and kBins +
// 1 stay empty. Bin kNoBin has the cells that do not count.
class FieldLight::Window {
 public:
  /// `row`: the window's middle row.
  Window(const FieldLight& of, std::size_t row)
      : of_(of),
        top_(row - std::min(row, kWindow)),
        bottom_(std::min<std::size_t>(row + kWindow, of.grid_.rows - 1u)) {}

  void add(std::size_t column) {
    for (std::size_t row = top_, cell = row * of_.grid_.columns + column; row <= bottom_;
         ++row, cell += of_.grid_.columns) {
      const Sums sums = of_.sums_[cell];
      const std::size_t bin = of_.bin_[cell];
      whole_ += sums;
      sums_[bin] += sums;
      weight_[bin] = static_cast<std::int16_t>(weight_[bin] + sums[0]);
    }
  }
  void remove(std::size_t column) {
    for (std::size_t row = top_, cell = row * of_.grid_.columns + column; row <= bottom_;
         ++row, cell += of_.grid_.columns) {
      const Sums sums = of_.sums_[cell];
      const std::size_t bin = of_.bin_[cell];
      whole_ -= sums;
      sums_[bin] -= sums;
      weight_[bin] = static_cast<std::int16_t>(weight_[bin] - sums[0]);
    }
  }
  // Returns the weight of all cells, including cells that do not count.
  [[nodiscard]] std::int32_t whole() const { return whole_[0]; }
  [[nodiscard]] std::int32_t around(std::size_t bin) const {
    return weight_[bin - 1] + weight_[bin] + weight_[bin + 1];
  }
  [[nodiscard]] Sums sums_around(std::size_t bin) const { return sums_[bin - 1] + sums_[bin] + sums_[bin + 1]; }
  // Returns the first bin with the largest smoothed weight: twice the bin's own plus its neighbors'.
  [[nodiscard]] std::size_t most_frequent() const {
    // The weight is at most 16 for each of 49 cells, so sums fit into 16 bits and eight are compared at a time.
    using Sums8 [[gnu::vector_size(16)]] = std::int16_t;
    std::array<Sums8, kBins / 8> weight;
    Sums8 most{};
    for (std::size_t i = 0; i < weight.size(); ++i) {
      weight[i] = eight_from<Sums8>(8 * i) + 2 * eight_from<Sums8>(8 * i + 1) + eight_from<Sums8>(8 * i + 2);
      most = most > weight[i] ? most : weight[i];
    }
    const auto of_most = __builtin_bit_cast(std::array<std::int16_t, 8>, most);
    const std::int16_t largest = *std::max_element(of_most.begin(), of_most.end());
    std::size_t i = 0;
    std::array<std::uint64_t, 2> is_largest{};
    for (;; ++i) {
      is_largest = __builtin_bit_cast(std::array<std::uint64_t, 2>, weight[i] == largest);
      if ((is_largest[0] | is_largest[1]) != 0) break;
    }
    static_assert(std::endian::native == std::endian::little);
    const bool is_high = is_largest[0] == 0;
    const auto lane = static_cast<std::size_t>(std::countr_zero(is_largest[is_high ? 1 : 0])) / 16;
    return 8 * i + (is_high ? 4 : 0) + lane + 1;
  }

 private:
  template <class Eight>
  [[nodiscard]] Eight eight_from(std::size_t bin) const {
    Eight eight;
    std::memcpy(&eight, &weight_[bin], sizeof eight);
    return eight;
  }

  const FieldLight& of_;
  std::size_t top_, bottom_;
  Sums whole_{};
  std::array<Sums, kNoBin + 1> sums_{};
  std::array<std::int16_t, kNoBin + 1> weight_{};  // copy of the weights in sums_
};

Status FieldLight::configure(const LightReference& reference, PixelFormat format, std::uint16_t width_px,
                             std::uint16_t height_px) {
  grid_ = {};
  reset();
  if (width_px == 0 || width_px > kMaxFrameWidth || height_px == 0 || height_px > kMaxFrameHeight) {
    return ErrorCode::kOutOfRange;
  }
  if (reference.columns == 0) return {};
  const ReferenceGrid grid = ReferenceGrid::of(width_px, height_px);
  if (reference.columns != grid.columns || reference.rows != grid.rows) return ErrorCode::kInconsistent;
  space_ = color_space(format);
  std::array<std::size_t, 3> usable_cells{};
  for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
    usable_[cell] = weight_[cell] = 0;
    unsigned whole = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint16_t sum = std::min<std::uint16_t>(reference.colors.sum[c][cell], kLog.size() - 1);
      whole += sum;
      if (sum < kMinReferenceSum) continue;
      usable_[cell] = static_cast<std::uint8_t>(usable_[cell] | 1u << c);
      reference_[c][cell] = kLog[sum];
      ++usable_cells[c];
    }
    // Bright cells are measured more accurately. The largest weight is 16.
    if (usable_[cell] != 0) weight_[cell] = static_cast<std::uint8_t>(1 + whole / 205);
  }
  base_channel_ = 1;
  for (std::size_t c = 0; c < 3; ++c) {
    if (usable_cells[c] > usable_cells[base_channel_]) base_channel_ = c;
  }
  grid_ = grid;
  return {};
}

void FieldLight::reset() {
  tint_.fill(0);
  for (std::size_t c = 0; c < 3; ++c) change_[c].fill(0);
  known_.fill(false);
  measured_.fill(0);
  row_changed_.fill(false);
  next_ = 0;
  recognized_ = -1;
  mean_ = 0;
  channel_means_.fill(0);
  started_ = false;
}

bool FieldLight::measure(const Frame& frame) {
  if (!active()) return false;
  row_changed_.fill(false);
  bool changed = false;
  if (started_) {
    for (std::size_t row = next_; row < grid_.rows; row += kRowStep) compare(frame, row);
    const Agreement now = agreement(next_);
    Agreement& usual = usual_[next_];
    if (!differs(now, usual)) {
      if (now.cells >= kMinCells) usual.approach(now);
      if (next_ == 0) find_tint();
      for (std::size_t row = next_; row < grid_.rows; row += kRowStep) find_brightness(row);
      for (std::size_t row = next_; row < grid_.rows; row += kRowStep) changed = find_change(row) || changed;
      find_recognized(next_, kRowStep);
      next_ = (next_ + 1) % kRowStep;
      return changed && interpolate();
    }
  }
  started_ = true;
  for (std::size_t row = 0; row < grid_.rows; ++row) compare(frame, row);
  find_tint();
  for (std::size_t row = 0; row < grid_.rows; ++row) find_brightness(row);
  for (std::size_t row = 0; row < grid_.rows; ++row) changed = find_change(row) || changed;
  changed = changed && interpolate();
  for (std::size_t row = 0; row < kRowStep; ++row) usual_[row] = agreement(row);
  find_recognized(0, 1);
  return changed;
}

void FieldLight::find_recognized(std::size_t first_row, std::size_t step) {
  std::int32_t cells = 0, fitting = 0;
  for (std::size_t row = first_row; row < grid_.rows; row += step) {
    for (std::size_t cell = row * grid_.columns; cell < (row + 1) * grid_.columns; ++cell) {
      if (usable_[cell] == 0) continue;
      ++cells;
      if (measured_[cell] == 0) continue;
      bool fits = true;
      for (std::size_t c = 0; c < 3; ++c) {
        fits = fits && ((measured_[cell] >> c & 1u) == 0 || std::abs(ratio_[c][cell] - change_[c][cell]) <= kFit);
      }
      fitting += fits ? 1 : 0;
    }
  }
  if (cells >= kMinCells) recognized_ = static_cast<float>(fitting) / static_cast<float>(cells);
}

// Measures the ratio of a row of cells to the reference.
void FieldLight::compare(const Frame& frame, std::size_t row) {
  sample_cells(frame, grid_, row, now_);
  for (std::size_t cell = row * grid_.columns; cell < (row + 1) * grid_.columns; ++cell) {
    unsigned measured = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      if ((usable_[cell] >> c & 1u) == 0 || now_.sum[c][cell] < kMinPresentSum) continue;
      ratio_[c][cell] = static_cast<Steps>(kLog[now_.sum[c][cell]] - reference_[c][cell]);
      measured |= 1u << c;
    }
    measured_[cell] = static_cast<std::uint8_t>(measured);
  }
}

// Finds the median tint, with the weights of the cells.
void FieldLight::find_tint() {
  constexpr int kStepsPerTintBin = 4;
  constexpr std::size_t kTintBins = 2 * kMaxChange / kStepsPerTintBin;
  for (std::size_t c = 0; c < 3; ++c) {
    std::array<std::int32_t, kTintBins> bins{};
    std::int32_t whole = 0;
    const unsigned needed = 1u << c | 1u << base_channel_;
    for (std::size_t cell = 0; cell < grid_.cells(); ++cell) {
      if ((measured_[cell] & needed) != needed) continue;
      const int tint = ratio_[c][cell] - ratio_[base_channel_][cell];
      if (tint < -kMaxChange || tint >= kMaxChange) continue;
      bins[static_cast<std::size_t>((tint + kMaxChange) / kStepsPerTintBin)] += weight_[cell];
      whole += weight_[cell];
    }
    tint_[c] = 0;
    std::int32_t sum = 0;
    for (std::size_t bin = 0; bin < kTintBins && whole > 0; ++bin) {
      sum += bins[bin];
      if (2 * sum < whole) continue;
      tint_[c] = static_cast<Steps>(kStepsPerTintBin * static_cast<int>(bin) + kStepsPerTintBin / 2 - kMaxChange);
      break;
    }
  }
  tint_[base_channel_] = 0;
}

// Finds the brightness of a row's cells, and fills the channels that could not be measured.
void FieldLight::find_brightness(std::size_t row) {
  for (std::size_t cell = row * grid_.columns; cell < (row + 1) * grid_.columns; ++cell) {
    bin_[cell] = kNoBin;
    sums_[cell] = Sums{};
    int sum = 0, count = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      if ((measured_[cell] >> c & 1u) == 0) continue;
      sum += ratio_[c][cell] - tint_[c];
      ++count;
    }
    if (count == 0) continue;
    const int brightness = sum / count;
    bool plausible = brightness >= -kMaxChange && brightness < kMaxChange;
    for (std::size_t c = 0; c < 3; ++c) {
      const int expected = brightness + tint_[c];
      if ((measured_[cell] >> c & 1u) == 0) {
        ratio_[c][cell] = static_cast<Steps>(expected);
      } else {
        plausible = plausible && std::abs(ratio_[c][cell] - expected) <= kMaxTint;
      }
    }
    if (plausible) bin_[cell] = bin_of(brightness);
    const std::int32_t weight = weight_[cell];
    sums_[cell] = Sums{weight, weight * ratio_[0][cell], weight * ratio_[1][cell], weight * ratio_[2][cell]};
  }
}

FieldLight::Agreement FieldLight::agreement(std::size_t first_row) const {
  Agreement out;
  std::int32_t fitting = 0;
  std::array<std::int32_t, 3> sum{};
  for (std::size_t row = first_row; row < grid_.rows; row += kRowStep) {
    for (std::size_t cell = row * grid_.columns; cell < (row + 1) * grid_.columns; ++cell) {
      if (measured_[cell] == 0) continue;
      std::array<int, 3> deviation{};
      for (std::size_t c = 0; c < 3; ++c) {
        if ((measured_[cell] >> c & 1u) != 0) deviation[c] = ratio_[c][cell] - change_[c][cell];
      }
      ++out.cells;
      if (std::any_of(deviation.begin(), deviation.end(), [](int d) { return std::abs(d) > kFit; })) continue;
      ++fitting;
      for (std::size_t c = 0; c < 3; ++c) sum[c] += deviation[c];
    }
  }
  out.fitting = kWhole * fitting / std::max(1, out.cells);
  for (std::size_t c = 0; c < 3; ++c) out.deviation[c] = kParts * sum[c] / std::max(1, fitting);
  return out;
}

// Returns whether the light of these rows has changed. `usual` is the agreement after the last full measurement. A
// covered or crowded floor disagrees after every measurement, so it causes no further one.
bool FieldLight::differs(const Agreement& now, const Agreement& usual) {
  if (now.cells < kMinCells) return false;
  if (100 * now.fitting < kFewer_percent * usual.fitting) return true;
  for (std::size_t c = 0; c < 3; ++c) {
    if (std::abs(now.deviation[c] - usual.deviation[c]) > kParts * kStep) return true;
  }
  return false;
}

// Finds the change at each cell of a row. Returns true if it differs from the known one.
bool FieldLight::find_change(std::size_t row) {
  Window window(*this, row);
  bool changed = false;
  for (std::size_t column = 0; column < std::min<std::size_t>(kWindow, grid_.columns); ++column) window.add(column);
  for (std::size_t column = 0; column < grid_.columns; ++column) {
    if (column + kWindow < grid_.columns) window.add(column + kWindow);
    if (column > kWindow) window.remove(column - kWindow - 1);
    const std::size_t cell = row * grid_.columns + column;
    std::size_t bin = bin_of(change_[base_channel_][cell]);
    // A level with the majority of the weight is the mode, without a search.
    if (2 * window.around(bin) <= window.whole()) {
      const std::size_t best = window.most_frequent();
      if (100 * window.around(bin) < kKeep_percent * window.around(best)) bin = best;
    }
    const std::int32_t weight = window.around(bin);
    const bool is_known = window.whole() >= kMinWindowWeight && 100 * weight >= kFrequent_percent * window.whole();
    bool differs = is_known != known_[cell];
    known_[cell] = is_known;
    if (is_known) {
      std::array<Steps, 3> found{};
      bool same = true;
      const Sums sums = window.sums_around(bin);
      for (std::size_t c = 0; c < 3; ++c) {
        found[c] = static_cast<Steps>(std::clamp(sums[c + 1] / weight, -kMaxChange, kMaxChange));
        same = same && std::abs(found[c] - change_[c][cell]) <= kNoChange;
      }
      for (std::size_t c = 0; c < 3; ++c) found_[c][cell] = same ? change_[c][cell] : found[c];
      differs = differs || !same;
    }
    changed = changed || differs;
  }
  return changed;
}

float FieldLight::at(std::size_t channel, std::uint16_t tile_column, std::uint16_t tile_row) const {
  return at(tile_column, tile_row)[channel];
}

std::array<float, 3> FieldLight::at(std::uint16_t tile_column, std::uint16_t tile_row) const {
  std::array<float, 3> out{};
  if (!active()) return out;
  const std::size_t cell = grid_.cell_of_tile(tile_column, tile_row);
  if (space_ == ColorSpace::kRgb) {
    for (std::size_t c = 0; c < 3; ++c) out[c] = static_cast<float>(change_[c][cell]) / float{kStepsPerLevel};
    return out;
  }
  // Weights of BT.601.
  const int luma = 77 * change_[0][cell] + 150 * change_[1][cell] + 29 * change_[2][cell];
  out.fill(static_cast<float>(luma) / (256.0f * kStepsPerLevel));
  return out;
}

float FieldLight::rgb_at(std::size_t channel, std::uint16_t tile_column, std::uint16_t tile_row) const {
  if (!active()) return 0.0f;
  return static_cast<float>(change_[channel][grid_.cell_of_tile(tile_column, tile_row)]) / float{kStepsPerLevel};
}

}  // namespace touchline
