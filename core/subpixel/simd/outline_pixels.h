// Part of simd/kernel_functions.h, which includes it once for each instruction set: no include guard, no #include.

namespace touchline {
namespace TOUCHLINE_SIMD {

/// Ranges of columns in eight rows, relative to an outline's center. A range is empty if low > high.
struct ColumnRange {
  Float8 low, high;
};

/// List of pixels, row after row without gaps. Groups of eight therefore have few unused lanes.
class PixelList {
 public:
  void clear() { count_ = 0; }

  /// Adds the pixels of row v from column `first` to `last` at a distance of `stride`. False if there are too many.
  bool add_row(int first, int last, int stride, int v) {
    if (first > last) return true;
    const int number = (stride > 1 ? (last - first) / stride : last - first) + 1;  // mostly 1, and division is slow
    if (count_ + number > kMaxPixels) return false;
    const Integer8 steps = iota() * broadcast_integer(stride);
    // Writes up to seven entries too many. The next row overwrites them, and the array has room for the last ones.
    auto at = static_cast<std::size_t>(count_);
    for (int i = 0; i < number; i += kLanes, at += kLanes) {
      write(broadcast_integer(first + i * stride) + steps, &u_[at]);
      write(broadcast_integer(v), &v_[at]);
    }
    count_ += number;
    return true;
  }

  /// Calls use(u, v, counts) with eight pixels at a time. Lanes not masked by `counts` are arbitrary pixels of the
  /// list.
  template <class Use>
  bool for_each_eight(Use use) {
    if (count_ == 0) return true;
    const auto last = static_cast<std::size_t>(count_ - 1);
    write(broadcast_integer(u_[last]), &u_[last + 1]);
    write(broadcast_integer(v_[last]), &v_[last + 1]);
    for (int i = 0; i < count_; i += kLanes) {
      const auto at = static_cast<std::size_t>(i);
      if (!use(read(&u_[at]), read(&v_[at]), iota() < broadcast_integer(count_ - i))) return false;
    }
    return true;
  }

 private:
  // For 37 x 37 pixels, the largest square that is sampled completely.
  static constexpr int kMaxPixels = 1369;
  using Numbers = std::array<std::int32_t, kMaxPixels + 2 * kLanes>;

  static void write(Integer8 numbers, std::int32_t* to) { std::memcpy(to, &numbers, sizeof numbers); }
  static Integer8 read(const std::int32_t* from) {
    Integer8 numbers;
    std::memcpy(&numbers, from, sizeof numbers);
    return numbers;
  }

  Numbers u_, v_;  // uninitialized beyond count_
  int count_ = 0;
};

/// The pixels of an outline in the picture. A rough test separates completely covered pixels from those on the edge.
class OutlinePixels {
 public:
  /// Collects rows up to `reach_v` from the center at a distance of `stride`. crossed_by(from_v) returns the columns of
  /// eight rows that the outline touches, covered_in(from_v) those that it covers completely. False if there are too
  /// many pixels.
  template <class CrossedBy, class CoveredIn>
  bool collect(const Frame& frame, PixelPoint center, float reach_v, int stride, CrossedBy crossed_by,
               CoveredIn covered_in) {
    const float width = frame.width_px;
    const auto row_number = [&](float v) {
      return static_cast<int>(std::clamp(v, 0.0f, static_cast<float>(frame.height_px)));
    };
    const int top = row_number(std::ceil(center.v_px - reach_v));
    const int bottom = row_number(std::floor(center.v_px + reach_v) + 1.0f);
    const Float8 u = broadcast(center.u_px), one = broadcast(1.0f);
    const Integer8 steps = iota() * broadcast_integer(stride);
    for (int first_row = top; first_row < bottom; first_row += kLanes * stride) {
      const Float8 from_v = to_floats(broadcast_integer(first_row) + steps) - broadcast(center.v_px);
      const ColumnRange crossed = crossed_by(from_v), covered = covered_in(from_v);
      StoredInteger8 left, last, inner, outer;
      store(ceil_to_integer(clamp(u + crossed.low, 0.0f, width)), left);
      store(floor_to_integer(clamp(u + crossed.high, -1.0f, width - 1.0f)), last);
      store(ceil_to_integer(clamp(u + covered.low, 0.0f, width)), inner);
      // Empty where nothing is covered.
      store(floor_to_integer(select(covered.high >= covered.low, clamp(u + covered.high + one, 0.0f, width))), outer);
      for (std::size_t i = 0; i < kLanes; ++i) {
        const int v = first_row + static_cast<int>(i) * stride;
        if (v >= bottom) break;
        if (!add_row(left.value[i], last.value[i], inner.value[i], outer.value[i], stride, v)) return false;
      }
    }
    return true;
  }

  /// The edge pixels, a few of which may be covered or untouched, and the covered pixels.
  [[nodiscard]] PixelList& edge() { return edge_; }
  [[nodiscard]] PixelList& inside() { return inside_; }

 private:
  // Of the columns [left, last], those in [inner, outer) are completely covered.
  bool add_row(int left, int last, int inner, int outer, int stride, int v) {
    if (stride > 1) {
      const auto on_grid = [&](int column) {
        return left + (std::max(column - left, 0) + stride - 1) / stride * stride;
      };
      inner = on_grid(inner);
      outer = on_grid(outer);
    }
    if (inner >= outer) return edge_.add_row(left, last, stride, v);
    return edge_.add_row(left, std::min(inner - 1, last), stride, v) &&
           inside_.add_row(inner, std::min(outer - 1, last), stride, v) && edge_.add_row(outer, last, stride, v);
  }

  PixelList edge_, inside_;
};

}  // namespace TOUCHLINE_SIMD
}  // namespace touchline
