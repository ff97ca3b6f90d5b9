#include "hal/mock/rigid_body.h"

#include <algorithm>
#include <limits>

namespace touchline::hal::mock {
namespace {

// Slower impacts do not bounce: else resting contacts would never come to rest.
constexpr double kLeastBounceMps = 0.05;
constexpr int kIterations = 8;
// Of the overlap that is more than the slop, so much is removed each step; all at once would let heaps jitter.
constexpr double kCorrection = 0.3, kSlopM = 0.0002;
// Half of a square's diagonal, and a hair more, over half of its side.
constexpr double kCornerReach = 1.4143;

Vec2 to_local(const Square& square, Vec2 point) { return rotated(point - square.body->position, -square.body->theta); }

bool is_inside(const Square& square, Vec2 point) {
  const Vec2 local = to_local(square, point);
  return std::abs(local.x) <= square.half_side_m && std::abs(local.y) <= square.half_side_m;
}

void add(Contacts& out, Body* a, Body* b, Vec2 point, Vec2 normal, double depth_m, Surface surface) {
  Contact contact;
  contact.a = a;
  contact.b = b;
  contact.point = point;
  contact.normal = normal;
  contact.depth_m = depth_m;
  contact.restitution = surface.restitution;
  contact.friction = surface.friction;
  out.push_back(contact);
}

// Of the way from `begin` to `end`: where a point stands beside it, 0 at the begin and 1 at the end; beyond them below
// 0 and above 1.
double place_along(Vec2 begin, Vec2 end, Vec2 point) {
  const Vec2 way = end - begin;
  return dot(point - begin, way) / dot(way, way);
}

Vec2 nearest_of_wall(Vec2 begin, Vec2 end, Vec2 point) {
  return begin + std::clamp(place_along(begin, end, point), 0.0, 1.0) * (end - begin);
}

// The place of a polygon's rim that is nearest to a point.
struct RimPlace {
  Vec2 point, inwards;  // normal of the wall
  double distance_m = 0.0;
};

RimPlace nearest_on(const Outline& outline, Vec2 point) {
  RimPlace best;
  std::size_t wall = 0;
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 nearest = nearest_of_wall(outline[i], outline[(i + 1) % outline.size()], point);
    const double square = dot(point - nearest, point - nearest);
    if (square >= least) continue;
    least = square;
    best.point = nearest;
    wall = i;
  }
  const Vec2 way = outline[(wall + 1) % outline.size()] - outline[wall];
  best.inwards = (1.0 / length(way)) * perpendicular(way);
  best.distance_m = std::sqrt(least);
  return best;
}

// From a point outside of the walls to the rim; on the rim the wall's own normal says it.
Vec2 way_in(const RimPlace& rim, Vec2 point) {
  return rim.distance_m > 1e-9 ? (1.0 / rim.distance_m) * (rim.point - point) : rim.inwards;
}

// The way out of `square` for a point inside of it: to the nearest side.
struct Exit {
  Vec2 normal;  // outwards, in the field's frame
  double depth_m = 0.0;
};
Exit nearest_side(const Square& square, Vec2 point) {
  const Vec2 local = to_local(square, point);
  const double gap_x = square.half_side_m - std::abs(local.x), gap_y = square.half_side_m - std::abs(local.y);
  const Vec2 normal = gap_x < gap_y ? Vec2{local.x < 0.0 ? -1.0 : 1.0, 0.0} : Vec2{0.0, local.y < 0.0 ? -1.0 : 1.0};
  return {rotated(normal, square.body->theta), std::min(gap_x, gap_y)};
}

Vec2 velocity_at(const Body* body, Vec2 point) {
  if (body == nullptr) return {};
  return body->velocity + body->w * perpendicular(point - body->position);
}

void push(Body* body, Vec2 point, Vec2 impulse) {
  if (body == nullptr) return;
  body->velocity = body->velocity + body->inverse_mass * impulse;
  body->w += body->inverse_inertia * cross(point - body->position, impulse);
}

// Change of the relative velocity along `direction` by a unit impulse along it.
double mobility(const Contact& contact, Vec2 direction) {
  double sum = 0.0;
  for (const Body* body : {contact.a, contact.b}) {
    if (body == nullptr) continue;
    const double arm = cross(contact.point - body->position, direction);
    sum += body->inverse_mass + body->inverse_inertia * arm * arm;
  }
  return sum;
}

void exchange(Contact& contact, Vec2 impulse) {
  push(contact.a, contact.point, impulse);
  push(contact.b, contact.point, -impulse);
}

void iterate(Contact& contact) {
  const Vec2 tangent = perpendicular(contact.normal);
  const auto relative = [&] { return velocity_at(contact.a, contact.point) - velocity_at(contact.b, contact.point); };
  {
    const double wanted = (contact.bounce_mps - dot(relative(), contact.normal)) / mobility(contact, contact.normal);
    const double sum = std::max(0.0, contact.normal_impulse + wanted);
    exchange(contact, (sum - contact.normal_impulse) * contact.normal);
    contact.normal_impulse = sum;
  }
  const double limit = contact.friction * contact.normal_impulse;
  const double wanted = -dot(relative(), tangent) / mobility(contact, tangent);
  const double sum = std::clamp(contact.tangent_impulse + wanted, -limit, limit);
  exchange(contact, (sum - contact.tangent_impulse) * tangent);
  contact.tangent_impulse = sum;
}

}  // namespace

