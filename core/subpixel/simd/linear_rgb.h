// Part of simd/kernel_functions.h, which includes it once for each instruction set: no include guard, no #include.

namespace touchline {
namespace TOUCHLINE_SIMD {

/// Red, green and blue of eight pixels, proportional to the light on the sensor; 1 corresponds to a value of 255.
using LinearRgb8 = std::array<Float8, 3>;

/// Converts channel values (0 to 1) to linear light: value ^ 2.2 with an error below 3e-4, by a polynomial.
inline Float8 linear_light(Float8 t) {
  return t * (broadcast(-0.0156862f) +
              t * (broadcast(0.7355875f) + t * (broadcast(0.3826977f) + t * broadcast(-0.1025990f))));
}

/// As above, for values from 0 to 255.
inline Float8 linear_light(Integer8 value) { return linear_light(to_floats(value) * broadcast(1.0f / 255.0f)); }

/// Reads a frame's pixels as linear light. A pixel that two surfaces share shows the weighted mean of their light, but
/// cameras apply a gamma curve to this mean (2.2 here, within 0.1 of ITU-R BT.709, BT.601 and sRGB). Without
/// linearization, a pixel that a bright patch covers by half would look three quarters covered. YUV is BT.601.
class LinearRgbImage {
 public:
  /// The scan must have accepted `frame`. It must be wider than one pixel and outlive this object.
  explicit LinearRgbImage(const Frame& frame)
      : frame_(frame),
        width_(frame.width_px),
        height_(frame.height_px),
        is_yuv_(touchline::is_yuv(color_space(frame.format))),
        step_(info_of(frame.format).channel[0].step),
        first_is_blue_(info_of(frame.format).channel[0].offset == 2) {
    if (!is_yuv_) return;
    for (std::size_t c = 0; c < 3; ++c) {
      const ChannelLayout& layout = info_of(frame.format).channel[c];
      channel_[c] = {frame.plane[layout.plane] + layout.offset,
                     static_cast<std::int32_t>(frame.stride_bytes[layout.plane]),
                     layout.step,
                     layout.shift_u,
                     layout.shift_v,
                     static_cast<std::int32_t>(plane_bytes(frame, layout.plane)) - layout.offset - 4};
    }
    const ColorSpace space = color_space(frame.format);
    const YuvToRgb factors = yuv_to_rgb(space);
    constexpr float kUnit = 1.0f / (255.0f * YuvToRgb::kOne);
    luma_ = kUnit * static_cast<float>(factors.luma);
    black_ = luma_ * static_cast<float>(black_value(space, 0));
    red_v_ = kUnit * static_cast<float>(factors.red_v);
    green_u_ = kUnit * static_cast<float>(factors.green_u);
    green_v_ = kUnit * static_cast<float>(factors.green_v);
    blue_u_ = kUnit * static_cast<float>(factors.blue_u);
  }

  /// Light of eight pixels inside the picture.
  [[nodiscard, gnu::always_inline]] LinearRgb8 at(Integer8 u, Integer8 v) const {
    if (is_yuv_) {
      const LinearRgb8 value = from_yuv(u, v);
      return {linear_light(value[0]), linear_light(value[1]), linear_light(value[2])};
    }
    std::array<Integer8, 3> value = bytes_at(v * broadcast_integer(stride()) + u * broadcast_integer(step_));
    if (first_is_blue_) value = {value[2], value[1], value[0]};
    return {linear_light(value[0]), linear_light(value[1]), linear_light(value[2])};
  }

  /// Light of the pixels nearest to eight points. `inside` masks the points inside the picture; the light of the others
  /// is arbitrary.
  [[nodiscard, gnu::always_inline]] LinearRgb8 nearest(Float8 u_px, Float8 v_px, Integer8& inside) const {
    // From the picture's corner. Clamped as floats, because points far outside exceed the range of int.
    const Float8 right = u_px + broadcast(0.5f), down = v_px + broadcast(0.5f), zero = broadcast(0.0f);
    const Float8 width = broadcast(width_), height = broadcast(height_);
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
    const std::uint8_t* first = nullptr;
    std::int32_t stride = 0, step = 1, shift_u = 0, shift_v = 0;
    std::int32_t last_word = 0;  // where the last four bytes of the plane begin; negative: it has fewer
  };

  [[nodiscard, gnu::always_inline]] static Integer8 place(const Channel& channel, Integer8 u, Integer8 v) {
    return (v >> channel.shift_v) * broadcast_integer(channel.stride) +
           (u >> channel.shift_u) * broadcast_integer(channel.step);
  }

  [[nodiscard, gnu::always_inline]] static Float8 samples(const Channel& channel, Integer8 at) {
#if defined(TOUCHLINE_SIMD_AVX2)
    // Reads four bytes per sample, but none beyond the plane.
    if (const Integer8 beyond = broadcast_integer(channel.last_word) < at; !any(beyond)) {
      const auto* const words = reinterpret_cast<const int*>(channel.first);
      const __m256i four = _mm256_i32gather_epi32(words, __builtin_bit_cast(__m256i, at), 1);
      return to_floats(__builtin_bit_cast(Integer8, four) & broadcast_integer(255));
    }
#endif
    StoredInteger8 place, value;
    store(at, place);
    for (std::size_t i = 0; i < kLanes; ++i) value.value[i] = channel.first[place.value[i]];
    return to_floats(load(value));
  }

  // R, G and B from 0 to 1; to_rgb8() rounds them.
  [[nodiscard, gnu::always_inline]] LinearRgb8 from_yuv(Integer8 u, Integer8 v) const {
    const Float8 middle = broadcast(static_cast<float>(black_value(ColorSpace::kYuv, 1)));
    const Integer8 at_blue = place(channel_[1], u, v);
    const Integer8 at_red = channel_[2].stride == channel_[1].stride ? at_blue : place(channel_[2], u, v);
    const Float8 luma = broadcast(luma_) * samples(channel_[0], place(channel_[0], u, v)) - broadcast(black_);
    const Float8 blue = samples(channel_[1], at_blue) - middle, red = samples(channel_[2], at_red) - middle;
    return {clamp_to_unit(luma + broadcast(red_v_) * red),
            clamp_to_unit(luma - broadcast(green_u_) * blue - broadcast(green_v_) * red),
            clamp_to_unit(luma + broadcast(blue_u_) * blue)};
  }

  Frame frame_;
  float width_, height_;
  bool is_yuv_;
  std::int32_t step_;  // bytes of a pixel, in RGB
  bool first_is_blue_;
  // In YUV: the channels, and the conversion to R, G and B from 0 to 1.
  std::array<Channel, 3> channel_;
  float luma_ = 0, black_ = 0, red_v_ = 0, green_u_ = 0, green_v_ = 0, blue_u_ = 0;
};

}  // namespace TOUCHLINE_SIMD
}  // namespace touchline
