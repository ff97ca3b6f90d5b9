#include "core/control/motion/speed_profile.h"

#include <algorithm>
#include <cmath>

namespace touchline {
double profile_time(double way, double begin, double end, const ProfileLimits& limits) {
  const double a = limits.acceleration;
  double time = 0.0;
  if (begin < 0.0) {
    time = -begin / a;
    way += 0.5 * begin * begin / a;
    begin = 0.0;
  }
  begin = std::min(begin, limits.speed);
  end = std::min(end, limits.speed);
  const double braking = 0.5 * (begin * begin - end * end) / a;
  if (braking > way) return time + begin / a + 2.0 * std::sqrt((braking - way) / a);
  if (-braking > way) return time + (std::sqrt(begin * begin + 2.0 * a * way) - begin) / a;
  const double peak = std::sqrt(a * way + 0.5 * (begin * begin + end * end));
  if (peak <= limits.speed) return time + (2.0 * peak - begin - end) / a;
  const double top = limits.speed;
  return time + (2.0 * top - begin - end) / a + (way - (top * top - 0.5 * (begin * begin + end * end)) / a) / top;
}

double next_speed(double way, double now, double end, double period_s, const ProfileLimits& limits) {
  if (way < 0.0 && end <= 0.0) return -next_speed(-way, -now, 0.0, period_s, limits);
  const double a = limits.acceleration, step = a * period_s;
  const double left = way - 0.5 * period_s * now;  // less what is driven until the middle of the period
  // Speed n from which the way that is left after the period suffices for braking: n^2 - end^2 = 2 a (left - T n / 2).
  const auto parabola = [&](double way_left) {
    const double square = 0.25 * step * step + end * end + 2.0 * a * way_left;
    return square > 0.0 ? std::sqrt(square) - 0.5 * step : 0.0;
  };
  double next = 0.0;
  if (end > 0.0) {
    next = parabola(left);
  } else {
    // Proportional to the way that is left after the period, where this needs no more than the acceleration; farther
    // away, the parabola that continues it.
    const double time = limits.periods_to_close * period_s, linear = a * time * time;
    next = left / (time + 0.5 * period_s);
    if (next > a * time) next = parabola(left - 0.5 * linear);
  }
  next = std::min(next, limits.speed);
  return std::clamp(next, now - step, now + step);
}

}  // namespace touchline