std::array<Vec2, 4> corners(const Square& square) {
  const Vec2 ahead = rotated({square.half_side_m, 0.0}, square.body->theta);
  const Vec2 left = perpendicular(ahead);
  const Vec2 p = square.body->position;
  return {p + ahead + left, p - ahead + left, p - ahead - left, p + ahead - left};
}

bool is_inside(const Outline& outline, Vec2 point) {
  bool inside = false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 a = outline[i], b = outline[(i + 1) % outline.size()];
    // Walls that the way from the point along x crosses, each counted once.
    if ((a.y > point.y) != (b.y > point.y) && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)) {
      inside = !inside;
    }
  }
  return inside;
}

void collide(const Square& a, const Square& b, Surface surface, Contacts& out) {
  const Vec2 between = a.body->position - b.body->position;
  const double reach = (a.half_side_m + b.half_side_m) * kCornerReach;
  if (dot(between, between) > reach * reach) return;
  // Separating axes: the sides' normals of both; the one with the least overlap is the way out.
  const std::size_t before = out.size();
  const std::array<Vec2, 4> of_a = corners(a), of_b = corners(b);
  double least = std::numeric_limits<double>::max();
  Vec2 normal;
  for (int i = 0; i < 4; ++i) {
    Vec2 axis = rotated(i % 2 == 0 ? Vec2{1.0, 0.0} : Vec2{0.0, 1.0}, (i < 2 ? a : b).body->theta);
    if (dot(axis, between) < 0.0) axis = -axis;
    double lowest_a = std::numeric_limits<double>::max(), highest_b = std::numeric_limits<double>::lowest();
    for (const Vec2& corner : of_a) lowest_a = std::min(lowest_a, dot(corner, axis));
    for (const Vec2& corner : of_b) highest_b = std::max(highest_b, dot(corner, axis));
    const double overlap = highest_b - lowest_a;
    if (overlap <= 0.0) return;
    if (overlap < least) {
      least = overlap;
      normal = axis;
    }
  }
  double lowest_a = std::numeric_limits<double>::max(), highest_b = std::numeric_limits<double>::lowest();
  for (const Vec2& corner : of_a) lowest_a = std::min(lowest_a, dot(corner, normal));
  for (const Vec2& corner : of_b) highest_b = std::max(highest_b, dot(corner, normal));
  for (const Vec2& corner : of_a) {
    if (is_inside(b, corner)) add(out, a.body, b.body, corner, normal, highest_b - dot(corner, normal), surface);
  }
  for (const Vec2& corner : of_b) {
    if (is_inside(a, corner)) add(out, a.body, b.body, corner, normal, dot(corner, normal) - lowest_a, surface);
  }
  // Two squares one on the other, as at a careless start, may cross like a star: no corner is inside.
  if (out.size() == before)
    add(out, a.body, b.body, 0.5 * (a.body->position + b.body->position), normal, least, surface);
}

