// Part of simd/kernel_functions.h, which includes it once for each instruction set: no include guard, no #include.

namespace touchline {
namespace TOUCHLINE_SIMD {

/// Red, green and blue of eight pixels, proportional to the light on the sensor; 1 corresponds to a value of 255.
using LinearRgb8 = std::array<Float8, 3>;

/// Converts channel values (0 to 255) to linear light: (value / 255) ^ 2.2 with an error below 3e-4, by a polynomial.
inline Float8 linear_light(Integer8 value) {
  const Float8 t = to_floats(value) * broadcast(1.0f / 255.0f);
  return t * (broadcast(-0.0156862f) +
              t * (broadcast(0.7355875f) + t * (broadcast(0.3826977f) + t * broadcast(-0.1025990f))));
}

/// Reads a frame's pixels as linear light. A pixel that two surfaces share shows the mean of their light, but the
/// camera delivers this mean after gamma encoding (2.2 here, within 0.1 of ITU-R BT.709, BT.601 and sRGB). With gamma,
/// a pixel that a bright patch covers by half looks three quarters covered. YUV is BT.601.
class LinearRgbImage {
 public:
  /// `frame` must be one that the scan accepted, wider than one pixel, and must outlive this object.
  explicit LinearRgbImage(const Frame& frame)
      : frame_(frame),
        step_(info_of(frame.format).channel[0].step),
        first_is_blue_(info_of(frame.format).channel[0].offset == 2) {
    if (!is_yuv(color_space(frame.format))) return;
    for (std::size_t c = 0; c < 3; ++c) {
      const ChannelLayout& layout = info_of(frame.format).channel[c];
      channel_[c] = {frame.plane[layout.plane],
                     static_cast<std::int32_t>(frame.stride_bytes[layout.plane]),
                     layout.offset,
                     layout.step,
                     layout.shift_u,
                     layout.shift_v,
                     static_cast<std::int32_t>(plane_bytes(frame, layout.plane)) - 4};
    }
  }

  /// Light of eight pixels inside the picture.
  [[nodiscard, gnu::always_inline]] LinearRgb8 at(Integer8 u, Integer8 v) const {
    std::array<Integer8, 3> value;
    if (color_space(frame_.format) == ColorSpace::kRgb) {
      value = bytes_at(v * broadcast_integer(stride()) + u * broadcast_integer(step_));
      if (first_is_blue_) value = {value[2], value[1], value[0]};
    } else {
      value = from_yuv(u, v);
    }
    return {linear_light(value[0]), linear_light(value[1]), linear_light(value[2])};
  }

  /// Light of the pixels nearest to eight points. `inside` masks the points inside the picture; the light of the others
  /// is arbitrary.
  [[nodiscard, gnu::always_inline]] LinearRgb8 nearest(Float8 u_px, Float8 v_px, Integer8& inside) const {
    // From the picture's corner. Clamped as floats, because points far outside exceed the range of int.
    const Float8 right = u_px + broadcast(0.5f), down = v_px + broadcast(0.5f), zero = broadcast(0.0f);
    const Float8 width = broadcast(frame_.width_px), height = broadcast(frame_.height_px);
    inside = (right > zero) & (down > zero) & (right < width) & (down < height);
    const auto number = [zero](Float8 place, Float8 size) {
      return to_integers(min(max(place, zero), size - broadcast(1.0f)));
    };
    return at(number(right, width), number(down, height));
  }

 private:
  [[nodiscard]] std::int32_t stride() const { return static_cast<std::int32_t>(frame_.stride_bytes[0]); }

