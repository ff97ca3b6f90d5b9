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
// Deeper than this a square's corner is not inside a wall but beyond its end.
constexpr double kWallThicknessM = 0.05;

std::array<Vec2, 4> corners(const Square& square) {
  const Vec2 ahead = rotated({square.half_side_m, 0.0}, square.body->theta);
  const Vec2 left = perpendicular(ahead);
  const Vec2 p = square.body->position;
  return {p + ahead + left, p - ahead + left, p - ahead - left, p + ahead - left};
}

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

void collide(const Square& a, const Square& b, Surface surface, Contacts& out) {
  const Vec2 between = a.body->position - b.body->position;
  const double reach = (a.half_side_m + b.half_side_m) * 1.4143;
  if (dot(between, between) > reach * reach) return;
  // Separating axes: the sides' normals of both; the one with the least overlap is the way out.
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
}

void collide(const Square& a, const Wall& wall, Surface surface, Contacts& out) {
  const Vec2 way = wall.end - wall.begin;
  const double extent = length(way);
  const Vec2 along = (1.0 / extent) * way, inwards = perpendicular(along);
  const double distance = dot(a.body->position - wall.begin, inwards);
  if (distance > a.half_side_m * 1.4143 || distance < -kWallThicknessM) return;
  for (const Vec2& corner : corners(a)) {
    const Vec2 from_begin = corner - wall.begin;
    const double depth = -dot(from_begin, inwards), place = dot(from_begin, along);
    if (depth > 0.0 && depth < kWallThicknessM && place >= 0.0 && place <= extent) {
      add(out, a.body, nullptr, corner, inwards, depth, surface);
    }
  }
  // Where two walls meet in an edge that stands into the field (a goal post), it is the edge that enters the square.
  if (is_inside(a, wall.end)) {
    const Exit exit = nearest_side(a, wall.end);
    add(out, a.body, nullptr, wall.end, -exit.normal, exit.depth_m, surface);
  }
}

void collide(const Circle& a, const Square& b, Surface surface, Contacts& out) {
  const Vec2 between = a.body->position - b.body->position;
  const double reach = a.radius_m + b.half_side_m * 1.4143;
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

void collide(const Circle& a, const Wall& wall, Surface surface, Contacts& out) {
  const Vec2 way = wall.end - wall.begin;
  const double extent = length(way);
  const Vec2 along = (1.0 / extent) * way, inwards = perpendicular(along);
  const Vec2 from_begin = a.body->position - wall.begin;
  const double distance = dot(from_begin, inwards), place = dot(from_begin, along);
  if (place >= 0.0 && place <= extent) {
    if (distance < a.radius_m && distance > -kWallThicknessM) {
      add(out, a.body, nullptr, a.body->position - distance * inwards, inwards, a.radius_m - distance, surface);
    }
    return;
  }
  const Vec2 gap = a.body->position - wall.end;
  const double to_edge = length(gap);
  if (to_edge < a.radius_m && to_edge > 0.0 && distance > 0.0) {
    add(out, a.body, nullptr, wall.end, (1.0 / to_edge) * gap, a.radius_m - to_edge, surface);
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