void collide(const Square& a, const Outline& walls, Surface surface, Contacts& out) {
  const double reach = a.half_side_m * kCornerReach;
  if (is_inside(walls, a.body->position) && nearest_on(walls, a.body->position).distance_m > reach) return;
  for (const Vec2& corner : corners(a)) {
    if (is_inside(walls, corner)) continue;
    const RimPlace rim = nearest_on(walls, corner);
    add(out, a.body, nullptr, corner, way_in(rim, corner), rim.distance_m, surface);
  }
  // A corner of the outline that stands into the field (a goal post) may enter the square between the square's own.
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const Vec2 before = walls[i], post = walls[(i + 1) % walls.size()], after = walls[(i + 2) % walls.size()];
    if (cross(post - before, after - post) >= 0.0 || !is_inside(a, post)) continue;
    const Exit exit = nearest_side(a, post);
    add(out, a.body, nullptr, post, -exit.normal, exit.depth_m, surface);
  }
}

void collide(const Circle& a, const Square& b, Surface surface, Contacts& out) {
  const Vec2 between = a.body->position - b.body->position;
  const double reach = a.radius_m + b.half_side_m * kCornerReach;
  if (dot(between, between) > reach * reach) return;
  if (is_inside(b, a.body->position)) {
    const Exit exit = nearest_side(b, a.body->position);
    add(out, a.body, b.body, a.body->position, exit.normal, exit.depth_m + a.radius_m, surface);
    return;
  }
  const Vec2 local = to_local(b, a.body->position);
  const Vec2 nearest_local{std::clamp(local.x, -b.half_side_m, b.half_side_m),
                           std::clamp(local.y, -b.half_side_m, b.half_side_m)};
  const Vec2 nearest = b.body->position + rotated(nearest_local, b.body->theta);
  const Vec2 gap = a.body->position - nearest;
  const double distance = length(gap);
  if (distance >= a.radius_m || distance <= 0.0) return;
  add(out, a.body, b.body, nearest, (1.0 / distance) * gap, a.radius_m - distance, surface);
}

void collide(const Circle& a, const Outline& walls, Surface surface, Contacts& out) {
  const Vec2 center = a.body->position;
  if (!is_inside(walls, center)) {
    const RimPlace rim = nearest_on(walls, center);
    add(out, a.body, nullptr, rim.point, way_in(rim, center), rim.distance_m + a.radius_m, surface);
    return;
  }
  double place_before = place_along(walls.back(), walls[0], center);
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const Vec2 begin = walls[i], end = walls[(i + 1) % walls.size()];
    const double place = place_along(begin, end, center);
    // Its begin only where the wall before has ended: else that one is what stands in the way.
    const bool faces = place < 1.0 && (place > 0.0 || place_before >= 1.0);
    place_before = place;
    if (!faces) continue;
    const Vec2 nearest = nearest_of_wall(begin, end, center), gap = center - nearest;
    const double distance = length(gap);
    if (distance >= a.radius_m || distance <= 0.0) continue;
    add(out, a.body, nullptr, nearest, (1.0 / distance) * gap, a.radius_m - distance, surface);
  }
}

void resolve(Contacts& contacts) {
  for (Contact& contact : contacts) {
    const Vec2 relative = velocity_at(contact.a, contact.point) - velocity_at(contact.b, contact.point);
    const double approach = -dot(relative, contact.normal);
    contact.bounce_mps = approach > kLeastBounceMps ? contact.restitution * approach : 0.0;
  }
  for (int i = 0; i < kIterations; ++i) {
    for (Contact& contact : contacts) iterate(contact);
  }
  for (const Contact& contact : contacts) {
    const double excess = contact.depth_m - kSlopM;
    if (excess <= 0.0) continue;
    const double mass_b = contact.b == nullptr ? 0.0 : contact.b->inverse_mass;
    const double share = kCorrection * excess / (contact.a->inverse_mass + mass_b);
    contact.a->position = contact.a->position + share * contact.a->inverse_mass * contact.normal;
    if (contact.b != nullptr) contact.b->position = contact.b->position - share * mass_b * contact.normal;
  }
}

}  // namespace touchline::hal::mock