  // The first three bytes of pixels in the first plane.
  [[nodiscard, gnu::always_inline]] std::array<Integer8, 3> bytes_at(Integer8 offset) const {
#if defined(TOUCHLINE_SIMD_AVX2)
    // Reads four bytes per pixel. The last pixel may have only three, so it is read from one byte before it.
    const int last = stride() * (frame_.height_px - 1) + step_ * frame_.width_px - 4;
    const Integer8 end = broadcast_integer(last), early = offset < end;
    const Integer8 from = (early & offset) | (~early & end);
    const auto* const bytes = reinterpret_cast<const int*>(frame_.plane[0]);
    const auto four =
        __builtin_bit_cast(Integer8, _mm256_i32gather_epi32(bytes, __builtin_bit_cast(__m256i, from), 1)) >>
        ((offset - from) << 3);
    return {four & broadcast_integer(255), (four >> 8) & broadcast_integer(255), (four >> 16) & broadcast_integer(255)};
#else
    StoredInteger8 at;
    store(offset, at);
    std::array<StoredInteger8, 3> value;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const std::uint8_t* pixel = frame_.plane[0] + at.value[i];
      TOUCHLINE_UNROLL for (std::size_t c = 0; c < 3; ++c) value[c].value[i] = pixel[c];
    }
    return {load(value[0]), load(value[1]), load(value[2])};
#endif
  }

  // A channel of a frame in YUV.
  struct Channel {
    const std::uint8_t* plane = nullptr;
    std::int32_t stride = 0, offset = 0, step = 1, shift_u = 0, shift_v = 0;
    std::int32_t last_word = 0;  // where the last four bytes of the plane begin; negative: it has fewer
  };

  [[nodiscard, gnu::always_inline]] static Integer8 samples(const Channel& channel, Integer8 u, Integer8 v) {
    const Integer8 at = (v >> channel.shift_v) * broadcast_integer(channel.stride) +
                        (u >> channel.shift_u) * broadcast_integer(channel.step) + broadcast_integer(channel.offset);
#if defined(TOUCHLINE_SIMD_AVX2)
    // Reads four bytes per sample, but none beyond the plane.
    if (channel.last_word >= 0) {
      const Integer8 end = broadcast_integer(channel.last_word), early = at < end;
      const Integer8 from = (early & at) | (~early & end);
      const auto* const words = reinterpret_cast<const int*>(channel.plane);
      const __m256i four = _mm256_i32gather_epi32(words, __builtin_bit_cast(__m256i, from), 1);
      return (__builtin_bit_cast(Integer8, four) >> ((at - from) << 3)) & broadcast_integer(255);
    }
#endif
    StoredInteger8 place, value;
    store(at, place);
    for (std::size_t i = 0; i < kLanes; ++i) value.value[i] = channel.plane[place.value[i]];
    return load(value);
  }

  [[nodiscard, gnu::always_inline]] static Integer8 limited_to_byte(Integer8 value) {
    const Integer8 positive = value & ~(value < broadcast_integer(0)), most = broadcast_integer(255);
    const Integer8 is_byte = positive < most;
    return (is_byte & positive) | (~is_byte & most);
  }

  // As to_rgb8().
  [[nodiscard, gnu::always_inline]] std::array<Integer8, 3> from_yuv(Integer8 u, Integer8 v) const {
    const ColorSpace space = color_space(frame_.format);
    const YuvToRgb factors = yuv_to_rgb(space);
    std::array<Integer8, 3> yuv;
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < 3; ++c) {
      yuv[c] = samples(channel_[c], u, v) - broadcast_integer(black_value(space, c));
    }
    const Integer8 luma = broadcast_integer(factors.luma) * yuv[0] + broadcast_integer(YuvToRgb::kOne / 2);
    return {
        limited_to_byte((luma + broadcast_integer(factors.red_v) * yuv[2]) >> 10),
        limited_to_byte(
            (luma - broadcast_integer(factors.green_u) * yuv[1] - broadcast_integer(factors.green_v) * yuv[2]) >> 10),
        limited_to_byte((luma + broadcast_integer(factors.blue_u) * yuv[1]) >> 10)};
  }

  Frame frame_;
  std::int32_t step_;  // bytes of a pixel, in RGB
  bool first_is_blue_;
  std::array<Channel, 3> channel_;  // in YUV
};

}  // namespace TOUCHLINE_SIMD
}  // namespace touchline
